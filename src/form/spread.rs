//! Pressure on a disc larger than the contact disc, with the same low moments as Hertz's pressure.
//!
//! The response of a body to a pressure on a disc depends only on the moments of the pressure, except at the surface
//! near the disc. So Hertz's pressure over the radius r_p may be spread over R ≥ r_p as
//!
//! p(r) = Σ w_m m/(π R²) (1 − r²/R²)^{m−1},  m = 3, 4, 5,
//!
//! with the same ∫p = 1, ∫p r² = 2/5 r_p² and ∫p r⁴ = 8/35 r_p⁴, also for r_p = 0. Its Hankel transform is P = Σ w_m
//! Λ_m(ξR) with Λ_m(x) = m! (2/x)^m J_m(x). It differs from the transform of Hertz's pressure, Λ_{3/2}(ξ r_p), by O(ξ⁶)
//! for long waves. It decreases faster for short waves, so that larger cells can resolve it. The compliance of a
//! half-space under p differs from the compliance under Hertz's pressure: it is proportional to ∫P² dξ.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::area::{AreaShape, ContactArea};
use super::disc::{hertz_wave, pieces, pressure_rule};
use crate::element::gauss_legendre;

/// Smallest exponent m.
const LOWEST: usize = 3;

/// Largest x = ξR for which the transforms are evaluated by their power series.
const SERIES: f64 = 3.0;

/// Hertz's pressure, spread over a disc of radius R; or the pressure of a wide contact area itself, with R its half width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Ratio r_p / R.
    ratio: f64,
    weights: [f64; 3],
    /// Shape of the area, if the pressure is not spread. Its transform P is taken to be that of Hertz's pressure with the same
    /// second moment: it serves corrections for waves that are short compared with such an area, which are small.
    area: Option<ContactArea>,
}

/// Number of Gauss points along each side of a square, from line to line: exact for products of splines.
const POINTS_OF_SQUARE: usize = 8;

impl Spread {
    /// Spreads Hertz's pressure of the radius r_p over a disc of radius R, for a `ratio` r_p/R from 0 to 1.
    pub fn new(ratio: f64) -> Self {
        // Moments ∫ s^k m (1 − s)^{m−1} ds from 0 to 1.
        let moments = Matrix3::from_fn(|k, i| {
            let m = (LOWEST + i) as f64;
            (1..=k).map(|j| j as f64 / (m + j as f64)).product()
        });
        let square = ratio * ratio;
        let hertz = Vector3::new(1.0, 0.4 * square, 8.0 / 35.0 * square * square);
        let weights = moments.lu().solve(&hertz).expect("moments of powers are independent");
        Self { ratio, weights: weights.into(), area: None }
    }

    /// Pressure of a contact area, and its radius R (m): spread over a disc of a radius (m), or as it is if it is wider.
    pub fn of_area(area: &ContactArea, disc: f64) -> (Self, f64) {
        let ratio = area.equivalent_radius() / disc;
        if ratio <= 1.0 {
            return (Self::new(ratio), disc);
        }
        let ratio = area.equivalent_radius() / area.half_width;
        (Self { ratio, weights: [0.0; 3], area: Some(*area) }, area.half_width)
    }

    /// Radius (m) of the Hertzian pressure that has the transform P, if there is one.
    pub fn as_hertz(&self) -> Option<f64> {
        self.area.as_ref().map(ContactArea::equivalent_radius)
    }

    /// Ratio of p to Hertz's pressure over the same disc of radius R, at `square` = r²/R² < 1.
    pub fn over_hertz(&self, square: f64) -> f64 {
        let inside = (1.0 - square).max(0.0);
        if let Some(area) = self.area {
            // Quadrature points do not lie on the rim but for rounding.
            return if area.shape == AreaShape::EvenDisc { 1.0 / (1.5 * inside.max(1e-15).sqrt()) } else { 1.0 };
        }
        let powers = (LOWEST..).zip(self.weights).map(|(m, w)| w * m as f64 * inside.powi(m as i32 - LOWEST as i32));
        powers.sum::<f64>() * inside.powf(LOWEST as f64 - 1.5) / 1.5
    }

