//! The state of body and impactor at one time.

use petsc_wrap::Vector;

/// Displacement, velocity and acceleration of body and impactor.
pub struct State {
    /// u, m.
    pub u: Vector,
    /// u̇, m/s.
    pub v: Vector,
    /// ü, m/s².
    pub a: Vector,
    /// The impactor, the same on all ranks.
    pub q: Impactor,
}

/// The impactor along its direction of travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impactor {
    /// q, m.
    pub position: f64,
    /// q̇, m/s.
    pub velocity: f64,
    /// q̈, m/s².
    pub acceleration: f64,
}
