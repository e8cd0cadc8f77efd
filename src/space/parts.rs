//! Parts of the faces of a box on which supports and loads act: grids have lines on their edges and small cells there.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use crate::description::{Description, Extent, Place, Region};
use crate::form::Material;
use crate::form::plate::Section;
use crate::scene::{Geometry, Scene, Vec3, faces};

use super::grading::divide;

/// Largest cell at a part, over the shortest length that the stresses have there ([`FacePart::length`]).
const CELL_OVER_LENGTH: f64 = 1.0 / 3.0;

/// Growth of the cell size with the distance from a part.
const CELL_GROWTH: f64 = 0.5;

/// Ratio of Young's modulus to that of the stiffest layer below which a layer is an interlayer: it carries shear between
/// plies, and does not bend.
const SOFT: f64 = 0.1;

/// Least distance between two lines, over the size of the cells there. A nearer line at a part is left out.
const LEAST_DISTANCE: f64 = 0.05;

/// A part of a face on which a support or a load acts.
#[derive(Debug, Clone, PartialEq)]
pub struct FacePart {
    /// Axis normal to the face.
    pub across: usize,
    /// Extent on the face.
    pub extent: Extent,
    /// Axis along which a box-shaped part is a strip; `None` for other parts.
    pub along: Option<usize>,
    /// Bedding length (4D/k)^¼ of the most flexible ply, m (Timoshenko & Woinowsky-Krieger, *Theory of Plates and Shells*,
    /// § 57), and at least its thickness, below which a ply does not bend; infinite for a load, and on the sides.
    pub bedding_length: f64,
    /// Shortest length of the stresses there, m: the bedding length, the shear length of a laminate, or the radius of a disc.
    /// Infinite for a load on a box-shaped part of a single layer.
    pub length: f64,
}

/// Parts of the faces of a scene's box on which supports and loads act, without whole faces. Empty for a mesh file.
pub fn parts(scene: &Scene) -> Vec<FacePart> {
    let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else {
        return Vec::new();
    };
    let (description, plies) = (Description::new(scene), Plies::new(scene, (struck, size[struck])));
    let on_spring = |stiffness: Vec3| (4.0 * plies.least_rigidity / stiffness[struck]).powf(0.25).max(plies.thinnest);
    let springs = description.springs.iter().map(|spring| (&spring.region, on_spring(spring.stiffness)));
    let pads = description.pads.iter().map(|pad| (&pad.region, on_spring(pad.foundation.stiffness)));
    let loads = description.tractions.iter().map(|traction| (&traction.region, f64::INFINITY));
    let of_region = |(region, length): (&Region, f64)| {
        let is_part = |place: &&Place| place.extent != Extent::All;
        let of_place = |place: &Place| {
            let radius = if let Extent::Ball { radius, .. } = place.extent { radius } else { f64::INFINITY };
            let across = faces(&place.surface).first().map_or(struck, |(across, _)| *across);
            let length = if across == struck { length } else { f64::INFINITY };
            let shortest = length.min(plies.shear_length).min(radius);
            let along = if let Extent::Box(corners) = place.extent { strip_axis(corners, across, size) } else { None };
            FacePart { across, extent: place.extent, along, bedding_length: length, length: shortest }
        };
        region.iter().filter(is_part).map(of_place).collect::<Vec<_>>()
    };
    springs.chain(pads).chain(loads).flat_map(of_region).collect()
}

/// Axis along which a part of a face is a strip, if it is longer along one of the face's axes; `size` is the size of the box.
fn strip_axis([low, high]: [Vec3; 2], across: usize, size: &Vec3) -> Option<usize> {
    let [one, other] = faces::along(across);
    let length = |axis: usize| high[axis].min(0.5 * size[axis]) - low[axis].max(-0.5 * size[axis]);
    match length(one).total_cmp(&length(other)) {
        Ordering::Less => Some(other),
        Ordering::Equal => None,
        Ordering::Greater => Some(one),
    }
}

/// Stiff layers of a body, and the interlayers between them.
struct Plies {
    /// Bending stiffness of the most flexible ply, N m.
    least_rigidity: f64,
    /// Thickness of the thinnest ply, m.
    thinnest: f64,
    /// Shortest length over which two plies begin to act together, m; infinite without interlayers.
    shear_length: f64,
}