    /// Points and weights of p over its disc or square within a grid (m): for each coordinate along the first axis, the coordinates
    /// and weights along the second axis. The total weight is 1 if the grid contains all of it.
    pub fn strips(&self, centre: [f64; 2], radius: f64, lines: [&[f64]; 2]) -> Vec<(f64, Vec<(f64, f64)>)> {
        let one = |(point, weight): &([f64; 2], f64)| {
            let [x, y] = [0, 1].map(|i| (point[i] - centre[i]) / radius);
            (point[1], weight * self.over_hertz(x * x + y * y))
        };
        if self.area.is_some_and(|area| area.shape == AreaShape::EvenSquare) {
            let [along, across] = [0, 1].map(|axis| on_side(centre[axis], radius, lines[axis]));
            let strip = |of: f64| across.iter().map(|(y, weight)| (*y, of * weight)).collect();
            return along.iter().map(|(x, weight)| (*x, strip(*weight))).collect();
        }
        let points = pressure_rule(centre, radius, lines);
        let strips = points.chunk_by(|(p, _), (q, _)| p[0] == q[0]);
        strips.map(|strip| (strip[0].0[0], strip.iter().map(one).collect())).collect()
    }

    /// Mean displacement of a half-space under p, weighted by p, divided by the same under Hertz's pressure over R: ∫P²
    /// dξ divided by (3π/5)/R.
    pub fn compliance(&self) -> f64 {
        if let Some(area) = self.area {
            return area.dent_over_hertz();
        }
        let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        let sum: f64 = pairs.map(|(i, j)| self.weights[i] * self.weights[j] * overlap(LOWEST + i, LOWEST + j)).sum();
        sum / (0.6 * PI)
    }

    /// P at x = ξR, for large x.
    fn wave(&self, x: f64) -> f64 {
        // The recurrence J_{k+1} = (2k/x) J_k − J_{k−1} loses at most one digit up to J_5 for x > 3.
        let (mut before, mut bessel) = (libm::j0(x), libm::j1(x));
        let (mut factor, mut sum) = (2.0 / x, 0.0);
        for k in 1..LOWEST + 2 {
            let part = 2.0 * k as f64 / x;
            (before, bessel) = (bessel, part * bessel - before);
            factor *= part + 2.0 / x;
            if let Some(of_weights) = (k + 1).checked_sub(LOWEST) {
                sum += self.weights[of_weights] * factor * bessel;
            }
        }
        sum
    }

    /// Hankel transform Λ_{3/2}(ξ r_p) of Hertz's pressure over r_p, at x = ξR.
    pub fn hertz(&self, x: f64) -> f64 {
        hertz_wave(self.ratio * x)
    }

    /// Hankel transform P at x = ξR.
    pub fn transform(&self, x: f64) -> f64 {
        match self.area {
            Some(_) => self.hertz(x),
            None if x > SERIES => self.wave(x),
            None => self.hertz(x) + self.beyond_hertz(x),
        }
    }

    /// Pairs (m, w_m).
    pub fn parts(&self) -> [(i32, f64); 3] {
        std::array::from_fn(|i| ((LOWEST + i) as i32, self.weights[i]))
    }

    /// P² at x = ξR.
    pub fn square(&self, x: f64) -> f64 {
        self.over_waves(x) + self.hertz(x).powi(2)
    }

    /// P² − Λ_{3/2}² at x = ξR, computed without cancellation.
    pub fn over_waves(&self, x: f64) -> f64 {
        if self.area.is_some() {
            return 0.0;
        }
        let hertz = self.hertz(x);
        if x > SERIES {
            return self.wave(x).powi(2) - hertz * hertz;
        }
        let difference = self.beyond_hertz(x);
        difference * (difference + 2.0 * hertz)
    }

    /// P − Λ_{3/2} at a small x = ξR, computed without cancellation.
    fn beyond_hertz(&self, x: f64) -> f64 {
        let quarter = -0.25 * x * x;
        let mut terms = [1.0; 3];
        let (mut of_hertz, mut difference) = (1.0, 0.0);
        for k in 1..20 {
            let n = f64::from(k);
            for (term, m) in terms.iter_mut().zip(LOWEST..) {
                *term *= quarter / (n * (m as f64 + n));
            }
            of_hertz *= quarter * self.ratio * self.ratio / (n * (1.5 + n));
            if k > 2 {
                difference += terms.iter().zip(self.weights).map(|(term, w)| w * term).sum::<f64>() - of_hertz;
            }
        }
        difference
    }
}

