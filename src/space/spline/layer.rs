//! What a spread pressure moves a plate of infinite extent besides a half-space.
//!
//! In the wavenumber ξ a layer moves under a pressure on its top by Γ where a half-space moves by H (see
//! [`crate::space::plate::layer`]). Hertz's pressure, with the transform P_h, and what stands for it, with P, are told apart there by
//! (1/2π) ∫ Γ (P² − P_h²) ξ dξ. A half-space's part of it, with H, is known in closed form; the rest converges, since P² − P_h² = O(ξ⁶).

use std::f64::consts::PI;

use crate::form::Spread;
use crate::space::plate::layer::{END, HALF_SPACE, flexibility, integrate, squeezed};

/// E h/(2π) ∫ (Γ − H) (P² − P_h²) ξ dξ, for a disc's radius in thicknesses.
pub(super) fn beyond_half_space(spread: &Spread, poisson: f64, disc: f64) -> f64 {
    // Half a wave of P² a panel.
    let panel = (0.5 * PI / disc).min(1.0);
    let value = |t: f64| (flexibility(t) - 2.0) * spread.over_waves(t * disc);
    (1.0 - poisson * poisson) / (2.0 * PI) * integrate(0.0, HALF_SPACE, panel, value)
}

/// E h/(2π) ∫ Γ_s P² ξ dξ: what squeezing alone, Γ's second part, yields under the spread pressure.
pub(super) fn squeezing(spread: &Spread, poisson: f64, disc: f64) -> f64 {
    let panel = (0.5 * PI / disc).min(1.0);
    let value = |t: f64| squeezed(t) * spread.square(t * disc);
    (1.0 - poisson * poisson) / (2.0 * PI) * integrate(0.0, END / disc, panel, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bending and squeezing are all of f; and the midpoint rule of the formula as it stands.
    #[test]
    fn squeezing_is_the_second_part() {
        let parts = |t: f64| ((t.cosh() + 1.0) / (t.sinh() - t), (t.cosh() - 1.0) / (t.sinh() + t));
        for t in [0.5, 1.0, 5.0, 20.0] {
            let (bending, squeezing) = parts(t);
            assert!((squeezed(t) / squeezing - 1.0).abs() < 1e-12);
            assert!(((bending + squeezed(t)) / flexibility(t) - 1.0).abs() < 1e-12);
        }
        for (ratio, disc) in [(0.0, 2.0), (0.5, 1.0)] {
            let (spread, step) = (Spread::new(ratio), 1e-3);
            let at = |i: i32| step * (f64::from(i) + 0.5);
            let sum: f64 = (0..60_000).map(|i| parts(at(i)).1 * spread.square(at(i) * disc)).sum();
            let plain = (1.0 - 0.23 * 0.23) / (2.0 * PI) * sum * step;
            // The rule's (step/disc)², and the tail.
            assert!((squeezing(&spread, 0.23, disc) / plain - 1.0).abs() < 1e-6);
        }
    }

    /// By an independent script's plain sums up to t = 60: 0.5, 1, 1.5 and 2 thicknesses, ν = 0.23.
    #[test]
    fn known_constants() {
        for (disc, exact) in [(0.5, -2.877e-5), (1.0, -1.359e-3), (1.5, -9.807e-3), (2.0, -3.267e-2)] {
            let found = beyond_half_space(&Spread::new(0.0), 0.23, disc);
            // The script begins at t = 0.02, with steps of 1e-4.
            assert!((found / exact - 1.0).abs() < 2e-3, "{disc}: {found:e} {exact:e}");
        }
    }
}
