//! Lumped (diagonal) mass and damping of a body, for explicit time integration.

use petsc_wrap::Vector;

/// Diagonal replacements of M and C, with one entry per unknown, constrained unknowns included.
pub struct Lumped {
    /// Diagonal mass, kg. Positive; the entries of each displacement component sum to the mass of the body.
    pub mass: Vector,
    /// Diagonal of the damping C of the dampers (13), N s/m. Not negative; `None` if the scene has no damper.
    pub damping: Option<Vector>,
}
