//! The largest tension on the faces of a body, from stresses at points that are dense enough for it.
//!
//! On a box these are the face that is hit ("upper") and the one opposite ("lower"), or both faces of each layer ("1-upper", "1-lower" and so
//! on from the hit down), on the points of a grid; between these a parabola
//! along each axis tells how much higher the largest value lies. On a mesh from a file they are its named surfaces, at their nodes.

use std::cell::OnceCell;
use std::rc::Rc;

use petsc_wrap::Int;

use crate::form::stress::{largest_in_plane, largest_principal, place};
use crate::mesh::Whole;
use crate::scene::Vec3;
use crate::scene::face_names;
use crate::scene::faces::{along, name as surface_name};

use super::search::{Screen, StressRows};
use super::stress_map::Recovered;
use super::{ContactNow, Form, LineStresses, LocalPoint, Map, NearHit, StressMap, TensionMap};

/// Thicknesses about the hit within which a face of a box is read at the hit alone, by a mean: a contact's largest tension is there, and
/// nearby the stresses of coarse cells are off.
const NEAR: f64 = 1.25;

/// Thicknesses about the hit within which faces get the local field.
const REACH: f64 = 2.0;

/// Difference of two stresses over them that may be rounding.
pub(super) const ALIKE: f64 = 1e-6;

/// Where stresses are read for the largest tension on each face; one rank has them.
#[derive(Clone)]
pub struct FaceStresses {
    /// The coordinates of the body that they need.
    pub columns: Vec<Int>,
    /// Stresses at the sampled points: of a box those in the plane of the face, a, b and ab.
    pub map: StressMap,
    /// The faces.
    pub faces: Vec<Face>,
    /// Of the map, what many searches share.
    pub(super) rows: OnceCell<Rc<StressRows>>,
    /// Of faces with grids, what such searches choose steps by.
    pub(super) screen: OnceCell<Option<Rc<Screen>>>,
}

/// The points of one face.
#[derive(Debug, Clone)]
pub struct Face {
    /// Its name.
    pub name: String,
    /// Where stresses are read, m.
    pub points: Vec<Vec3>,
    /// The number of its first point among those sampled.
    pub first: usize,
    /// What points near the hit lack, by their numbers.
    pub local: Vec<(usize, LocalPoint)>,
    /// Which of its points are not read.
    pub left_out: Vec<bool>,
    /// 1, or −1 where the stresses are the opposite of those sampled: on a plate that bends.
    pub sign: f64,
    /// Points along two axes where they form a grid, the second's fastest.
    pub grid: Option<FaceGrid>,
}

/// Points of a face between lines.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceGrid {
    /// The axes along the face.
    pub axes: [usize; 2],
    /// Coordinates along these, ascending, m.
    pub lines: [Vec<f64>; 2],
    /// Along which axes the first line is a plane of symmetry.
    pub is_mirrored: [bool; 2],
}

/// The largest tension on a face at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceTension {
    /// The largest principal stress, Pa.
    pub largest: f64,
    /// Where it is, m; of a quarter in the part that is modelled.
    pub point: Vec3,
}

impl Default for FaceStresses {
    /// Of a rank that does not read.
    fn default() -> Self {
        let map = StressMap::Forms { map: Map::Sparse(Vec::new()), components: 3 };
        Self::new(map, Vec::new())
    }
}

impl Face {
    /// Adds what points of a mesh near the hit lack.
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
    /// The largest principal stress at one of its points, of the stresses sampled there and the contact; NaN where it is not read.
    pub(super) fn value(&self, point: usize, sampled: &[f64], contact: &ContactNow) -> f64 {
        if self.left_out[point] {
            return f64::NAN;
        }
        let local = self.local_at(point).filter(|_| contact.force > 0.0).map(|local| local.stress(contact));
        let of = |i: usize, component: usize| self.sign * sampled[i] + local.map_or(0.0, |local| local[component]);
        match (sampled.len(), &self.grid) {
            (3, Some(FaceGrid { axes: [a, b], .. })) => largest_in_plane([of(0, *a), of(1, *b), of(2, place(*a, *b))]),
            (6, _) => largest_principal(std::array::from_fn(|i| of(i, i))),
            _ => f64::NAN,
        }
    }

    fn local_at(&self, point: usize) -> Option<&LocalPoint> {
        self.local.binary_search_by_key(&point, |(of, _)| *of).ok().map(|at| &self.local[at].1)
    }

    /// The largest value of points, which are read and ascend, at the first of those that have it but for rounding, as points that mirror
    /// each other do, with its number; on a grid lifted by its neighbours.
    pub(super) fn largest(
        &self,
        points: impl Iterator<Item = usize>,
        value: impl Fn(usize) -> f64,
    ) -> (usize, FaceTension) {
        let mut points = points.map(|point| (point, value(point))).peekable();
        // (Most often there is but one.)
        let first = match (points.next(), points.peek()) {
            (Some(one), Some(_)) => {
                let values: Vec<(usize, f64)> = std::iter::once(one).chain(points).collect();
                let most = values.iter().map(|(_, value)| *value).fold(f64::NAN, f64::max);
                values.into_iter().find(|(_, value)| *value >= most - ALIKE * most.abs())
            }
            (one, _) => one.filter(|(_, value)| !value.is_nan()),
        };
        let (point, largest) = first.unwrap_or((0, f64::NAN));
        let mut found = FaceTension { largest, point: self.points.get(point).copied().unwrap_or_default() };
        if let Some(grid) = &self.grid {
            grid.refine(point, largest, value, &mut found);
        }
        (point, found)
    }

