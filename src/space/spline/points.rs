//! Displacement and stress at the points of a box of splines.

use crate::form::Material;
use crate::form::elastic::{VOLUME, displacement};
use crate::form::tensor::{Linear, Part, Tensor};
use crate::scene::Vec3;
use crate::space::evaluate::{Form, Forms, PointEvaluator, add, divided, summed};
use crate::space::grid::GridField;

use super::DEGREE;

/// Hexahedra in a cell of splines along each axis, where fields are written.
const PIECES: usize = 2;

/// Points in a cell along each axis at which the largest tension is looked for.
const FACE_PIECES: usize = 2;

/// Points of fields at most, but for one at each crossing of lines.
const MOST_POINTS: usize = 20_000;

/// A box's discretisation, to be read anywhere in the modelled part.
#[derive(Debug, Clone)]
pub struct Points {
    pub(super) tensor: Tensor<3>,
    pub(super) lines: [Vec<f64>; 3],
    /// Hooke's law: stresses over ∂u_i/∂x_j.
    law: [[f64; 9]; 6],
    /// Radius of the disc that is pressed, m.
    disc: f64,
}

impl Points {
    pub(super) fn new(tensor: Tensor<3>, lines: [Vec<f64>; 3], material: &Material, disc: f64) -> Self {
        Self { tensor, lines, law: material.stress_of_gradient(), disc }
    }
}

impl GridField for Points {
    fn lines(&self) -> [&[f64]; 3] {
        self.lines.each_ref().map(Vec::as_slice)
    }

    fn degrees(&self) -> [usize; 3] {
        [DEGREE; 3]
    }

    fn unknowns(&self) -> usize {
        self.tensor.unknowns()
    }

    fn displacement(&self, x: Vec3) -> [Form; 3] {
        [0, 1, 2].map(|axis| self.tensor.at_point(displacement(axis), x, 1.0))
    }

    fn body_force(&self, force: Vec3) -> Vec<f64> {
        let forms = (0..3).map(|i| Linear { factor: force[i], part: displacement(i), place: VOLUME });
        self.tensor.vector(&forms.filter(|form| form.factor != 0.0).collect::<Vec<_>>())
    }
}

impl PointEvaluator for Points {
    fn at(&self, x: Vec3) -> Forms {
        let mut stress: [Form; 6] = Default::default();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let mut derivatives = [0; 3];
            derivatives[j] = 1;
            let slope = self.tensor.at_point(Part { field: i, derivatives }, x, 1.0);
            stress.iter_mut().zip(&self.law).for_each(|(form, row)| add(form, row[3 * i + j], &slope));
        }
        Forms { displacement: self.displacement(x), stress: stress.map(summed) }
    }

    fn blurred(&self) -> Option<f64> {
        Some(self.disc)
    }

    fn face_lines(&self) -> [Vec<f64>; 3] {
        self.lines.each_ref().map(|lines| divided(lines, FACE_PIECES))
    }

    fn bends_alone(&self) -> bool {
        false
    }

    fn field_lines(&self) -> [Vec<f64>; 3] {
        let cut = |pieces: usize| self.lines.each_ref().map(|lines| divided(lines, pieces));
        let fine = cut(PIECES);
        if fine.iter().map(Vec::len).product::<usize>() <= MOST_POINTS { fine } else { cut(1) }
    }
}
