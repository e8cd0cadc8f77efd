//! What is decided of a Krylov basis before it grows.

/// How a basis begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// s, 1/s.
    pub shift: f64,
    /// How long the run is, s.
    pub end: f64,
    /// Whether the basis of a plate is to know its long waves alone, where that serves ([`InfinitePlate`](super::InfinitePlate)).
    pub leaves_short_waves: bool,
    /// Whether vectors may be made orthogonal in blocks, by Lanczos' recurrence, where the body is small and elastic: quicker for long bases,
    /// with a little more rounding in their last vectors.
    pub in_blocks: bool,
}

impl From<f64> for Start {
    /// At a rate (1/s), for a run of any length and waves of all lengths, vector by vector.
    fn from(shift: f64) -> Self {
        Self { shift, end: f64::INFINITY, leaves_short_waves: false, in_blocks: false }
    }
}
