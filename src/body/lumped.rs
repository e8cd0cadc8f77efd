//! Lumped mass and damping of a body: diagonals, for steps that solve nothing.

use petsc_wrap::Vector;

/// The diagonals in the places of M and C, one value an unknown, those of held ones included.
pub struct Lumped {
    /// Of M, kg: positive, each component summing to the body's mass.
    pub mass: Vector,
    /// Of C of the dampers (13), N s/m: not negative; `None` where the scene has no damper.
    pub damping: Option<Vector>,
}
