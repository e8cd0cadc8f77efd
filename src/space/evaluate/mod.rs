//! Displacements and stresses at any points of a body, as linear functions of its unknowns.

mod faces;
mod grid;
mod line_stress;
mod map;
mod near;
mod sampler;
mod search;
mod smoothed;
mod stress_map;
mod tension_map;

pub use faces::{Face, FaceGrid, FaceStresses, FaceTension};
pub use grid::Grid;
pub use line_stress::{AtPlace, FaceLines, LinePart, LineStresses, Lines};
pub use map::{Map, products_of_steps, renumbered};
pub use near::{ContactNow, ContactSize, Hit, HitBody, LEAST_MEAN, LocalPoint, NearHit, TensionErrors};
pub use sampler::{FieldSampler, Fields};
pub use search::{Coordinates, STEPS_TOGETHER, Searched, TensionSearch};
pub use smoothed::Add;
pub use stress_map::StressMap;
pub use tension_map::TensionMap;

use std::cell::OnceCell;
use std::rc::Rc;

use crate::contact::Patch;
use crate::description::Description;
use crate::form::Material;
use crate::form::stress::place;
use crate::mesh::Whole;
use crate::scene::faces::along;
use crate::scene::{Scene, Symmetry, Vec3};

use super::finite_element::Nodes;
use super::parts::watched_places;
use faces::{BoxFaces, SampledFace, WITHIN};
use smoothed::smoothed;
use stress_map::Recovered;

/// A linear form on the unknowns of a body: pairs of unknown and coefficient. An unknown may occur more than once.
pub type Form = Vec<(usize, f64)>;

/// Linear forms for the displacement and the stress at a point.
#[derive(Debug, Clone, Default)]
pub struct Forms {
    /// Displacement along x, y, z, m.
    pub displacement: [Form; 3],
    /// Stresses xx, yy, zz, yz, xz, xy, Pa.
    pub stress: [Form; 6],
    /// Local field near the impact point, which these stresses lack.
    pub local: Option<LocalPoint>,
}

/// A body on a grid, or a plate, that can be evaluated at points of its modelled part.
pub trait PointEvaluator {
    /// Forms of the displacement and stress at a point, m.
    fn at(&self, x: Vec3) -> Forms;

    /// How the body carries the contact force, if known.
    fn hit(&self) -> Option<Hit>;

    /// Coordinates along the axes for the grid on which fields are written, m.
    fn field_lines(&self) -> [Vec<f64>; 3];

    /// In-plane stresses at a point of a face, m. An unknown may occur more than once.
    fn face_stress(&self, x: Vec3) -> [Form; 6];

    /// All stresses at a point of a face, m. An unknown may occur more than once.
    fn whole_stress(&self, x: Vec3) -> [Form; 6] {
        self.at(x).stress
    }

    /// Evaluates the in-plane stresses of faces line by line; `None` if they are evaluated point by point.
    fn on_face_lines(&self) -> Option<&dyn FaceLineEvaluator> {
        None
    }

    /// Ends of the cells along the axes, ascending, m.
    fn cell_lines(&self) -> [Vec<f64>; 3];

    /// Whether the stresses on the two faces are opposite.
    fn bends_alone(&self) -> bool;

    /// Number of unknowns.
    fn unknowns(&self) -> usize;

    /// Passes the stresses at a point, as carried by the section there, to `add`. In-plane stresses follow from their
    /// mean and moment over the thickness; transverse shear stresses follow from the shear force, with a parabolic
    /// distribution.
    fn add_section_stress(&self, x: Vec3, add: &mut smoothed::Add);

    /// Same as [`Self::add_section_stress`] for the normal stresses. Other components may be passed too.
    fn add_normal_section_stress(&self, x: Vec3, add: &mut smoothed::Add) {
        self.add_section_stress(x, add);
    }

    /// Weighted sum of these stresses over points on the line through `x` along an axis, given by their coordinates (m)
    /// and weights.
    fn add_normal_section_stress_along(&self, x: Vec3, axis: usize, line: &[(f64, f64)], add: &mut smoothed::Add) {
        for (at, weight) in line {
            let mut place = x;
            place[axis] = *at;
            self.add_normal_section_stress(place, &mut |component, unknown, value| {
                add(component, unknown, weight * value);
            });
        }
    }
}

/// A body whose in-plane stresses can be evaluated on lines along a face.
pub trait FaceLineEvaluator {
    /// In-plane stresses of a face at a height (m, along the axis normal to it) at the crossings of lines along its
    /// axes, ascending.
    fn in_plane(&self, lines: [&[f64]; 2], height: f64) -> FaceLines;

