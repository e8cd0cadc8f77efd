//! What a Reissner–Mindlin plate misses of the local field under a load on its top: derived from the static solution of an infinite
//! layer, nothing fitted.
//!
//! In the wavenumber ξ a layer of thickness h under a pressure on its top moves there by, with t = ξ h,
//!
//! Γ = (1 − ν²)/(E ξ) f(t),  f = (cosh t + 1)/(sinh t − t) + (cosh t − 1)/(sinh t + t)
//!
//! (bending and squeezing), and a half-space by H = 2 (1 − ν²)/(E ξ). A plate
//! loaded by Hertz's pressure over a disc of radius r and read as its mean of w + s h² ∇·θ moves by Γ_M P(ξ r)² with
//!
//! Γ_M = (1 + s t²)²/(D ξ⁴) + 1/(κ μ h ξ²),  P(x) = 3 (sin x − x cos x)/x³.
//!
//! Γ_M P² has Γ's terms of ξ⁻⁴ and, by the choice of s, of ξ⁻². What Γ − H has besides is a constant c_M, since Hertz's law
//! holds H: α = δ − c_M F.

use std::f64::consts::PI;

use crate::element::gauss_legendre;
use crate::form::{hertz_terms, hertz_wave};

/// A layer and the plate in its place, lengths in thicknesses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// ν.
    pub poisson: f64,
    /// κ of the plate.
    pub shear_factor: f64,
    /// Radius of the disc over which the plate is loaded and read; positive.
    pub disc: f64,
    /// Radius of the patch on the layer that is to be matched; 0 for its limit.
    pub patch: f64,
}

/// Up to this t differences from the leading terms are summed as series.
const SERIES: f64 = 3.0;

/// From this t on Γ is H to rounding.
pub(in crate::body) const HALF_SPACE: f64 = 44.0;

/// Where the plate's tail, which falls like x⁻³, ends in x = ξ r; what is left is below 1e-8 of c_M with the tail's mean added.
const END: f64 = 4e3;

impl Layer {
    /// s of the reading w + s h² ∇·θ.
    pub fn reading(&self) -> f64 {
        let Self { poisson: nu, disc, patch, .. } = *self;
        let of_shear = self.shear() / (12.0 * (1.0 - nu * nu));
        0.5 * (0.2 - 0.2 * patch * patch - of_shear + 0.2 * disc * disc)
    }

    /// c_M E h.
    pub fn compliance(&self) -> f64 {
        let panel = (PI / self.disc.max(self.patch)).min(2.0);
        let mut sum = integrate(0.0, SERIES, panel, |t| self.layer_rest(t) - self.plate_rest(t));
        sum += integrate(SERIES, HALF_SPACE, panel, |t| self.layer(t) - self.plate(t));
        let end = (END / self.disc).max(2.0 * HALF_SPACE);
        sum -= integrate(HALF_SPACE, end, PI / self.disc, |t| self.plate(t));
        // Beyond, 9 cos² x/x⁴ of P² has the mean 9/2 x⁻⁴, times 12 (1 − ν²) s² t.
        let s = self.reading();
        sum -= 12.0 * (1.0 - self.poisson.powi(2)) * s * s * 4.5 / self.disc.powi(4) * 0.5 / (end * end);
        sum / (2.0 * PI)
    }

    /// E h/(κ μ h).
    fn shear(&self) -> f64 {
        2.0 * (1.0 + self.poisson) / self.shear_factor
    }

    /// E h · [Γ − H] P² ξ dξ/dt.
    fn layer(&self, t: f64) -> f64 {
        (1.0 - self.poisson.powi(2)) * (flexibility(t) - 2.0) * hertz_wave(t * self.patch).powi(2)
    }

    /// E h · Γ_M P² ξ dξ/dt.
    fn plate(&self, t: f64) -> f64 {
        let of_bending = 12.0 * (1.0 - self.poisson.powi(2)) * (1.0 + self.reading() * t * t).powi(2) / t.powi(3);
        (of_bending + self.shear() / t) * hertz_wave(t * self.disc).powi(2)
    }

    /// The same without the terms of t⁻³ and t⁻¹, which are those of [`Self::plate_rest`].
    fn layer_rest(&self, t: f64) -> f64 {
        let of_pressure = pressure_rest(self.patch * t);
        let square = hertz_wave(self.patch * t).powi(2);
        let rest =
            layer_series(t) * square + 12.0 / t.powi(3) * of_pressure[1] + 2.4 / t * of_pressure[0] - 2.0 * square;
        (1.0 - self.poisson.powi(2)) * rest
    }

    /// [`Self::plate`] without its terms of t⁻³ and t⁻¹.
    fn plate_rest(&self, t: f64) -> f64 {
        let [first, second] = pressure_rest(self.disc * t);
        let (s, square) = (self.reading(), hertz_wave(self.disc * t).powi(2));
        let of_bending = (second / t + 2.0 * s * t * first) / (t * t) + s * s * t * square;
        12.0 * (1.0 - self.poisson.powi(2)) * of_bending + self.shear() / t * first
    }
}