/// Points and weights of a constant density on a side of a square within the lines of a grid, m. The whole side has the weight 1.
fn on_side(centre: f64, half: f64, lines: &[f64]) -> Vec<(f64, f64)> {
    let lines: Vec<f64> = lines.iter().map(|x| (x - centre) / half).collect();
    let ends = pieces(lines.iter().copied().chain([-1.0, 1.0]), &lines, 1.0);
    let rule = gauss_legendre(POINTS_OF_SQUARE);
    let of_piece = |piece: &[f64]| {
        let (middle, reach) = (0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0]));
        rule.iter()
            .map(move |(t, weight)| (centre + half * (middle + reach * t), 0.5 * reach * weight))
            .collect::<Vec<_>>()
    };
    ends.windows(2).flat_map(of_piece).collect()
}

/// ∫ Λ_m Λ_n dx = √π g(m) g(n) g(m + n)/(m + n), g(m) = m!/Γ(m + ½) (Weber and Schafheitlin's integral, DLMF 10.22.57).
fn overlap(m: usize, n: usize) -> f64 {
    let g = |m: usize| (1..=m).fold(1.0 / PI.sqrt(), |g, k| g * k as f64 / (k as f64 - 0.5));
    PI.sqrt() * g(m) * g(n) * g(m + n) / (m + n) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATIOS: [f64; 5] = [1.0, 0.7, 0.5, 0.3, 0.0];

    /// ∫p = 1, ∫p x² = r_p²/5, ∫p x⁴ = 3 r_p⁴/35 and ∫p x²y² = r_p⁴/35, for R = 1.
    #[test]
    fn moments_are_those_of_hertz() {
        for ratio in RATIOS {
            let spread = Spread::new(ratio);
            let mut sums = [0.0; 4];
            for ([x, y], weight) in pressure_rule([0.0; 2], 1.0, [&[-9.0, 0.3, 9.0], &[-9.0, 9.0]]) {
                let weight = weight * spread.over_hertz(x * x + y * y);
                let values = [1.0, x * x, x.powi(4), x * x * y * y];
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
            let square = ratio * ratio;
            let exact = [1.0, square / 5.0, 3.0 / 35.0 * square * square, square * square / 35.0];
            // The rule is accurate to 1e-12; the weights sum to up to 60.
            for (sum, exact) in sums.iter().zip(exact) {
                assert!((sum - exact).abs() < 1e-10, "{ratio}: {sums:?}");
            }
        }
    }

    /// J_m by Bessel's integral, with a rule that is exact to rounding for its periodic integrand.
    fn bessel(m: usize, x: f64) -> f64 {
        let count = 400;
        let angle = |i: usize| PI * (i as f64 + 0.5) / f64::from(count);
        (0..count as usize).map(|i| (m as f64 * angle(i) - x * angle(i).sin()).cos()).sum::<f64>() / f64::from(count)
    }

    fn transform(spread: &Spread, x: f64) -> f64 {
        let one = |(m, weight): (usize, f64)| {
            let factor = (1..=m).map(|k| k as f64 * 2.0 / x).product::<f64>();
            weight * factor * bessel(m, x)
        };
        (LOWEST..).zip(spread.weights).map(one).sum()
    }

    /// The compliance is compared with a numerical integration of P² over ξ.
    #[test]
    fn compliance_is_the_integral_over_waves() {
        for ratio in RATIOS {
            let spread = Spread::new(ratio);
            // The midpoint rule for an even entire function. It is exact up to the transform beyond 2π/step and the
            // part of the integral beyond the end, x⁻⁶.
            let (step, count) = (0.25, 800);
            let integral: f64 = (0..count).map(|i| step * transform(&spread, (i as f64 + 0.5) * step).powi(2)).sum();
            let found = integral / (0.6 * PI);
            assert!((found / spread.compliance() - 1.0).abs() < 1e-6, "{ratio}: {found} {}", spread.compliance());
        }
    }

    /// P² − Λ_{3/2}², by Bessel functions where these have enough digits.
    #[test]
    fn waves_are_those_of_bessel() {
        for ratio in RATIOS {
            let spread = Spread::new(ratio);
            for x in [1.0, 3.0, 8.0, 14.0, 15.5, 40.0] {
                let plain = transform(&spread, x).powi(2) - hertz_wave(ratio * x).powi(2);
                // Rounding of J_m over x^m.
                assert!((spread.over_waves(x) - plain).abs() < 1e-9, "{ratio} {x}: {} {plain}", spread.over_waves(x));
            }
            // For small x it is O(x⁶).
            let [near, far] = [1e-2, 2e-2].map(|x| spread.over_waves(x));
            assert!(ratio == 1.0 || (far / near / 64.0 - 1.0).abs() < 1e-3, "{ratio}: {near} {far}");
        }
    }
}
