//! Stresses of many steps, computed in single precision from rows for all of them, and in double precision on request.
//!
//! *Bound.* Coordinates w_i are scaled by ρ_i, the largest stress at any point for w_i = 1, and by S = Σ ρ_i |w_i|.
//! Then each stress divided by S is a sum of n products whose absolute values sum to at most 1. In arithmetic of unit
//! roundoff u its error is at most (n + 4) u, including the roundings of the factors (Higham, Accuracy and Stability of
//! Numerical Algorithms, §3.1).

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;

use super::local::parts;

/// Stresses at the sampled points for a unit value of each coordinate.
#[derive(Clone)]
pub struct StressRows {
    /// Number of coordinates.
    pub count: usize,
    /// Stresses a, b and ab, one row for each.
    rows: Vec<f64>,
    /// Scales ρ of the coordinates.
    pub scales: Vec<f64>,
    /// One column for each coordinate, for its value 1/ρ: (a + b)/2 at all sampled points, then (a − b)/2, then ab.
    scaled: DMatrix<f32>,
}

impl StressRows {
    /// Stresses from a row for each component a, b and ab of each point.
    pub fn new(count: usize, rows: Vec<f64>) -> Self {
        let sampled = rows.len() / (3 * count);
        let of_point = |point: usize, coordinate: usize| {
            parts([0, 1, 2].map(|component| rows[(3 * point + component) * count + coordinate]))
        };
        let scale = |coordinate: usize| {
            let largest = (0..sampled).flat_map(|point| of_point(point, coordinate)).map(f64::abs);
            largest.fold(0.0, f64::max)
        };
        let scales: Vec<f64> = (0..count).map(scale).collect();
        let mut scaled = DMatrix::zeros(3 * sampled, count);
        for (coordinate, scale) in scales.iter().enumerate().filter(|(_, scale)| **scale > 0.0) {
            for point in 0..sampled {
                for (part, stress) in of_point(point, coordinate).into_iter().enumerate() {
                    scaled[(part * sampled + point, coordinate)] = (stress / scale) as f32;
                }
            }
        }
        Self { count, rows, scales, scaled }
    }

    /// Number of sampled points.
    pub fn points(&self) -> usize {
        self.scaled.nrows() / 3
    }

    /// Writes the stresses divided by S at some steps, one column after the other, and returns S of each step.
    pub fn of_steps(&self, coordinates: &[f64], columns: &mut Vec<f32>) -> Vec<f64> {
        let (mut sizes, mut scaled) = (Vec::new(), Vec::with_capacity(coordinates.len()));
        for of_step in coordinates.chunks(self.count) {
            let size: f64 = of_step.iter().zip(&self.scales).map(|(w, scale)| (w * scale).abs()).sum();
            let over = if size > 0.0 { size } else { 1.0 };
            scaled.extend(of_step.iter().zip(&self.scales).map(|(w, scale)| (w * scale / over) as f32));
            sizes.push(size);
        }
        let (rows, steps) = (self.scaled.nrows(), sizes.len());
        columns.resize(rows * steps, 0.0);
        matmul(
            MatMut::from_column_major_slice_mut(columns, rows, steps),
            Accum::Replace,
            MatRef::from_column_major_slice(self.scaled.as_slice(), rows, self.count),
            MatRef::from_column_major_slice(&scaled, self.count, steps),
            1.0,
            Par::Seq,
        );
        sizes
    }

    /// Stresses at a sampled point in double precision.
    pub fn at(&self, number: usize, coordinates: &[f64]) -> [f64; 3] {
        let rows = &self.rows[3 * number * self.count..3 * (number + 1) * self.count];
        let [a, rest] = [&rows[..self.count], &rows[self.count..]];
        products([a, &rest[..self.count], &rest[self.count..]], coordinates)
    }
}

/// Scalar products Σ a_i b_i of three rows with the same factors.
fn products([a, b, c]: [&[f64]; 3], factors: &[f64]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (((a, b), c), factor) in a.iter().zip(b).zip(c).zip(factors) {
        sums[0] += a * factor;
        sums[1] += b * factor;
        sums[2] += c * factor;
    }
    sums
}
