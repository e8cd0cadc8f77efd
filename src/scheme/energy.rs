//! Energy-conserving scheme: the midpoint rule with discrete gradients of the potentials of contact and pads (O.
//! Gonzalez, Exact energy and momentum conserving algorithms for general models in nonlinear elasticity, Comput.
//! Methods Appl. Mech. Eng. 190, 2000; for contact T. A. Laursen & V. Chawla, Design of energy conserving algorithms
//! for frictionless dynamic contact problems, Int. J. Numer. Methods Eng. 40, 1997).
//!
//! The energy is conserved to rounding at any step size, with and without contact. The scheme is of second order while
//! the contact stays closed.

use super::Implicit;

/// Returns the midpoint rule with mean forces instead of the forces at the stage. Its acceleration is computed as in
/// the average-acceleration rule and does not affect the steps.
pub fn energy() -> Implicit {
    Implicit { alpha_m: 0.5, alpha_f: 0.5, beta: 0.25, gamma: 0.5, gradient: true }
}
