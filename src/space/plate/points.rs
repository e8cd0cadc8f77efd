//! A plate's displacement and stress at its points.
//!
//! A point at the height ζ along w moves by ζ θ in the plane, Kirchhoff's θ being −∇w. Stresses are plane, those of bending: across the
//! plate there is none but Mindlin's shear, on the parabola that is zero on both faces.

use super::geometry::PlateGeometry;
use super::{Local, PlateTheory};
use crate::description::Part as BodyPart;
use crate::form::Parity;
use crate::form::plate::{AREA, Section, deflection, rotation};
use crate::form::stress::place;
use crate::form::tensor::{Linear, Part, Tensor};
use crate::scene::Vec3;
use crate::space::evaluate::{Add, Form, Forms, Hit, PointEvaluator, add, divided, summed};
use crate::space::grid::GridField;
use crate::stack::{Pressure, Sections};

/// Hexahedra in a cell of splines along each axis, where fields are written: splines of degree 5 bend within a cell.
const PIECES: usize = 3;

/// Points in a cell along each axis at which the largest tension is looked for.
const FACE_PIECES: usize = 2;

/// A plate's discretisation, to be read anywhere in the modelled part.
#[derive(Debug, Clone)]
pub struct Points {
    pub(super) geometry: PlateGeometry,
    pub(super) section: Section,
    /// The ends of the cells along the scene's axes, m: across the plate its two faces.
    pub(super) lines: [Vec<f64>; 3],
    pub(super) tensor: Tensor<2>,
    pub(super) theory: PlateTheory,
    pub(super) local: Option<Local>,
}

impl Points {
    /// The ends of the cells along the axes of the plane, m.
    pub(super) fn lines_in_plane(&self) -> [&[f64]; 2] {
        self.geometry.axes.map(|axis| &self.lines[axis][..])
    }

    /// ζ times the rotation along an axis of the plane, differentiated.
    pub(super) fn turned(&self, axis: usize, derivatives: [usize; 2], height: f64) -> (f64, Part<2>) {
        match self.theory {
            PlateTheory::Mindlin => (height, rotation(axis, derivatives)),
            PlateTheory::Kirchhoff => {
                let mut all = derivatives;
                all[axis] += 1;
                (-height, deflection(all))
            }
        }
    }

    /// Unknowns of all classes; each has those of the tensor.
    pub(super) fn all_unknowns(&self) -> usize {
        self.geometry.classes.len() * self.tensor.unknowns()
    }

    /// The lines of all that is read, along the scene's axes, m.
    pub(super) fn lines_of_whole(&self) -> [Vec<f64>; 3] {
        let mut lines = self.lines.clone();
        for (i, axis) in self.geometry.axes.into_iter().enumerate() {
            lines[axis] = self.geometry.lines_of_whole(i, &lines[axis]);
        }
        lines
    }

