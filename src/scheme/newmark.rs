//! Newmark's family (N. M. Newmark, A method of computation for structural dynamics, J. Eng. Mech. Div. ASCE 85, 1959).
//!
//! The scheme is of second order for γ = 1/2 and of first order otherwise. It is unconditionally stable for
//! 2β ≥ γ ≥ 1/2. For γ ≥ 1/2 and 2β < γ the stability limit is Δt = 1/(ω_max √(γ/2 − β)); for γ < 1/2 every vibration
//! grows. β = 1/4, γ = 1/2 is the average-acceleration rule, which conserves the energy of a linear system.

use super::Implicit;

/// Returns Newmark's scheme, in which the equation of motion holds at the end of the step.
pub fn newmark(beta: f64, gamma: f64) -> Implicit {
    Implicit { alpha_m: 0.0, alpha_f: 0.0, beta, gamma, gradient: false }
}
