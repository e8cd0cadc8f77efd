//! Stability limit of Newmark's method.

/// Returns Ω_crit, the limit of ω Δt below which Newmark's method with β and γ keeps an undamped vibration of angular
/// frequency ω bounded. Steps below Ω_crit/ω_max are stable for a body. Ω_crit is infinite for 2β ≥ γ ≥ 1/2,
/// 1/√(γ/2 − β) for γ ≥ 1/2 and β < γ/2, and 0 for γ < 1/2.
///
/// The central difference method, β = 0 and γ = 1/2, has Ω_crit = 2. At Ω_crit itself the vibration grows linearly with
/// the number of steps. Dampers do not change the limit for γ = 1/2 and raise it for γ > 1/2. Source: T. J. R. Hughes,
/// The Finite Element Method, 2000, section 9.1.
pub fn critical_frequency(beta: f64, gamma: f64) -> f64 {
    if gamma < 0.5 {
        0.0
    } else if 2.0 * beta >= gamma {
        f64::INFINITY
    } else {
        1.0 / (0.5 * gamma - beta).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scheme::{CentralDifference, newmark};

    const STEPS: usize = 2000;

    /// Amplitude of ü = −u after many steps of size Ω, from u = u̇ = 1, by Newmark's method; β = 0 uses the explicit
    /// formulas.
    fn growth(beta: f64, gamma: f64, step: f64) -> f64 {
        let (mut u, mut v, mut a) = (1.0, 1.0, -1.0);
        for _ in 0..STEPS {
            if beta == 0.0 {
                let scheme = CentralDifference { step };
                let half;
                (u, half) = scheme.predict(u, v, a);
                (v, a) = scheme.correct(half, -u, 1.0, 0.0);
            } else {
                let update = newmark(beta, gamma).end(step);
                let (_, known) = update.apply(0.0, v, a);
                let increment = -(known + u) / (update.c2 + 1.0);
                (v, a) = update.apply(increment, v, a);
                u += increment;
            }
            // The amplitude is far beyond the bound tested below; further steps could overflow.
            if u.abs() > 1e100 {
                break;
            }
        }
        u.abs()
    }

    /// At 0.999 Ω_crit a vibration stays below 1/√(1 − 0.999²) = 22. At 1.001 Ω_crit and γ = 1/2 it grows by
    /// √(8·0.001) = 0.09 a step. For γ > 1/2 it grows by 4γ²/(2γ − 1)·X·0.001/(1 + βΩ²) a step with X = 2/γ, which is
    /// at least 0.007 here: a factor of e^14 in total.
    #[test]
    fn vibrations_are_bounded_below_the_limit_and_grow_above() {
        for (beta, gamma) in [(0.0, 0.5), (1.0 / 6.0, 0.5), (0.05, 0.5), (0.2, 0.6), (0.1, 0.9)] {
            let limit = critical_frequency(beta, gamma);
            let (below, above) = (growth(beta, gamma, 0.999 * limit), growth(beta, gamma, 1.001 * limit));
            assert!(below < 25.0, "β = {beta}, γ = {gamma}: {below} below the limit {limit}");
            assert!(above > 1e5, "β = {beta}, γ = {gamma}: {above} above the limit {limit}");
        }
        assert_eq!(critical_frequency(0.0, 0.5), 2.0);
    }

    #[test]
    fn no_limit_and_no_stable_step() {
        for (beta, gamma) in [(0.25, 0.5), (0.3025, 0.6), (1.0, 1.0)] {
            assert_eq!(critical_frequency(beta, gamma), f64::INFINITY);
            // The average-acceleration rule conserves u² + u̇² = 2; the other schemes dissipate energy.
            assert!([0.1, 10.0, 1e4].iter().all(|step| growth(beta, gamma, *step) < 1.5));
        }
        for (beta, gamma) in [(0.25, 0.45), (0.1, 0.4)] {
            assert_eq!(critical_frequency(beta, gamma), 0.0);
            // |μ|² = 1 + (1/2 − γ) Ω² to first order.
            assert!(growth(beta, gamma, 0.5) > 1e3);
        }
    }
}