    /// A part at a point of the plane in each class: the class' first unknown, the point's mirror image in the modelled part, and the
    /// part's sign at the point over that there.
    fn in_classes(&self, part: Part<2>, point: [f64; 2]) -> impl Iterator<Item = (usize, [f64; 2], f64)> + '_ {
        let is_beyond = [0, 1].map(|i| self.geometry.halved[i] && point[i] < 0.0);
        let image = [0, 1].map(|i| if is_beyond[i] { -point[i] } else { point[i] });
        // A rotation is a slope: odd where the deflection is even.
        let is_turned =
            [0, 1].map(|i| (part.derivatives[i] + usize::from(part.field == rotation(i, [0, 0]).field)) % 2 == 1);
        self.geometry.classes.iter().enumerate().map(move |(number, class)| {
            let flips = |i: &usize| is_beyond[*i] && (class[*i] == Parity::Odd) != is_turned[*i];
            let sign = if [0, 1].iter().filter(|i| flips(i)).count() == 1 { -1.0 } else { 1.0 };
            (number * self.tensor.unknowns(), image, sign)
        })
    }

    /// Hands runs of entries of weight · (part of v at a point) to a visitor, each with its first unknown.
    fn each_at(&self, part: Part<2>, point: [f64; 2], weight: f64, mut visit: impl FnMut(usize, &[f64])) {
        for (start, image, sign) in self.in_classes(part, point) {
            self.tensor.each_at(part, image, sign * weight, |first, values| visit(start + first, values));
        }
    }

    /// Adds weight · (part of v at a point) to a vector.
    pub(super) fn add_point(&self, part: Part<2>, point: [f64; 2], weight: f64, sum: &mut [f64]) {
        self.each_at(part, point, weight, |first, values| {
            sum[first..].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        });
    }

    /// Adds factor · Σ weight · (part of v) of places and weights on a line along the second axis.
    pub(super) fn add_line(&self, (part, factor): (Part<2>, f64), x: f64, line: &[(f64, f64)], sum: &mut [f64]) {
        let [below, above]: [Vec<(f64, f64)>; 2] =
            [true, false].map(|is_below| line.iter().copied().filter(|(y, _)| (*y < 0.0) == is_below).collect());
        for side in [below, above].into_iter().filter(|side| !side.is_empty()) {
            let n = self.tensor.unknowns();
            let first = side[0].0;
            for (start, [x, y], sign) in self.in_classes(part, [x, first]) {
                let turn = if y == first { 1.0 } else { -1.0 };
                let images: Vec<(f64, f64)> = side.iter().map(|(y, weight)| (turn * y, *weight)).collect();
                self.tensor.add_line((part, sign * factor), ([x, 0.0], 1), &images, &mut sum[start..start + n]);
            }
        }
    }

    /// The displacement at a point, with parts at points of the plane as they are read.
    fn displacement_by(&self, x: Vec3, read: impl Fn(Part<2>, [f64; 2], f64) -> Form) -> [Form; 3] {
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (point, height) = self.seen(x);
        let mut displacement: [Form; 3] = Default::default();
        displacement[normal] = read(deflection([0, 0]), point, sign);
        for (i, axis) in axes.into_iter().enumerate() {
            let (factor, part) = self.turned(i, [0, 0], height);
            displacement[axis] = read(part, point, factor);
        }
        displacement
    }

    /// A part at a point in all classes, as a form.
    fn form(&self, part: Part<2>, point: [f64; 2], factor: f64) -> Form {
        let mut form = Form::new();
        self.each_at(part, point, factor, |first, values| {
            form.extend(values.iter().enumerate().filter(|(_, v)| **v != 0.0).map(|(n, v)| (first + n, *v)));
        });
        form
    }

    /// Hands over a part times a factor at a point, to each of some components times another factor.
    fn put(&self, x: Vec3, to: &[(usize, f64)], (factor, part): (f64, Part<2>), add: &mut Add) {
        let (point, _) = self.seen(x);
        self.each_at(part, point, factor, |first, values| {
            for (n, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                to.iter().for_each(|(component, factor)| add(*component, first + n, factor * value));
            }
        });
    }

    /// Coordinates in the plane, and ζ.
    fn seen(&self, x: Vec3) -> ([f64; 2], f64) {
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        (axes.map(|axis| x[axis]), sign * x[normal])
    }
}

impl GridField for Points {
    fn lines(&self) -> [&[f64]; 3] {
        self.lines.each_ref().map(Vec::as_slice)
    }

    fn degrees(&self) -> [usize; 3] {
        let mut degrees = [super::theory::DEGREE; 3];
        degrees[self.geometry.normal] = 1;
        degrees
    }

    fn unknowns(&self) -> usize {
        self.tensor.unknowns()
    }

    fn displacement(&self, x: Vec3) -> [Form; 3] {
        self.displacement_by(x, |part, point, factor| self.tensor.at_point(part, point, factor))
    }

    fn body_force(&self, parts: &[BodyPart]) -> Vec<f64> {
        // A plate theory has one material, and so the same force everywhere.
        let force = parts.first().map_or([0.0; 3], |part| part.force);
        let factor = self.geometry.across(force) * self.section.thickness;
        self.tensor.vector(&[Linear { factor, part: deflection([0, 0]), place: AREA }])
    }
}

