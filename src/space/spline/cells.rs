//! The cells of a block: of one size around the hit, growing with the distance from it to what carries the waves of the contact.

use super::DEGREE;
use super::geometry::BoxGeometry;
use super::patch::PatchModel;
use crate::form::plate::Section;
use crate::form::spline::WIDTH;
use crate::scene::Scene;
use crate::space::plate::{contact_time, wavelength};

/// Cells at the hit over the radius of the disc that is pressed.
const OF_DISC: f64 = 0.375;

/// Cells over the distance from the hit, along the struck face and into the body.
const GROWTH: [f64; 2] = [0.5, 1.6];

/// The largest cell, in lengths of the waves of the contact's frequency.
const OF_WAVE: f64 = 0.085;

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
        let at_hit = (cell_size_factor * OF_DISC * patch.disc).min(lengths[0].max(lengths[1]));
        let sizes = Sizes { hit: at_hit, largest: cell_size_factor * largest, growth };
        lengths.map(|length| Side { length, sizes })
    });
    let folds = |axis: usize| patch.bends && axis == geometry.struck;
    let functions = |axis: usize| {
        let all = sides[axis].iter().map(Side::cells).sum::<f64>() + DEGREE as f64;
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

/// Cells across a thickness whose functions are folded: as many as without, and no more than there may be of such.
fn folded(sides: &[Side; 2]) -> usize {
    let cells = sides.iter().map(Side::cells).sum::<f64>();
    cells.min((2 * WIDTH - DEGREE) as f64) as usize
}

/// Flexural waves of the thinnest plate that the box is, or shear waves where these are shorter, m.
fn shortest_wave(geometry: &BoxGeometry, scene: &Scene) -> f64 {
    let body = &scene.body;
    let thickness = geometry.size.into_iter().fold(f64::INFINITY, f64::min);
    let section = Section { thickness, young: body.young, poisson: body.poisson, density: body.density };
    let time = contact_time(&section, &scene.impactor);
    let shear = (section.shear() / (section.density * thickness)).sqrt();
    wavelength(&section, time).min(shear * time)
}

/// Sizes of cells, m: that at the hit, the largest, and the growth, which has no unit.
#[derive(Debug, Clone, Copy)]
struct Sizes {
    hit: f64,
    largest: f64,
    growth: f64,
}

/// One side of the hit along an axis.
#[derive(Debug, Clone, Copy)]
struct Side {
    length: f64,
    sizes: Sizes,
}

impl Side {
    /// ∫ dx over the size of the cell at x, up to a distance: the size is that at the hit, then the distance times the growth, then
    /// the largest.
    fn count(&self, distance: f64) -> f64 {
        let [(near, at_near), (far, at_far)] = self.turns();
        if distance <= near {
            return distance / self.sizes.hit.min(self.sizes.largest);
        }
        let grown = at_near + (distance.min(far) / near).ln() / self.sizes.growth;
        if distance <= far { grown } else { at_far + (distance - far) / self.sizes.largest }
    }

    /// The inverse.
    fn distance(&self, count: f64) -> f64 {
        let [(near, at_near), (far, at_far)] = self.turns();
        if count <= at_near {
            count * self.sizes.hit.min(self.sizes.largest)
        } else if count <= at_far {
            near * (self.sizes.growth * (count - at_near)).exp()
        } else {
            far + (count - at_far) * self.sizes.largest
        }
    }

    /// Where the size begins to grow and where it ends to, with the counts there.
    fn turns(&self) -> [(f64, f64); 2] {
        let Sizes { hit, largest, growth } = self.sizes;
        let near = hit.min(largest) / growth;
        let far = largest / growth;
        [(near, 1.0 / growth), (far, (1.0 + (far / near).ln()) / growth)]
    }

    /// How many cells there are: none where an end is nearer to the hit than half a cell.
    fn cells(&self) -> f64 {
        if self.length < 0.5 * self.sizes.hit.min(self.sizes.largest) {
            return 0.0;
        }
        // What rounding leaves is no cell.
        (self.count(self.length) * (1.0 - 1e-9)).ceil().max(1.0)
    }

    /// Distances of the cells' far ends from the hit.
    fn lines(&self) -> Vec<f64> {
        let (cells, all) = (self.cells(), self.count(self.length));
        (1..=cells as usize).map(|i| self.distance(all * i as f64 / cells)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes are between those at the hit and the largest, within what a whole number of cells asks for, and grow as they should.
    #[test]
    fn cells_follow_their_size() {
        let sizes = Sizes { hit: 0.01, largest: 0.1, growth: 0.5 };
        for length in [0.004, 0.02, 0.13, 0.7] {
            let side = Side { length, sizes };
            let lines = side.lines();
            assert_eq!(lines.is_empty(), length < 0.005, "{length}");
            let mut from = 0.0;
            for &to in &lines {
                let middle: f64 = 0.5 * (from + to);
                let size = (0.5 * middle).clamp(0.01, 0.1);
                let cells = side.count(length);
                // The size varies by a half within a cell.
                let ratio = (to - from) / size * cells.ceil() / cells;
                assert!((0.8..1.2).contains(&ratio) || lines.len() == 1, "{length}: {lines:?}");
                from = to;
            }
            if let Some(last) = lines.last() {
                assert!((last / length - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn count_and_distance_are_inverse() {
        for sizes in [(0.01, 0.1, 0.5), (0.2, 0.1, 0.5), (0.01, 10.0, 1.6)] {
            let sizes = Sizes { hit: sizes.0, largest: sizes.1, growth: sizes.2 };
            let side = Side { length: 1.0, sizes };
            for i in 1..200 {
                let x = f64::from(i) / 200.0;
                assert!((side.distance(side.count(x)) / x - 1.0).abs() < 1e-12, "{sizes:?} {x}");
            }
        }
    }
}
