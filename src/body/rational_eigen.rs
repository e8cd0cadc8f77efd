//! Eigenpairs of (λ² + K + g(λ) D) φ = 0, g = Σ G_i λτ_i/(1 + λτ_i): the free motions of a body with one generalised
//! Maxwell chain (Prony series).
//!
//! Each pair is computed separately by inverse iteration with the Rayleigh functional (Ruhe, SIAM J. Numer. Anal. 10,
//! 1973, for T(λ) = Tᵀ). Each vibration starts from a mode with a given modulus. In each interval between two poles
//! −1/τ_i, where g takes all values from −∞ to ∞, there is one real pair for each direction of D. It starts from the
//! solution for a fixed λ², which is close because λ² has little effect.
//!
//! If a pair is found twice, another pair is missing. Two sums show whether all pairs are present: Σ λ φφᵀ/(φᵀT′φ) = 1
//! and −Σ λ⁻¹ φφᵀ/(φᵀT′φ) = K⁻¹. The defect of the first sum belongs to the missing pair, whose search starts from
//! there.
//!
//! The cost of a pair is the cube of the number of modes. The cost of the first-order system is the cube of the product
//! of the numbers of modes and terms.

use nalgebra::{Cholesky, Complex, ComplexField, DMatrix, DVector, Dyn};

use super::axpy::Entry;
use super::dense_solve::solved;
use super::eigen::symmetric_eigen;
use super::secular_eigen::Secular;
use crate::material::Maxwell;

/// Largest number of iterations for one pair. Convergence is cubic.
pub(super) const MAX_ITERATIONS: usize = 12;

/// Relative change of λ after which one more iteration is accurate to rounding.
const CLOSE: f64 = 1e-6;

/// Relative change of λ below which the iterations end. Pairs that lie close together need more iterations.
const CONVERGED: f64 = 1e-10;

/// Convergence state of the iterations for one pair.
#[derive(Debug)]
pub(super) struct Convergence {
    /// Whether λ is accurate enough for a last iteration, which makes φ as accurate as λ.
    pub is_found: bool,
    /// Last relative change of λ.
    last: f64,
}

impl Convergence {
    pub fn new() -> Self {
        Self { is_found: false, last: f64::INFINITY }
    }

    /// Records the next relative change of λ. Returns whether it is the last one: it is small, or rounding prevents a
    /// further decrease.
    pub fn ends(&mut self, part: f64) -> bool {
        let ends = part.is_nan() || self.is_found && (part <= CONVERGED || part >= self.last);
        self.is_found |= part <= CLOSE;
        self.last = part;
        ends
    }
}

/// Ratio of the chain's stiffness to the other stiffness in a direction below which no creep is computed.
pub(super) const IDLE: f64 = 1e-10;

/// Largest relative error of the sums over all pairs.
const LARGEST_SUM_ERROR: f64 = 1e-8;

/// Numbers that define the test vectors for the sums: fractional parts of multiples of their square roots.
const PROBES: [f64; 4] = [2.0, 3.0, 5.0, 7.0];

/// Relative difference of rates and shapes below which two results are the same pair.
const SAME_PAIR: f64 = 1e-6;

/// Largest number of repeated pairs that are replaced by missing ones. Each replacement takes sums over all pairs.
const MAX_REPLACED_PAIRS: usize = 12;

/// An eigenpair. For a conjugate pair, the one with Im λ > 0.
pub struct Pair {
    /// Eigenvalue λ, 1/s.
    pub rate: Complex<f64>,
    /// Eigenvector φ.
    pub shape: DVector<Complex<f64>>,
    /// Slope φᵀT′(λ)φ.
    pub slope: Complex<f64>,
}

/// Region in which a pair was searched.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Vibration,
    /// Between these rates, 1/s, the first of them a pole.
    Between(f64, f64),
}

/// The eigenproblem T(λ) φ = 0.
pub struct Rational<'a> {
    /// Stiffness K after all relaxation.
    pub stiffness: &'a DMatrix<f64>,
    /// Distortion stiffness D.
    pub distortion: &'a DMatrix<f64>,
    /// B with D = B Bᵀ, if it has few columns, and the modulus ḡ: the unit vectors are modes of K + ḡ D.
    pub factor: Option<(&'a DMatrix<f64>, f64)>,
    /// Terms of the Prony series.
    pub chain: &'a Maxwell,
}

impl Pair {
    /// Number of eigenvalues that the pair represents.
    pub fn count(&self) -> f64 {
        if self.rate.im == 0.0 { 1.0 } else { 2.0 }
    }

    /// Whether both are the same pair.
    fn is(&self, other: &Self) -> bool {
        let close = (self.rate - other.rate).norm() <= SAME_PAIR * self.rate.norm();
        // Shapes have unit length, and are equal up to a factor of modulus 1.
        close && self.shape.dotc(&other.shape).norm() >= 1.0 - SAME_PAIR
    }
}