impl PointEvaluator for Points {
    fn at(&self, x: Vec3) -> Forms {
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (point, height) = self.seen(x);
        let form = |(factor, part): (f64, Part<2>)| self.form(part, point, factor);
        let mut stress: [Form; 6] = Default::default();
        let Section { young, poisson, thickness, .. } = self.section;
        let (plane, shear) = (young / (1.0 - poisson * poisson), 0.5 * young / (1.0 + poisson));
        for (i, axis) in axes.into_iter().enumerate() {
            let mut along = [0, 0];
            along[i] = 1;
            let stretch = form(self.turned(i, along, height));
            add(&mut stress[axis], plane, &stretch);
            add(&mut stress[axes[1 - i]], plane * poisson, &stretch);
            add(&mut stress[place(axes[0], axes[1])], shear, &form(self.turned(i, [along[1], along[0]], height)));
            if let Some(local) = &self.local {
                let over_mean = 1.5 * (1.0 - (2.0 * height / thickness).powi(2));
                let factor = sign * over_mean * local.shear_factor * shear;
                let to = &mut stress[place(axis, normal)];
                add(to, factor, &form((1.0, deflection(along))));
                add(to, factor, &form((1.0, rotation(i, [0, 0]))));
            }
        }
        let displacement = self.displacement_by(x, |part, point, factor| self.form(part, point, factor));
        Forms { displacement, stress: stress.map(summed), local: None }
    }

    fn hit(&self) -> Option<Hit> {
        let PlateGeometry { axes, normal, hit, .. } = self.geometry;
        let mut point = [0.0; 3];
        (point[axes[0]], point[axes[1]]) = (hit[0], hit[1]);
        let (pressure, reading) = match self.local {
            None => (Pressure::Point, 0.0),
            Some(Local { spread, radius, reading, .. }) => (Pressure::Spread { spread, radius }, reading),
        };
        let reading = reading * self.section.thickness.powi(2);
        Some(Hit {
            pressure,
            body: Sections::Plate { reading },
            cell: Hit::cell(&self.lines_of_whole(), normal, point),
        })
    }

    fn face_lines(&self) -> [Vec<f64>; 3] {
        self.lines_of_whole().map(|lines| divided(&lines, FACE_PIECES))
    }

    fn bends_alone(&self) -> bool {
        true
    }

    fn unknowns(&self) -> usize {
        self.all_unknowns()
    }

    fn add_section_stress(&self, x: Vec3, add: &mut Add) {
        self.add_normal_section_stress(x, add);
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (_, height) = self.seen(x);
        let Section { young, poisson, thickness, .. } = self.section;
        let shear = 0.5 * young / (1.0 + poisson);
        for (i, axis) in axes.into_iter().enumerate() {
            let (mut along, mut across) = ([0, 0], [0, 0]);
            (along[i], across[1 - i]) = (1, 1);
            self.put(x, &[(place(axes[0], axes[1]), shear)], self.turned(i, across, height), add);
            let over_mean = 1.5 * (1.0 - (2.0 * height / thickness).powi(2));
            if let Some(local) = self.local.as_ref().filter(|_| over_mean > 1e-12) {
                let to = [(place(axis, normal), sign * over_mean * local.shear_factor * shear)];
                self.put(x, &to, (1.0, deflection(along)), add);
                self.put(x, &to, (1.0, rotation(i, [0, 0])), add);
            }
        }
    }

    fn add_normal_section_stress(&self, x: Vec3, add: &mut Add) {
        let axes = self.geometry.axes;
        let (_, height) = self.seen(x);
        let Section { young, poisson, .. } = self.section;
        let plane = young / (1.0 - poisson * poisson);
        for (i, axis) in axes.into_iter().enumerate() {
            let mut along = [0, 0];
            along[i] = 1;
            self.put(x, &[(axis, plane), (axes[1 - i], plane * poisson)], self.turned(i, along, height), add);
        }
    }

    fn face_stress(&self, x: Vec3) -> [Form; 6] {
        let mut stress: [Form; 6] = Default::default();
        self.add_section_stress(x, &mut |component, unknown, value| stress[component].push((unknown, value)));
        stress
    }

    fn face_stress_on_lines(&self, lines: [&[f64]; 2], height: f64, basis: &[Vec<f64>]) -> Option<Vec<f64>> {
        Some(self.stress_on_lines(lines, height, basis))
    }

    fn field_lines(&self) -> [Vec<f64>; 3] {
        let half = 0.5 * self.section.thickness;
        let mut lines = self.lines_of_whole().map(|lines| divided(&lines, PIECES));
        lines[self.geometry.normal] = vec![-half, 0.0, half];
        lines
    }
}
