//! Largest tension on the faces of a body, from stresses at sufficiently dense points.
//!
//! The faces of a box are the impacted face ("upper") and the opposite face ("lower"), or both faces of each layer
//! ("1-upper", "1-lower" and so on from the impacted face). Their points form a grid; a parabola along each axis
//! estimates the maximum between points. On the faces of stiff layers only the in-plane stresses are used. On the faces
//! of soft layers all stresses are used, since transverse shear is dominant there. On a mesh from a file, the faces are
//! its named surfaces, evaluated at their nodes.

mod grid;

use petsc_wrap::Int;

use crate::form::stress::{largest_in_plane, largest_principal, place, with_shear};
use crate::mesh::Whole;
use crate::scene::face_names;
use crate::scene::faces::name as surface_name;
use crate::scene::{Geometry, Scene, Vec3};

use super::stress_map::Recovered;
use super::{ContactNow, Form, LineStresses, LocalPoint, Map, NearHit, StressMap, TensionMap};

pub use grid::FaceGrid;

/// Distance from the impact point, divided by the thickness, within which a face of a box is evaluated only at the
/// impact point, by a mean. The largest tension of a contact is there, and the stresses of coarse cells nearby are
/// inaccurate.
const NEAR_HIT_OVER_THICKNESS: f64 = 1.25;

/// Distance from the impact point within which faces include the local field, divided by the larger of the thickness
/// and the contact radius.
const REACH: f64 = 2.0;

/// Relative difference of two stresses that may be due to rounding.
pub(super) const ALIKE: f64 = 1e-6;

/// Points and stresses for the largest tension on each face; held by one rank.
#[derive(Clone)]
pub struct FaceStresses {
    /// Coordinates of the body that the map uses.
    pub columns: Vec<Int>,
    /// Stresses at the sampled points. On a box, three for each point: the in-plane stresses a, b and ab, or the
    /// stresses across the face.
    pub map: StressMap,
    /// Faces.
    pub faces: Vec<Face>,
}

/// Largest difference of two equal coordinates due to rounding, m.
const SAME_PLACE: f64 = 1e-9;

/// Points of one face.
#[derive(Debug, Clone)]
pub struct Face {
    /// Name of the face.
    pub name: String,
    /// Positions at which stresses are evaluated, m.
    pub points: Vec<Vec3>,
    /// Number of its first point among the sampled points.
    pub first: usize,
    /// Number of the first sampled point of the stresses across the face (shear along a, shear along b, normal stress),
    /// if these are used too.
    pub across: Option<usize>,
    /// Local field at points near the impact point, by point number.
    pub local: Vec<(usize, LocalPoint)>,
    /// For each point, whether it is left out.
    pub left_out: Vec<bool>,
    /// 1, or −1 if the stresses are opposite to the sampled stresses (on a plate in bending).
    pub sign: f64,
    /// Lines of the points along two axes, if they form a grid; the index along the second axis varies fastest.
    pub grid: Option<FaceGrid>,
}

/// Largest tension on a face at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceTension {
    /// Largest principal stress, Pa.
    pub largest: f64,
    /// Position, m; for a quarter, in the modelled part.
    pub point: Vec3,
}

impl Default for FaceStresses {
    /// Data of a rank that evaluates no stresses.
    fn default() -> Self {
        let map = StressMap::Forms { map: Map::Sparse(Vec::new()), components: 3 };
        Self::new(map, Vec::new())
    }
}

impl Face {
    /// Adds the local field at points of a mesh near the impact point.
    pub(super) fn add_local(&mut self, near: &NearHit, recovered: &Recovered) {
        for (number, x) in self.points.iter().enumerate() {
            if near.distance(*x) > REACH * near.width() {
                continue;
            }
            let local = near.recovered(*x, recovered.samples(self.first + number));
            self.local.extend(local.map(|local| (number, local.without_ring())));
        }
    }
}

