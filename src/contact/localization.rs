//! The localisation vector a of (14) (contact force vector).

use petsc_wrap::{Int, Vector};

use super::Patch;

/// The localisation vector a of (14): aᵀu is the surface displacement under the impactor, and a F the load on the body.
/// Its entries sum to the unit vector d of the direction of travel.
pub struct Localization {
    /// The vector a, distributed like the displacements.
    pub vector: Vector,
    /// The non-zero entries by ascending global index, the same on all ranks.
    pub entries: Vec<(Int, f64)>,
    /// Local compliance c_l, m/N: the part of aᵀu for F = 1 N that Hertz's law already contains, α = δ + c_l F; 0 for a
    /// point force.
    pub compliance: f64,
    /// The patch, if the force acts on one.
    pub patch: Option<Patch>,
}
