//! Differences between an infinite layer, or a stack of layers, and a half-space under a spread pressure.
//!
//! At the wavenumber ξ, a layer of thickness h has the response Γ = (1 − ν²)/(E ξ) f(ξh) to a pressure on its top, with
//! f(t) = (cosh t + 1)/(sinh t − t) + (cosh t − 1)/(sinh t + t) for bending and squeezing. A half-space has the response
//! H = 2 (1 − ν²)/(E ξ). Let Hertz's pressure have the transform P_h, and the pressure that replaces it the
//! transform P. The difference of the two displacements is (1/2π) ∫ Γ (P² − P_h²) ξ dξ. The part of a half-space, with
//! H, is known in closed form. The remaining integral converges, since P² − P_h² = O(ξ⁶).

use std::f64::consts::PI;

use crate::form::Spread;
use crate::space::loaded_face::{END, LoadedFace, integrate};
use crate::stack::Stack;

/// Value of ξh above which a layer responds like the half-space to rounding.
const HALF_SPACE: f64 = 44.0;

/// E h/(2π) ∫ (Γ − H) (P² − P_h²) ξ dξ; `disc` is the radius of the disc divided by the thickness.
pub(super) fn beyond_half_space(spread: &Spread, poisson: f64, disc: f64) -> f64 {
    // Each panel is half a wave of P².
    let panel = (0.5 * PI / disc).min(1.0);
    let value = |t: f64| (flexibility(t) - 2.0) * spread.over_waves(t * disc);
    (1.0 - poisson * poisson) / (2.0 * PI) * integrate(0.0, HALF_SPACE, panel, value)
}

/// Value of ξH, H the thickness of the stack, below which the integrand of a stack is negligible: it is proportional to
/// ξ³.
const LONGEST_WAVE: f64 = 1e-2;

/// (1/2π) ∫ (Γ − H) (P² − P_h²) ξ dξ of a stack of layers, m/N; `disc` is the radius of the disc, m. On a disc as wide as
/// the impacted layer is thick, a single layer is nearly a half-space. A layer on a soft interlayer bends under the disc
/// as well.
pub(super) fn stack_beyond_half_space(stack: &Stack, spread: &Spread, disc: f64) -> f64 {
    let face = LoadedFace::new(stack, disc);
    let value = |xi: f64| face.beyond_half_space(xi) * spread.over_waves(xi * disc) * xi;
    face.integrate(LONGEST_WAVE / stack.thickness(), face.half_space_from(), value) / (2.0 * PI)
}

/// E h/(2π) ∫ Γ_s P² ξ dξ: compliance due to squeezing alone (the second part of Γ) under the spread pressure.
pub(super) fn squeezing(spread: &Spread, poisson: f64, disc: f64) -> f64 {
    let panel = (0.5 * PI / disc).min(1.0);
    let value = |t: f64| squeezed(t) * spread.square(t * disc);
    (1.0 - poisson * poisson) / (2.0 * PI) * integrate(0.0, END / disc, panel, value)
}

/// Function f(t), which tends to 2 for large t.
fn flexibility(t: f64) -> f64 {
    (t.cosh() + 1.0) / (t.sinh() - t) + squeezed(t)
}

/// Second part of f(t), (cosh t − 1)/(sinh t + t), without overflow.
fn squeezed(t: f64) -> f64 {
    (0.5 * t).tanh() / (1.0 + t / t.sinh())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stack::Layer;

    /// Bending and squeezing sum to f. The integral agrees with the midpoint rule applied to the original formula.
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
            // Error of the midpoint rule, (step/disc)², and the neglected tail.
            assert!((squeezing(&spread, 0.23, disc) / plain - 1.0).abs() < 1e-6);
        }
    }

    /// A stack of one layer, or of three layers of one material, is the layer.
    #[test]
    fn stacks_of_one_material_are_a_layer() {
        let (young, poisson, spread) = (70e9, 0.23, Spread::new(0.0));
        let layer = |thickness: f64| Layer { thickness, young, poisson };
        for disc in [0.5, 1.0, 2.0] {
            let exact = beyond_half_space(&spread, poisson, disc) / (young * 0.02);
            for thicknesses in [&[0.02][..], &[0.008, 0.002, 0.01]] {
                let layers: Vec<Layer> = thicknesses.iter().map(|thickness| layer(*thickness)).collect();
                let stack = Stack::new(&layers).expect("an elastic stack");
                let found = stack_beyond_half_space(&stack, &spread, disc * 0.02);
                // The single layer's response is a half-space's from a smaller ξh on.
                assert!((found / exact - 1.0).abs() < 1e-4, "{disc} {thicknesses:?}: {found:e} {exact:e}");
            }
        }
    }

    /// Values from plain sums up to t = 60 by an independent script: 0.5, 1, 1.5 and 2 thicknesses, ν = 0.23.
    #[test]
    fn known_constants() {
        for (disc, exact) in [(0.5, -2.877e-5), (1.0, -1.359e-3), (1.5, -9.807e-3), (2.0, -3.267e-2)] {
            let found = beyond_half_space(&Spread::new(0.0), 0.23, disc);
            // The script starts at t = 0.02, with steps of 1e-4.
            assert!((found / exact - 1.0).abs() < 2e-3, "{disc}: {found:e} {exact:e}");
        }
    }
}
