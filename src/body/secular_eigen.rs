//! Eigenpairs of (λ² + Ω + γ(λ) B Bᵀ) φ = 0, Ω diagonal, γ = g − ḡ, g = Σ G_i λτ_i/(1 + λτ_i): the free motions of a
//! body with one generalised Maxwell chain (Prony series), whose modes, with the modulus ḡ, relax in the directions B.
//!
//! The vibration that begins as mode k has φ_k = 1. The amplitudes of the other modes follow from systems with as many
//! unknowns as B has columns:
//!
//! ω_k² + λ² + γ b_kᵀ y = 0,  (1 + γ Σ_{j≠k} b_j b_jᵀ/(ω_j² + λ²)) y = b_k,  φ_j = −γ b_jᵀy/(ω_j² + λ²),
//!
//! with the rows b_k of B (the secular equation of G. H. Golub, SIAM Rev. 15, 1973, for several columns). Newton's
//! method solves it for λ. In each interval between two poles −1/τ_i, where g takes all values from −∞ to ∞, there is
//! one real pair for each direction. Real pairs satisfy (1 + γ Σ b_j b_jᵀ/(ω_j² + λ²)) y = 0 with φ_j ∝
//! b_jᵀy/(ω_j² + λ²). They are found by inverse iteration with the Rayleigh functional (Ruhe, SIAM J. Numer. Anal. 10,
//! 1973, for T(λ) = Tᵀ), from the solution for a fixed λ², which is close because λ² has little effect.
//!
//! If a pair is found twice, another pair is missing. It is searched again with the known pairs deflated. Two sums show
//! whether all pairs are present: Σ λ φφᵀ/(φᵀT′φ) = 1 and −Σ λ⁻¹ φφᵀ/(φᵀT′φ) = K⁻¹.
//!
//! The cost of a pair is the number of modes times the square of the number of directions. The cost of the first-order
//! system is the cube of its size.

use faer::MatRef;
use faer::linalg::solvers::Solve as _;
use nalgebra::{Cholesky, Complex, ComplexField, DMatrix, DVector, Dyn};

use super::block_matrix::real_times_complex;
use super::eigen::symmetric_eigen;
use crate::material::Maxwell;

/// Largest number of iterations for one pair.
const MAX_ITERATIONS: usize = 12;

/// Relative change of λ after which one more iteration is accurate to rounding.
const CLOSE: f64 = 1e-6;

/// Relative change of λ below which the iterations end. Pairs that lie close together need more iterations.
const CONVERGED: f64 = 1e-10;

/// Ratio of the chain's stiffness to the other stiffness in a direction below which no creep is computed.
const IDLE: f64 = 1e-10;

/// Largest relative error of the sums over all pairs.
const LARGEST_SUM_ERROR: f64 = 1e-8;

/// Numbers that define the test vectors for the sums: fractional parts of multiples of their square roots.
const PROBES: [f64; 4] = [2.0, 3.0, 5.0, 7.0];

/// Relative difference of rates and shapes below which two results are the same pair.
const SAME_PAIR: f64 = 1e-6;

/// Convergence state of the iterations for one pair.
#[derive(Debug)]
struct Convergence {
    /// Whether λ is accurate enough for a last iteration, which makes φ as accurate as λ.
    is_found: bool,
    /// Last relative change of λ.
    last: f64,
}

impl Convergence {
    fn new() -> Self {
        Self { is_found: false, last: f64::INFINITY }
    }

    /// Records the next relative change of λ. Returns whether it is the last one: it is small, or rounding prevents a
    /// further decrease.
    fn ends(&mut self, part: f64) -> bool {
        let ends = part.is_nan() || self.is_found && (part <= CONVERGED || part >= self.last);
        self.is_found |= part <= CLOSE;
        self.last = part;
        ends
    }
}

/// An eigenpair. For a conjugate pair, the one with Im λ > 0.
#[derive(Clone)]
pub struct Pair {
    /// Eigenvalue λ, 1/s.
    pub rate: Complex<f64>,
    /// Eigenvector φ.
    pub shape: DVector<Complex<f64>>,
    /// Slope φᵀT′(λ)φ.
    pub slope: Complex<f64>,
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

/// The eigenproblem T(λ) φ = 0.
pub struct Secular<'a> {
    /// ω² of the modes, 1/s².
    squares: &'a DVector<f64>,
    /// B and its transpose.
    factor: &'a DMatrix<f64>,
    transposed: DMatrix<f64>,
    /// Terms of the Prony series.
    chain: &'a Maxwell,
    /// Modulus ḡ.
    modulus: f64,
}

