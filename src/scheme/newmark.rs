//! Newmark's family (N. M. Newmark, A method of computation for structural dynamics, J. Eng. Mech. Div. ASCE 85, 1959).
//!
//! Second order for γ = 1/2, first order otherwise. Unconditionally stable for 2β ≥ γ ≥ 1/2; with γ ≥ 1/2 and 2β < γ the limit is
//! Δt = 1/(ω_max √(γ/2 − β)); with γ < 1/2 every vibration grows. β = 1/4, γ = 1/2 is the average acceleration, which
//! conserves the energy of a linear system.

use super::Implicit;

/// Newmark's scheme, balanced at the end of the step.
pub fn newmark(beta: f64, gamma: f64) -> Implicit {
    Implicit { alpha_m: 0.0, alpha_f: 0.0, beta, gamma, gradient: false }
}
