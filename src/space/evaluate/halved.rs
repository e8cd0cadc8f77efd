//! What reads a body by half of its unknowns: each one that is left stands for its mirror image across the diagonal too.

use crate::body::Diagonal;
use crate::scene::Vec3;

use super::smoothed::Add;
use super::{Form, Forms, Hit, PointEvaluator};

/// A body's points by the unknowns that [`Diagonal`] leaves.
pub struct HalvedPoints<P> {
    points: P,
    diagonal: Diagonal,
}

impl<P: PointEvaluator> HalvedPoints<P> {
    /// Of points by all unknowns.
    pub fn new(points: P, diagonal: Diagonal) -> Self {
        Self { points, diagonal }
    }

    fn halved(&self, mut form: Form) -> Form {
        form.iter_mut().for_each(|(unknown, _)| *unknown = self.diagonal.standing(*unknown));
        form
    }
}

impl<P: PointEvaluator> PointEvaluator for HalvedPoints<P> {
    fn at(&self, x: Vec3) -> Forms {
        let Forms { displacement, stress, local } = self.points.at(x);
        let halved = |form: Form| super::summed(self.halved(form));
        Forms { displacement: displacement.map(halved), stress: stress.map(halved), local }
    }

    fn hit(&self) -> Option<Hit> {
        self.points.hit()
    }

    fn field_lines(&self) -> [Vec<f64>; 3] {
        self.points.field_lines()
    }

    fn face_stress(&self, x: Vec3) -> [Form; 6] {
        self.points.face_stress(x).map(|form| self.halved(form))
    }

    fn cell_lines(&self) -> [Vec<f64>; 3] {
        self.points.cell_lines()
    }

    fn bends_alone(&self) -> bool {
        self.points.bends_alone()
    }

    fn unknowns(&self) -> usize {
        self.diagonal.unknowns()
    }

    fn add_section_stress(&self, x: Vec3, add: &mut Add) {
        let mut add = |component, unknown, value| add(component, self.diagonal.standing(unknown), value);
        self.points.add_section_stress(x, &mut add);
    }

    fn add_normal_section_stress(&self, x: Vec3, add: &mut Add) {
        let mut add = |component, unknown, value| add(component, self.diagonal.standing(unknown), value);
        self.points.add_normal_section_stress(x, &mut add);
    }

    fn add_normal_section_stress_along(&self, x: Vec3, axis: usize, line: &[(f64, f64)], add: &mut Add) {
        let mut add = |component, unknown, value| add(component, self.diagonal.standing(unknown), value);
        self.points.add_normal_section_stress_along(x, axis, line, &mut add);
    }
}
