//! Compliance of the local field under a load on the top face, which a layerwise plate lacks. It is derived from the
//! static solution of the infinite stack, without fitting.
//!
//! As for one layer ([`crate::space::plate::layer`]), let Γ(ξ) be the response of the stack at the wavenumber ξ to a
//! pressure on its top, Γ_L(ξ) the response of the theory on the same face, and H(ξ) the response of a half-space of the
//! impacted layer. For long waves Γ and Γ_L have the same terms in ξ⁻⁴ and ξ⁻². The remainder is a constant in the
//! contact law,
//!
//! c = (1/2π) ∫ {[Γ − H] P_h² − Γ_L P²} ξ dξ,
//!
//! where P is the transform of the pressure on the plate, and P_h that of Hertz's pressure which it stands for.

use std::f64::consts::PI;

use crate::form::Spread;
use crate::space::loaded_face::LoadedFace;
use crate::space::plate::layer::END;
use crate::stack::Layerwise;

/// Upper limit of ξH for the smallest wavenumber ξ of the integral, where H is the thickness of the stack. ξ is
/// otherwise the wavenumber π/edge of the longest wave on the plate.
const LONGEST_WAVE: f64 = 0.05;

/// Value of ξR above which the plate's part of the integral is integrated separately.
const APART: f64 = 3.0;

/// Compliance c (m/N) of a stack under a spread pressure on a disc of a radius (m), for a plate with the
/// longer edge `edge` (m).
///
/// For waves longer than the plate, Γ = Γ_L is assumed; the integrand is then −H ξ.
pub(super) fn compliance(theory: &Layerwise, (spread, radius): (&Spread, f64), edge: f64) -> f64 {
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
    use crate::space::plate::layer::Layer as Single;
    use crate::stack::{Layer, Stack};

    fn theory(layers: &[(f64, f64, f64)]) -> Layerwise {
        let layers: Vec<Layer> =
            layers.iter().map(|&(thickness, young, poisson)| Layer { thickness, young, poisson }).collect();
        Layerwise::new(&Stack::new(&layers).expect("elastic layers"))
    }

    /// For one layer the compliance is that of Mindlin's plate. Both plates have the same response in long waves, and
    /// their difference in waves as short as the disc is part of both constants.
    #[test]
    fn one_layer_is_mindlins() {
        let (h, young, poisson, disc) = (0.02, 70e9, 0.23, 2.0);
        let spread = Spread::new(0.0);
        let single = Single { poisson, shear_factor: 5.0 / (6.0 - poisson), spread, disc };
        let found = compliance(&theory(&[(h, young, poisson)]), (&spread, disc * h), 1.0);
        let exact = single.compliance() / (young * h);
        assert!((found / exact - 1.0).abs() < 2e-2, "{found:e} {exact:e}");
    }
}
