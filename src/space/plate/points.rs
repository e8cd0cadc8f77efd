//! Displacement and stress at points of a plate.
//!
//! For the displacement see `space/plate/layers/profile.rs`. Stresses are the plane stresses of bending. The only stress
//! across the plate is the transverse shear of [`crate::stack::Transverse`].

use super::geometry::PlateGeometry;
use super::layers::profile::is_rotation;
use super::{Disc, Layers};
use crate::description::Part;
use crate::form::plate::{AREA, Section, deflection};
use crate::form::stress::place;
use crate::form::tensor::{Derivative, Linear, Tensor};
use crate::form::{Material, Parity};
use crate::scene::Vec3;
use crate::space::evaluate::{
    Add, FaceLineEvaluator, FaceLines, Form, Forms, Hit, HitBody, PointEvaluator, add, divided, summed,
};
use crate::space::grid::GridField;
use crate::stack::{Pressure, Sections};

/// Number of hexahedra along each axis of a spline cell in which fields are written, since splines of degree 5 bend
/// within a cell.
const PIECES: usize = 3;

/// Discretisation of a plate that can be evaluated anywhere in the modelled part.
#[derive(Debug, Clone)]
pub struct Points {
    pub(super) geometry: PlateGeometry,
    pub(super) section: Section,
    /// Ends of the cells along the axes of the scene, m. Across the plate: the two faces, or all faces and interfaces
    /// of the layers.
    pub(super) lines: [Vec<f64>; 3],
    pub(super) tensor: Tensor<2>,
    pub(super) layers: Layers,
}

/// Material law at a height.
pub(super) struct Law {
    /// Plane-stress modulus E/(1 − ν²), Pa.
    pub plane: f64,
    pub poisson: f64,
    /// Shear modulus μ, Pa.
    pub shear: f64,
}

impl Points {
    /// Ends of the cells along the axes of the plane, m.
    pub(super) fn lines_in_plane(&self) -> [&[f64]; 2] {
        self.geometry.axes.map(|axis| &self.lines[axis][..])
    }

    /// Derivative of the displacement along an axis of the plane, as terms with factors: ζ times the rotation, or a sum
    /// over several rotations.
    pub(super) fn turned(&self, axis: usize, derivatives: [usize; 2], height: f64) -> Vec<(f64, Derivative<2>)> {
        let profile = &self.layers.profile;
        let of = |k: usize| {
            let (sign, part) = profile.rotation(k, axis, derivatives);
            (sign * profile.at(k, height), part)
        };
        (0..profile.functions()).map(of).filter(|(factor, _)| *factor != 0.0).collect()
    }

    /// Material law at a height. An interface belongs to the layer nearer to the impact point.
    pub(super) fn law(&self, height: f64) -> Law {
        let plane = |Material { young, poisson, .. }: Material| young / (1.0 - poisson * poisson);
        let shear = |Material { young, poisson, .. }: Material| 0.5 * young / (1.0 + poisson);
        let material = self.layers.material(self.layers.profile.layer_at(height));
        Law { plane: plane(material), poisson: material.poisson, shear: shear(material) }
    }

    /// Number of unknowns of all symmetry classes; each class has all unknowns of the tensor-product space.
    pub(super) fn all_unknowns(&self) -> usize {
        self.geometry.classes.len() * self.tensor.unknowns()
    }

    /// Lines of the whole region that is evaluated, along the axes of the scene, m.
    pub(super) fn lines_of_whole(&self) -> [Vec<f64>; 3] {
        let mut lines = self.lines.clone();
        for (i, axis) in self.geometry.axes.into_iter().enumerate() {
            lines[axis] = self.geometry.lines_of_whole(i, &lines[axis]);
        }
        lines
    }

