//! What a layerwise plate misses of the local field under a load on its top: derived from the static solution of the infinite stack,
//! nothing fitted.
//!
//! As for one layer ([`crate::space::plate::layer`]), in the wavenumber ξ the stack moves by Γ(ξ) under a pressure on its top, the theory
//! by W(ξ), and a half-space of the layer that is hit by H(ξ). Γ − W falls as ξ⁻² while waves are long, and its factor hardly changes as the
//! layers begin to slide. So the plate is loaded and read by w + β M, M being the sum of its bending moments, which adds 2β/ξ² by
//! equilibrium alone. What is left is a constant in the contact law,
//!
//! c = (1/2π) ∫ {[Γ − H] − Γ_L P²} ξ dξ,
//!
//! with Γ_L of the plate as it is read and P of the pressure that it is under.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::form::Spread;
use crate::space::plate::layer::{END, integrate};
use crate::stack::{Layerwise, Stack};

/// ξ over that of the longest wave at most, times the stack's thickness, at which the response is matched.
const LONG: f64 = 0.05;

/// ξ times the thickness of the layer that is hit from which on Γ is H: the rest falls as (ξh)² e^{−2ξh}.
const HALF_SPACE: f64 = 22.0;

/// ξR from which on the plate's part of the integral is summed by itself.
const APART: f64 = 3.0;

/// β (m/N) and c (m/N) of a stack under a spread pressure on a disc of a radius (m), on a plate whose longer edge is given, m.
///
/// In longer waves than the plate Γ is Γ_L: what is left there is H.
pub(super) fn constants(theory: &Layerwise, (spread, radius): (&Spread, f64), edge: f64) -> (f64, f64) {
    let stack = theory.stack();
    let longest = (PI / edge).min(LONG / stack.thickness());
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
    // H ξ is a constant.
    let (mut sum, mut from) = (-half_space(longest) * longest * longest, longest);
    // Panels grow with the wavenumber: a soft layer begins to slide far below 1/H.
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

/// Γ, m/Pa.
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

    /// One layer has the constants of Mindlin's plate, but for the wave at which they are matched.
    #[test]
    fn one_layer_is_mindlins() {
        let (h, young, poisson, disc) = (0.02, 70e9, 0.23, 2.0);
        let spread = Spread::new(0.0);
        let single = Single { poisson, shear_factor: 5.0 / (6.0 - poisson), spread, disc };
        let theory = theory(&[(h, young, poisson)]);
        let (reading, compliance) = constants(&theory, (&spread, disc * h), 1.0);
        let rigidity = young * h.powi(3) / (12.0 * (1.0 - poisson * poisson));
        // Waves are matched at ξh = 0.05: its square, some times over.
        let exact = single.reading() * h * h / rigidity;
        assert!((reading / exact - 1.0).abs() < 2e-2, "{reading:e} {exact:e}");
        let exact = single.compliance() / (young * h);
        assert!((compliance / exact - 1.0).abs() < 2e-2, "{compliance:e} {exact:e}");
    }

    /// Of a laminate with a soft or a stiff interlayer what the plate reads is the exact response, from the longest waves on; what is left
    /// is a constant, of a part of (ξH)⁴: sixteen times as much at twice the wavenumber.
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
