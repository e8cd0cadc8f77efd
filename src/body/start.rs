//! Settings of a Krylov basis that are fixed before it grows.

/// Settings of a Krylov basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Shift s, 1/s. Vectors that are made from sudden loads have a lower shift.
    pub shift: f64,
    /// Rate at which the modes of a viscoelastic body have their moduli, 1/s. It is equal to the shift, unless the shift is
    /// low: then it is the rate of the impact. Modes that do not take part, and directions that do not relax, keep these
    /// moduli.
    pub rate: f64,
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
    /// Creates the settings for a shift (1/s): moduli at the same rate, a run of any length, waves of all lengths, and
    /// orthogonalisation vector by vector.
    fn from(shift: f64) -> Self {
        Self { shift, rate: shift, end: f64::INFINITY, leaves_short_waves: false, in_blocks: false }
    }
}