    /// A derivative of a field at a point of the plane, for each symmetry class: the first unknown of the class, the
    /// mirror image of the point in the modelled part, and the ratio (±1) of the value at the point to the value at the
    /// image.
    fn in_classes(&self, part: Derivative<2>, point: [f64; 2]) -> impl Iterator<Item = (usize, [f64; 2], f64)> + '_ {
        let is_beyond = [0, 1].map(|i| self.geometry.halved[i] && point[i] < 0.0);
        let image = [0, 1].map(|i| if is_beyond[i] { -point[i] } else { point[i] });
        // A rotation is a slope: it is odd if the deflection is even.
        let is_turned = [0, 1].map(|i| (part.derivatives[i] + usize::from(is_rotation(part.field, i))) % 2 == 1);
        self.geometry.classes.iter().enumerate().map(move |(number, class)| {
            let flips = |i: &usize| is_beyond[*i] && (class[*i] == Parity::Odd) != is_turned[*i];
            let sign = if [0, 1].iter().filter(|i| flips(i)).count() == 1 { -1.0 } else { 1.0 };
            (number * self.tensor.unknowns(), image, sign)
        })
    }

    /// Calls `visit` with runs of consecutive entries of weight · (part of v at a point), each with its first unknown.
    fn each_at(&self, part: Derivative<2>, point: [f64; 2], weight: f64, mut visit: impl FnMut(usize, &[f64])) {
        for (start, image, sign) in self.in_classes(part, point) {
            self.tensor.each_at(part, image, sign * weight, |first, values| visit(start + first, values));
        }
    }

    /// Adds weight · (part of v at a point) to a vector.
    pub(super) fn add_point(&self, part: Derivative<2>, point: [f64; 2], weight: f64, sum: &mut [f64]) {
        self.each_at(part, point, weight, |first, values| {
            sum[first..].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        });
    }

    /// Adds factor · Σ weight · (part of v) for coordinates and weights on a line along the second axis.
    pub(super) fn add_line(&self, (part, factor): (Derivative<2>, f64), x: f64, line: &[(f64, f64)], sum: &mut [f64]) {
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

    /// Displacement at a point, where `read` evaluates a derivative of a field at a point of the plane.
    fn displacement_by(&self, x: Vec3, read: impl Fn(Derivative<2>, [f64; 2], f64) -> Form) -> [Form; 3] {
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (point, height) = self.seen(x);
        let mut displacement: [Form; 3] = Default::default();
        displacement[normal] = read(deflection([0, 0]), point, sign);
        for (i, axis) in axes.into_iter().enumerate() {
            let parts = self.turned(i, [0, 0], height).into_iter();
            displacement[axis] = parts.flat_map(|(factor, part)| read(part, point, factor)).collect();
        }
        displacement
    }

    /// A derivative of a field at a point in all symmetry classes, as a form.
    fn form(&self, part: Derivative<2>, point: [f64; 2], factor: f64) -> Form {
        let mut form = Form::new();
        self.each_at(part, point, factor, |first, values| {
            form.extend(values.iter().enumerate().filter(|(_, v)| **v != 0.0).map(|(n, v)| (first + n, *v)));
        });
        form
    }

    /// Passes a derivative of a field at a point, times a factor, to `add` for each of some components, times the
    /// factor of the component.
    fn put(&self, x: Vec3, to: &[(usize, f64)], (factor, part): (f64, Derivative<2>), add: &mut Add) {
        let (point, _) = self.seen(x);
        self.each_at(part, point, factor, |first, values| {
            for (n, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                to.iter().for_each(|(component, factor)| add(*component, first + n, factor * value));
            }
        });
    }

    /// Passes the in-plane stresses at a point to `add`.
    fn add_stress_in_plane(&self, x: Vec3, add: &mut Add) {
        self.add_normal_section_stress(x, add);
        let axes = self.geometry.axes;
        let (_, height) = self.seen(x);
        let Law { shear, .. } = self.law(height);
        for i in 0..axes.len() {
            let mut turn = [0, 0];
            turn[1 - i] = 1;
            for part in self.turned(i, turn, height) {
                self.put(x, &[(place(axes[0], axes[1]), shear)], part, add);
            }
        }
    }

    /// Coordinates in the plane, and the height ζ.
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

    fn body_force(&self, _: &[Part]) -> Vec<f64> {
        let force = [0, 1, 2].map(|axis| self.layers.force(axis));
        let factor = self.geometry.across(force);
        self.tensor.vector(&[Linear { factor, part: deflection([0, 0]), place: AREA }])
    }
}

impl FaceLineEvaluator for Points {
    fn in_plane(&self, lines: [&[f64]; 2], height: f64) -> FaceLines {
        self.stress_on_lines(lines, height)
    }

    fn across(&self, x: Vec3) -> [Form; 6] {
        let mut stress: [Form; 6] = Default::default();
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (point, height) = self.seen(x);
        for (i, axis) in axes.into_iter().enumerate() {
            for (factor, part) in self.layers.shear_stress(i, height) {
                stress[place(axis, normal)].extend(self.form(part, point, sign * factor));
            }
        }
        stress
    }
}