    /// Stresses across the face at one of its points, without the in-plane stresses. An unknown may occur more than
    /// once.
    fn across(&self, x: Vec3) -> [Form; 6];
}

/// A body that can be evaluated at points. If a quarter is modelled, the whole body can be evaluated.
pub struct Evaluator {
    kind: Kind,
    /// Neighbourhood of the impact point, where the local field is added to the stresses.
    near: Option<Box<NearHit>>,
    /// Axes normal to planes of symmetry beyond which there are mirror images.
    mirrors: Vec<usize>,
    /// Heights along z of the interfaces between layers of a box. For each, the height at which the layer nearer to the
    /// impact point is evaluated, m.
    interfaces: Vec<[f64; 2]>,
    /// Mean stresses on the other face opposite the impact point. They are needed for the error of the stresses and for
    /// the search for the largest tension.
    under_hit: OnceCell<Box<[Form; 6]>>,
}

enum Kind {
    Nodes(Rc<Nodes>),
    Grid(Box<dyn PointEvaluator>),
}

impl Evaluator {
    /// Evaluator of a solid on a mesh. Stresses are recovered at its nodes ([`super::finite_element::Recovery`]) and
    /// interpolated between them.
    pub fn of_mesh(scene: &Scene, mesh: Whole, patch: Option<&Patch>) -> Self {
        let parts: Vec<Material> =
            Description::new(scene).parts.iter().map(|part| part.material.instantaneous).collect();
        // The mesh includes its mirror images, so that recovery patches on a plane of symmetry are complete.
        let mesh = mirrors(scene).into_iter().fold(mesh, Whole::with_image);
        let near = patch.and_then(|patch| NearHit::of_patch_on_mesh(scene, patch.radius)).map(Box::new);
        Self {
            kind: Kind::Nodes(Rc::new(Nodes::new(mesh, &parts))),
            near,
            mirrors: Vec::new(),
            interfaces: Vec::new(),
            under_hit: OnceCell::new(),
        }
    }

    /// Evaluator of splines or a plate.
    pub fn of_grid(scene: &Scene, points: impl PointEvaluator + 'static) -> Self {
        let near = points.hit().and_then(|hit| NearHit::new(scene, hit)).map(Box::new);
        let layers = scene.hit_layers();
        let inner = layers.iter().skip(1).take(layers.len().saturating_sub(2));
        let nearer = |height: &f64| height + WITHIN * (layers[1] - layers[0]).copysign(scene.impactor.point[2]);
        Self {
            kind: Kind::Grid(Box::new(points)),
            near,
            mirrors: mirrors(scene),
            interfaces: inner.map(|height| [*height, nearer(height)]).collect(),
            under_hit: OnceCell::new(),
        }
    }

