//! Compliance of the local field under a load on the top face, which a layerwise plate lacks. It is derived from the
//! static solution of the infinite stack, without fitting.
//!
//! Let Γ(ξ) be the response of the stack at the wavenumber ξ to a pressure on its top, Γ_L(ξ) the response of the theory on
//! the same face, and H(ξ) the response of a half-space of the impacted layer. For long waves Γ and Γ_L have the same terms in ξ⁻⁴ and ξ⁻². The remainder is a constant in the
//! contact law,
//!
//! c = (1/2π) ∫ {[Γ − H] P_h² − Γ_L P²} ξ dξ,
//!
//! where P is the transform of the pressure on the plate, and P_h that of Hertz's pressure which it stands for.

use std::f64::consts::PI;

use super::Disc;
use crate::space::loaded_face::{END, LoadedFace};
use crate::stack::Layerwise;

/// Upper limit of ξH for the smallest wavenumber ξ of the integral, where H is the thickness of the stack. ξ is
/// otherwise the wavenumber π/edge of the longest wave on the plate.
const LONGEST_WAVE: f64 = 0.05;

/// Value of ξR above which the plate's part of the integral is integrated separately.
const APART: f64 = 3.0;

/// Compliance c (m/N) of a stack under the pressure on a disc, for a plate with the longer edge `edge` (m).
///
/// For waves longer than the plate, Γ = Γ_L is assumed; the integrand is then −H ξ.
pub(super) fn compliance(theory: &Layerwise, &Disc { spread, radius }: &Disc, edge: f64) -> f64 {
    let stack = theory.stack();
    let longest = (PI / edge).min(LONGEST_WAVE / stack.thickness());
    let face = LoadedFace::new(stack, radius);
    let hertz = |xi: f64| spread.hertz(xi * radius).powi(2);
    let plate = |xi: f64| theory.face_deflection(&theory.wave(xi));
    let together = |xi: f64| {
        let plate = plate(xi);
        ((face.beyond_half_space(xi) - plate) * hertz(xi) - plate * spread.over_waves(xi * radius)) * xi
    };
    let apart = (APART / radius).max(longest);
    // H ξ is constant.
    let mut sum = -face.half_space(longest) * longest * longest;
    sum += face.integrate(longest, apart, together);
    sum += face.integrate(apart, face.half_space_from(), |xi| face.beyond_half_space(xi) * hertz(xi) * xi);
    sum -= face.integrate(apart, END / radius, |xi| plate(xi) * spread.square(xi * radius) * xi);
    sum / (2.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::Spread;
    use crate::stack::{Layer, Stack};

    /// Compliance of one layer by the midpoint rule, with both responses in closed form. With t = ξh,
    /// Γ = (1 − ν²)/(E ξ) [(cosh t + 1)/(sinh t − t) + (cosh t − 1)/(sinh t + t)], and
    /// Γ_L = (1 + s t²)²/(D ξ⁴) + 6/(5 μ h ξ²) with s = −ν/(10 (1 − ν)).
    #[test]
    fn one_layer_by_closed_forms() {
        let (h, young) = (0.02, 70e9);
        for (poisson, radius, patch) in [(0.23, 2.0, 0.0), (0.23, 0.5, 0.0), (0.45, 0.7, 0.25), (-0.5, 1.0, 0.1)] {
            let poisson: f64 = poisson;
            let spread = Spread::new(patch / radius);
            let plane = 1.0 - poisson * poisson;
            let [reading, step] = [-0.1 * poisson / (1.0 - poisson), 1e-3];
            let value = |t: f64| {
                let squeezed = (t.cosh() - 1.0) / (t.sinh() + t);
                let layer = if t > 300.0 { 0.0 } else { (t.cosh() + 1.0) / (t.sinh() - t) + squeezed - 2.0 };
                let bending = 12.0 * plane * (1.0 + reading * t * t).powi(2) / t.powi(3);
                let plate = bending + 2.4 * (1.0 + poisson) / t;
                plane * layer * spread.hertz(t * radius).powi(2) - plate * spread.square(t * radius)
            };
            // Below t = 0.05 the closed forms lose their digits to rounding; the integrand is nearly constant there.
            let sum: f64 = (0..300_000).map(|i| value((step * (f64::from(i) + 0.5)).max(0.05))).sum();
            let plain = sum * step / (2.0 * PI) / (young * h);
            let stack = Stack::new(&[Layer { thickness: h, young, poisson }]).expect("an elastic layer");
            let found = compliance(&Layerwise::new(&stack), &Disc { spread, radius: radius * h }, 1.0);
            // The integrand varies by some tenths of a unit below t = 0.05, where both sums take a constant.
            assert!((found - plain).abs() < 3e-3 / (young * h), "{poisson} {radius}: {found:e} {plain:e}");
        }
    }
}
