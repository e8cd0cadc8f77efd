//! Reduction of the relaxing directions of a body to those with an effect on the impact.
//!
//! D couples all modes, but an impact moves only some of them. With D = B Bᵀ + R, only B Bᵀ is assumed to relax; R
//! keeps the modulus that the modes were computed with. The columns of B come from a Cholesky factorisation of D. Each
//! pivot is the mode with the largest remaining strain energy at the amplitude of its vibration (pivoted Cholesky: N.
//! J. Higham, Accuracy and Stability of Numerical Algorithms, 2002, 10.3). A mode that was a pivot relaxes exactly, and
//! so does its coupling with all other modes, because its row of R is zero. Each term of a Prony series uses as many of
//! the first columns of B as it needs.

use nalgebra::{DMatrix, DVector};

use super::eigen::pivoted_factor;
use crate::material::{Maxwell, Term};

/// Ratio of the square root of the left-out fraction of the strain energy to the accuracy, if all terms relax. This
/// factor is fitted. Compared with runs in which all directions relax, the error was 0.01 to 0.03 times that square root
/// on panes of 0.5 x 0.5 m and 1.0 x 0.8 m hit by 52 kg, and 0.1 to 0.16 times it on a pane of 0.8 x 0.4 m hit by 2 kg.
/// With this factor, the largest of these errors is 0.96 times the accuracy.
const LEFT_OUT: f64 = 6.0;

/// Assumed ratio of the frequency of the fastest vibrations that matter to the rate of the modes. A term that relaxes
/// faster is a dashpot in all of them. An estimate.
const FASTEST_VIBRATION: f64 = 100.0;

/// Returns the amplitudes of vibrations after an impact, from their squared frequencies (1/s²) and modal forces.
/// Vibrations faster than a rate (1/s) have reduced amplitudes.
pub fn amplitudes(squares: &DVector<f64>, force: &DVector<f64>, rate: f64) -> DVector<f64> {
    squares.zip_map(force, |square, force| {
        let square = square.max(f64::MIN_POSITIVE);
        force.abs() / square.sqrt() / (1.0 + square / (rate * rate))
    })
}

/// The matrix B, and the number of its first columns in which each term of a Prony series relaxes.
#[derive(Debug, Clone)]
pub struct Directions {
    /// B; its columns are the directions.
    pub factor: DMatrix<f64>,
    /// Number of columns for each term.
    pub counts: Vec<usize>,
}

/// Returns the fraction of the strain energy that each term of a Prony series may keep as springs, in a run of length
/// `end` (s), for modes that were computed with the modulus at a rate (1/s).
///
/// A term loses G(1 − exp(−T/τ)) in a run of length T. The error of its springs is proportional to this loss and to the
/// square root of their energy. A term that loses less therefore relaxes in fewer directions, or in none. The loss is
/// relative to the largest loss of a term or, if this is smaller, to the modulus of the modes. Terms that relax long before
/// the modes move may be a hundred times as stiff as the others, but contribute hardly anything to this modulus. (With the
/// largest loss alone, a laminate at 41 °C, with terms of 8 to 120 MPa that relax within 2 µs and of 0.4 to 3 MPa that are
/// slower, had an error of 10% of the peak and an estimate of 0.8%, because the slow terms did not relax. On eleven such
/// laminates the error is now at most 0.5%.) At a rate s, terms with τ < 1/(100 s) act as
/// dashpots in all vibrations that matter; for them the modulus of the modes is divided by 100 s τ.
pub fn left_out(chain: &Maxwell, rate: f64, end: f64, accuracy: f64) -> Vec<f64> {
    let lost = |term: &Term| -(-end / term.time).exp_m1() * term.modulus;
    let largest = chain.terms.iter().map(lost).fold(f64::MIN_POSITIVE, f64::max);
    let held = chain.transformed(rate);
    let reference = |term: &Term| largest.min(held / (FASTEST_VIBRATION * rate * term.time).min(1.0));
    chain.terms.iter().map(|term| (LEFT_OUT * accuracy * reference(term) / lost(term)).powi(2)).collect()
}

impl Directions {
    /// Computes the directions for modes of the given amplitudes and fractions of the strain energy that may be left
    /// out. `None` if the modes do not move.
    pub fn new(distortion: &DMatrix<f64>, amplitudes: &DVector<f64>, left_out: &[f64]) -> Option<Self> {
        let weights = amplitudes.map(|amplitude| amplitude * amplitude);
        let all = distortion.diagonal().dot(&weights);
        let mut counts = vec![None; left_out.len()];
        let factor = pivoted_factor(distortion, &weights, |left, found| {
            let energy = left.dot(&weights);
            for (count, _) in counts.iter_mut().zip(left_out).filter(|(_, part)| energy <= **part * all) {
                count.get_or_insert(found);
            }
            counts.iter().all(Option::is_some)
        });
        let counts = counts.into_iter().map(|count| count.unwrap_or(factor.ncols())).collect();
        (all > 0.0).then_some(Self { factor, counts })
    }

    /// Restricts the directions to modes that no column couples with other modes.
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

    /// Without modes that move there are no directions. (A pivot of none does not exist.)
    #[test]
    fn no_modes_have_no_directions() {
        assert!(Directions::new(&DMatrix::zeros(0, 0), &DVector::zeros(0), &[1e-3, 1e-3]).is_none());
    }

    /// A stiff term that relaxes long before the modes move does not change the fractions of the other terms, beyond its part
    /// of the modulus of the modes. If the largest loss is smaller than this modulus, it is the reference.
    #[test]
    fn fast_terms_do_not_hold_slow_ones() {
        let term = |modulus: f64, time: f64| Term { modulus, time };
        let chain = |terms: &[Term]| Maxwell { equilibrium: 3e5, terms: terms.to_vec() };
        let (rate, end, accuracy) = (3e3, 8e-3, 2e-3);
        let slow = [term(1e6, 1e-4), term(4e5, 1e-3)];
        let with_fast = [term(1e8, 1e-10), slow[0], slow[1]];
        let [alone, beside] = [chain(&slow), chain(&with_fast)].map(|chain| left_out(&chain, rate, end, accuracy));
        // G̃ = 0.3 + 0.23 + 0.3 MPa is below the largest loss, 1 MPa, and the fast term adds 1e8 · 3e-7 Pa to it.
        for (alone, beside) in alone.iter().zip(&beside[1..]) {
            assert!((alone / beside - 1.0).abs() < 1e-4, "{alone} {beside}");
            assert!(*alone < 1e-2, "{alone}");
        }
        // For the fast term itself, the largest loss remains the reference.
        assert!((beside[0] / (LEFT_OUT * accuracy).powi(2) - 1.0).abs() < 1e-12, "{}", beside[0]);
        let stiff = Maxwell { equilibrium: 1e7, terms: slow.to_vec() };
        let of_largest = left_out(&stiff, rate, end, accuracy)[0];
        assert!((of_largest / (LEFT_OUT * accuracy).powi(2) - 1.0).abs() < 1e-12, "{of_largest}");
    }

    /// D = B Bᵀ in the rows of the heaviest modes, to rounding. The remainder is positive and as small as requested.
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
            // No column is superfluous.
            assert!(energy(&left(count)) <= part && energy(&left(count - 1)) > part, "{count}");
            assert!(left(count).row(0).amax() < 1e-12, "{count}");
            assert!(left(count).symmetric_eigenvalues().min() > -1e-9 * distortion.amax(), "{count}");
        }
    }
}
