//! Constants of the local field under a load on the top face, which a layerwise plate lacks. They are derived from the
//! static solution of the infinite stack, without fitting.
//!
//! As for one layer ([`crate::space::plate::layer`]), let Γ(ξ) be the response of the stack at the wavenumber ξ to a
//! pressure on its top, W(ξ) the response of the theory, and H(ξ) the response of a half-space of the impacted layer.
//! For long waves Γ − W is proportional to ξ⁻², and the factor hardly changes as the layers begin to slide. So the
//! plate is loaded and evaluated by w + β M, where M is the sum of its bending moments. By equilibrium alone, this adds
//! 2β/ξ². The remainder is a constant in the contact law,
//!
//! c = (1/2π) ∫ {[Γ − H] − Γ_L P²} ξ dξ,
//!
//! where Γ_L is the response of the plate by w + β M, and P is the transform of the pressure on it.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::form::Spread;
use crate::space::plate::layer::{END, integrate};
use crate::stack::{Layerwise, Stack};

/// Upper limit of ξH for the wavenumber ξ at which the response is matched, where H is the thickness of the stack. ξ is
/// otherwise the wavenumber π/edge of the longest wave on the plate.
const LARGEST_MATCHED_WAVENUMBER: f64 = 0.05;

/// Value of ξh, h the thickness of the impacted layer, above which Γ is set to H. The difference is proportional to
/// (ξh)² e^{−2ξh}.
const HALF_SPACE: f64 = 22.0;

/// Value of ξR above which the plate's part of the integral is integrated separately.
const APART: f64 = 3.0;

/// Constants β (m/N) and c (m/N) of a stack under a spread pressure on a disc of a radius (m), for a plate with the
/// longer edge `edge` (m).
///
/// For waves longer than the plate, Γ = Γ_L is assumed; the integrand is then −H ξ.
pub(super) fn constants(theory: &Layerwise, (spread, radius): (&Spread, f64), edge: f64) -> (f64, f64) {
    let stack = theory.stack();
    let longest = (PI / edge).min(LARGEST_MATCHED_WAVENUMBER / stack.thickness());
    let wave = theory.wave(longest);
    let reading = 0.5 * longest * longest * (loaded_face(stack, longest) - theory.read(&wave));
    let read = theory.clone().with_reading(reading);
    let struck = stack.layers()[0];
    let half_space = |xi: f64| 2.0 * (1.0 - struck.poisson.powi(2)) / (struck.young * xi);
    let plate = |xi: f64| read.read(&read.wave(xi));
    let together = |xi: f64| {
        let (exact, plate) = (loaded_face(stack, xi), plate(xi));
        (exact - plate - half_space(xi) - plate * spread.over_waves(xi * radius)) * xi
    };
    let panel = (FRAC_PI_2 / radius).min(1.0 / struck.thickness);
    let apart = (APART / radius).max(longest);
    // H ξ is constant.
    let (mut sum, mut from) = (-half_space(longest) * longest * longest, longest);
    // The panels grow with the wavenumber, since a soft layer begins to slide far below ξ = 1/H, H being the thickness
    // of the stack.
    while from < apart {
        let to = (2.0 * from).min(from + 10.0 * panel).min(apart);
        sum += integrate(from, to, panel, together);
        from = to;
    }
    let end = HALF_SPACE / struck.thickness;
    if end > apart {
        sum += integrate(apart, end, panel, |xi| (loaded_face(stack, xi) - half_space(xi)) * xi);
    }
    sum -= integrate(apart, END / radius, panel, |xi| plate(xi) * spread.square(xi * radius) * xi);
    (reading, sum / (2.0 * PI))
}

/// Response Γ of the loaded face, m/Pa.
fn loaded_face(stack: &Stack, wavenumber: f64) -> f64 {
    stack.wave(wavenumber).response(stack, 0.0).u_z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::plate::layer::Layer as Single;
    use crate::stack::{Layer, Section};

    fn theory(layers: &[(f64, f64, f64)]) -> Layerwise {
        let layers: Vec<Layer> =
            layers.iter().map(|&(thickness, young, poisson)| Layer { thickness, young, poisson }).collect();
        let stack = Stack::new(&layers).expect("elastic layers");
        Layerwise::new(&stack, &Section::new(&stack).shear_factors(&stack)).expect("factors")
    }

    /// For one layer the constants equal the constants of Mindlin's plate, apart from the finite wavenumber at which
    /// the response is matched.
    #[test]
    fn one_layer_is_mindlins() {
        let (h, young, poisson, disc) = (0.02, 70e9, 0.23, 2.0);
        let spread = Spread::new(0.0);
        let single = Single { poisson, shear_factor: 5.0 / (6.0 - poisson), spread, disc };
        let theory = theory(&[(h, young, poisson)]);
        let (reading, compliance) = constants(&theory, (&spread, disc * h), 1.0);
        let rigidity = young * h.powi(3) / (12.0 * (1.0 - poisson * poisson));
        // The response is matched at ξh = 0.05; the relative difference is a small multiple of the square of this.
        let exact = single.reading() * h * h / rigidity;
        assert!((reading / exact - 1.0).abs() < 2e-2, "{reading:e} {exact:e}");
        let exact = single.compliance() / (young * h);
        assert!((compliance / exact - 1.0).abs() < 2e-2, "{compliance:e} {exact:e}");
    }

    /// For a laminate with a soft or a stiff interlayer, the response by w + β M agrees with the exact response for
    /// long waves. The relative error is proportional to (ξH)⁴: sixteen times as large at twice the wavenumber.
    #[test]
    fn long_waves_are_exact() {
        for shear in [1e5, 1e6, 1e7, 1e8] {
            let bulk = 2e9;
            let poisson = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
            let interlayer = (0.00076, 2.0 * shear * (1.0 + poisson), poisson);
            let theory = theory(&[(0.01, 70e9, 0.23), interlayer, (0.01, 70e9, 0.23)]);
            let (reading, _) = constants(&theory, (&Spread::new(0.0), 0.02), 0.5);
            let read = theory.clone().with_reading(reading);
            for (wavenumber, tolerance) in [(6.3, 2e-4), (10.0, 3e-4), (20.0, 1e-3), (40.0, 1.6e-2)] {
                let found = read.read(&read.wave(wavenumber));
                let exact = loaded_face(theory.stack(), wavenumber);
                assert!((found / exact - 1.0).abs() < tolerance, "{shear:e} {wavenumber}: {found:e} {exact:e}");
            }
        }
    }
}
