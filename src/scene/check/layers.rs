//! Grid planes across layers. Each interface is a grid plane.

use super::super::{SceneError, Source, layout, raw};
use super::grid::Hit;

/// Number of cells across the impacted layer. It sets the cell size of the other layers.
const EACH: f64 = 2.0;

/// Least thickness of the impacted layer that sets the cell size of the others, as a fraction of the whole thickness.
const LEAST: f64 = 0.01;

/// Cells of equal size in each layer. The impacted layer (thickness `struck`, m) has two; the others have a number in
/// proportion to their thickness, at least one.
pub(super) fn uniform(interfaces: &[f64], struck: f64) -> Vec<f64> {
    let total = interfaces.last().zip(interfaces.first()).map_or(0.0, |(high, low)| high - low);
    let struck = struck.max(LEAST * total);
    let cells = |thickness: f64| (EACH * thickness / struck).round().max(1.0) as usize;
    cut(interfaces, |_, thickness| cells(thickness))
}

/// Same as [`uniform`], except for the outer layer with the face at height `hit`. Its cells grow from that face, with
/// the smallest cell (m), growth factor and largest cell (m) of [`layout::growing`].
pub(super) fn growing(
    interfaces: &[f64],
    hit: f64,
    (smallest, growth, largest): (f64, f64, f64),
    struck: f64,
) -> Vec<f64> {
    let plain = uniform(interfaces, struck);
    let is_above = hit > 0.0;
    let [low, high] = match interfaces {
        [.., low, high] if is_above => [*low, *high],
        [low, high, ..] => [*low, *high],
        _ => return plain,
    };
    let (thickness, middle) = (high - low, 0.5 * (low + high));
    let mut graded = layout::growing(thickness, hit - middle, smallest, growth, largest);
    graded.iter_mut().for_each(|plane| *plane += middle);
    // Both ends, without the rounding of the sum.
    let last = graded.len() - 1;
    (graded[0], graded[last]) = (low, high);
    let others = plain.into_iter().filter(|plane| *plane < low || *plane > high);
    let mut all: Vec<f64> = others.chain(graded).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// A given number of cells over all layers; the thickest cells are divided first.
///
/// # Errors
/// If there are fewer cells than layers, or if cells are graded across layers.
pub(super) fn given(
    source: &Source,
    raw: &raw::Body,
    (cells, ratio): (usize, f64),
    hit: Hit,
) -> Result<Vec<f64>, SceneError> {
    let interfaces = hit.composition.interfaces();
    let layers = interfaces.len() - 1;
    if ratio != 1.0 {
        let help = "[x, y, 1] with numbers of 1 or more for x and y".to_owned();
        let message = "across layers, cells are not graded".to_owned();
        return Err(source.conflict("body.grading", "body.layer", message, help));
    }
    if raw.cells.is_some() && cells < layers {
        let message = format!("{cells} cells across {layers} layers");
        let help = format!("the third number is {layers} or more: the cells of all layers");
        return Err(source.conflict("body.cells", "body.layer", message, help));
    }
    let thickness = |i: usize| interfaces[i + 1] - interfaces[i];
    let mut counts = vec![1; layers];
    for _ in layers..cells {
        let size = |i: &usize| thickness(*i) / f64::from(counts[*i]);
        let thickest = (0..layers).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or_default();
        counts[thickest] += 1;
    }
    Ok(cut(&interfaces, |i, _| counts[i] as usize))
}

/// Cuts each layer into equal cells. `cells` gives their number from the index of the layer and its thickness (m).
fn cut(interfaces: &[f64], cells: impl Fn(usize, f64) -> usize) -> Vec<f64> {
    let mut planes = vec![interfaces[0]];
    for (i, ends) in interfaces.windows(2).enumerate() {
        let (thickness, count) = (ends[1] - ends[0], cells(i, ends[1] - ends[0]));
        planes.extend((1..count).map(|k| ends[0] + thickness * k as f64 / count as f64));
        planes.push(ends[1]);
    }
    planes
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTERFACES: [f64; 4] = [-0.0104, -0.0004, 0.0004, 0.0104];

    /// A coat of a millionth of the thickness does not divide the other layer into millions of cells.
    #[test]
    fn thin_coats_leave_the_other_cells_large() {
        assert!(uniform(&[-0.005, 0.005 - 1e-8, 0.005], 1e-8).len() < 220);
    }

    #[test]
    fn interfaces_are_planes() {
        let plain = uniform(&INTERFACES, 0.01);
        let expected = [-0.0104, -0.0054, -0.0004, 0.0004, 0.0054, 0.0104];
        // Tolerance: rounding of a sum.
        assert!(plain.len() == 6 && plain.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-17), "{plain:?}");
        for hit in [0.0104, -0.0104] {
            let planes = growing(&INTERFACES, hit, (0.001, 1.5, 0.015), 0.01);
            assert!(INTERFACES.iter().all(|height| planes.contains(height)), "{planes:?}");
            assert!(planes.windows(2).all(|pair| pair[0] < pair[1]), "{planes:?}");
            // The cell at the impacted face has at most the given size. The other ply has its two cells.
            let at_hit =
                planes.iter().map(|plane| (plane - hit).abs()).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
            assert!(at_hit <= 0.001 * (1.0 + 1e-12), "{planes:?}");
            assert_eq!(planes.iter().filter(|plane| **plane * hit < 0.0).count(), 3);
        }
    }
}