    /// Evaluator of the largest tension on each face, in the unknowns of the body or, with `basis`, in its reduced
    /// coordinates. Each basis vector holds the values of all unknowns.
    pub fn faces(&self, scene: &Scene, basis: Option<&[Vec<f64>]>) -> FaceStresses {
        let (faces, map) = match (&self.kind, scene.struck_axis()) {
            (Kind::Grid(points), Some(struck)) => {
                let hit = (struck, scene.impactor.point);
                let lines = points.cell_lines().map(|lines| divided(&lines, FACE_PIECES));
                let grid = FaceGrid::of_box(hit, &lines, &self.mirrors);
                let on_lines = basis.and_then(|basis| Some((points.on_face_lines()?, basis)));
                let BoxFaces { faces, forms, sampled } = faces::of_box(
                    hit,
                    (&scene.hit_layers(), &scene.soft_layers()),
                    (&lines, grid.clone()),
                    points.bends_alone(),
                    |x, reading| match on_lines {
                        _ if reading.is_smoothed => self.stress(points.as_ref(), x),
                        None if reading.is_whole => points.whole_stress(x),
                        None => points.face_stress(x),
                        Some((on_lines, _)) if reading.is_whole => on_lines.across(x),
                        Some(_) => Default::default(),
                    },
                    self.near.as_deref(),
                );
                let at_lines = grid.lines.each_ref().map(Vec::as_slice);
                let map = match (on_lines, &sampled[..]) {
                    (Some((on_lines, basis)), [SampledFace { height, .. }])
                        if basis.len() >= LEAST_VECTORS_FOR_LINES =>
                    {
                        let mut apart = Vec::new();
                        let mut forms = forms.into_iter();
                        for crossing in 0..forms.len() / 3 {
                            let of_point: Vec<Form> = forms.by_ref().take(3).collect();
                            if !of_point[0].is_empty() {
                                apart.push((crossing, Map::new(of_point.into_iter(), Some(basis))));
                            }
                        }
                        StressMap::Lines(LineStresses::new(on_lines.in_plane(at_lines, *height), apart, basis))
                    }
                    (Some((on_lines, basis)), sampled) => {
                        let is_apart: Vec<bool> = forms.iter().step_by(3).map(|form| !form.is_empty()).collect();
                        let (count, mut rows) = (basis.len(), Map::coefficients(forms, basis));
                        for SampledFace { first, height } in sampled {
                            let lines = LineStresses::new(on_lines.in_plane(at_lines, *height), Vec::new(), basis);
                            // All faces leave out the same points.
                            let is_on_lines = |point: usize| !is_apart[first + point] && !faces[0].left_out[point];
                            lines.write_forms(is_on_lines, &mut rows[3 * first * count..]);
                        }
                        StressMap::Forms { map: Map::Dense(count, rows), components: 3 }
                    }
                    (None, _) => StressMap::Forms { map: Map::new(forms.into_iter(), basis), components: 3 },
                };
                (faces, map)
            }
            (Kind::Nodes(nodes), struck) => {
                let layers = scene.hit_layers().len().saturating_sub(1);
                let hit = struck.map(|axis| (axis, scene.impactor.point));
                let (mut faces, all) = faces::of_mesh(&nodes.mesh, hit, layers);
                let recovered = Recovered::at(nodes, &all);
                if let Some(near) = &self.near {
                    faces.iter_mut().for_each(|face| face.add_local(near, &recovered));
                }
                let map = match basis {
                    Some(basis) => StressMap::on_basis(&recovered, basis),
                    None => StressMap::Recovered(Rc::new(recovered)),
                };
                (faces, map)
            }
            (Kind::Grid(_), None) => return FaceStresses::default(),
        };
        FaceStresses::new(map, faces)
    }

    /// Estimated errors of the tension under the impact point by averaging and by the local field; zero if no mean is used.
    pub fn tension_errors(&self) -> TensionErrors {
        match (&self.kind, &self.near) {
            (Kind::Grid(_), Some(near)) => near.tension_errors(),
            _ => TensionErrors::default(),
        }
    }

    /// Stresses σ_a, σ_b and σ_ab on the other face of a box opposite the impact point, along its axes: forms on all
    /// unknowns, and the missing local stresses for 1 N. The error of the stresses is estimated from them. `None` if
    /// they are not evaluated as means.
    pub fn hit_stress(&self, scene: &Scene) -> Option<(Vec<Vec<f64>>, [f64; 3])> {
        let (Kind::Grid(points), Some(near)) = (&self.kind, &self.near) else { return None };
        let x = near.under_hit();
        if !self.is_smoothed(points.as_ref(), x) {
            return None;
        }
        let radius = ContactSize::new(scene).at_peak(&scene.impactor);
        let local = near.lack_under_hit(radius);
        let stress = self.stress(points.as_ref(), x);
        let [a, b] = along(near.struck);
        let dense = |component: usize| {
            let mut form = vec![0.0; points.unknowns()];
            stress[component].iter().for_each(|(unknown, value)| form[*unknown] += value);
            form
        };
        let components = [a, b, place(a, b)];
        Some((components.map(dense).to_vec(), components.map(|component| local[component])))
    }

    /// Stresses at watched places ([`watched_places`]) on the faces of a box, or of its stiff layers: for each place and face
    /// σ_a, σ_b and σ_ab along its axes, as forms on all unknowns. Faces with opposite stresses are there once.
    pub fn watched_stresses(&self, scene: &Scene) -> Vec<Vec<f64>> {
        let (Kind::Grid(points), Some(near), Some(struck)) = (&self.kind, &self.near, scene.struck_axis()) else {
            return Vec::new();
        };
        let heights = faces::heights_of_stiff_layers(scene, points.bends_alone());
        let [a, b] = along(struck);
        let mut forms = Vec::new();
        for [x, y] in watched_places(scene, &self.mirrors, 2.0 * near.width()) {
            for height in &heights {
                let mut point = [*height; 3];
                (point[a], point[b]) = (x, y);
                let stress = points.face_stress(point);
                for component in [a, b, place(a, b)] {
                    let mut form = vec![0.0; points.unknowns()];
                    stress[component].iter().for_each(|(unknown, value)| form[*unknown] += value);
                    forms.push(form);
                }
            }
        }
        forms
    }

