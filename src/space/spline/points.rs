//! Displacement and stress at points of a box of splines.

use crate::description::Part;
use crate::element::gauss_legendre;
use crate::form::elastic::displacement;
use crate::form::stress::place;
use crate::form::tensor::{Derivative, Linear, Tensor};
use crate::form::{Projection, Spread};
use crate::scene::Vec3;
use crate::space::evaluate::{Add, Form, Forms, Hit, HitBody, PointEvaluator, add, divided, summed};
use crate::space::grid::GridField;
use crate::stack::{Layer, Pressure, Sections, Stack, on_parabola};

use nalgebra::DMatrix;

use super::geometry::BoxGeometry;
use super::patch::PatchModel;
use super::{DEGREE, inner, place as place_of, projected};

/// Number of hexahedra along each axis of a spline cell in which fields are written.
const PIECES: usize = 2;

/// Largest number of points of the fields, unless there is only one at each crossing of lines.
const MOST_POINTS: usize = 20_000;

/// Number of the two directions of a stress component that are normal to a face.
fn across_face(component: usize, across: usize) -> usize {
    (0..3)
        .flat_map(|i| (i..3).map(move |j| (i, j)))
        .find(|(i, j)| place(*i, *j) == component)
        .map_or(0, |(i, j)| usize::from(i == across) + usize::from(j == across))
}

/// Pressure that a part takes from its projected change of volume.
#[derive(Debug, Clone)]
struct ProjectedVolume {
    /// Part of λ that acts on the projected change of volume, Pa.
    lambda: f64,
    /// Projections along the axes.
    projections: [Projection; 3],
    /// For each component of the displacement and each axis, the projected functions of ∂u_i/∂x_i.
    functions: [[DMatrix<f64>; 3]; 3],
}

impl ProjectedVolume {
    /// Pressure of a part; `None` if all of λ acts on the change of volume itself.
    fn new(tensor: &Tensor<3>, part: &Part) -> Option<Self> {
        let lambda = projected(part);
        let of_axis = |axis: usize| Projection::new(&tensor.splines(0)[axis]);
        (lambda > 0.0).then(|| {
            let projections = [0, 1, 2].map(of_axis);
            let functions = [0, 1, 2]
                .map(|i| [0, 1, 2].map(|a| projections[a].coefficients(&tensor.splines(i)[a], usize::from(a == i))));
            Self { lambda, projections, functions }
        })
    }

    /// Passes the entries of λ Π div u at a point to `visit`.
    fn each_at(&self, tensor: &Tensor<3>, x: Vec3, mut visit: impl FnMut(usize, f64)) {
        for (component, functions) in self.functions.iter().enumerate() {
            let along = [0, 1, 2].map(|axis| self.projections[axis].values(x[axis], &functions[axis]));
            tensor.each_product(component, &along, self.lambda, &mut visit);
        }
    }
}

/// Discretisation of a box that can be evaluated anywhere in the modelled part.
#[derive(Debug, Clone)]
pub struct Points {
    pub(super) tensor: Tensor<3>,
    pub(super) lines: [Vec<f64>; 3],
    /// Hooke's law of each part, from below: stresses as functions of ∂u_i/∂x_j. For viscoelastic parts, at t → 0.
    laws: Vec<[[f64; 9]; 6]>,
    /// The rest of the normal stresses of each part, if it is nearly incompressible.
    projected: Vec<Option<ProjectedVolume>>,
    /// Heights of the interfaces between the parts, m. At an interface the law of the upper part applies, like the
    /// strains of the upper cell.
    interfaces: Vec<f64>,
    /// Pressure on the loaded disc, and the radius of the disc, m.
    spread: Spread,
    disc: f64,
    /// Whether the body is a layer, or a stack of layers, around the impact point.
    is_layer: bool,
    /// Stack of several layers, from the impacted face.
    stack: Option<Stack>,
    /// Impact point, m, and the axis normal to the impacted face.
    hit: Vec3,
    struck: usize,
    /// Whether the body is modelled in pure bending. The other half then has the opposite in-plane stresses.
    bends: bool,
}