impl Face {
    /// Largest principal stress at a point, from the sampled stresses (by number) and the contact; NaN if the point is
    /// left out.
    pub(super) fn value<S: AsRef<[f64]>>(
        &self,
        point: usize,
        sampled: impl Fn(usize) -> S,
        contact: &ContactNow,
    ) -> f64 {
        if self.left_out[point] {
            return f64::NAN;
        }
        let local = self.local_at(point).filter(|_| contact.force > 0.0).map(|local| local.stress(contact));
        let own = sampled(self.first + point);
        let own = own.as_ref();
        let lacking = |component: usize| local.map_or(0.0, |local| local[component]);
        let of = |i: usize, component: usize| self.sign * own[i] + lacking(component);
        let (a, b) = match (own.len(), &self.grid) {
            (3, Some(FaceGrid { axes: [a, b], .. })) => (*a, *b),
            (6, _) => return largest_principal(std::array::from_fn(|i| of(i, i))),
            _ => return f64::NAN,
        };
        let in_plane = [of(0, a), of(1, b), of(2, place(a, b))];
        let Some(first) = self.across else { return largest_in_plane(in_plane) };
        let (across, normal) = (sampled(first + point), 3 - a - b);
        let across = across.as_ref();
        // On a plate in bending, transverse shear is the same on both faces, and the normal stress is opposite.
        let shear = [(0, a), (1, b)].map(|(i, axis)| across[i] + lacking(place(axis, normal)));
        with_shear(in_plane, [shear[0], shear[1], self.sign * across[2] + lacking(normal)])
    }

    fn local_at(&self, point: usize) -> Option<&LocalPoint> {
        self.local.binary_search_by_key(&point, |(of, _)| *of).ok().map(|at| &self.local[at].1)
    }

    /// Largest value of some points that are not left out, and the numbers of all points with the same value up to
    /// rounding, such as mirror images. The position is the one of these points with the largest x, then y, then z. On
    /// a grid the value is increased by interpolation with the neighbours there.
    pub(super) fn largest(
        &self,
        points: impl Iterator<Item = usize>,
        value: impl Fn(usize) -> f64,
    ) -> (Vec<usize>, FaceTension) {
        let mut alike: Vec<(usize, f64)> = points.map(|point| (point, value(point))).collect();
        let most = alike.iter().map(|(_, value)| *value).fold(f64::NAN, f64::max);
        alike.retain(|(_, value)| *value >= most - ALIKE * most.abs());
        let farther = |one: (usize, f64), other: (usize, f64)| {
            if is_farther(self.points[other.0], self.points[one.0]) { other } else { one }
        };
        let (point, largest) = alike.iter().copied().reduce(farther).unwrap_or((0, f64::NAN));
        let mut found = FaceTension { largest, point: self.points.get(point).copied().unwrap_or_default() };
        if let Some(grid) = &self.grid {
            grid.refine(point, largest, value, &mut found);
        }
        (alike.into_iter().map(|(point, _)| point).collect(), found)
    }

    /// Numbers of the points that are not left out.
    pub(super) fn read_points(&self) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(|point| !self.left_out[*point])
    }
}

/// Whether a position has the larger x; if x is equal, the larger y, then z.
fn is_farther(one: Vec3, other: Vec3) -> bool {
    let differences = one.iter().zip(other).map(|(one, other)| one - other);
    differences.into_iter().find(|difference| difference.abs() > SAME_PLACE).is_some_and(|difference| difference > 0.0)
}

impl FaceTension {
    /// Value if no stress was evaluated.
    pub const UNKNOWN: Self = Self { largest: f64::NAN, point: [f64::NAN; 3] };
}

/// Distance from a face of a layer, divided by its thickness, at which the face is evaluated, so that it does not
/// belong to the next layer.
pub(super) const WITHIN: f64 = 1e-9;

/// A face of a layer: its name, the number of the layer counted from the impacted face, its coordinate along the normal
/// axis, and the coordinate at which it is evaluated, m.
struct Level {
    name: String,
    layer: usize,
    height: f64,
    read_at: f64,
}

/// Faces of layers between ends (ascending, m), starting with the face farthest from the impact point.
fn levels(ends: &[f64], is_hit_from_above: bool) -> Vec<Level> {
    let mut ends = ends.to_vec();
    if is_hit_from_above {
        ends.reverse();
    }
    let sides = ends.windows(2).flat_map(|layer| {
        let within = if ends.len() > 2 { WITHIN * (layer[1] - layer[0]) } else { 0.0 };
        [(layer[0], layer[0] + within), (layer[1], layer[1] - within)]
    });
    let named = face_names(ends.len() - 1).into_iter().zip(sides).enumerate();
    let level = |(number, (name, (height, read_at)))| Level { name, layer: number / 2, height, read_at };
    let mut levels: Vec<Level> = named.map(level).collect();
    levels.reverse();
    levels
}