/// ∫ f dt between two ends, in panels of a width or less: Gauss's rule of 10 points each.
pub(in crate::body) fn integrate(from: f64, to: f64, width: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(10);
    let count = ((to - from) / width).ceil().max(1.0);
    let half = 0.5 * (to - from) / count;
    let panel = |i: usize| {
        let middle = from + (2.0 * i as f64 + 1.0) * half;
        rule.iter().map(|(x, weight)| half * weight * f(middle + half * x)).sum::<f64>()
    };
    (0..count as usize).map(panel).sum()
}

/// f(t), which tends to 2.
pub(in crate::body) fn flexibility(t: f64) -> f64 {
    (t.cosh() + 1.0) / (t.sinh() - t) + (t.cosh() - 1.0) / (t.sinh() + t)
}

/// f − 12/t³ − 2.4/t: the numerator over the first denominator as a series, where those terms have cancelled, and the
/// squeezing.
fn layer_series(t: f64) -> f64 {
    // 1/(2k)!, 1/(2k+1)! and 1/(2k+3)! from k = 2 on.
    let (mut even, mut odd, mut next) = (1.0 / 24.0, 1.0 / 120.0, 1.0 / 5040.0);
    let (mut power, mut numerator, mut denominator) = (t.powi(4), 0.0, t.powi(3) / 6.0);
    for k in 2..20 {
        numerator += power * (even - 12.0 * next - 2.4 * odd);
        denominator += power * t * odd;
        let n = 2.0 * f64::from(k);
        even /= (n + 1.0) * (n + 2.0);
        odd /= (n + 2.0) * (n + 3.0);
        next /= (n + 4.0) * (n + 5.0);
        power *= t * t;
    }
    let squeezing = 2.0 * (0.5 * t).sinh().powi(2) / (t.sinh() + t);
    numerator / denominator + squeezing
}

/// P² − 1 and P² − 1 + x²/5.
fn pressure_rest(x: f64) -> [f64; 2] {
    if x < 1.0 {
        let (first, second) = (hertz_terms(x, 1), hertz_terms(x, 2));
        [first * (2.0 + first), 2.0 * second + first * first]
    } else {
        let square = hertz_wave(x).powi(2);
        [square - 1.0, square - 1.0 + 0.2 * x * x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYERS: [Layer; 4] = [
        Layer { poisson: 0.23, shear_factor: 5.0 / 6.0, disc: 0.5, patch: 0.0 },
        Layer { poisson: 0.23, shear_factor: 5.0 / 6.0, disc: 0.3, patch: 0.0 },
        Layer { poisson: 0.49, shear_factor: 0.9, disc: 0.7, patch: 0.25 },
        Layer { poisson: -0.5, shear_factor: 0.8, disc: 0.1, patch: 0.1 },
    ];

    /// By an independent script's plain sums of the formulas, to the digits that they give.
    #[test]
    fn known_constants() {
        for (layer, s, c) in [(LAYERS[0], -0.0049, -0.7122), (LAYERS[1], -0.0209, -0.9496)] {
            assert!((layer.reading() - s).abs() < 5e-5, "{}", layer.reading());
            assert!((layer.compliance() - c).abs() < 1e-4, "{}", layer.compliance());
        }
    }

    /// Series and formulas agree where both have digits; so the terms of t⁻³ and t⁻¹ are alike in layer and plate.
    #[test]
    fn rests_are_those_of_the_formulas() {
        for layer in LAYERS {
            for t in [0.5, 1.0, 2.0, SERIES] {
                let [found, exact] = [layer.layer_rest(t) - layer.plate_rest(t), layer.layer(t) - layer.plate(t)];
                // Rounding of the leading term.
                assert!((found - exact).abs() < 1e-14 * 12.0 / t.powi(3) + 1e-13, "{layer:?} {t}: {found} {exact}");
            }
            // What is left at long waves is a constant, without a term of t⁻¹.
            let rests = [1e-2, 1e-4, 1e-6].map(|t| layer.layer_rest(t) - layer.plate_rest(t));
            assert!(rests.iter().all(|rest| (rest - rests[2]).abs() < 0.05), "{rests:?}");
        }
    }

    /// The midpoint rule to t = 2000, and the tail's mean.
    #[test]
    fn compliance_is_that_of_a_plain_sum() {
        for layer in LAYERS {
            let h = 2e-3;
            let plain: f64 = (0..1_000_000)
                .map(|i| {
                    let t = h * (f64::from(i) + 0.5);
                    let of_layer = if t > 300.0 { 0.0 } else { layer.layer(t) };
                    if t < 1.0 { layer.layer_rest(t) - layer.plate_rest(t) } else { of_layer - layer.plate(t) }
                })
                .sum::<f64>()
                * h
                / (2.0 * PI);
            let nu = layer.poisson;
            let rest = 12.0 * (1.0 - nu * nu) * layer.reading().powi(2) * 4.5 / layer.disc.powi(4) * 0.5 / 4e6;
            let found = layer.compliance();
            // The rule's (h/r)² and the tail's own oscillation.
            assert!((found - (plain - rest / (2.0 * PI))).abs() < 3e-6, "{layer:?}: {found} {plain}");
        }
    }
}