impl Rational<'_> {
    /// Returns all pairs. `squares` are ω² of the unit vectors as modes with a mean modulus. `None` if some pairs are
    /// not found.
    pub fn pairs(&self, squares: &DVector<f64>) -> Option<Vec<Pair>> {
        let count = squares.len();
        let factor = self.stiffness.clone().cholesky()?;
        let secular = self.factor.map(|(factor, modulus)| Secular::new(squares, factor, modulus));
        let mut found = Vec::new();
        for (j, square) in squares.iter().enumerate() {
            if let Some(pair) = secular.as_ref().and_then(|secular| secular.vibration(j, self)) {
                found.push((pair, Place::Vibration));
                continue;
            }
            let shape = DVector::from_fn(count, |i, _| Complex::new(f64::from(u8::from(i == j)), 0.0));
            found.push((self.vibration(square.sqrt(), shape)?, Place::Vibration));
        }
        let mut times: Vec<f64> = self.chain.terms.iter().map(|term| term.time).collect();
        times.sort_by(|a, b| b.total_cmp(a));
        let mut slower = 0.0;
        for pole in times.into_iter().map(|time| -1.0 / time) {
            let place = Place::Between(pole, slower);
            if let Some(pairs) = secular.as_ref().and_then(|secular| secular.creeping((pole, slower), self)) {
                found.extend(pairs.into_iter().map(|pair| (pair, place)));
            } else {
                for (rate, shape) in self.creeping(pole, slower)? {
                    found.push((self.creep(rate, shape, (pole, slower))?, place));
                }
            }
            slower = pole;
        }
        let pairs = self.without_repetition(found, squares)?;
        self.are_complete(&pairs, &factor).then_some(pairs)
    }

    /// Returns the vibration near a frequency, rad/s; `None` if the iterations do not lead to a vibration.
    fn vibration(&self, frequency: f64, shape: DVector<Complex<f64>>) -> Option<Pair> {
        self.refined(Complex::new(0.0, frequency), shape).filter(|pair| pair.rate.im > 0.0)
    }

    /// Returns the real pair near a rate; `None` if it does not lie between the two given rates.
    fn creep(&self, rate: f64, shape: DVector<f64>, (pole, slower): (f64, f64)) -> Option<Pair> {
        self.refined(rate, shape).filter(|pair| pair.rate.re > pole && pair.rate.re < slower)
    }

    /// Returns each pair once, with missing pairs in the place of repeated ones; `None` if these are not found.
    fn without_repetition(&self, found: Vec<(Pair, Place)>, squares: &DVector<f64>) -> Option<Vec<Pair>> {
        let mut pairs: Vec<Pair> = Vec::with_capacity(found.len());
        let mut begin = 0;
        let (mut last, mut missing) = (Place::Vibration, Vec::new());
        for (pair, place) in found {
            if place != last {
                (last, begin) = (place, pairs.len());
            }
            if pairs[begin..].iter().any(|other| pair.is(other)) { missing.push(place) } else { pairs.push(pair) }
        }
        if missing.len() > MAX_REPLACED_PAIRS {
            return None;
        }
        // Vibrations have the largest weight and are therefore searched first.
        for place in missing {
            let (weights, shapes) =
                symmetric_eigen(sum(&pairs, |pair| pair.rate) - DMatrix::identity(squares.len(), squares.len()));
            let heaviest = weights.iamax();
            let shape = shapes.column(heaviest).into_owned();
            let pair = match place {
                Place::Vibration => {
                    let square = shape.component_mul(&shape).dot(squares);
                    self.vibration(square.sqrt(), shape.map(|entry| Complex::new(entry, 0.0)))?
                }
                Place::Between(pole, slower) => {
                    let [stiff, stretched] =
                        [self.stiffness, self.distortion].map(|matrix| shape.dot(&(matrix * &shape)));
                    let rate = self.balanced((pole, slower), |rate, g| rate * rate + stiff + g * stretched);
                    self.creep(rate, shape, (pole, slower))?
                }
            };
            if pairs.iter().any(|other| pair.is(other)) {
                return None;
            }
            pairs.push(pair);
        }
        Some(pairs)
    }

    /// Returns the rate between a pole and a slower rate at which a function of the rate and g is zero. The function
    /// increases from −∞ at the pole.
    pub(super) fn balanced(&self, (pole, slower): (f64, f64), value: impl Fn(f64, f64) -> f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let rate = pole + middle * (slower - pole);
            let [g, _] = self.modulus(rate);
            if value(rate, g) < 0.0 { low = middle } else { high = middle }
        }
        pole + 0.5 * (low + high) * (slower - pole)
    }

    /// Returns approximate real pairs between two poles, with λ² fixed at its value at the faster pole.
    fn creeping(&self, pole: f64, slower: f64) -> Option<Vec<(f64, DVector<f64>)>> {
        let count = self.stiffness.nrows();
        let held = self.stiffness + DMatrix::identity(count, count) * (pole * pole);
        let lower = held.cholesky()?.unpack();
        let half = lower.solve_lower_triangular(self.distortion)?;
        let both = lower.solve_lower_triangular(&half.transpose())?;
        let (values, directions) = symmetric_eigen((&both + both.transpose()) * 0.5);
        let all: f64 = self.chain.terms.iter().map(|term| term.modulus).sum();
        let mut found = Vec::new();
        for (value, direction) in values.iter().zip(directions.column_iter()).filter(|(value, _)| **value * all > IDLE)
        {
            let rate = self.balanced((pole, slower), |_, g| 1.0 + g * value);
            let shape = lower.tr_solve_lower_triangular(&direction.into_owned())?;
            found.push((rate, shape.normalize()));
        }
        Some(found)
    }

    /// Returns g and g′.
    pub(super) fn modulus<T: ComplexField<RealField = f64> + Copy>(&self, rate: T) -> [T; 2] {
        let one = T::one();
        self.chain.terms.iter().fold([T::zero(); 2], |[value, slope], term| {
            let [modulus, time] = [term.modulus, term.time].map(T::from_real);
            let (x, inverse) = (rate * time, one / (one + rate * time));
            [value + modulus * x * inverse, slope + modulus * time * inverse * inverse]
        })
    }

    /// Refines an approximate pair by inverse iteration; `None` if it does not converge.
    fn refined<T>(&self, mut rate: T, mut shape: DVector<T>) -> Option<Pair>
    where
        T: Entry + Into<Complex<f64>>,
    {
        let [stiffness, distortion] = [self.stiffness, self.distortion].map(|matrix| matrix.map(T::from_real));
        let slope = |rate: T, shape: &DVector<T>, stretched: &DVector<T>| {
            let [_, slope] = self.modulus(rate);
            (rate + rate) * shape.dot(shape) + slope * shape.dot(stretched)
        };
        let mut convergence = Convergence::new();
        for _ in 0..MAX_ITERATIONS {
            let [g, of_g] = self.modulus(rate);
            let stretched = &distortion * &shape;
            let mut matrix = &stiffness + &distortion * g;
            (0..shape.len()).for_each(|i| matrix[(i, i)] += rate * rate);
            let turned = &shape * (rate + rate) + &stretched * of_g;
            let mut next = solved(matrix.clone(), turned);
            let length = next.norm();
            if !length.is_finite() {
                // The matrix is singular: λ is exact.
                break;
            }
            next /= T::from_real(length);
            let stretched = &distortion * &next;
            let change = next.dot(&(&matrix * &next)) / slope(rate, &next, &stretched);
            shape = next;
            rate -= change;
            if convergence.ends(change.modulus() / rate.modulus()) {
                break;
            }
        }
        let stretched = &distortion * &shape;
        let slope = slope(rate, &shape, &stretched);
        convergence.is_found.then(|| Pair { rate: rate.into(), shape: shape.map(Into::into), slope: slope.into() })
    }

    /// Whether no pair is missing or inaccurate: the sums over all pairs, multiplied by test vectors, must have their
    /// known values. The contribution of a missing pair is practically never orthogonal to all test vectors.
    fn are_complete(&self, pairs: &[Pair], factor: &Cholesky<f64, Dyn>) -> bool {
        let count = self.stiffness.nrows();
        // No two entries are equal, not even up to the sign, so that a mode found twice in the place of another one is
        // detected too.
        let probes = DMatrix::from_fn(count, PROBES.len(), |i, j| ((i + 1) as f64 * PROBES[j].sqrt()).fract() - 0.5);
        let of_rates = sum_times(pairs, |pair| pair.rate, &probes) - &probes;
        let at_rest = factor.solve(&probes);
        let off = &at_rest + sum_times(pairs, |pair| pair.rate.inv(), &probes);
        of_rates.amax() <= LARGEST_SUM_ERROR && off.amax() <= LARGEST_SUM_ERROR * at_rest.amax()
    }
}

