//! Cells of a box: of constant size near the impact point, growing with the distance from it to the size that resolves
//! the waves of the contact.

use super::geometry::BoxGeometry;
use super::patch::PatchModel;
use super::{DEGREE, Settings};
use crate::form::plate::Section;
use crate::form::spline::WIDTH;
use crate::scene::{Composition, Layer, Parts, Scene};
use crate::space::grading::{Side, Sizes};
use crate::space::grid::count_cells;
use crate::space::parts;
use crate::space::plate::{contact_time, wavelength};

/// Size of the cells at the impact point divided by the radius of the loaded disc.
const CELL_OVER_DISC: f64 = 0.375;

/// Cell size divided by the distance from the impact point, along the impacted face and into the body.
const CELL_GROWTH: [f64; 2] = [0.5, 1.6];

/// Size of the largest cell divided by the length of the waves at the frequency of the contact.
const CELL_OVER_WAVELENGTH: f64 = 0.085;

/// Cell size factor from which one cell across the thickness is used. One cell causes an error of 0.03% to 0.4% of the
/// force (measured). A comparison with larger cells does not reveal it, since there is also one cell.
const ONE_ACROSS: f64 = 1.5;

/// Largest number of unknowns; each has about a thousand entries in the matrix.
const MAX_UNKNOWNS: f64 = 4e4;

/// Cells along the two sides of the impact point on each axis, chosen for a scene.
struct Sides {
    sides: [[Side; 2]; 3],
    /// Lines along an axis of the impacted face with parts that carry supports or loads; `None` without such parts.
    at_parts: [Option<Vec<f64>>; 3],
}

impl Sides {
    fn new(geometry: &BoxGeometry, scene: &Scene, patch: &PatchModel, settings: &Settings) -> Self {
        let Settings { cell_size_factor, part_cell_factor } = *settings;
        let (largest, parts) = (CELL_OVER_WAVELENGTH * shortest_wave(geometry, scene), parts::parts(scene));
        let sides: [[Side; 2]; 3] = std::array::from_fn(|axis| {
            let [low, high] = geometry.ends(axis);
            let hit = geometry.hit[axis];
            let growth = cell_size_factor * CELL_GROWTH[usize::from(axis == geometry.struck)];
            let lengths = [hit - low, high - hit];
            // At least one cell on the longer side, or two if the factor is below `ONE_ACROSS` across the thickness.
            let longest = lengths[0].max(lengths[1]);
            let is_halved = axis == geometry.struck && cell_size_factor < ONE_ACROSS;
            let at_hit =
                (cell_size_factor * CELL_OVER_DISC * patch.disc).min(if is_halved { 0.5 * longest } else { longest });
            let sizes = Sizes { hit: at_hit, largest: cell_size_factor * largest, growth };
            lengths.map(|length| Side { length, sizes })
        });
        let at_parts = std::array::from_fn(|axis| {
            let is_halved = geometry.mirrors.contains(&axis);
            let edges = parts::edges(&parts, axis, is_halved, geometry.ends(axis));
            let (hit, size) = (geometry.hit[axis], |x: f64| sides[axis][0].sizes.at(x - geometry.hit[axis]));
            let is_along_face = axis != geometry.struck && !edges.is_empty();
            is_along_face.then(|| parts::lines(geometry.ends(axis), (hit, 2), &edges, part_cell_factor, size))
        });
        Self { sides, at_parts }
    }

    /// Number of cells along an axis, with a part of a cell counted as one.
    fn cells(&self, axis: usize) -> f64 {
        match &self.at_parts[axis] {
            Some(lines) => count_cells(lines) as f64,
            None => self.sides[axis].iter().map(Side::cells).sum(),
        }
    }

    /// Estimated number of unknowns.
    fn unknowns(&self, geometry: &BoxGeometry, patch: &PatchModel) -> f64 {
        let functions = |axis: usize| {
            // Each layer adds a cell, and functions that end at its interfaces.
            let of_layers = if axis == 2 { (DEGREE * geometry.interfaces.len().saturating_sub(2)) as f64 } else { 0.0 };
            let all = self.cells(axis) + DEGREE as f64 + of_layers;
            if folds(axis, geometry, patch) { 0.5 * all } else { all }
        };
        3.0 * (0..3).map(functions).product::<f64>()
    }
}

/// Whether only one half of the thickness carries unknowns along an axis, since the body only bends.
fn folds(axis: usize, geometry: &BoxGeometry, patch: &PatchModel) -> bool {
    patch.bends && axis == geometry.struck
}

/// Estimated number of unknowns of a box with the cells of [`lines`].
pub(super) fn unknowns(geometry: &BoxGeometry, scene: &Scene, patch: &PatchModel, settings: &Settings) -> f64 {
    Sides::new(geometry, scene, patch, settings).unknowns(geometry, patch)
}