impl PointEvaluator for Points {
    fn at(&self, x: Vec3) -> Forms {
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (point, height) = self.seen(x);
        let form = |(factor, part): (f64, Derivative<2>)| self.form(part, point, factor);
        let mut stress: [Form; 6] = Default::default();
        let Law { plane, poisson, shear } = self.law(height);
        for (i, axis) in axes.into_iter().enumerate() {
            let mut along = [0, 0];
            along[i] = 1;
            let sum = |parts: Vec<(f64, Derivative<2>)>| -> Form { parts.into_iter().flat_map(&form).collect() };
            let stretch = sum(self.turned(i, along, height));
            add(&mut stress[axis], plane, &stretch);
            add(&mut stress[axes[1 - i]], plane * poisson, &stretch);
            add(&mut stress[place(axes[0], axes[1])], shear, &sum(self.turned(i, [along[1], along[0]], height)));
            add(&mut stress[place(axis, normal)], sign, &sum(self.layers.shear_stress(i, height)));
        }
        let displacement = self.displacement_by(x, |part, point, factor| self.form(part, point, factor));
        Forms { displacement, stress: stress.map(summed), local: None }
    }

    fn hit(&self) -> Option<Hit> {
        let PlateGeometry { axes, normal, hit, .. } = self.geometry;
        let mut point = [0.0; 3];
        (point[axes[0]], point[axes[1]]) = (hit[0], hit[1]);
        let (pressure, carrier) = match (self.layers.disc, self.geometry.wide_area()) {
            (Some(Disc { spread, radius }), _) => {
                (Pressure::of(spread, radius), HitBody::Layerwise(self.layers.theory().clone()))
            }
            (None, Some(area)) => {
                (Pressure::Hertz { radius: area.equivalent_radius() }, HitBody::OneLayer(Sections::Plate))
            }
            (None, None) => (Pressure::Point, HitBody::OneLayer(Sections::Plate)),
        };
        Some(Hit { pressure, body: carrier, cell: Hit::cell(&self.lines_of_whole(), normal, point) })
    }

    fn cell_lines(&self) -> [Vec<f64>; 3] {
        self.lines_of_whole()
    }

    fn bends_alone(&self) -> bool {
        self.layers.profile.is_mirrored()
    }

    fn unknowns(&self) -> usize {
        self.all_unknowns()
    }

    fn add_section_stress(&self, x: Vec3, add: &mut Add) {
        self.add_stress_in_plane(x, add);
        let PlateGeometry { axes, normal, sign, .. } = self.geometry;
        let (_, height) = self.seen(x);
        for (i, axis) in axes.into_iter().enumerate() {
            for part in self.layers.shear_stress(i, height) {
                self.put(x, &[(place(axis, normal), sign)], part, add);
            }
        }
    }

    fn add_normal_section_stress(&self, x: Vec3, add: &mut Add) {
        let axes = self.geometry.axes;
        let (_, height) = self.seen(x);
        let Law { plane, poisson, .. } = self.law(height);
        for (i, axis) in axes.into_iter().enumerate() {
            let mut along = [0, 0];
            along[i] = 1;
            for part in self.turned(i, along, height) {
                self.put(x, &[(axis, plane), (axes[1 - i], plane * poisson)], part, add);
            }
        }
    }

    /// Evaluates line by line: each line needs one product of the functions along both axes.
    fn add_normal_section_stress_along(&self, x: Vec3, axis: usize, line: &[(f64, f64)], add: &mut Add) {
        let axes = self.geometry.axes;
        debug_assert_eq!(axis, axes[1]);
        let (point, height) = self.seen(x);
        let Law { plane, poisson, .. } = self.law(height);
        for (i, axis) in axes.into_iter().enumerate() {
            let mut along = [0, 0];
            along[i] = 1;
            for (factor, part) in self.turned(i, along, height) {
                let mut form = vec![0.0; self.all_unknowns()];
                self.add_line((part, factor), point[0], line, &mut form);
                for (unknown, value) in form.into_iter().enumerate().filter(|(_, value)| *value != 0.0) {
                    add(axis, unknown, plane * value);
                    add(axes[1 - i], unknown, plane * poisson * value);
                }
            }
        }
    }

    fn face_stress(&self, x: Vec3) -> [Form; 6] {
        let mut stress: [Form; 6] = Default::default();
        self.add_stress_in_plane(x, &mut |component, unknown, value| stress[component].push((unknown, value)));
        stress
    }

    fn whole_stress(&self, x: Vec3) -> [Form; 6] {
        let mut stress = self.face_stress(x);
        stress.iter_mut().zip(self.across(x)).for_each(|(all, across)| all.extend(across));
        stress
    }

    fn on_face_lines(&self) -> Option<&dyn FaceLineEvaluator> {
        Some(self)
    }

    fn field_lines(&self) -> [Vec<f64>; 3] {
        let mut lines = self.lines_of_whole().map(|lines| divided(&lines, PIECES));
        let heights = &self.layers.profile.heights;
        lines[self.geometry.normal] = match heights[..] {
            [lower, upper] => vec![lower, 0.0, upper],
            _ => self.geometry.across_plate(heights),
        };
        lines
    }
}
