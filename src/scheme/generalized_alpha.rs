//! The generalised-α scheme (J. Chung & G. M. Hulbert, A time integration algorithm for structural dynamics with improved
//! numerical dissipation: the generalized-α method, J. Appl. Mech. 60, 1993).
//!
//! The scheme is of second order and unconditionally stable. ρ∞ is the spectral radius at infinite frequency: the
//! amplitude ratio of the highest frequencies over a step, from 1 (undamped: the midpoint rule) to 0 (removed in one
//! step).

use super::Implicit;

/// Returns the scheme with the least damping of low frequencies for a given ρ∞ in [0, 1].
pub fn generalized_alpha(rho_inf: f64) -> Implicit {
    let alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0);
    let alpha_f = rho_inf / (rho_inf + 1.0);
    let gamma = 0.5 - alpha_m + alpha_f;
    Implicit { alpha_m, alpha_f, beta: 0.25 * (1.0 - alpha_m + alpha_f).powi(2), gamma, gradient: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The spectral radius of a step at very high frequency is ρ∞.
    #[test]
    fn what_is_left_of_the_highest_frequencies() {
        for rho_inf in [0.2, 0.5, 0.8] {
            let scheme = generalized_alpha(rho_inf);
            // At ωΔt = 1e4 the radius is accurate to the square root of 1/(ωΔt), since the eigenvalue −ρ∞ is double.
            let (step, squared): (f64, f64) = (1.0, 1e8);
            let (stage, end) = (scheme.stage(step), scheme.end(step));
            let (mut u, mut v, mut a) = (1.0, 0.0, -squared);
            let mut growth = 0.0;
            for _ in 0..60 {
                let before = f64::abs(a);
                let known = -(stage.apply(0.0, v, a).1 + squared * u);
                let increment = known / (stage.c2 + squared) / scheme.theta();
                (v, a) = end.apply(increment, v, a);
                u += increment;
                growth = f64::abs(a) / before;
            }
            // The eigenvalue is double, so the amplitude behaves as n λⁿ⁻¹ and the growth ratio approaches λ with an
            // error of order 1/n.
            assert!((growth - rho_inf).abs() < 0.05 * rho_inf, "{rho_inf}: {growth}");
        }
    }
}
