//! The grid planes across layers: each interface is one.

use super::super::{SceneError, Source, layout, raw};
use super::grid::Hit;

/// Cells in a layer at least, over its thickness in those of the layer that is hit.
const EACH: f64 = 2.0;

/// Cells of one size in each layer: as many as its part of the thickness of the layer that is hit, which has two.
pub(super) fn uniform(interfaces: &[f64], struck: f64) -> Vec<f64> {
    let cells = |thickness: f64| (EACH * thickness / struck).round().max(1.0) as usize;
    cut(interfaces, |_, thickness| cells(thickness))
}

/// The same but for the layer with the face at `hit`, in which cells grow from there: by the smallest cell, the growth and the largest
/// (m), as of [`layout::growing`].
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
    // The ends without the rounding of a sum.
    let last = graded.len() - 1;
    (graded[0], graded[last]) = (low, high);
    let others = plain.into_iter().filter(|plane| *plane < low || *plane > high);
    let mut all: Vec<f64> = others.chain(graded).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// So many cells in all, the thickest ones cut first.
///
/// # Errors
/// Fewer cells than layers; a grading across them.
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

/// Each layer cut into as many equal cells as a number of layer and thickness (m) asks for.
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

    #[test]
    fn interfaces_are_planes() {
        let plain = uniform(&INTERFACES, 0.01);
        let expected = [-0.0104, -0.0054, -0.0004, 0.0004, 0.0054, 0.0104];
        // Rounding of a sum.
        assert!(plain.len() == 6 && plain.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-17), "{plain:?}");
        for hit in [0.0104, -0.0104] {
            let planes = growing(&INTERFACES, hit, (0.001, 1.5, 0.015), 0.01);
            assert!(INTERFACES.iter().all(|height| planes.contains(height)), "{planes:?}");
            assert!(planes.windows(2).all(|pair| pair[0] < pair[1]), "{planes:?}");
            // The cell at the hit is the smallest but for the interlayer, of at most the given size; the other ply has its two.
            let at_hit =
                planes.iter().map(|plane| (plane - hit).abs()).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
            assert!(at_hit <= 0.001 * (1.0 + 1e-12), "{planes:?}");
            assert_eq!(planes.iter().filter(|plane| **plane * hit < 0.0).count(), 3);
        }
    }
}
