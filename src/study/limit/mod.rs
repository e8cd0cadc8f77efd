//! Finds the lowest value of one key of a scene at which the largest tension reaches the strength.
//!
//! The search finds the lowest root of ln(tension / strength) as a function of the value. The values of a coarse grid
//! are computed in ascending order up to the first change of sign (`bracket`). Intervals before it whose curvature
//! allows a maximum beyond the strength are refined. Then the bracket is narrowed by Chandrupatla's method (`root`).

mod bracket;
mod range;
mod root;

pub use range::Range;

use bracket::{Scan, scan};

/// Share of the tolerance to which the root is found. The rest is for the errors of the runs.
const ROOT_SHARE: f64 = 0.05;

/// Lower bound of the ratio in its logarithm: an impact that misses the body has the ratio 0.
const LEAST_RATIO: f64 = 1e-3;

/// A value of the key and the ratio of tension to strength there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Value of the key, in the key's unit.
    pub value: f64,
    /// Largest ratio of tension to strength.
    pub ratio: f64,
}

/// Result of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The lowest root; `None` if the ratio stays on one side of 1 in the whole range.
    pub root: Option<Root>,
    /// All computed values, ascending. Each is one run.
    pub samples: Vec<Sample>,
    /// Number of samples added to the grid where a lower root might hide.
    pub added: usize,
    /// Whether no interval is left whose curvature allows a root below the one found.
    pub is_complete: bool,
}

/// The lowest value at which the ratio is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Root {
    /// The value and the ratio there; it is one of the samples.
    pub at: Sample,
    /// Whether the ratio increases with the value at the root, so that lower values do not reach the strength.
    pub is_rising: bool,
    /// Whether the ratio jumps across 1 at the root, without a value near 1.
    pub is_jump: bool,
    /// Whether the search ended because the root is accurate enough, not because of the largest number of runs.
    pub is_converged: bool,
    /// Change of the value per small change of the logarithm of the ratio, |d value / d ln ratio|, in the key's unit.
    pub sensitivity: f64,
}

/// Finds the lowest value in a range at which `ratio` is 1, with an error of a small share of the relative tolerance.
///
/// # Errors
/// The first error of `ratio`.
pub fn search<E>(range: &Range, tolerance: f64, mut ratio: impl FnMut(f64) -> Result<f64, E>) -> Result<Found, E> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut sign = None;
    // The sign makes the function negative before the root, whether the ratio rises or falls there.
    let mut function = |place: f64| {
        let value = range.value(place);
        let ratio = ratio(value)?;
        samples.insert(samples.partition_point(|sample| sample.value < value), Sample { value, ratio });
        let logarithm = ratio.max(LEAST_RATIO).ln();
        Ok(logarithm * *sign.get_or_insert(if logarithm < 0.0 { 1.0 } else { -1.0 }))
    };
    let Scan { points, crossing, added, is_complete } = scan(&range.grid(), tolerance, &mut function)?;
    let part = ROOT_SHARE * tolerance;
    let target = root::Target { function: part, relative: part, jump: tolerance };
    let narrowed = match crossing {
        Some(at) => Some(root::narrow([points[at - 1], points[at]], &target, range, &mut function)?),
        None => None,
    };
    let is_rising = sign == Some(1.0);
    let root = narrowed.map(|root::Narrowed { place, is_jump, is_converged }| {
        let value = range.value(place);
        let at = samples.iter().find(|sample| sample.value == value).copied().unwrap_or(Sample { value, ratio: 1.0 });
        Root { at, is_rising, is_jump, is_converged, sensitivity: sensitivity(&samples, at, tolerance) }
    });
    Ok(Found { root, samples, added, is_complete })
}

/// Estimates |d value / d ln ratio| at a sample, from the nearest other sample whose ratio differs by clearly more than
/// the errors of the runs.
fn sensitivity(samples: &[Sample], at: Sample, tolerance: f64) -> f64 {
    /// Least difference of ln ratio, relative to the tolerance, from which a slope is computed.
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