    /// The numbers of the points that are read.
    pub(super) fn read_points(&self) -> impl Iterator<Item = usize> {
        (0..self.points.len()).filter(|point| !self.left_out[*point])
    }
}

impl FaceTension {
    /// Nothing was read.
    pub const UNKNOWN: Self = Self { largest: f64::NAN, point: [f64::NAN; 3] };
}

impl FaceGrid {
    /// Of the faces of a box that is hit across an axis at a point: lines along the axes, m, with those through the hit.
    pub(super) fn of_box((struck, hit): (usize, Vec3), lines: &[Vec<f64>; 3], mirrors: &[usize]) -> Self {
        let axes = along(struck);
        Self {
            axes,
            lines: axes.map(|axis| with_hit(&lines[axis], hit[axis])),
            is_mirrored: axes.map(|axis| mirrors.contains(&axis)),
        }
    }

    /// The points on the face at a height along the axis across it, m.
    fn points(&self, across: usize, height: f64) -> Vec<Vec3> {
        let at = |a: f64, b: f64| {
            let mut x = [0.0; 3];
            (x[self.axes[0]], x[self.axes[1]], x[across]) = (a, b, height);
            x
        };
        self.lines[0].iter().flat_map(|a| self.lines[1].iter().map(move |b| at(*a, *b))).collect()
    }
}

/// Part of a layer's thickness by which its faces are read within it, lest they be the next layer's.
pub(super) const WITHIN: f64 = 1e-9;

/// A face of a layer: its name, where it is along the axis across it, and where it is read, m.
struct Level {
    name: String,
    height: f64,
    read_at: f64,
}

/// The faces of layers between ends (ascending, m), from the one that is farthest from the hit.
fn levels(ends: &[f64], is_hit_from_above: bool) -> Vec<Level> {
    let mut ends = ends.to_vec();
    if is_hit_from_above {
        ends.reverse();
    }
    let sides = ends.windows(2).flat_map(|layer| {
        let within = if ends.len() > 2 { WITHIN * (layer[1] - layer[0]) } else { 0.0 };
        [(layer[0], layer[0] + within), (layer[1], layer[1] - within)]
    });
    let named = face_names(ends.len() - 1).into_iter().zip(sides);
    let mut levels: Vec<Level> = named.map(|(name, (height, read_at))| Level { name, height, read_at }).collect();
    levels.reverse();
    levels
}

/// The faces of a box across an axis, or of its layers between ends along it, with the forms of the stresses in their planes, point by point.
pub(super) fn of_box(
    (struck, hit): (usize, Vec3),
    layers: &[f64],
    (lines, grid): (&[Vec<f64>; 3], FaceGrid),
    bends_alone: bool,
    at: impl Fn(Vec3, bool) -> [Form; 6],
    near: Option<&NearHit>,
) -> (Vec<Face>, Vec<Form>) {
    let axes = grid.axes;
    let half = lines[struck].last().copied().unwrap_or_default();
    let outer = [-half, half];
    let layers = if layers.is_empty() { &outer[..] } else { layers };
    let size = lines.each_ref().map(|lines| lines.last().copied().unwrap_or_default());
    let is_hit = |x: Vec3| near.is_some_and(|near| near.distance(x) <= 1e-6 * near.thickness());
    let is_smoothed = |x: Vec3| is_hit(x) && near.is_some_and(|near| near.is_smoothed(x, size));
    let has_hit = is_smoothed(hit);
    let is_left_out =
        |x: &Vec3| has_hit && !is_hit(*x) && near.is_some_and(|near| near.distance(*x) < NEAR * near.thickness());
    let local = |points: &[Vec3]| -> Vec<(usize, LocalPoint)> {
        let reached = points.iter().enumerate().filter_map(|(number, x)| {
            let near = near.filter(|near| near.distance(*x) <= REACH * near.width() && !is_left_out(x))?;
            // (The ring of tension at the contact's edge is told by itself.)
            Some((number, near.at(*x, is_smoothed(*x))?.without_ring()))
        });
        reached.collect()
    };
    let in_plane = |x: &Vec3| {
        if is_left_out(x) {
            return Default::default();
        }
        let mut stress = at(*x, is_smoothed(*x));
        [axes[0], axes[1], place(axes[0], axes[1])].map(|component| std::mem::take(&mut stress[component]))
    };
    let (mut faces, mut forms): (Vec<Face>, Vec<Form>) = (Vec::new(), Vec::new());
    let levels = levels(layers, hit[struck] > 0.0);
    let count = levels.len();
    for (number, Level { name, height, read_at }) in levels.into_iter().enumerate() {
        let read = grid.points(struck, read_at);
        // A body that bends alone has the opposite stresses on the other side of its middle.
        let opposite = (bends_alone && number >= count / 2).then(|| faces[count - 1 - number].first);
        let (first, sign) = opposite.map_or((forms.len() / 3, 1.0), |first| (first, -1.0));
        if opposite.is_none() {
            forms.extend(read.iter().flat_map(in_plane));
        }
        let local = local(&read);
        let left_out = read.iter().map(is_left_out).collect();
        let points = grid.points(struck, height);
        faces.push(Face { name, points, first, local, left_out, sign, grid: Some(grid.clone()) });
    }
    faces.reverse();
    (faces, forms)
}