/// Returns Re Σ f φφᵀ/(φᵀT′φ) over all pairs. Conjugate pairs count twice.
fn sum(pairs: &[Pair], factor: impl Fn(&Pair) -> Complex<f64>) -> DMatrix<f64> {
    let count = pairs.first().map_or(0, |pair| pair.shape.len());
    sum_times(pairs, factor, &DMatrix::identity(count, count))
}

/// Returns the same sum multiplied by vectors, the columns of `vectors`.
fn sum_times(pairs: &[Pair], factor: impl Fn(&Pair) -> Complex<f64>, vectors: &DMatrix<f64>) -> DMatrix<f64> {
    let count = vectors.nrows();
    // Re f φφᵀ = Re(f φ) Re φᵀ − Im(f φ) Im φᵀ, as products of matrices.
    let scaled: Vec<_> = pairs.iter().map(|pair| &pair.shape * (factor(pair) * pair.count() / pair.slope)).collect();
    let part = |of: &dyn Fn(usize, usize) -> f64| DMatrix::from_fn(count, pairs.len(), |i, k| of(k, i));
    part(&|k, i| scaled[k][i].re) * part(&|k, i| pairs[k].shape[i].re).tr_mul(vectors)
        - part(&|k, i| scaled[k][i].im) * part(&|k, i| pairs[k].shape[i].im).tr_mul(vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Term;

    /// A vibration and a creep pair that were found twice are replaced by the missing pairs.
    #[test]
    fn missing_pairs_are_found() {
        let count = 6;
        let squares = DVector::from_fn(count, |i, _| [1.0, 2.0, 2.2, 5.0, 9.0, 9.5][i]);
        // Full rank, and a large part of the stiffness.
        let distortion = DMatrix::from_fn(count, count, |i, j| {
            let together = 0.1 / (1.0 + (i as f64 - j as f64).powi(2));
            together * (squares[i] * squares[j]).sqrt()
        });
        let terms = [(0.8, 0.3), (0.5, 20.0)].map(|(modulus, time)| Term { modulus, time });
        let chain = Maxwell { equilibrium: 0.0, terms: terms.to_vec() };
        let stiffness = DMatrix::from_diagonal(&squares) - &distortion * chain.transformed_terms(3.0);
        let rational = Rational { stiffness: &stiffness, distortion: &distortion, factor: None, chain: &chain };
        let all = rational.pairs(&squares).expect("all pairs");
        assert_eq!(all.len(), count + 2 * count);
        let place = |number: usize| match number / count {
            0 => Place::Vibration,
            1 => Place::Between(-1.0 / 20.0, 0.0),
            _ => Place::Between(-1.0 / 0.3, -1.0 / 20.0),
        };
        let again = |number: usize| {
            let Pair { rate, shape, slope } = &all[number];
            Pair { rate: *rate, shape: shape.clone(), slope: *slope }
        };
        let place_of_creep = 2 * count;
        for lost in [vec![1], vec![place_of_creep + 3], vec![4, place_of_creep]] {
            // Each lost pair is replaced by a copy of the next one.
            let found = (0..all.len()).map(|k| (again(if lost.contains(&k) { k + 1 } else { k }), place(k)));
            let pairs = rational.without_repetition(found.collect(), &squares).expect("the missing pairs");
            assert_eq!(pairs.len(), all.len());
            for number in lost {
                assert!(pairs.iter().any(|pair| pair.is(&all[number])), "{number}");
            }
        }
    }

    /// Pairs of modes that lie close together and relax in few directions satisfy the equation with the full matrices.
    #[test]
    fn close_pairs_settle() {
        let count = 24;
        let squares = DVector::from_fn(count, |i, _| (1.0 + (i / 2) as f64).powi(2) * (1.0 + 0.01 * (i % 2) as f64));
        let factor = DMatrix::from_fn(count, 4, |i, j| 0.05 * squares[i].sqrt() * ((3 * i * (j + 1) + j) as f64).sin());
        let terms = [(0.8, 0.03), (0.6, 0.4), (0.5, 20.0)].map(|(modulus, time)| Term { modulus, time });
        let chain = Maxwell { equilibrium: 0.0, terms: terms.to_vec() };
        let (distortion, modulus) = (&factor * factor.transpose(), chain.transformed_terms(3.0));
        let stiffness = DMatrix::from_diagonal(&squares) - &distortion * modulus;
        let factor = Some((&factor, modulus));
        let rational = Rational { stiffness: &stiffness, distortion: &distortion, factor, chain: &chain };
        let pairs = rational.pairs(&squares).expect("all pairs");
        assert_eq!(pairs.len(), count + 3 * 4);
        for Pair { rate, shape, .. } in &pairs {
            let [g, _] = rational.modulus(*rate);
            let real = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0)) * shape;
            let (held, stretched) = (real(&stiffness), real(&distortion) * g);
            let off = &held + &stretched + shape * (rate * rate);
            // Rounding of sums whose largest terms cancel. Measured: 1e-13.
            let size = held.norm() + stretched.norm() + rate.norm_sqr();
            assert!(off.norm() < 1e-11 * size, "{rate}: {:e}", off.norm() / size);
        }
    }
}