impl Points {
    /// Evaluator of a box. In the local field, viscoelastic layers have their secant moduli at `time`, s.
    pub(super) fn new(
        tensor: Tensor<3>,
        lines: [Vec<f64>; 3],
        parts: &[Part],
        (geometry, patch): (&BoxGeometry, &PatchModel),
        time: f64,
    ) -> Self {
        let stack = match geometry.interfaces.len() {
            0 => None,
            _ => stack(parts, geometry, time),
        };
        let projected: Vec<_> = parts.iter().map(|part| ProjectedVolume::new(&tensor, part)).collect();
        let law = |(part, projected): (&Part, &Option<ProjectedVolume>)| {
            let mut rows = part.material.instantaneous.stress_of_gradient();
            let lambda = projected.as_ref().map_or(0.0, |projected| projected.lambda);
            (0..9).for_each(|k| rows[k / 3][4 * (k % 3)] -= lambda);
            rows
        };
        Self {
            stack,
            laws: parts.iter().zip(&projected).map(law).collect(),
            projected,
            tensor,
            lines,
            interfaces: inner(&geometry.interfaces),
            spread: patch.spread,
            disc: patch.disc,
            hit: geometry.hit,
            struck: geometry.struck,
            is_layer: patch.is_layer || (patch.is_stack && !geometry.interfaces.is_empty()),
            bends: patch.bends,
        }
    }

    /// Ends of the part at a height along the axis normal to the impacted face, m; for a single part, the ends of the
    /// box.
    fn layer_at(&self, height: f64) -> [f64; 2] {
        let half = self.lines[self.struck].last().copied().unwrap_or_default();
        let number = self.interfaces.partition_point(|end| *end <= height);
        let below = if number == 0 { -half } else { self.interfaces[number - 1] };
        [below, self.interfaces.get(number).copied().unwrap_or(half)]
    }

    /// Number of the part at a point; on top of the box, of its last part.
    fn part(&self, x: Vec3) -> usize {
        self.interfaces.partition_point(|height| *height <= x[2])
    }

    /// Hooke's law at a point.
    fn law(&self, x: Vec3) -> &[[f64; 9]; 6] {
        &self.laws[self.part(x)]
    }

    /// Form of the stress at a point that Hooke's law of its part lacks, equal along all axes.
    fn projected_at(&self, x: Vec3) -> Form {
        let mut form = Form::new();
        if let Some(projected) = &self.projected[self.part(x)] {
            projected.each_at(&self.tensor, x, |unknown, value| form.push((unknown, value)));
        }
        form
    }
}

/// Layers of a box from the impacted face, with their secant moduli at a time, s.
pub(super) fn stack(parts: &[Part], geometry: &BoxGeometry, time: f64) -> Option<Stack> {
    let layer = |(part, ends): (&Part, &[f64])| Layer::of(ends[1] - ends[0], &part.material.secant(time));
    let mut layers: Vec<Layer> = parts.iter().zip(geometry.interfaces.windows(2)).map(layer).collect();
    if geometry.hit[geometry.struck] > 0.0 {
        layers.reverse();
    }
    Stack::new(&layers)
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

    fn body_force(&self, parts: &[Part]) -> Vec<f64> {
        let of_part = |part: &Part| {
            let (force, place) = (part.force, place_of(part));
            (0..3).map(move |i| Linear { factor: force[i], part: displacement(i), place })
        };
        let forms = parts.iter().flat_map(of_part);
        self.tensor.vector(&forms.filter(|form| form.factor != 0.0).collect::<Vec<_>>())
    }
}

