//! The lowest value of one key of a scene at which the largest tension just reaches the strength.
//!
//! What is searched is the ratio of tension to strength as a function of the value: the lowest root of its logarithm. The values of a
//! coarse grid are computed in ascending order up to the first change of sign (`bracket`). Intervals before it whose curvature allows a
//! maximum beyond the strength are refined; then the bracket is narrowed by Chandrupatla's method (`root`).

mod bracket;
mod range;
mod root;

pub use range::Range;

use bracket::{Scan, scan};

/// Part of the tolerance to which the root is found: what is left of it is the runs' own.
const OF_ROOT: f64 = 0.05;

/// Ratios below this are taken for it: an impact that misses the body has no logarithm.
const LEAST_RATIO: f64 = 1e-3;

/// One value of the key and the ratio of tension to strength there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Value of the key.
    pub value: f64,
    /// Largest ratio of tension to strength.
    pub ratio: f64,
}

/// What a search has found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The lowest root; `None` where the ratio is on one side of 1 on the whole range.
    pub root: Option<Root>,
    /// All values that were computed, ascending; their number is that of the runs.
    pub samples: Vec<Sample>,
    /// How many of them were added to the grid where a lower root might hide.
    pub added: usize,
    /// Whether no interval is left in which the curvature allows a root below the one that was found.
    pub is_complete: bool,
}

/// The lowest value at which the ratio is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// The value, and the ratio there; it is among the samples.
    pub at: Sample,
    /// Whether the ratio rises there, so that lower values do not reach the strength.
    pub is_rising: bool,
    /// Whether the ratio jumps across 1 there without a value near 1.
    pub is_jump: bool,
    /// Change of the value over a small change of the logarithm of the ratio.
    pub sensitivity: f64,
}

/// Finds the lowest value in a range at which `ratio` is 1, with an error of a small part of the relative tolerance.
///
/// # Errors
/// The first one of `ratio`.
pub fn search<E>(range: &Range, tolerance: f64, mut ratio: impl FnMut(f64) -> Result<f64, E>) -> Result<Found, E> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut sign = None;
    // Negative before the root, whichever way the ratio crosses 1.
    let mut function = |place: f64| {
        let value = range.value(place);
        let ratio = ratio(value)?;
        samples.insert(samples.partition_point(|sample| sample.value < value), Sample { value, ratio });
        let logarithm = ratio.max(LEAST_RATIO).ln();
        Ok(logarithm * *sign.get_or_insert(if logarithm < 0.0 { 1.0 } else { -1.0 }))
    };
    let Scan { points, crossing, added, is_complete } = scan(&range.grid(), tolerance, &mut function)?;
    let part = OF_ROOT * tolerance;
    let target = root::Target { function: part, relative: part, jump: tolerance };
    let narrowed = match crossing {
        Some(at) => Some(root::narrow([points[at - 1], points[at]], &target, range, &mut function)?),
        None => None,
    };
    let is_rising = sign == Some(1.0);
    let root = narrowed.map(|root::Narrowed { place, is_jump }| {
        let value = range.value(place);
        let at = samples.iter().find(|sample| sample.value == value).copied().unwrap_or(Sample { value, ratio: 1.0 });
        Root { at, is_rising, is_jump, sensitivity: sensitivity(&samples, at, tolerance) }
    });
    Ok(Found { root, samples, added, is_complete })
}

/// Change of the value over that of the logarithm of the ratio about a sample, from the nearest other one whose ratio differs by clearly
/// more than the runs' errors.
fn sensitivity(samples: &[Sample], at: Sample, tolerance: f64) -> f64 {
    /// Differences of ratios over the tolerance from which a slope can be told.
    const CLEAR: f64 = 5.0;
    let logarithm = |sample: &Sample| sample.ratio.max(LEAST_RATIO).ln();
    let change = |sample: &Sample| (logarithm(sample) - logarithm(&at)).abs();
    let distance = |sample: &Sample| (sample.value - at.value).abs();
    let others = || samples.iter().filter(|sample| sample.value != at.value);
    let clear = others().filter(|sample| change(sample) >= CLEAR * tolerance);
    let nearest = clear.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let nearest = nearest.or_else(|| others().max_by(|a, b| change(a).total_cmp(&change(b))));
    nearest.map_or(0.0, |sample| distance(sample) / change(sample))
}

#[cfg(test)]
mod tests;
