//! Constants of the local field under a load on the top face, which a Reissner–Mindlin plate lacks. They are derived
//! from the static solution of an infinite layer, without fitting.
//!
//! At the wavenumber ξ, a layer of thickness h under a pressure on its top has there the response, with t = ξ h,
//!
//! Γ = (1 − ν²)/(E ξ) f(t),  f = (cosh t + 1)/(sinh t − t) + (cosh t − 1)/(sinh t + t)
//!
//! (bending and squeezing), and a half-space has the response H = 2 (1 − ν²)/(E ξ). Hertz's pressure has the transform
//! P_h. The plate is loaded by a [`Spread`] pressure instead, with the transform P, and its displacement is evaluated
//! as the mean of w + s h² ∇·θ. Its response is Γ_M P² with
//!
//! Γ_M = (1 + s t²)²/(D ξ⁴) + 1/(κ μ h ξ²).
//!
//! It has the terms of Γ in ξ⁻⁴ and, by the choice of s, in ξ⁻²; P² equals P_h² up to O(ξ⁶). The remainder of (Γ − H)
//! P_h² is a constant c_M, since H is already contained in Hertz's law: α = δ − c_M F.

use std::cell::Cell;
use std::f64::consts::PI;

use crate::element::gauss_legendre;
use crate::form::Spread;

/// A layer and the plate that models it; lengths are divided by the thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Shear factor κ of the plate.
    pub shear_factor: f64,
    /// Pressure on the plate.
    pub spread: Spread,
    /// Radius of the disc over which the plate is loaded and its displacement averaged; positive.
    pub disc: f64,
}

thread_local! {
    /// The last layer evaluated and its c_M E h. The plates of a model on finer and coarser cells have the same layer.
    static LAST_LAYER: Cell<Option<(Layer, f64)>> = const { Cell::new(None) };
}

/// Largest t for which the differences from the leading terms are evaluated by their power series.
const SERIES: f64 = 3.0;

/// Value of t above which Γ equals H to rounding.
pub(in crate::space) const HALF_SPACE: f64 = 44.0;

/// Value of x = ξ R above which P², which decreases as x⁻⁷, is below 1e-9.
pub(in crate::space) const END: f64 = 60.0;

impl Layer {
    /// Factor s in the displacement w + s h² ∇·θ.
    pub fn reading(&self) -> f64 {
        0.1 - self.shear() / (24.0 * (1.0 - self.poisson.powi(2)))
    }

    /// Dimensionless local compliance c_M E h.
    pub fn compliance(&self) -> f64 {
        if let Some((_, known)) = LAST_LAYER.get().filter(|(layer, _)| layer == self) {
            return known;
        }
        let found = self.integrated();
        LAST_LAYER.set(Some((*self, found)));
        found
    }

    fn integrated(&self) -> f64 {
        let panel = (0.5 * PI / self.disc).min(1.0);
        let end = (END / self.disc).max(SERIES);
        let mut sum = integrate(0.0, SERIES, panel, |t| self.rest(t));
        sum += integrate(SERIES, HALF_SPACE, panel, |t| self.layer(t));
        sum -= integrate(SERIES, end, panel, |t| self.plate(t) * self.spread.square(t * self.disc));
        sum / (2.0 * PI)
    }

    /// E h/(κ μ h).
    fn shear(&self) -> f64 {
        2.0 * (1.0 + self.poisson) / self.shear_factor
    }

    /// Integrand E h · (Γ − H) P_h² ξ dξ/dt of the layer.
    fn layer(&self, t: f64) -> f64 {
        (1.0 - self.poisson.powi(2)) * (flexibility(t) - 2.0) * self.spread.hertz(t * self.disc).powi(2)
    }

    /// Integrand E h · Γ_M ξ dξ/dt of the plate, without P².
    fn plate(&self, t: f64) -> f64 {
        let of_bending = 12.0 * (1.0 - self.poisson.powi(2)) * (1.0 + self.reading() * t * t).powi(2) / t.powi(3);
        of_bending + self.shear() / t
    }

    /// [`Self::layer`] minus the plate's part with P², without the terms that cancel.
    fn rest(&self, t: f64) -> f64 {
        let (s, x) = (self.reading(), t * self.disc);
        let rest = layer_series(t) - 12.0 * s * s * t - 2.0;
        (1.0 - self.poisson.powi(2)) * rest * self.spread.hertz(x).powi(2) - self.plate(t) * self.spread.over_waves(x)
    }
}