impl PointEvaluator for Points {
    fn at(&self, x: Vec3) -> Forms {
        let mut stress: [Form; 6] = Default::default();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let mut derivatives = [0; 3];
            derivatives[j] = 1;
            let slope = self.tensor.at_point(Derivative { field: i, derivatives }, x, 1.0);
            stress.iter_mut().zip(self.law(x)).for_each(|(form, row)| add(form, row[3 * i + j], &slope));
        }
        let projected = self.projected_at(x);
        stress[..3].iter_mut().for_each(|form| add(form, 1.0, &projected));
        Forms { displacement: self.displacement(x), stress: stress.map(summed), local: None }
    }

    fn hit(&self) -> Option<Hit> {
        let body = if self.bends { Sections::BentSolid } else { Sections::Solid };
        let pressure = Pressure::of(self.spread, self.disc);
        let cell = Hit::cell(&self.lines, self.struck, self.hit);
        let body = match &self.stack {
            Some(stack) => HitBody::Layers(stack.clone()),
            None => HitBody::OneLayer(body),
        };
        self.is_layer.then_some(Hit { pressure, body, cell })
    }

    fn cell_lines(&self) -> [Vec<f64>; 3] {
        self.lines.clone()
    }

    fn bends_alone(&self) -> bool {
        self.bends
    }

    fn unknowns(&self) -> usize {
        self.tensor.unknowns()
    }

    fn face_stress(&self, x: Vec3) -> [Form; 6] {
        let mut stress: [Form; 6] = Default::default();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let mut derivatives = [0; 3];
            derivatives[j] = 1;
            self.tensor.each_at(Derivative { field: i, derivatives }, x, 1.0, |first, values| {
                for (component, row) in self.law(x).iter().enumerate() {
                    let factor = row[3 * i + j];
                    if factor != 0.0 && across_face(component, self.struck) == 0 {
                        let entries = values.iter().enumerate().filter(|(_, value)| **value != 0.0);
                        stress[component].extend(entries.map(|(n, value)| (first + n, factor * value)));
                    }
                }
            });
        }
        let projected = self.projected_at(x);
        (0..3).filter(|axis| *axis != self.struck).for_each(|axis| add(&mut stress[axis], 1.0, &projected));
        stress
    }

    fn add_section_stress(&self, x: Vec3, add: &mut Add) {
        let (across, lines) = (self.struck, &self.lines[self.struck]);
        let [low, high] = self.layer_at(x[across]);
        let (middle, thickness) = (0.5 * (low + high), high - low);
        let height = x[across] - middle;
        // Stresses times z² are of degree DEGREE + 2.
        let rule = gauss_legendre(if self.interfaces.is_empty() { DEGREE / 2 + 1 } else { DEGREE / 2 + 2 });
        // In pure bending, the stresses in the other half are opposite.
        let from = if self.bends { 0.0 } else { low };
        let both = if self.bends { 2.0 } else { 1.0 };
        let inside = lines.iter().copied().filter(|z| from < *z && *z <= high);
        let breaks: Vec<f64> = std::iter::once(from).chain(inside).collect();
        for ends in breaks.windows(2).filter(|ends| ends[0] < ends[1]) {
            for (node, weight) in &rule {
                let mut at = x;
                at[across] = 0.5 * (ends[0] + ends[1] + (ends[1] - ends[0]) * node);
                let part = 0.5 * (ends[1] - ends[0]) * weight / thickness;
                let mean = if self.bends { 0.0 } else { part };
                // In-plane: σ(z) = ∫σ dz/h + 12 z ∫σ z dz/h³. Transverse shear: 3/2 (1 − (2z/h)²) ∫σ dz/h.
                let along = mean + both * part * 12.0 * height * (at[across] - middle) / (thickness * thickness);
                let shear = if self.interfaces.is_empty() {
                    both * part * 1.5 * (1.0 - (height / (0.5 * thickness)).powi(2))
                } else {
                    // Shear is non-zero at the faces of a layer: the parabola with the same three moments.
                    part * on_parabola(height / thickness, (at[across] - middle) / thickness)
                };
                for (unknown, value) in self.projected_at(at) {
                    (0..3).filter(|axis| *axis != across).for_each(|axis| add(axis, unknown, along * value));
                }
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    let mut derivatives = [0; 3];
                    derivatives[j] = 1;
                    self.tensor.each_at(Derivative { field: i, derivatives }, at, 1.0, |first, values| {
                        for (component, row) in self.law(at).iter().enumerate() {
                            let factor = row[3 * i + j]
                                * match across_face(component, across) {
                                    0 => along,
                                    1 => shear,
                                    _ => 0.0,
                                };
                            if factor != 0.0 {
                                values
                                    .iter()
                                    .enumerate()
                                    .for_each(|(n, value)| add(component, first + n, factor * value));
                            }
                        }
                    });
                }
            }
        }
    }

    fn field_lines(&self) -> [Vec<f64>; 3] {
        let cut = |pieces: usize| self.lines.each_ref().map(|lines| divided(lines, pieces));
        let fine = cut(PIECES);
        if fine.iter().map(Vec::len).product::<usize>() <= MOST_POINTS { fine } else { cut(1) }
    }
}