impl<'a> Secular<'a> {
    /// Creates the problem from the ω² (1/s²) of modes with the modulus ḡ, from B, and from the terms of the Prony
    /// series.
    pub fn new(squares: &'a DVector<f64>, factor: &'a DMatrix<f64>, chain: &'a Maxwell, modulus: f64) -> Self {
        Self { squares, factor, transposed: factor.transpose(), chain, modulus }
    }

    /// Returns all pairs; `None` if some of them are not found. The stiffness K is Ω − ḡ B Bᵀ, with all terms relaxed.
    pub fn pairs(&self, stiffness: &DMatrix<f64>) -> Option<Vec<Pair>> {
        let stiffness = stiffness.clone().cholesky()?;
        let mut pairs = found_once(self.squares.len(), |mode, known| self.vibration(mode, known))?;
        let mut times: Vec<f64> = self.chain.terms.iter().map(|term| term.time).collect();
        times.sort_by(|a, b| b.total_cmp(a));
        let all: f64 = self.chain.terms.iter().map(|term| term.modulus).sum();
        let mut slower = 0.0;
        for pole in times.into_iter().map(|time| -1.0 / time) {
            let (values, directions) = symmetric_eigen(self.sum(&self.receptances(pole)));
            let moving: Vec<usize> = (0..values.len()).filter(|&k| values[k] * all > IDLE).collect();
            pairs.extend(found_once(moving.len(), |number, known| {
                let k = moving[number];
                let rate = self.balanced((pole, slower), values[k]);
                let pair = self.creep(rate, directions.column(k).into_owned(), known);
                pair.filter(|pair| pair.rate.re > pole && pair.rate.re < slower)
            })?);
            slower = pole;
        }
        self.are_complete(&pairs, &stiffness).then_some(pairs)
    }

    /// Returns the vibration that begins as a mode, other than the known ones; `None` if the iterations do not lead to
    /// a vibration.
    fn vibration(&self, mode: usize, known: &[Pair]) -> Option<Pair> {
        let own: DVector<Complex<f64>> = self.transposed.column(mode).map(|entry| Complex::new(entry, 0.0));
        let square = self.squares[mode];
        let [g, _] = self.excess(Complex::new(0.0, square.sqrt()));
        // This sign belongs to a decaying vibration.
        let mut rate = -(-(own.dot(&own) * g + square)).sqrt();
        let mut convergence = Convergence::new();
        let (mut shape, mut slope) = (DVector::zeros(self.squares.len()), Complex::new(0.0, 0.0));
        for _ in 0..MAX_ITERATIONS {
            let [g, of_g] = self.excess(rate);
            let mut receptances = self.receptances(rate);
            receptances[mode] = Complex::new(0.0, 0.0);
            let [real, imaginary] = [receptances.map(|r| r.re), receptances.map(|r| r.im)].map(|part| self.sum(&part));
            let y = solved(&plus_one(real.zip_map(&imaginary, Complex::new) * g), &own);
            shape = real_times_complex(self.factor, &y).component_mul(&receptances) * -g;
            shape[mode] = Complex::new(1.0, 0.0);
            slope = rate * 2.0 * shape.dot(&shape) + of_g * y.dot(&y);
            let value = rate * rate + square + g * own.dot(&y);
            let change = value / known.iter().fold(slope, |slope, pair| slope - value / (rate - pair.rate));
            rate -= change;
            if convergence.ends(change.modulus() / rate.modulus()) {
                break;
            }
        }
        let length = shape.norm();
        let pair = Pair { rate, shape: shape / Complex::new(length, 0.0), slope: slope / (length * length) };
        Some(pair).filter(|pair| convergence.is_found && pair.rate.is_finite() && pair.rate.im > 0.0)
    }

    /// Refines an approximate real pair, other than the known ones; `None` if the iterations do not converge.
    fn creep(&self, mut rate: f64, mut y: DVector<f64>, known: &[Pair]) -> Option<Pair> {
        let mut convergence = Convergence::new();
        for _ in 0..MAX_ITERATIONS {
            let [g, of_g] = self.excess(rate);
            let receptances = self.receptances(rate);
            let system = plus_one(self.sum(&receptances) * g);
            let turned = |y: &DVector<f64>| {
                let spread = (self.factor * y).component_mul(&receptances);
                let bent = spread.component_mul(&receptances) * (2.0 * rate * g);
                self.factor.tr_mul(&(spread * of_g - bent))
            };
            let next = solved(&system, &turned(&y));
            let length = next.norm();
            if !length.is_finite() {
                // The matrix is singular: λ is exact.
                break;
            }
            y = next / length;
            let (value, slope) = (y.dot(&(&system * &y)), y.dot(&turned(&y)));
            let change = value / known.iter().fold(slope, |slope, pair| slope - value / (rate - pair.rate.re));
            rate -= change;
            if convergence.ends(change.abs() / rate.abs()) {
                break;
            }
        }
        let shape = (self.factor * &y).component_mul(&self.receptances(rate)).normalize();
        let [_, of_g] = self.excess(rate);
        let slope = 2.0 * rate * shape.dot(&shape) + of_g * self.factor.tr_mul(&shape).norm_squared();
        let [rate, slope] = [rate, slope].map(|value| Complex::new(value, 0.0));
        convergence.is_found.then(|| Pair { rate, shape: shape.map(|entry| Complex::new(entry, 0.0)), slope })
    }