    /// Forms at a point (m); `None` outside a mesh. Splines are extrapolated beyond their ends. At an interface between
    /// layers of a box, the layer nearer to the impact point is evaluated.
    pub fn at(&self, mut point: Vec3) -> Option<Forms> {
        for [height, nearer] in &self.interfaces {
            if (point[2] - height).abs() < (nearer - height).abs() {
                point[2] = *nearer;
            }
        }
        let (mut image, mut signs) = (point, [1.0; 3]);
        for &axis in self.mirrors.iter().filter(|&&axis| point[axis] < 0.0) {
            (image[axis], signs[axis]) = (-point[axis], -1.0);
        }
        let mut forms = match &self.kind {
            Kind::Nodes(nodes) => {
                let (forms, samples) = nodes.at(image)?;
                let local = self.near.as_ref().and_then(|near| near.recovered(image, samples.into_iter()));
                Forms { local, ..forms }
            }
            Kind::Grid(points) => {
                let local =
                    self.near.as_ref().and_then(|near| near.at(point, self.is_smoothed(points.as_ref(), image)));
                Forms { stress: self.stress(points.as_ref(), image), local, ..points.at(image) }
            }
        };
        let turn = |form: &mut Form, sign: f64| form.iter_mut().for_each(|(_, value)| *value *= sign);
        for i in 0..3 {
            turn(&mut forms.displacement[i], signs[i]);
            (i + 1..3).for_each(|j| turn(&mut forms.stress[place(i, j)], signs[i] * signs[j]));
        }
        Some(forms)
    }

    fn is_smoothed(&self, points: &dyn PointEvaluator, x: Vec3) -> bool {
        let half = points.cell_lines().map(|lines| lines.last().copied().unwrap_or_default());
        self.near.as_ref().is_some_and(|near| near.is_smoothed(x, half))
    }

    /// Stresses of a body on a grid at a point of its modelled part; means near the impact point.
    fn stress(&self, points: &dyn PointEvaluator, x: Vec3) -> [Form; 6] {
        match &self.near {
            Some(near) if self.is_smoothed(points, x) => {
                let mean = || smoothed(points, &self.mirrors, x, (along(near.struck), near.smoothing()));
                if x == near.under_hit() { *self.under_hit.get_or_init(|| Box::new(mean())).clone() } else { mean() }
            }
            _ => points.at(x).stress,
        }
    }
}

/// Axes normal to planes of symmetry. The modelled part has positive coordinates along them.
fn mirrors(scene: &Scene) -> Vec<usize> {
    match scene.body.symmetry {
        Symmetry::Quarter { axes } => axes.to_vec(),
        Symmetry::None { .. } | Symmetry::Parts { .. } => Vec::new(),
    }
}

/// Adds the entries of a form, times a factor, to another form.
pub(super) fn add(to: &mut Form, factor: f64, form: &[(usize, f64)]) {
    if factor != 0.0 {
        to.extend(form.iter().map(|(unknown, value)| (*unknown, factor * value)));
    }
}

/// The same form with one entry for each unknown, ascending.
pub(super) fn summed(mut form: Form) -> Form {
    form.sort_by_key(|(unknown, _)| *unknown);
    form.dedup_by(|next, first| {
        let is_same = next.0 == first.0;
        if is_same {
            first.1 += next.1;
        }
        is_same
    });
    form.retain(|(_, value)| *value != 0.0);
    form
}

/// Number of basis vectors from which the stresses on lines are computed from spline coefficients at each step. For
/// fewer vectors, a dense map to all stresses is cheaper. With 228 vectors, lines take half the time.
const LEAST_VECTORS_FOR_LINES: usize = 150;

/// Number of pieces of a cell's edge, at whose ends the largest tension is searched.
const FACE_PIECES: usize = 2;

/// Ends of all cells, without repetition, and of the equal pieces into which each cell is divided.
pub(super) fn divided(breaks: &[f64], pieces: usize) -> Vec<f64> {
    let cells = breaks.windows(2).filter(|pair| pair[0] < pair[1]);
    let inner =
        cells.flat_map(|pair| (0..pieces).map(move |i| pair[0] + (pair[1] - pair[0]) * i as f64 / pieces as f64));
    inner.chain(breaks.last().copied()).collect()
}
