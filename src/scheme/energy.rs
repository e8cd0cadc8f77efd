//! The energy-conserving scheme: midpoint rule with discrete gradients of the potentials of contact and pads (O. Gonzalez, Exact
//! energy and momentum conserving algorithms for general models in nonlinear elasticity, Comput. Methods Appl. Mech. Eng.
//! 190, 2000; for contact T. A. Laursen & V. Chawla, Design of energy conserving algorithms for frictionless dynamic contact
//! problems, Int. J. Numer. Methods Eng. 40, 1997).
//!
//! Energy is kept to rounding at any step, in contact as out of it; second order where the contact holds.

use super::Implicit;

/// The midpoint rule, with mean forces in place of those at the stage. Its acceleration is that of the average-acceleration
/// rule and does not enter the steps.
pub fn energy() -> Implicit {
    Implicit { alpha_m: 0.5, alpha_f: 0.5, beta: 0.25, gamma: 0.5, gradient: true }
}
