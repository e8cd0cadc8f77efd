//! Settings of a Krylov basis that are fixed before it grows.

use super::{Krylov, LinearBody};
use crate::error::Result;

/// Number of vectors of the bases from which the lowest frequency is computed.
const VECTORS: usize = 10;

/// Number of these bases, made in turn. The shift of the first is that of the impact, which may be far above the lowest
/// frequency. The shift of the next is the lowest frequency of the first.
const BASES: usize = 2;

/// Ratio to the largest ω² of a basis below which an ω² is that of a free motion, with rounding.
const FREE_MOTION: f64 = 1e-12;

/// Settings of a Krylov basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Shift s, 1/s.
    pub shift: f64,
    /// Shift of the vectors that are made from sudden loads, 1/s; `None` for the same shift. Loads excite slow motions,
    /// which vectors at the shift of an impact represent poorly.
    pub loads_shift: Option<f64>,
    /// Length of the run, s.
    pub end: f64,
    /// Whether the basis of a plate is made for its long waves only, where this is useful
    /// ([`InfinitePlate`](super::InfinitePlate)).
    pub leaves_short_waves: bool,
    /// Whether vectors may be orthogonalised in blocks, by a Lanczos recurrence, if each process stores the whole body and
    /// the body has a single shift and no dampers. This is faster for long bases, with slightly more rounding in the
    /// last vectors.
    pub in_blocks: bool,
}

impl From<f64> for Start {
    /// Creates the settings for a shift (1/s): a run of any length, waves of all lengths, and orthogonalisation vector
    /// by vector.
    fn from(shift: f64) -> Self {
        Self { shift, loads_shift: None, end: f64::INFINITY, leaves_short_waves: false, in_blocks: false }
    }
}

/// Returns the shift of the vectors that are made from sudden loads, 1/s: about the lowest frequency of the body, apart
/// from free motions. `None` if there are no such loads, because the body has none or starts from equilibrium, or if all
/// motions are free. Collective.
///
/// # Errors
/// Same as [`Krylov::new`].
pub fn loads_shift(body: &dyn LinearBody, start: Start) -> Result<Option<f64>> {
    if body.properties()?.sudden_loads().is_none() {
        return Ok(None);
    }
    let mut found = None;
    for _ in 0..BASES {
        let shift = found.unwrap_or(start.shift);
        let mut krylov = Krylov::new(body, Start { end: start.end, ..Start::from(shift) })?;
        krylov.grow(body, VECTORS)?;
        let squares = krylov.projection(body)?.stiffness_at_rate().symmetric_eigenvalues();
        let is_vibration = |square: &f64| *square > FREE_MOTION * squares.max();
        found = squares.iter().copied().filter(is_vibration).min_by(f64::total_cmp).map(f64::sqrt).or(found);
    }
    Ok(found)
}