    /// Returns the rate between a pole and a slower rate at which 1 + γ · `value` is zero. The function increases from
    /// −∞ at the pole.
    fn balanced(&self, (pole, slower): (f64, f64), value: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        let rate = |part: f64| pole + part * (slower - pole);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let [excess, _] = self.excess(rate(middle));
            if 1.0 + excess * value < 0.0 { low = middle } else { high = middle }
        }
        rate(0.5 * (low + high))
    }

    /// Returns γ and g′.
    fn excess<T: ComplexField<RealField = f64> + Copy>(&self, rate: T) -> [T; 2] {
        let one = T::one();
        self.chain.terms.iter().fold([T::from_real(-self.modulus), T::zero()], |[value, slope], term| {
            let [modulus, time] = [term.modulus, term.time].map(T::from_real);
            let (x, inverse) = (rate * time, one / (one + rate * time));
            [value + modulus * x * inverse, slope + modulus * time * inverse * inverse]
        })
    }

    /// Returns 1/(ω² + λ²) of all modes.
    fn receptances<T: ComplexField<RealField = f64> + Copy>(&self, rate: T) -> DVector<T> {
        self.squares.map(|square| T::one() / (rate * rate + T::from_real(square)))
    }

    /// Returns Bᵀ diag(receptances) B.
    fn sum(&self, receptances: &DVector<f64>) -> DMatrix<f64> {
        let mut scaled = self.transposed.clone();
        scaled.column_iter_mut().zip(receptances).for_each(|(mut column, receptance)| column *= *receptance);
        scaled * self.factor
    }

    /// Whether no pair is missing or inaccurate: the sums over all pairs, multiplied by test vectors, must have their
    /// known values. The contribution of a missing pair is practically never orthogonal to all test vectors.
    fn are_complete(&self, pairs: &[Pair], stiffness: &Cholesky<f64, Dyn>) -> bool {
        // No two entries are equal, not even up to the sign, so that a mode found twice in the place of another one is
        // detected too.
        let entry = |i: usize, j: usize| ((i + 1) as f64 * PROBES[j].sqrt()).fract() - 0.5;
        let probes = DMatrix::from_fn(self.squares.len(), PROBES.len(), entry);
        let of_rates = sum_times(pairs, |pair| pair.rate, &probes) - &probes;
        let at_rest = stiffness.solve(&probes);
        let off = &at_rest + sum_times(pairs, |pair| pair.rate.inv(), &probes);
        of_rates.amax() <= LARGEST_SUM_ERROR && off.amax() <= LARGEST_SUM_ERROR * at_rest.amax()
    }
}

/// Returns a number of different pairs; `None` if fewer are found. A search that fails or leads to a pair of another
/// search is repeated with all other pairs as the known ones.
fn found_once(count: usize, search: impl Fn(usize, &[Pair]) -> Option<Pair>) -> Option<Vec<Pair>> {
    let is_new = |pair: &Pair, pairs: &[Pair]| !pairs.iter().any(|other| pair.is(other));
    let (mut pairs, mut open) = (Vec::with_capacity(count), Vec::new());
    for number in 0..count {
        match search(number, &[]).filter(|pair| is_new(pair, &pairs)) {
            Some(pair) => pairs.push(pair),
            None => open.push(number),
        }
    }
    for number in open {
        let pair = search(number, &pairs).filter(|pair| is_new(pair, &pairs))?;
        pairs.push(pair);
    }
    Some(pairs)
}

/// Returns the solution of a linear system. It is not finite if the matrix is singular.
fn solved<T: faer::traits::ComplexField + ComplexField>(matrix: &DMatrix<T>, right: &DVector<T>) -> DVector<T> {
    let count = right.len();
    let matrix = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
    let solution = matrix.partial_piv_lu().solve(MatRef::from_column_major_slice(right.as_slice(), count, 1));
    DVector::from_fn(count, |i, _| solution[(i, 0)].clone())
}

/// Returns 1 + A.
fn plus_one<T: ComplexField + Copy>(mut matrix: DMatrix<T>) -> DMatrix<T> {
    (0..matrix.nrows()).for_each(|i| matrix[(i, i)] += T::one());
    matrix
}

