//! A pressure over a wider disc in the place of Hertz's.
//!
//! All of a body but its surface nearby sees of a pressure on a disc its moments alone. So Hertz's pressure over r_p may be spread over
//! R > r_p as
//!
//! p(r) = Σ w_m m/(π R²) (1 − r²/R²)^{m−1},  m = 3, 4, 5,
//!
//! with the same ∫p = 1, ∫p r² = 2/5 r_p² and ∫p r⁴ = 8/35 r_p⁴. Its Hankel transform, Σ w_m Λ_m(ξR) with
//! Λ_m(x) = m! (2/x)^m J_m(x), differs from Hertz's by O(ξ⁶) for long waves and falls faster for short ones, so that larger cells
//! carry it. What a half-space yields under it is another number: that goes with ∫P² dξ.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

/// The lowest m.
const LOWEST: usize = 3;

/// Hertz's pressure over a disc, spread over a wider one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// R / r_p.
    widening: f64,
    weights: [f64; 3],
}

impl Spread {
    /// Over R = `widening` · r_p, from 1 on.
    pub fn new(widening: f64) -> Self {
        // ∫ s^k m (1 − s)^{m−1} ds from 0 to 1.
        let moments = Matrix3::from_fn(|k, i| {
            let m = (LOWEST + i) as f64;
            (1..=k).map(|j| j as f64 / (m + j as f64)).product()
        });
        let shrunk = widening.powi(-2);
        let hertz = Vector3::new(1.0, 0.4 * shrunk, 8.0 / 35.0 * shrunk * shrunk);
        let weights = moments.lu().solve(&hertz).expect("moments of powers are independent");
        Self { widening, weights: weights.into() }
    }

    /// R / r_p.
    pub fn widening(&self) -> f64 {
        self.widening
    }

    /// p over Hertz's pressure on the same disc, at r²/R² < 1.
    pub fn over_hertz(&self, square: f64) -> f64 {
        let inside = (1.0 - square).max(0.0);
        let powers = (LOWEST..).zip(self.weights).map(|(m, w)| w * m as f64 * inside.powi(m as i32 - LOWEST as i32));
        powers.sum::<f64>() * inside.powf(LOWEST as f64 - 1.5) / 1.5
    }

    /// Mean displacement of a half-space under p, weighted by p, over that under Hertz's pressure over r_p: ∫P² dξ over
    /// (3π/5)/r_p.
    pub fn compliance(&self) -> f64 {
        let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        let sum: f64 = pairs.map(|(i, j)| self.weights[i] * self.weights[j] * overlap(LOWEST + i, LOWEST + j)).sum();
        sum / (0.6 * PI * self.widening)
    }
}

/// ∫ Λ_m Λ_n dx = √π g(m) g(n) g(m + n)/(m + n), g(m) = m!/Γ(m + ½) (Weber and Schafheitlin's integral, DLMF 10.22.57).
fn overlap(m: usize, n: usize) -> f64 {
    let g = |m: usize| (1..=m).fold(1.0 / PI.sqrt(), |g, k| g * k as f64 / (k as f64 - 0.5));
    PI.sqrt() * g(m) * g(n) * g(m + n) / (m + n) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::pressure_rule;

    const WIDENINGS: [f64; 5] = [1.0, 1.3, 2.0, 3.1, 4.0];

    /// ∫p, ∫p x² = r_p²/5, ∫p x⁴ = 3 r_p⁴/35 and ∫p x²y² = r_p⁴/35.
    #[test]
    fn moments_are_those_of_hertz() {
        for widening in WIDENINGS {
            let spread = Spread::new(widening);
            let mut sums = [0.0; 4];
            for ([x, y], weight) in pressure_rule([0.0; 2], widening, [&[-9.0, 0.3, 9.0], &[-9.0, 9.0]]) {
                let weight = weight * spread.over_hertz((x * x + y * y) / (widening * widening));
                let values = [1.0, x * x, x.powi(4), x * x * y * y];
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
            // The rule's 1e-12 times sums of weights of up to 40.
            for (sum, exact) in sums.iter().zip([1.0, 0.2, 3.0 / 35.0, 1.0 / 35.0]) {
                assert!((sum - exact).abs() < 1e-9, "{widening}: {sums:?}");
            }
        }
    }

    /// J_m by Bessel's integral, with a rule that is exact to rounding for its periodic function.
    fn bessel(m: usize, x: f64) -> f64 {
        let count = 400;
        let angle = |i: usize| PI * (i as f64 + 0.5) / f64::from(count);
        (0..count as usize).map(|i| (m as f64 * angle(i) - x * angle(i).sin()).cos()).sum::<f64>() / f64::from(count)
    }

    /// ∫P² dξ by sums over waves, and Hertz's pressure as the limit of none that is spread.
    #[test]
    fn compliance_is_the_integral_over_waves() {
        for widening in WIDENINGS {
            let spread = Spread::new(widening);
            let transform = |x: f64| -> f64 {
                let one = |(m, weight): (usize, f64)| {
                    let factor = (1..=m).map(|k| k as f64 * 2.0 / x).product::<f64>();
                    weight * factor * bessel(m, x)
                };
                (LOWEST..).zip(spread.weights).map(one).sum()
            };
            // The midpoint rule of an even entire function: exact up to what lies beyond 2π over the step and beyond the end, x⁻⁶.
            let (step, count) = (0.25, 800);
            let integral: f64 = (0..count).map(|i| step * transform((i as f64 + 0.5) * step).powi(2)).sum();
            let ratio = integral / widening / (0.6 * PI);
            assert!((ratio / spread.compliance() - 1.0).abs() < 1e-6, "{widening}: {ratio} {}", spread.compliance());
        }
        // Of discs alike in size it changes by what their short waves make.
        assert!((Spread::new(1.5).compliance() - 1.0).abs() < 5e-3);
    }
}
