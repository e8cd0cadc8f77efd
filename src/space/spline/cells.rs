//! The cells of a block: of one size around the hit, growing with the distance from it to what carries the waves of the contact.

use super::DEGREE;
use super::geometry::BoxGeometry;
use super::patch::PatchModel;
use crate::form::plate::Section;
use crate::form::spline::WIDTH;
use crate::scene::{Composition, Layer, Parts, Scene};
use crate::space::grading::{Side, Sizes};
use crate::space::plate::{contact_time, wavelength};

/// Cells at the hit over the radius of the disc that is pressed.
const OF_DISC: f64 = 0.375;

/// Cells over the distance from the hit, along the struck face and into the body.
const GROWTH: [f64; 2] = [0.5, 1.6];

/// The largest cell, in lengths of the waves of the contact's frequency.
const OF_WAVE: f64 = 0.085;

/// Size of the cells over the default's from which one across the thickness will do. One was measured to leave 0.03% to 0.4% of the force,
/// which larger cells, of which there is one too, do not show.
const ONE_ACROSS: f64 = 1.5;

/// Unknowns at most: each has about a thousand entries in the matrix.
const MOST: f64 = 4e4;

/// The lines across each axis of the modelled part, for a place that is hit. Where splines would be smooth across the hit, its
/// line stands twice: with one continuous derivative less they resolve it as those of a quarter, which end there.
///
/// # Errors
/// Why there are none: a clause.
pub(super) fn lines(
    geometry: &BoxGeometry,
    scene: &Scene,
    patch: &PatchModel,
    cell_size_factor: f64,
) -> Result<[Vec<f64>; 3], String> {
    let largest = OF_WAVE * shortest_wave(geometry, scene);
    let sides: [[Side; 2]; 3] = std::array::from_fn(|axis| {
        let [low, high] = geometry.ends(axis);
        let hit = geometry.hit[axis];
        let growth = cell_size_factor * GROWTH[usize::from(axis == geometry.struck)];
        let lengths = [hit - low, high - hit];
        // At least one cell on the longer side.
        let longest = lengths[0].max(lengths[1]);
        let is_halved = axis == geometry.struck && cell_size_factor < ONE_ACROSS;
        let at_hit = (cell_size_factor * OF_DISC * patch.disc).min(if is_halved { 0.5 * longest } else { longest });
        let sizes = Sizes { hit: at_hit, largest: cell_size_factor * largest, growth };
        lengths.map(|length| Side { length, sizes })
    });
    let folds = |axis: usize| patch.bends && axis == geometry.struck;
    let functions = |axis: usize| {
        // Each layer adds a cell, and functions that end at its interfaces.
        let of_layers = if axis == 2 { (DEGREE * geometry.interfaces.len().saturating_sub(2)) as f64 } else { 0.0 };
        let all = sides[axis].iter().map(Side::cells).sum::<f64>() + DEGREE as f64 + of_layers;
        if folds(axis) { 0.5 * all } else { all }
    };
    let unknowns = 3.0 * (0..3).map(functions).product::<f64>();
    if !(1.0..=MOST).contains(&unknowns) {
        return Err(format!("it would take {unknowns:.0} unknowns"));
    }
    let lines: [Vec<f64>; 3] = std::array::from_fn(|axis| {
        let hit = geometry.hit[axis];
        if folds(axis) {
            // As many, alike above and below the middle.
            let (cells, [low, high]) = (folded(&sides[axis]), geometry.ends(axis));
            return (0..=cells).map(|i| low + (high - low) * i as f64 / cells as f64).collect();
        }
        if axis == 2 && !geometry.interfaces.is_empty() {
            return in_layers(&geometry.interfaces, hit, &sides[axis]);
        }
        let [below, above] = sides[axis].each_ref().map(Side::lines);
        let times = if below.is_empty() || above.is_empty() { 1 } else { 2 };
        let mut lines: Vec<f64> = below.iter().rev().map(|d| hit - d).collect();
        lines.extend(std::iter::repeat_n(hit, times));
        lines.extend(above.iter().map(|d| hit + d));
        // The ends, without the rounding of a difference, and with what is left of an edge beside the hit.
        let last = lines.len() - 1;
        [lines[0], lines[last]] = geometry.ends(axis);
        lines
    });
    let apart = |lines: &Vec<f64>, hit: f64| lines.windows(2).all(|pair| pair[0] < pair[1] || pair == [hit, hit]);
    if (0..3).any(|axis| !apart(&lines[axis], geometry.hit[axis])) {
        return Err("its cells are too thin for their coordinates to differ".into());
    }
    Ok(lines)
}

/// Lines across layers, from a hit on the uppermost or the lowermost face: of each layer as many cells as the sizes ask for, and one at least.
fn in_layers(interfaces: &[f64], hit: f64, sides: &[Side; 2]) -> Vec<f64> {
    let (is_from_below, side) = if sides[0].length < sides[1].length { (true, sides[1]) } else { (false, sides[0]) };
    let sign = if is_from_below { 1.0 } else { -1.0 };
    let mut lines = vec![interfaces[0]];
    for ends in interfaces.windows(2) {
        let [from, to] = [ends[0], ends[1]].map(|end| side.count((sign * (end - hit)).max(0.0)));
        // The cast is of a small number.
        let cells = ((to - from).abs() * (1.0 - 1e-9)).ceil().max(1.0) as usize;
        lines.extend((1..cells).map(|i| hit + sign * side.distance(from + (to - from) * i as f64 / cells as f64)));
        lines.push(ends[1]);
    }
    lines
}

/// Cells across a thickness whose functions are folded: as many as without, and no more than there may be of such.
fn folded(sides: &[Side; 2]) -> usize {
    let cells = sides.iter().map(Side::cells).sum::<f64>();
    cells.min((2 * WIDTH - DEGREE) as f64) as usize
}

/// Flexural waves of the thinnest plate that the box is, or shear waves where these are shorter, m.
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

/// A plate with the mass of layers and the stiffness that they have while they slide on each other: its waves are the shortest.
fn sliding(composition: &Composition, thickness: f64) -> Section {
    let struck = composition.struck;
    let density = composition.density().unwrap_or(struck.density);
    let Parts::Layers(layers) = &composition.parts else { return Section::new(thickness, &struck) };
    let of_layer = |layer: &Layer| Section::new(layer.thickness, &layer.material.instantaneous).rigidity();
    let rigidity: f64 = layers.iter().map(of_layer).sum();
    let young = struck.young * rigidity / Section::new(thickness, &struck).rigidity();
    Section { thickness, young, poisson: struck.poisson, density }
}