/// Returns Re Σ f φφᵀ/(φᵀT′φ) over all pairs, multiplied by vectors, the columns of `vectors`. Conjugate pairs count
/// twice.
fn sum_times(pairs: &[Pair], factor: impl Fn(&Pair) -> Complex<f64>, vectors: &DMatrix<f64>) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(vectors.nrows(), vectors.ncols());
    for pair in pairs {
        // Re f φφᵀ = Re(f φ) Re φᵀ − Im(f φ) Im φᵀ.
        let scaled = &pair.shape * (factor(pair) * pair.count() / pair.slope);
        let [re, im] = [|entry: Complex<f64>| entry.re, |entry: Complex<f64>| entry.im];
        sum +=
            scaled.map(re) * pair.shape.map(re).tr_mul(vectors) - scaled.map(im) * pair.shape.map(im).tr_mul(vectors);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Term;

    fn chain(terms: &[(f64, f64)]) -> Maxwell {
        Maxwell { equilibrium: 0.0, terms: terms.iter().map(|&(modulus, time)| Term { modulus, time }).collect() }
    }

    /// A pair that is found in the place of another one is replaced by the missing pair: the search is repeated beside the
    /// known pairs.
    #[test]
    fn missing_pairs_are_found() {
        let squares = DVector::from_row_slice(&[1.0, 2.0, 2.2, 5.0, 9.0, 9.5]);
        // Full rank, and a large part of the stiffness.
        let distortion = DMatrix::from_fn(6, 6, |i, j| {
            let together = 0.1 / (1.0 + (i as f64 - j as f64).powi(2));
            together * (squares[i] * squares[j]).sqrt()
        });
        let factor = distortion.clone().cholesky().expect("full rank").unpack();
        let chain = chain(&[(0.8, 0.3), (0.5, 20.0)]);
        let modulus = chain.transformed_terms(3.0);
        let stiffness = DMatrix::from_diagonal(&squares) - &distortion * modulus;
        let secular = Secular::new(&squares, &factor, &chain, modulus);
        let all = secular.pairs(&stiffness).expect("all pairs");
        assert_eq!(all.len(), 6 + 2 * 6);
        let is_among = |pairs: &[Pair], wanted: &Pair| pairs.iter().any(|pair| pair.is(wanted));
        // The first search from each start with an odd number leads to the pair of another one.
        let start = |number: usize, known: &[Pair]| if known.is_empty() { number / 2 * 2 } else { number };
        let found = found_once(6, |mode, known| secular.vibration(start(mode, known), known)).expect("vibrations");
        assert!(found.len() == 6 && all[..6].iter().all(|pair| is_among(&found, pair)));
        for place in [6, 12] {
            let creep = |number: usize, known: &[Pair]| {
                let from = &all[place + start(number, known)];
                // y = Bᵀφ.
                let y = factor.tr_mul(&from.shape.map(|entry| entry.re)).normalize();
                secular.creep(from.rate.re * 1.001, y, known)
            };
            let found = found_once(6, creep).expect("pairs that creep");
            assert!(found.len() == 6 && all[place..place + 6].iter().all(|pair| is_among(&found, pair)));
        }
    }

    /// Pairs of modes that lie close together and relax in few directions satisfy the equation with the full matrices.
    #[test]
    fn close_pairs_settle() {
        let count = 24;
        let squares = DVector::from_fn(count, |i, _| (1.0 + (i / 2) as f64).powi(2) * (1.0 + 0.01 * (i % 2) as f64));
        let factor = DMatrix::from_fn(count, 4, |i, j| 0.05 * squares[i].sqrt() * ((3 * i * (j + 1) + j) as f64).sin());
        let chain = chain(&[(0.8, 0.03), (0.6, 0.4), (0.5, 20.0)]);
        let (distortion, modulus) = (&factor * factor.transpose(), chain.transformed_terms(3.0));
        let stiffness = DMatrix::from_diagonal(&squares) - &distortion * modulus;
        let secular = Secular::new(&squares, &factor, &chain, modulus);
        let pairs = secular.pairs(&stiffness).expect("all pairs");
        assert_eq!(pairs.len(), count + 3 * 4);
        for Pair { rate, shape, .. } in &pairs {
            let [excess, _] = secular.excess(*rate);
            let real = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0)) * shape;
            let (held, stretched) = (real(&stiffness), real(&distortion) * (excess + modulus));
            let off = &held + &stretched + shape * (rate * rate);
            // Rounding of sums whose largest terms cancel. Measured: 1e-13.
            let size = held.norm() + stretched.norm() + rate.norm_sqr();
            assert!(off.norm() < 1e-11 * size, "{rate}: {:e}", off.norm() / size);
        }
    }
}
