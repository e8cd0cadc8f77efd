//! Eigenpairs of (λ² + K + g(λ) D) φ = 0, g = Σ G_i λτ_i/(1 + λτ_i): the free motions of a body with one relaxing chain.
//!
//! Each pair is found by itself, by inverse iteration with the Rayleigh functional (Ruhe, SIAM J. Numer. Anal. 10, 1973, for T(λ) = Tᵀ): from each mode of a given modulus a vibration, and in each interval between
//! two poles −1/τ_i, over which g falls from ∞ to −∞, a real one for each direction of D. From there on λ² changes them little. A pair that
//! is found twice means another one that is missing: whether all are there, the sums Σ λ φφᵀ/(φᵀT′φ) = 1 and −Σ λ⁻¹ φφᵀ/(φᵀT′φ) = K⁻¹
//! tell. The cost of a pair is the cube of the number of modes, where that of the first-order system is the cube of that times the number of terms.

use faer::MatRef;
use faer::linalg::solvers::Solve as _;
use nalgebra::{Cholesky, Complex, ComplexField, DMatrix, DVector, Dyn};

use super::eigen::symmetric_eigen;
use crate::material::Maxwell;

/// Iterations for one pair: convergence is cubic.
const MOST: usize = 12;

/// A change of λ over λ after which one iteration more leaves rounding.
const CLOSE: f64 = 1e-6;

/// Directions on which the chain has less than this part of the stiffness creep by nothing.
const IDLE: f64 = 1e-10;

/// What the sums of all pairs may be off by.
const COMPLETE: f64 = 1e-8;

/// An eigenpair; one of two that are conjugate, the one with Im λ > 0.
pub struct Pair {
    /// λ, 1/s.
    pub rate: Complex<f64>,
    /// φ.
    pub shape: DVector<Complex<f64>>,
    /// φᵀT′(λ)φ.
    pub slope: Complex<f64>,
}

/// T(λ).
pub struct Rational<'a> {
    /// K after all relaxation.
    pub stiffness: &'a DMatrix<f64>,
    /// D.
    pub distortion: &'a DMatrix<f64>,
    /// The terms.
    pub chain: &'a Maxwell,
}

impl Pair {
    /// How many pairs it stands for.
    pub fn count(&self) -> f64 {
        if self.rate.im == 0.0 { 1.0 } else { 2.0 }
    }
}