/// Coordinates (m) along the impact axis at which the faces of a scene's stiff layers are evaluated. On a body that
/// `bends_alone`, those of one half: the stresses on the others are opposite.
pub(super) fn heights_of_stiff_layers(scene: &Scene, bends_alone: bool) -> Vec<f64> {
    let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else {
        return Vec::new();
    };
    let (layers, soft) = (scene.hit_layers(), scene.soft_layers());
    let outer = [-0.5 * size[struck], 0.5 * size[struck]];
    let levels = levels(if layers.is_empty() { &outer } else { &layers }, scene.impactor.point[struck] > 0.0);
    let count = if bends_alone { levels.len() / 2 } else { levels.len() };
    let is_stiff = |level: &Level| soft.get(level.layer).is_none_or(|is_soft| !is_soft);
    levels.into_iter().take(count).filter(is_stiff).map(|level| level.read_at).collect()
}

/// How the stresses at a point of a face are evaluated.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointReading {
    /// As means near the impact point.
    pub is_smoothed: bool,
    /// All six components, not only the in-plane ones.
    pub is_whole: bool,
}

/// Faces of a box, or of its layers.
pub(super) struct BoxFaces {
    pub faces: Vec<Face>,
    /// Forms of the stresses at the sampled points, three each.
    pub forms: Vec<Form>,
    /// Faces whose in-plane stresses are sampled; the others have the opposite stresses.
    pub sampled: Vec<SampledFace>,
}

/// In-plane stresses at the points of a face.
pub(super) struct SampledFace {
    /// Number of the first sampled point.
    pub first: usize,
    /// Coordinate of the points along the axis normal to the face, m.
    pub height: f64,
}

/// Faces of a box normal to an axis, or of its layers, with the forms of the stresses at their points. `layers` are the
/// ends of the layers; `soft` says for each layer, from the impacted face, whether it is soft.
pub(super) fn of_box(
    (struck, hit): (usize, Vec3),
    (layers, soft): (&[f64], &[bool]),
    (lines, grid): (&[Vec<f64>; 3], FaceGrid),
    bends_alone: bool,
    at: impl Fn(Vec3, PointReading) -> [Form; 6],
    near: Option<&NearHit>,
) -> BoxFaces {
    let axes = grid.axes;
    let half = lines[struck].last().copied().unwrap_or_default();
    let outer = [-half, half];
    let layers = if layers.is_empty() { &outer[..] } else { layers };
    let size = lines.each_ref().map(|lines| lines.last().copied().unwrap_or_default());
    let is_hit = |x: Vec3| near.is_some_and(|near| near.distance(x) <= 1e-6 * near.thickness());
    let is_smoothed = |x: Vec3| is_hit(x) && near.is_some_and(|near| near.is_smoothed(x, size));
    let has_hit = is_smoothed(hit);
    let is_left_out = |x: &Vec3| {
        let is_near = has_hit
            && !is_hit(*x)
            && near.is_some_and(|near| near.distance(*x) < NEAR_HIT_OVER_THICKNESS * near.thickness());
        is_near || near.is_some_and(|near| near.is_under_layered_contact(*x))
    };
    let local = |points: &[Vec3]| -> Vec<(usize, LocalPoint)> {
        let reached = points.iter().enumerate().filter_map(|(number, x)| {
            let near = near.filter(|near| near.distance(*x) <= REACH * near.width() && !is_left_out(x))?;
            // The ring of tension at the edge of the contact is reported separately.
            Some((number, near.at(*x, is_smoothed(*x))?.without_ring()))
        });
        reached.collect()
    };
    let stress = |x: &Vec3, is_whole: bool| match is_left_out(x) {
        true => Default::default(),
        false => at(*x, PointReading { is_smoothed: is_smoothed(*x), is_whole }),
    };
    let [a, b] = axes;
    let (in_plane, across) = ([a, b, place(a, b)], [place(a, struck), place(b, struck), struck]);
    let (mut faces, mut forms, mut sampled) = (Vec::<Face>::new(), Vec::new(), Vec::new());
    let levels = levels(layers, hit[struck] > 0.0);
    let count = levels.len();
    for (number, Level { name, layer, height, read_at }) in levels.into_iter().enumerate() {
        let read = grid.points(struck, read_at);
        // In pure bending, the stresses on the other side of the middle plane are opposite.
        let opposite = (bends_alone && number >= count / 2).then(|| &faces[count - 1 - number]);
        let (first, across, sign) = match opposite {
            Some(Face { first, across, .. }) => (*first, *across, -1.0),
            None => {
                let (first, is_soft) = (forms.len() / 3, soft.get(layer).is_some_and(|is_soft| *is_soft));
                let mut all: Vec<[Form; 6]> = read.iter().map(|x| stress(x, is_soft)).collect();
                let mut take = |of: [usize; 3]| {
                    let of_points =
                        all.iter_mut().flat_map(|all| of.map(|component| std::mem::take(&mut all[component])));
                    forms.extend(of_points);
                };
                take(in_plane);
                sampled.push(SampledFace { first, height: read_at });
                if is_soft {
                    take(across);
                }
                (first, is_soft.then_some(first + read.len()), 1.0)
            }
        };
        let local = local(&read);
        let left_out = read.iter().map(is_left_out).collect();
        let points = grid.points(struck, height);
        faces.push(Face { name, points, first, across, local, left_out, sign, grid: Some(grid.clone()) });
    }
    faces.reverse();
    BoxFaces { faces, forms, sampled }
}