impl Plies {
    /// Layers across an axis, with a total thickness (m).
    fn new(scene: &Scene, (struck, thickness): (usize, f64)) -> Self {
        let layers = scene.body.composition.across(struck, thickness);
        let time = scene.impactor.moduli_time();
        let layers: Vec<(f64, Material)> = layers.into_iter().map(|(h, material)| (h, material.secant(time))).collect();
        let stiffest = layers.iter().map(|(_, material)| material.young).fold(0.0, f64::max);
        let plies: Vec<usize> = (0..layers.len()).filter(|i| layers[*i].1.young >= SOFT * stiffest).collect();
        let section = |layer: usize| Section::new(layers[layer].0, &layers[layer].1);
        let least_rigidity = plies.iter().map(|ply| section(*ply).rigidity()).fold(f64::INFINITY, f64::min);
        let thinnest = plies.iter().map(|ply| layers[*ply].0).fold(f64::INFINITY, f64::min);
        let shear_length = plies.windows(2).map(|pair| {
            let [above, below] = [pair[0], pair[1]].map(section);
            // Slip per shear stress, Σ h/G of the interlayers. Plies without an interlayer act together at once.
            let compliance: f64 = layers[pair[0] + 1..pair[1]].iter().map(|(h, material)| h / material.lame().mu).sum();
            let between: f64 = layers[pair[0] + 1..pair[1]].iter().map(|(h, _)| h).sum();
            let arm = between + 0.5 * (above.thickness + below.thickness);
            let stretch = |ply: Section| ply.thickness * ply.thickness / (12.0 * ply.rigidity());
            let slip = stretch(above) + stretch(below) + arm * arm / (above.rigidity() + below.rigidity());
            if compliance > 0.0 { (compliance / slip).sqrt() } else { f64::INFINITY }
        });
        Self { least_rigidity, thinnest, shear_length: shear_length.fold(f64::INFINITY, f64::min) }
    }
}

/// Number of watched places along an edge of a part or around a disc.
const ALONG_EDGES: usize = 20;

/// Distance of the watched places around a disc from its centre, over its radius.
const WATCHED_RADIUS: f64 = 0.8;

/// Number of watched places along half of an axis of a face.
const ALONG_FACE: usize = 5;

/// Places on the faces of a box across the impact axis at which stresses are compared to estimate their errors, as
/// coordinates along both axes of the faces, m: a coarse grid, and the edges and centres of parts that are bedded. Places
/// within the modelled part only; none on clamped edges, where the stresses of a solid are singular, or within `clearance`
/// (m) of the impact point.
pub fn watched_places(scene: &Scene, halved: &[usize], clearance: f64) -> Vec<[f64; 2]> {
    let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else {
        return Vec::new();
    };
    let axes = faces::along(struck);
    let half = axes.map(|axis| 0.5 * size[axis]);
    let spaced = |[from, to]: [f64; 2], count: usize| -> Vec<f64> {
        (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
    };
    let on_axis = |i: usize| match halved.contains(&axes[i]) {
        true => spaced([0.0, half[i]], ALONG_FACE),
        false => spaced([-half[i], half[i]], 2 * ALONG_FACE - 1),
    };
    let (first, second) = (on_axis(0), on_axis(1));
    let mut places: Vec<[f64; 2]> = first.iter().flat_map(|x| second.iter().map(|y| [*x, *y])).collect();
    for part in parts(scene).iter().filter(|part| part.across == struck && part.bedding_length.is_finite()) {
        match part.extent {
            Extent::All => {}
            Extent::Ball { centre, radius } => {
                let centre = axes.map(|axis| centre[axis]);
                // At the rim itself, which crosses cells, stresses have a kink, and two grids differ more than nearby.
                let radius = WATCHED_RADIUS * radius;
                let angles = (0..ALONG_EDGES).map(|i| TAU * i as f64 / ALONG_EDGES as f64);
                places.extend(angles.map(|angle| [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]));
                places.push(centre);
            }
            Extent::Box([low, high]) => {
                let ends = [0, 1].map(|i| [low[axes[i]].max(-half[i]), high[axes[i]].min(half[i])]);
                for (along, across) in [(0, 1), (1, 0)] {
                    for edge in ends[across].into_iter().filter(|edge| edge.abs() < half[across]) {
                        let mut on_edge = [[0.0; 2]; ALONG_EDGES];
                        for (place, x) in on_edge.iter_mut().zip(spaced(ends[along], ALONG_EDGES)) {
                            (place[along], place[across]) = (x, edge);
                        }
                        places.extend(on_edge);
                    }
                }
            }
        }
    }
    let hit = axes.map(|axis| scene.impactor.point[axis]);
    places.retain(|place| {
        let mut point = scene.impactor.point;
        axes.into_iter().zip(place).for_each(|(axis, x)| point[axis] = *x);
        let is_modelled = (0..2).all(|i| place[i].abs() <= half[i] && !(halved.contains(&axes[i]) && place[i] < 0.0));
        let is_apart = (place[0] - hit[0]).hypot(place[1] - hit[1]) > clearance;
        is_modelled && is_apart && !scene.is_at_clamped_edge(point)
    });
    places
}

/// Edges of a part along an axis, in the modelled part of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Edges {
    /// Coordinates of the edges, m.
    at: [f64; 2],
    /// Intervals with small cells, m: the whole part, or both ends of a strip along the axis, between which the stresses vary
    /// along the strip as little as beside it.
    near: [[f64; 2]; 2],
    /// Number of times that a grid has a line at an edge. The third derivative of the displacement jumps across a straight
    /// edge; twice the same line gives splines with one continuous derivative less.
    times: usize,
    /// Largest cell at the part, m.
    cell: f64,
}