/// Lines normal to each axis of the modelled part. If splines would be smooth across the impact point, its line is
/// repeated: with one continuous derivative less, they resolve it as well as the splines of a quarter, which end there.
///
/// # Errors
/// A clause that says why there are no such lines.
pub(super) fn lines(
    geometry: &BoxGeometry,
    scene: &Scene,
    patch: &PatchModel,
    settings: &Settings,
) -> Result<[Vec<f64>; 3], String> {
    let all = Sides::new(geometry, scene, patch, settings);
    let unknowns = all.unknowns(geometry, patch);
    if !(1.0..=MAX_UNKNOWNS).contains(&unknowns) {
        return Err(format!("it would take {unknowns:.0} unknowns"));
    }
    let Sides { sides, at_parts } = all;
    let lines: [Vec<f64>; 3] = std::array::from_fn(|axis| {
        let hit = geometry.hit[axis];
        if folds(axis, geometry, patch) {
            // The same number of cells, equal in size.
            let (cells, [low, high]) = (folded(&sides[axis]), geometry.ends(axis));
            return (0..=cells).map(|i| low + (high - low) * i as f64 / cells as f64).collect();
        }
        if axis == 2 && !geometry.interfaces.is_empty() {
            return in_layers(&geometry.interfaces, hit, &sides[axis]);
        }
        if let Some(lines) = &at_parts[axis] {
            return lines.clone();
        }
        let [below, above] = sides[axis].each_ref().map(Side::lines);
        let times = if below.is_empty() || above.is_empty() { 1 } else { 2 };
        let mut lines: Vec<f64> = below.iter().rev().map(|d| hit - d).collect();
        lines.extend(std::iter::repeat_n(hit, times));
        lines.extend(above.iter().map(|d| hit + d));
        // Sets the ends exactly. This removes the rounding of a difference, and includes the piece between the impact
        // point and an edge that is too short for a cell.
        let last = lines.len() - 1;
        [lines[0], lines[last]] = geometry.ends(axis);
        lines
    });
    let apart = |(lines, repeated): (&Vec<f64>, &Option<Vec<f64>>), hit: f64| {
        lines.windows(2).all(|pair| pair[0] < pair[1] || pair == [hit, hit] || repeated.is_some() && pair[0] == pair[1])
    };
    if (0..3).any(|axis| !apart((&lines[axis], &at_parts[axis]), geometry.hit[axis])) {
        return Err("its cells are too thin for their coordinates to differ".into());
    }
    Ok(lines)
}

/// Lines across layers, for an impact on the uppermost or the lowermost face. Each layer has the number of cells
/// according to the cell sizes, at least one.
fn in_layers(interfaces: &[f64], hit: f64, sides: &[Side; 2]) -> Vec<f64> {
    let (is_from_below, side) = if sides[0].length < sides[1].length { (true, sides[1]) } else { (false, sides[0]) };
    let sign = if is_from_below { 1.0 } else { -1.0 };
    let mut lines = vec![interfaces[0]];
    for ends in interfaces.windows(2) {
        let [from, to] = [ends[0], ends[1]].map(|end| side.count((sign * (end - hit)).max(0.0)));
        // The value is small enough for the cast.
        let cells = ((to - from).abs() * (1.0 - 1e-9)).ceil().max(1.0) as usize;
        lines.extend((1..cells).map(|i| hit + sign * side.distance(from + (to - from) * i as f64 / cells as f64)));
        lines.push(ends[1]);
    }
    lines
}

/// Number of cells across a thickness whose functions are folded: the same as without folding, limited to the largest
/// number that folding supports.
fn folded(sides: &[Side; 2]) -> usize {
    let cells = sides.iter().map(Side::cells).sum::<f64>();
    cells.min((2 * WIDTH - DEGREE) as f64) as usize
}

/// Shortest wavelength of the contact, m: flexural waves of the box as a plate of its shortest edge, or shear waves if
/// these are shorter.
fn shortest_wave(geometry: &BoxGeometry, scene: &Scene) -> f64 {
    let body = &scene.body;
    let thickness = geometry.size.into_iter().fold(f64::INFINITY, f64::min);
    let section = match body.composition.uniform() {
        Some(material) => Section::new(thickness, material),
        None => sliding(&body.composition, thickness),
    };
    let time = contact_time(&section, &scene.impactor);
    let shear = (section.shear() / (section.density * thickness)).sqrt();
    wavelength(&section, time).min(shear * time)
}

/// Plate with the mass of the layers and with their stiffness when they slide on each other without friction. Its waves
/// are the shortest.
fn sliding(composition: &Composition, thickness: f64) -> Section {
    let struck = composition.struck;
    let density = composition.density().unwrap_or(struck.density);
    let Parts::Layers(layers) = &composition.parts else { return Section::new(thickness, &struck) };
    let of_layer = |layer: &Layer| Section::new(layer.thickness, &layer.material.instantaneous).rigidity();
    let rigidity: f64 = layers.iter().map(of_layer).sum();
    let young = struck.young * rigidity / Section::new(thickness, &struck).rigidity();
    Section { thickness, young, poisson: struck.poisson, density }
}
