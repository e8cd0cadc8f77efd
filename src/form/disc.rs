//! Quadrature of Hertz's pressure over a disc, for functions that are smooth between the lines of a grid.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::element::gauss_legendre;

/// Number of Gauss points along one piece. The error is 1e-10 of the integral if the rim is near a crossing of grid
/// lines, 1e-13 otherwise.
const POINTS: usize = 20;

/// Hankel transform of Hertz's pressure at x = ξR: 3 (sin x − x cos x)/x³.
pub fn hertz_wave(x: f64) -> f64 {
    if x < 1.0 { 1.0 + hertz_terms(x, 1) } else { 3.0 * (x.sin() - x * x.cos()) / x.powi(3) }
}

/// Sum of the terms x^{2k} of [`hertz_wave`] from k = `from` on, for x < 1: 6 (k+1) (−x²)^k/(2k+3)!.
pub fn hertz_terms(x: f64, from: i32) -> f64 {
    let (mut term, mut sum) = (1.0, 0.0);
    for k in 1..10 {
        let n = f64::from(k);
        // Ratio of a term to the previous one.
        term *= -x * x * (n + 1.0) / (n * (2.0 * n + 2.0) * (2.0 * n + 3.0));
        if k >= from {
            sum += term;
        }
    }
    sum
}

/// Points and weights for p(r) = 3/(2π R²) √(1 − r²/R²), r < R, within a grid. The total weight is 1 if the grid
/// contains the whole disc.
///
/// The disc is divided into strips across the first axis. Strips end at grid lines and where grid lines of the second
/// axis meet the rim. A substitution removes the square-root singularities at their ends. Along a strip, the pieces run
/// from grid line to grid line; with y = Y sin φ, p dy = cos²φ dφ has no root.
pub fn pressure_rule(centre: [f64; 2], radius: f64, lines: [&[f64]; 2]) -> Vec<([f64; 2], f64)> {
    let rule = gauss_legendre(POINTS);
    let relative = |axis: usize| -> Vec<f64> { lines[axis].iter().map(|x| (x - centre[axis]) / radius).collect() };
    let [of_x, of_y] = [relative(0), relative(1)];
    let rim = of_y.iter().filter(|y| y.abs() < 1.0).flat_map(|y| {
        let half = (1.0 - y * y).sqrt();
        [-half, half]
    });
    let mut points = Vec::new();
    for strip in pieces(of_x.iter().copied().chain(rim).chain([-1.0, 1.0]), &of_x, 1.0).windows(2) {
        let (middle, half) = (0.5 * (strip[0] + strip[1]), 0.5 * (strip[1] - strip[0]));
        for (tau, weight) in &rule {
            let (sin, cos) = (FRAC_PI_2 * tau).sin_cos();
            let x = middle + half * sin;
            let of_strip = 1.5 / PI * weight * half * FRAC_PI_2 * cos * (1.0 - x * x);
            let length = (1.0 - x * x).sqrt();
            let ends = of_y.iter().copied().chain([-length, length]);
            for piece in pieces(ends, &of_y, length).windows(2) {
                let [from, to] = [piece[0], piece[1]].map(|y| (y / length).clamp(-1.0, 1.0).asin());
                for (t, weight) in &rule {
                    let phi = 0.5 * (from + to) + 0.5 * (to - from) * t;
                    let point = [centre[0] + radius * x, centre[1] + radius * length * phi.sin()];
                    points.push((point, of_strip * weight * 0.5 * (to - from) * phi.cos().powi(2)));
                }
            }
        }
    }
    points
}

/// Returns the places within ±`most` and within the grid, ascending, without duplicates up to rounding.
pub(super) fn pieces(places: impl Iterator<Item = f64>, lines: &[f64], most: f64) -> Vec<f64> {
    let (least, most) = (lines[0].max(-most), lines[lines.len() - 1].min(most));
    let mut places: Vec<f64> = places.filter(|x| (least..=most).contains(x)).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| (*a - *b).abs() < 1e-14);
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over the whole disc: ∫ p = 1, ∫ p x² = R²/5, ∫ p x⁴ = 3R⁴/35, ∫ p x²y² = R⁴/35, for any position of the lines.
    #[test]
    fn moments_whatever_the_lines() {
        let lines: [[&[f64]; 2]; 3] = [
            [&[-9.0, 9.0], &[-9.0, 9.0]],
            [&[-9.0, 0.9, 1.3, 1.31, 1.5, 9.0], &[-9.0, -0.4, 0.0, 0.01, 9.0]],
            [&[1.0 - 0.5, 1.0, 1.0 + 0.5], &[0.2 - 0.5, 0.2, 0.2 + 0.5]],
        ];
        for lines in lines {
            let (centre, radius) = ([1.0, 0.2], 0.5);
            let mut sums = [0.0; 6];
            for (point, weight) in pressure_rule(centre, radius, lines) {
                let [x, y] = [0, 1].map(|i| (point[i] - centre[i]) / radius);
                let values = [1.0, x, y, x * x, x.powi(4), x * x * y * y];
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
            for (sum, exact) in sums.iter().zip([1.0, 0.0, 0.0, 0.2, 3.0 / 35.0, 1.0 / 35.0]) {
                assert!((sum - exact).abs() < 1e-12, "{lines:?}: {sums:?}");
            }
        }
    }

    /// The load beyond a line at the distance e from the centre is 1/2 − 3/4 (e − e³/3). The kink of |x − e| lies on
    /// the line.
    #[test]
    fn parts_and_kinks() {
        for e in [0.0, 1e-9, 0.3, 0.999, -0.5] {
            let part: f64 = pressure_rule([0.0; 2], 1.0, [&[-2.0, 2.0], &[e, 2.0]]).iter().map(|(_, w)| w).sum();
            assert!((part - (0.5 - 0.75 * (e - e.powi(3) / 3.0))).abs() < 1e-10, "{e}: {part}");
            let kink = |axis: usize, lines: [&[f64]; 2]| -> f64 {
                pressure_rule([0.0; 2], 1.0, lines).iter().map(|(x, w)| w * (x[axis] - e).abs()).sum()
            };
            let [one, other] = [kink(0, [&[-2.0, e, 2.0], &[-2.0, 2.0]]), kink(1, [&[-2.0, 2.0], &[-2.0, e, 2.0]])];
            // ∫ |x − e| 3/4 (1 − x²) dx = 3/8 + 3/4 e² − e⁴/8.
            let exact = 0.375 + 0.75 * e * e - 0.125 * e.powi(4);
            assert!((one - exact).abs() < 1e-10 && (other - exact).abs() < 1e-10, "{e}: {one} {other} {exact}");
        }
    }
}