/// Edges of parts along an axis between two ends (m). Across a plane of symmetry at 0, the part with positive coordinates is
/// modelled. A part that covers the whole axis has no edges there.
pub fn edges(parts: &[FacePart], axis: usize, is_halved: bool, [low, high]: [f64; 2]) -> Vec<Edges> {
    let of_part = |part: &FacePart| {
        let (ends, times) = match part.extent {
            Extent::All => return None,
            Extent::Box([low, high]) => ([low[axis], high[axis]], 2),
            Extent::Ball { centre, radius } => ([centre[axis] - radius, centre[axis] + radius], 1),
        };
        let mut at = ends;
        if is_halved {
            at = ends.map(f64::abs);
            at.sort_by(f64::total_cmp);
        }
        let is_over_plane = is_halved && ends[0] < 0.0 && ends[1] > 0.0;
        let whole = [if is_over_plane { 0.0 } else { at[0] }, at[1]];
        let near = if part.along == Some(axis) { at.map(|at| [at; 2]) } else { [whole; 2] };
        let is_inside = |at: &f64| low < *at && *at < high;
        at.iter().any(is_inside).then_some(Edges { at, near, times, cell: CELL_OVER_LENGTH * part.length })
    };
    parts.iter().filter(|part| part.across != axis).filter_map(of_part).collect()
}

/// Line of a grid that is prescribed, with its number of repetitions.
pub type Line = (f64, usize);

/// Lines of a grid between the ends of an axis (m). Lines are at the ends, at the impact point and at the edges of parts.
/// `size` is the size of the cells (m) without parts; at parts, cells are at most `factor` times the largest cell there.
pub fn lines(ends: [f64; 2], hit: Line, edges: &[Edges], factor: f64, size: impl Fn(f64) -> f64) -> Vec<f64> {
    let size = &|x: f64| {
        let at_part = |edges: &Edges| {
            let from = |[low, high]: [f64; 2]| (low - x).max(x - high).max(0.0);
            let distance = from(edges.near[0]).min(from(edges.near[1]));
            factor * edges.cell.max(CELL_GROWTH * distance)
        };
        edges.iter().map(at_part).fold(size(x), f64::min)
    };
    let mut fixed: Vec<Line> = vec![(ends[0], 1), (ends[1], 1)];
    let mut add = |(at, times): Line, least: f64| {
        if let Some((_, known)) = fixed[2..].iter_mut().find(|(other, _)| (at - *other).abs() <= least * size(at)) {
            *known = times.max(*known);
            return;
        }
        let is_apart = fixed[..2].iter().all(|(other, _)| (at - other).abs() > least * size(at));
        if ends[0] < at && at < ends[1] && is_apart {
            fixed.push((at, times));
        }
    };
    add(hit, 0.5);
    edges.iter().for_each(|edges| edges.at.iter().for_each(|at| add((*at, edges.times), LEAST_DISTANCE)));
    fixed.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut lines = vec![fixed[0].0];
    for pair in fixed.windows(2) {
        let [(from, _), (to, times)] = [pair[0], pair[1]];
        lines.extend(divide([from, to], size));
        lines.extend(std::iter::repeat_n(to, times));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts of a pane of 10 mm with supports.
    fn of(supports: &str) -> Vec<FacePart> {
        let text = format!(
            "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.4, 0.01]\n\
             [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n{supports}"
        );
        parts(&Scene::parse("test", &text, &[]).expect("a scene").0)
    }

    /// The bedding length of the text book; at least the thickness, where a plate hardly bends; none on a side.
    #[test]
    fn bedding_lengths() {
        let on = |surface: &str, kind: &str| {
            format!(
                "[[support]]\nsurface = \"{surface}\"\nwithin = {{ box = [[-1, -1, -1], [1, -0.15, 1]] }}\n{kind}\n"
            )
        };
        let springs = "kind = \"elastic\"\nstiffness = [0, 0, 1e9]";
        let rigidity = 70e9 * 0.01_f64.powi(3) / (12.0 * (1.0 - 0.23 * 0.23));
        let exact = (4.0 * rigidity / 1e9).powf(0.25);
        let length = |text: String| of(&text).first().map(|part| part.bedding_length);
        assert!((length(on("bottom", springs)).expect("a part") / exact - 1.0).abs() < 1e-12);
        assert_eq!(length(on("bottom", "kind = \"clamped\"")), Some(0.01));
        assert_eq!(length(on("x-min", springs)), Some(f64::INFINITY));
    }

    /// A line at the hit is repeated if an edge is there, too.
    #[test]
    fn an_edge_at_the_hit_is_repeated() {
        let edges = [Edges { at: [0.2, 0.5], near: [[0.2; 2], [0.5; 2]], times: 2, cell: 0.1 }];
        let lines = lines([0.0, 1.0], (0.2, 1), &edges, 1.0, |_| 0.2);
        assert_eq!(lines.iter().filter(|line| **line == 0.2).count(), 2, "{lines:?}");
    }
}