impl Rational<'_> {
    /// All pairs; `squares` are those of the unit vectors as modes of a mean modulus. `None` where some are not found.
    pub fn pairs(&self, squares: &DVector<f64>) -> Option<Vec<Pair>> {
        let count = squares.len();
        let factor = self.stiffness.clone().cholesky()?;
        let mut pairs = Vec::new();
        for (j, square) in squares.iter().enumerate() {
            let shape = DVector::from_fn(count, |i, _| Complex::new(f64::from(u8::from(i == j)), 0.0));
            let pair = self.refined(Complex::new(0.0, square.sqrt()), shape)?;
            if pair.rate.im <= 0.0 {
                return None;
            }
            pairs.push(pair);
        }
        let mut times: Vec<f64> = self.chain.terms.iter().map(|term| term.time).collect();
        times.sort_by(|a, b| b.total_cmp(a));
        let mut slower = 0.0;
        for pole in times.into_iter().map(|time| -1.0 / time) {
            for (rate, shape) in self.creeping(pole, slower)? {
                let Pair { rate, shape, slope } = self.refined(rate, shape)?;
                if rate.re <= pole || rate.re >= slower {
                    return None;
                }
                pairs.push(Pair { rate, shape, slope });
            }
            slower = pole;
        }
        self.are_complete(&pairs, &factor).then_some(pairs)
    }

    /// Real pairs between two poles, with λ² as at the faster one.
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
            // 1 + g d = 0: g rises from −∞ at the faster pole.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                let [g, _] = self.modulus(pole + middle * (slower - pole));
                if 1.0 + g * value < 0.0 { low = middle } else { high = middle }
            }
            let shape = lower.tr_solve_lower_triangular(&direction.into_owned())?;
            found.push((pole + 0.5 * (low + high) * (slower - pole), shape.normalize()));
        }
        Some(found)
    }

    /// g and g′.
    fn modulus<T: ComplexField<RealField = f64> + Copy>(&self, rate: T) -> [T; 2] {
        let one = T::one();
        self.chain.terms.iter().fold([T::zero(); 2], |[value, slope], term| {
            let [modulus, time] = [term.modulus, term.time].map(T::from_real);
            let (x, inverse) = (rate * time, one / (one + rate * time));
            [value + modulus * x * inverse, slope + modulus * time * inverse * inverse]
        })
    }

    /// The pair near an approximate one.
    fn refined<T>(&self, mut rate: T, mut shape: DVector<T>) -> Option<Pair>
    where
        T: ComplexField<RealField = f64> + faer::traits::ComplexField + Copy + Into<Complex<f64>>,
    {
        let [stiffness, distortion] = [self.stiffness, self.distortion].map(|matrix| matrix.map(T::from_real));
        let slope = |rate: T, shape: &DVector<T>, stretched: &DVector<T>| {
            let [_, slope] = self.modulus(rate);
            (rate + rate) * shape.dot(shape) + slope * shape.dot(stretched)
        };
        let mut is_found = false;
        for _ in 0..MOST {
            let [g, of_g] = self.modulus(rate);
            let stretched = &distortion * &shape;
            let mut matrix = &stiffness + &distortion * g;
            (0..shape.len()).for_each(|i| matrix[(i, i)] += rate * rate);
            let turned = &shape * (rate + rate) + &stretched * of_g;
            let mut next = solved(&matrix, &turned);
            let length = next.norm();
            if !length.is_finite() {
                // λ is exact.
                break;
            }
            next /= T::from_real(length);
            let stretched = &distortion * &next;
            let change = next.dot(&(&matrix * &next)) / slope(rate, &next, &stretched);
            shape = next;
            rate -= change;
            if is_found {
                break;
            }
            // One more turn makes φ as good as λ.
            is_found = change.modulus() <= CLOSE * rate.modulus();
        }
        let stretched = &distortion * &shape;
        let slope = slope(rate, &shape, &stretched);
        is_found.then(|| Pair { rate: rate.into(), shape: shape.map(Into::into), slope: slope.into() })
    }

    /// Whether the sums of all pairs are what they are to be.
    fn are_complete(&self, pairs: &[Pair], factor: &Cholesky<f64, Dyn>) -> bool {
        let count = self.stiffness.nrows();
        let mut of_rates = -DMatrix::<f64>::identity(count, count);
        let mut at_rest = -factor.inverse();
        let size = at_rest.amax();
        for pair in pairs {
            let factor = Complex::new(pair.count(), 0.0) / pair.slope;
            for (j, right) in pair.shape.iter().enumerate() {
                let part = factor * right;
                for (i, left) in pair.shape.iter().enumerate() {
                    let product = part * left;
                    of_rates[(i, j)] += (product * pair.rate).re;
                    at_rest[(i, j)] -= (product / pair.rate).re;
                }
            }
        }
        of_rates.amax() <= COMPLETE && at_rest.amax() <= COMPLETE * size
    }
}

/// The solution of a system of linear equations; not finite where the matrix is singular.
fn solved<T: nalgebra::Scalar + faer::traits::ComplexField>(matrix: &DMatrix<T>, right: &DVector<T>) -> DVector<T> {
    let count = right.len();
    let matrix = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
    let solution = matrix.partial_piv_lu().solve(MatRef::from_column_major_slice(right.as_slice(), count, 1));
    DVector::from_fn(count, |i, _| solution[(i, 0)].clone())
}