/// Faces of a mesh, and the nodes on them, face by face. The faces are the named surfaces or, for a box impacted along
/// an axis, its two outer faces, named according to the number of layers.
pub(super) fn of_mesh(mesh: &Whole, hit: Option<(usize, Vec3)>, layers: usize) -> (Vec<Face>, Vec<usize>) {
    let named: Vec<(String, &Vec<usize>)> = match hit {
        None => mesh.surfaces.iter().map(|(name, nodes)| (name.clone(), nodes)).collect(),
        Some((struck, point)) => {
            let is_positive = point[struck] > 0.0;
            let of_face = |(name, is_upper): (Option<String>, bool)| {
                let nodes = mesh.surfaces.get(surface_name((struck, is_upper)))?;
                Some((name?, nodes))
            };
            let mut names = face_names(layers).into_iter();
            let (first, last) = (names.next(), names.next_back());
            [(first, is_positive), (last, !is_positive)].into_iter().filter_map(of_face).collect()
        }
    };
    let (mut faces, mut all) = (Vec::new(), Vec::new());
    for (name, nodes) in named.into_iter().filter(|(_, nodes)| !nodes.is_empty()) {
        let points = nodes.iter().map(|&node| mesh.nodes[node]).collect();
        let left_out = vec![false; nodes.len()];
        let first = all.len();
        faces.push(Face { name, points, first, across: None, local: Vec::new(), left_out, sign: 1.0, grid: None });
        all.extend_from_slice(nodes);
    }
    (faces, all)
}

impl FaceStresses {
    /// Faces with the map of the stresses at their sampled points.
    pub(super) fn new(map: StressMap, faces: Vec<Face>) -> Self {
        Self { columns: Vec::new(), map, faces }
    }

    /// Largest tension on each face at a time (s), from the stresses at the sampled points and the contact, and the
    /// tensions at all points. At the points of the largest tension, the map contains the interpolated maximum.
    pub fn tensions(&self, stresses: &[f64], contact: &ContactNow, time: f64) -> (Vec<FaceTension>, TensionMap) {
        let components = self.map.components();
        let sampled = |number: usize| &stresses[components * number..components * (number + 1)];
        let (mut found, mut all) = (Vec::with_capacity(self.faces.len()), Vec::new());
        for face in &self.faces {
            let value = |point: usize| face.value(point, sampled, contact);
            let values: Vec<f64> = (0..face.points.len()).map(value).collect();
            let (alike, largest) = face.largest(face.read_points(), |point| values[point]);
            let first = all.len();
            all.extend(values.iter().map(|value| if value.is_nan() { f32::NEG_INFINITY } else { *value as f32 }));
            alike.into_iter().for_each(|point| all[first + point] = all[first + point].max(largest.largest as f32));
            found.push(largest);
        }
        (found, TensionMap::of_step(all, time))
    }

    /// Stresses on lines, if the body is reduced to a basis and has them.
    pub fn on_lines(&self) -> Option<&LineStresses> {
        match &self.map {
            StressMap::Lines(lines) => Some(lines),
            _ => None,
        }
    }

    /// The map as a dense matrix, if the body is reduced to a basis: the number of coordinates, and the entries row by
    /// row.
    pub fn dense(&self) -> Option<(usize, &[f64])> {
        match &self.map {
            StressMap::Forms { map: Map::Dense(count, entries), .. } => Some((*count, entries)),
            _ => None,
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