/// The named surfaces of a mesh, or of a box that is hit along an axis its two faces, named after so many layers, and the nodes on them, face by
/// face.
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
        faces.push(Face { name, points, first: all.len(), local: Vec::new(), left_out, sign: 1.0, grid: None });
        all.extend_from_slice(nodes);
    }
    (faces, all)
}

/// Lines with one through the hit.
fn with_hit(lines: &[f64], hit: f64) -> Vec<f64> {
    let mut lines = lines.to_vec();
    let size = lines.last().copied().unwrap_or_default() - lines.first().copied().unwrap_or_default();
    let place = lines.partition_point(|x| *x < hit);
    let near = (0..lines.len()).find(|&i| (lines[i] - hit).abs() < 1e-6 * size);
    match near {
        // The hit itself, lest no point be on it.
        Some(i) => lines[i] = hit,
        None if place > 0 && place < lines.len() => lines.insert(place, hit),
        None => {}
    }
    lines
}

impl FaceStresses {
    /// Of the stresses at the sampled points and the faces.
    pub(super) fn new(map: StressMap, faces: Vec<Face>) -> Self {
        Self { columns: Vec::new(), map, faces, rows: OnceCell::new(), screen: OnceCell::new() }
    }

    /// The largest tension on each face at a time (s), of the stresses at the sampled points and the contact; and the tensions at all
    /// points, where at that of the largest this one counts.
    pub fn tensions(&self, stresses: &[f64], contact: &ContactNow, time: f64) -> (Vec<FaceTension>, TensionMap) {
        let components = self.map.components();
        let sampled = |number: usize| &stresses[components * number..components * (number + 1)];
        let (mut found, mut all) = (Vec::with_capacity(self.faces.len()), Vec::new());
        for face in &self.faces {
            let value = |point: usize| face.value(point, sampled(face.first + point), contact);
            let values: Vec<f64> = (0..face.points.len()).map(value).collect();
            let (point, largest) = face.largest(face.read_points(), |point| values[point]);
            let first = all.len();
            all.extend(values.iter().map(|value| if value.is_nan() { f32::NEG_INFINITY } else { *value as f32 }));
            if let Some(value) = all.get_mut(first + point) {
                *value = value.max(largest.largest as f32);
            }
            found.push(largest);
        }
        (found, TensionMap::of_step(all, time))
    }

    /// The stresses on lines, where the body moves on a basis and has them.
    pub fn on_lines(&self) -> Option<&LineStresses> {
        match &self.map {
            StressMap::Lines(lines) => Some(lines),
            _ => None,
        }
    }

    /// The map as a dense matrix, where the body moves on a basis: how many coordinates there are, and the entries row by row.
    pub fn dense(&self) -> Option<(usize, &[f64])> {
        match &self.map {
            StressMap::Forms { map: Map::Dense(count, entries), .. } => Some((*count, entries)),
            _ => None,
        }
    }
}

impl FaceGrid {
    /// Lifts the largest value to the tops of parabolas through it and its neighbours along each axis.
    fn refine(&self, best: usize, top: f64, value: impl Fn(usize) -> f64, found: &mut FaceTension) {
        let count = self.lines[1].len();
        let place = [best / count, best % count];
        for (side, stride) in [(0, count), (1, 1)] {
            let (lines, at) = (&self.lines[side], place[side]);
            if at + 1 >= lines.len() || (at == 0 && !self.is_mirrored[side]) {
                continue;
            }
            // (Neighbours that are not read make no parabola.)
            let (after, ahead) = (value(best + stride), lines[at + 1] - lines[at]);
            let (before, behind) =
                if at == 0 { (after, ahead) } else { (value(best - stride), lines[at] - lines[at - 1]) };
            // f(top) + s x + c x²/2 through both neighbours.
            let (rise, fall) = ((after - top) / ahead, (before - top) / behind);
            let curvature = 2.0 * (rise + fall) / (ahead + behind);
            let slope = rise - 0.5 * curvature * ahead;
            if curvature < 0.0 {
                let way = (-slope / curvature).clamp(-0.5 * behind, 0.5 * ahead);
                found.largest += slope * way + 0.5 * curvature * way * way;
                found.point[self.axes[side]] += way;
            }
        }
    }
}

#[cfg(test)]
mod tests;
