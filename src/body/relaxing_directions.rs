//! The directions in which a body relaxes as far as its impact can tell.
//!
//! D couples all modes, of which an impact moves some. With D = B Bᵀ + R, what is taken to relax is B Bᵀ alone; R keeps the modulus that
//! the modes are made with. Columns of B are those of Cholesky's factor of D, each for the mode that has the most of the strain energy that
//! is left, at the amplitude of its vibration (pivoted Cholesky: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, 10.3).
//! A mode that was a pivot relaxes as it does with D, and so do all modes with it: R has no row of it. Each term of a chain has the first columns of B, as
//! many as it needs.

use nalgebra::{DMatrix, DVector};

use super::eigen::symmetric_eigen;
use crate::material::{Maxwell, Term};

/// The root of the part of the strain energy that is left out where all terms relax, over the accuracy. With a hundredth of the energy left out, panes of
/// 0.5 x 0.5 m and of 1.0 x 0.8 m were off by 2.3e-3 and 1.1e-3 of the peak in the first contact, with a thousandth by 6.4e-4 and 3.6e-4, against steps of
/// all directions: a tenth to a quarter of the accuracy. A fit.
const LEFT_OUT: f64 = 10.0;

/// Eigenvalues of D below this part of the largest are rounding.
const ROUNDING: f64 = 1e-14;

/// B of all directions, the principal ones of D.
pub fn all_directions(distortion: &DMatrix<f64>) -> DMatrix<f64> {
    let (values, directions) = symmetric_eigen(distortion.clone());
    let largest = values.amax();
    let kept: Vec<usize> = (0..values.len()).filter(|&i| values[i] > ROUNDING * largest).collect();
    DMatrix::from_fn(values.len(), kept.len(), |i, j| values[kept[j]].sqrt() * directions[(i, kept[j])])
}

/// Amplitudes of vibrations after an impact, of squares of frequencies (1/s²) and parts of its force: less where they are faster than a rate, 1/s.
pub fn amplitudes(squares: &DVector<f64>, force: &DVector<f64>, rate: f64) -> DVector<f64> {
    squares.zip_map(force, |square, force| {
        let square = square.max(f64::MIN_POSITIVE);
        force.abs() / square.sqrt() / (1.0 + square / (rate * rate))
    })
}

/// B, and how many of its columns, the first ones, each term of a chain relaxes in.
#[derive(Debug, Clone)]
pub struct Directions {
    /// B, by columns.
    pub factor: DMatrix<f64>,
    /// One number for each term.
    pub counts: Vec<usize>,
}

/// The parts of the strain energy in which the terms of a chain may be springs over a run of a length (s).
///
/// A term loses G(1 − exp(−T/τ)) in it: what its springs leave out goes with that times the root of their energy. So one that loses less relaxes in fewer
/// directions, or in none.
pub fn left_out(chain: &Maxwell, end: f64, accuracy: f64) -> Vec<f64> {
    let lost = |term: &Term| -(-end / term.time).exp_m1() * term.modulus;
    let largest = chain.terms.iter().map(lost).fold(f64::MIN_POSITIVE, f64::max);
    chain.terms.iter().map(|term| (LEFT_OUT * accuracy * largest / lost(term)).powi(2)).collect()
}

impl Directions {
    /// For modes of the given amplitudes, and parts of the strain energy that may be left out; `None` where the modes do not move.
    pub fn new(distortion: &DMatrix<f64>, amplitudes: &DVector<f64>, left_out: &[f64]) -> Option<Self> {
        let weights = amplitudes.map(|amplitude| amplitude * amplitude);
        let mut left = distortion.diagonal();
        let all = left.dot(&weights);
        let mut found: Vec<DVector<f64>> = Vec::new();
        let mut counts = vec![None; left_out.len()];
        loop {
            let energy = left.dot(&weights);
            for (count, _) in counts.iter_mut().zip(left_out).filter(|(_, part)| energy <= **part * all) {
                count.get_or_insert(found.len());
            }
            let pivot = left.component_mul(&weights).imax();
            if counts.iter().all(Option::is_some) || left[pivot] <= 0.0 {
                break;
            }
            let mut next = distortion.column(pivot).into_owned();
            for known in &found {
                next.axpy(-known[pivot], known, 1.0);
            }
            next /= left[pivot].sqrt();
            left.zip_apply(&next, |left, entry| *left = (*left - entry * entry).max(0.0));
            // What has been taken is nothing any more.
            left[pivot] = 0.0;
            found.push(next);
        }
        let counts = counts.into_iter().map(|count| count.unwrap_or(found.len())).collect();
        let columns = |found: &[DVector<f64>]| match found {
            [] => DMatrix::zeros(distortion.nrows(), 0),
            found => DMatrix::from_columns(found),
        };
        (all > 0.0).then(|| Self { factor: columns(&found), counts })
    }

    /// Those of some modes, which no column couples with others.
    pub fn of_class(&self, modes: &[usize]) -> Self {
        let rows = self.factor.select_rows(modes);
        let own: Vec<usize> = (0..rows.ncols()).filter(|&column| rows.column(column).amax() > 0.0).collect();
        let counts = self.counts.iter().map(|&count| own.partition_point(|&column| column < count)).collect();
        Self { factor: rows.select_columns(&own), counts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// D = B Bᵀ in the rows of the heaviest modes, to rounding; what is left is positive, and as little as was asked for.
    #[test]
    fn heavy_modes_relax_as_they_do() {
        let count = 40;
        let distortion = DMatrix::from_fn(count, count, |i, j| {
            let apart = i as f64 - j as f64;
            (1.0 + i as f64) * (1.0 + j as f64) * (-0.2 * apart.abs()).exp()
        });
        let amplitudes = DVector::from_fn(count, |i, _| 0.5_f64.powi(i as i32));
        let all = amplitudes.dot(&distortion.diagonal().component_mul(&amplitudes));
        let left_out = [1e-2, 1e-3, 5e-5, 2.0];
        let Directions { factor, counts } = Directions::new(&distortion, &amplitudes, &left_out).expect("directions");
        assert!(factor.ncols() < 20 && factor.ncols() == counts[2] && counts[3] == 0, "{counts:?}");
        let energy = |matrix: &DMatrix<f64>| amplitudes.dot(&matrix.diagonal().component_mul(&amplitudes)) / all;
        for (count, part) in counts.into_iter().zip(left_out).take(3) {
            let left = |count: usize| {
                let columns = factor.columns(0, count);
                &distortion - columns * columns.transpose()
            };
            // No column too many.
            assert!(energy(&left(count)) <= part && energy(&left(count - 1)) > part, "{count}");
            assert!(left(count).row(0).amax() < 1e-12, "{count}");
            assert!(left(count).symmetric_eigenvalues().min() > -1e-9 * distortion.amax(), "{count}");
        }
    }
}