/// ∫ f dt between two ends, by Gauss's rule of 10 points on each of several panels of at most a given width.
pub(in crate::space) fn integrate(from: f64, to: f64, width: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(10);
    let count = ((to - from) / width).ceil().max(1.0);
    let half = 0.5 * (to - from) / count;
    let panel = |i: usize| {
        let middle = from + (2.0 * i as f64 + 1.0) * half;
        rule.iter().map(|(x, weight)| half * weight * f(middle + half * x)).sum::<f64>()
    };
    (0..count as usize).map(panel).sum()
}

/// Function f(t), which tends to 2 for large t.
pub(in crate::space) fn flexibility(t: f64) -> f64 {
    (t.cosh() + 1.0) / (t.sinh() - t) + squeezed(t)
}

/// Second part of f(t), (cosh t − 1)/(sinh t + t), without overflow.
pub(in crate::space) fn squeezed(t: f64) -> f64 {
    (0.5 * t).tanh() / (1.0 + t / t.sinh())
}

/// f − 12/t³ − 2.4/t: these terms cancel in the numerator over the first denominator, which are summed as series. The
/// squeezing part is added.
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
    numerator / denominator + squeezed(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYERS: [(f64, f64, f64, f64); 4] =
        [(0.23, 5.0 / 6.0, 2.0, 0.0), (0.23, 5.0 / 6.0, 0.5, 0.0), (0.49, 0.9, 0.7, 0.25), (-0.5, 0.8, 1.0, 0.1)];

    fn layers() -> [Layer; 4] {
        LAYERS.map(|(poisson, shear_factor, disc, patch)| Layer {
            poisson,
            shear_factor,
            disc,
            spread: Spread::new(patch / disc),
        })
    }

    /// The series and the formulas agree where both are accurate. This shows that the terms in t⁻³ and t⁻¹ are the same
    /// for layer and plate.
    #[test]
    fn rests_are_those_of_the_formulas() {
        for layer in layers() {
            for t in [0.5, 1.0, 2.0, SERIES] {
                let exact = layer.layer(t) - layer.plate(t) * layer.spread.square(t * layer.disc);
                // Rounding error of the leading term.
                assert!((layer.rest(t) - exact).abs() < 1e-13 * 12.0 / t.powi(3) + 1e-12, "{layer:?} {t}: {exact}");
            }
            // For long waves the remainder is a constant, without a term in t⁻¹.
            let rests = [1e-2, 1e-4, 1e-6].map(|t| layer.rest(t));
            assert!(rests.iter().all(|rest| (rest - rests[2]).abs() < 0.05), "{rests:?}");
        }
    }

    /// Compares with the midpoint rule applied to the original formulas.
    #[test]
    fn compliance_is_that_of_a_plain_sum() {
        for layer in layers() {
            let h = 1e-3;
            let plain: f64 = (0..300_000)
                .map(|i| h * (f64::from(i) + 0.5))
                // Below t = 0.05 the formulas lose their digits to rounding; there the value at 0.05 is used.
                .map(|t| {
                    if t < 0.05 {
                        return layer.rest(0.05);
                    }
                    let of_layer = if t > 300.0 { 0.0 } else { layer.layer(t) };
                    of_layer - layer.plate(t) * layer.spread.square(t * layer.disc)
                })
                .sum::<f64>()
                * h
                / (2.0 * PI);
            let found = layer.compliance();
            // The remainder varies by a tenth of a unit below 0.05.
            assert!((found - plain).abs() < 1e-3, "{layer:?}: {found} {plain}");
        }
    }

    /// The radius of the disc may be chosen freely: the difference of c_M for two radii is the difference of the
    /// compliances of the static plate.
    #[test]
    fn a_wider_disc_takes_what_the_plate_yields_less() {
        let [wide, narrow] =
            [2.0, 1.0].map(|disc| Layer { poisson: 0.23, shear_factor: 5.0 / 6.0, disc, spread: Spread::new(0.0) });
        let of = |layer: &Layer| {
            integrate(1e-6, 200.0, 0.2, |t| {
                layer.plate(t) * layer.spread.over_waves(t * layer.disc)
                    - layer.plate(t) * wide.spread.over_waves(t * wide.disc)
            }) / (2.0 * PI)
        };
        let (found, exact) = (narrow.compliance() - wide.compliance(), -of(&narrow));
        // The integral beyond t = 200 is neglected.
        assert!((found / exact - 1.0).abs() < 1e-4, "{found} {exact}");
    }
}
