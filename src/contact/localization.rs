//! The vector a of (14), whatever it is made of.

use petsc_wrap::{Int, Vector};

use super::Patch;

/// The vector a of (14): aᵀu is the surface's displacement under the impactor, a F the load on the body. Its entries
/// sum to the direction of travel d.
pub struct Localization {
    /// a, distributed as the displacements.
    pub vector: Vector,
    /// The entries that are not zero by ascending global number, the same on all ranks.
    pub entries: Vec<(Int, f64)>,
    /// c_l, m/N: the part of aᵀu for F = 1 N that Hertz's law holds already, α = δ + c_l F; 0 for a point.
    pub compliance: f64,
    /// The patch, where there is one.
    pub patch: Option<Patch>,
}
