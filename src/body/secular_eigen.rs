//! Eigenpairs of (λ² + Ω + γ(λ) B Bᵀ) φ = 0, Ω diagonal, γ = g − ḡ: a body whose modes, with the modulus ḡ, relax in
//! few directions.
//!
//! The vibration that begins as mode k has φ_k = 1. The amplitudes of the other modes follow from systems with as many
//! unknowns as B has columns:
//!
//! ω_k² + λ² + γ b_kᵀ y = 0,  (1 + γ Σ_{j≠k} b_j b_jᵀ/(ω_j² + λ²)) y = b_k,  φ_j = −γ b_jᵀy/(ω_j² + λ²),
//!
//! with the rows b_k of B (the secular equation of G. H. Golub, SIAM Rev. 15, 1973, for several columns). Newton's
//! method solves it for λ. Real pairs satisfy (1 + γ Σ b_j b_jᵀ/(ω_j² + λ²)) y = 0 with φ_j ∝ b_jᵀy/(ω_j² + λ²). They
//! are found by inverse iteration with the Rayleigh functional, in the same way as for relaxation in all directions
//! ([`super::rational_eigen`]).

use nalgebra::{Complex, ComplexField, DMatrix, DVector};

use super::axpy::product;
use super::dense_solve::solved;
use super::eigen::symmetric_eigen;
use super::rational_eigen::{Convergence, IDLE, MAX_ITERATIONS, Pair, Rational};

/// Modes, with the directions that couple them.
pub struct Secular<'a> {
    /// ω² of the modes, 1/s².
    squares: &'a DVector<f64>,
    /// B and its transpose.
    factor: &'a DMatrix<f64>,
    transposed: DMatrix<f64>,
    /// Modulus ḡ.
    modulus: f64,
}

impl<'a> Secular<'a> {
    /// Creates the problem from the ω² (1/s²) of modes with the modulus ḡ, and from B.
    pub fn new(squares: &'a DVector<f64>, factor: &'a DMatrix<f64>, modulus: f64) -> Self {
        Self { squares, factor, transposed: factor.transpose(), modulus }
    }

    /// Returns the vibration that begins as a mode; `None` if the iterations do not lead to a vibration.
    pub fn vibration(&self, mode: usize, of: &Rational<'_>) -> Option<Pair> {
        let own: DVector<Complex<f64>> = self.transposed.column(mode).map(|entry| Complex::new(entry, 0.0));
        let square = self.squares[mode];
        let [g, _] = self.excess(of, Complex::new(0.0, square.sqrt()));
        // This sign belongs to a decaying vibration.
        let mut rate = -(-(own.dot(&own) * g + square)).sqrt();
        let mut convergence = Convergence::new();
        let (mut shape, mut slope) = (DVector::zeros(self.squares.len()), Complex::new(0.0, 0.0));
        for _ in 0..MAX_ITERATIONS {
            let [g, of_g] = self.excess(of, rate);
            let mut receptances = self.receptances(rate);
            receptances[mode] = Complex::new(0.0, 0.0);
            let y = solved(self.system(&receptances, g), own.clone());
            shape = self.spread(&y).component_mul(&receptances) * -g;
            shape[mode] = Complex::new(1.0, 0.0);
            slope = rate * 2.0 * shape.dot(&shape) + of_g * y.dot(&y);
            let change = (rate * rate + square + g * own.dot(&y)) / slope;
            rate -= change;
            if convergence.ends(change.modulus() / rate.modulus()) {
                break;
            }
        }
        let length = shape.norm();
        let pair = Pair { rate, shape: shape / Complex::new(length, 0.0), slope: slope / (length * length) };
        Some(pair).filter(|pair| convergence.is_found && pair.rate.is_finite() && pair.rate.im > 0.0)
    }

    /// Returns the real pairs between two poles; `None` if some are not found.
    pub fn creeping(&self, (pole, slower): (f64, f64), of: &Rational<'_>) -> Option<Vec<Pair>> {
        let together = self.sum(&self.receptances(pole));
        let (values, directions) = symmetric_eigen(together);
        let all: f64 = of.chain.terms.iter().map(|term| term.modulus).sum();
        let found = values.iter().zip(directions.column_iter()).filter(|(value, _)| **value * all > IDLE);
        let pair = |(value, direction): (&f64, nalgebra::DVectorView<'_, f64>)| {
            let rate = of.balanced((pole, slower), |_, g| 1.0 + (g - self.modulus) * value);
            self.creep(rate, direction.into_owned(), of).filter(|pair| pair.rate.re > pole && pair.rate.re < slower)
        };
        found.map(pair).collect()
    }

    /// Refines an approximate real pair; `None` if the iterations do not converge.
    fn creep(&self, mut rate: f64, mut y: DVector<f64>, of: &Rational<'_>) -> Option<Pair> {
        let mut convergence = Convergence::new();
        for _ in 0..MAX_ITERATIONS {
            let [g, of_g] = self.excess(of, rate);
            let receptances = self.receptances(rate);
            let system = self.system(&receptances, g);
            let turned = |y: &DVector<f64>| {
                let spread = self.spread(y).component_mul(&receptances);
                let bent = product(&self.transposed, &spread.component_mul(&receptances));
                product(&self.transposed, &spread) * of_g - bent * (2.0 * rate * g)
            };
            let next = solved(system.clone(), turned(&y));
            let length = next.norm();
            if !length.is_finite() {
                // The matrix is singular: λ is exact.
                break;
            }
            y = next / length;
            let change = y.dot(&(&system * &y)) / y.dot(&turned(&y));
            rate -= change;
            if convergence.ends(change.abs() / rate.abs()) {
                break;
            }
        }
        let shape = self.spread(&y).component_mul(&self.receptances(rate)).normalize();
        let [_, of_g] = self.excess(of, rate);
        let slope = 2.0 * rate * shape.dot(&shape) + of_g * (&self.transposed * &shape).norm_squared();
        let [rate, slope] = [rate, slope].map(|value| Complex::new(value, 0.0));
        convergence.is_found.then(|| Pair { rate, shape: shape.map(|entry| Complex::new(entry, 0.0)), slope })
    }

    /// Returns γ and g′.
    fn excess<T: ComplexField<RealField = f64> + Copy>(&self, of: &Rational<'_>, rate: T) -> [T; 2] {
        let [g, slope] = of.modulus(rate);
        [g - T::from_real(self.modulus), slope]
    }

    /// Returns 1/(ω² + λ²) of all modes.
    fn receptances<T: ComplexField<RealField = f64> + Copy>(&self, rate: T) -> DVector<T> {
        self.squares.map(|square| T::one() / (rate * rate + T::from_real(square)))
    }

    /// Returns B y.
    fn spread<T: ComplexField<RealField = f64> + Copy>(&self, y: &DVector<T>) -> DVector<T> {
        let [real, imaginary] = parts(y);
        joined(&product(self.factor, &real), &product(self.factor, &imaginary))
    }

    /// Returns 1 + γ Bᵀ diag(receptances) B.
    fn system<T: ComplexField<RealField = f64> + Copy>(&self, receptances: &DVector<T>, g: T) -> DMatrix<T> {
        let mut system = self.sum(receptances) * g;
        (0..system.nrows()).for_each(|i| system[(i, i)] += T::one());
        system
    }

    /// Returns Bᵀ diag(receptances) B. Real and imaginary parts are stacked in one product.
    fn sum<T: ComplexField<RealField = f64> + Copy>(&self, receptances: &DVector<T>) -> DMatrix<T> {
        let (directions, modes) = self.transposed.shape();
        let [real, imaginary] = parts(receptances);
        // The imaginary part is skipped if it is zero.
        let rows = if imaginary.amax() > 0.0 { 2 * directions } else { directions };
        let mut scaled = DMatrix::zeros(rows, modes);
        let columns =
            scaled.as_mut_slice().chunks_exact_mut(rows).zip(self.transposed.as_slice().chunks_exact(directions));
        for ((scaled, column), (real, imaginary)) in columns.zip(real.iter().zip(&imaginary)) {
            for (part, by) in scaled.chunks_exact_mut(directions).zip([real, imaginary]) {
                part.iter_mut().zip(column).for_each(|(entry, of)| *entry = of * by);
            }
        }
        let product = scaled * self.factor;
        if rows == directions {
            return product.map(T::from_real);
        }
        joined(&product.rows(0, directions), &product.rows(directions, directions))
    }
}

/// Returns the real and the imaginary part.
fn parts<T: ComplexField<RealField = f64> + Copy>(of: &DVector<T>) -> [DVector<f64>; 2] {
    [of.map(T::real), of.map(T::imaginary)]
}

/// Joins real and imaginary parts. If T is real, the imaginary part must be zero.
fn joined<T, R, C, S>(
    real: &nalgebra::Matrix<f64, R, C, S>,
    imaginary: &nalgebra::Matrix<f64, R, C, S>,
) -> nalgebra::OMatrix<T, R, C>
where
    T: ComplexField<RealField = f64> + Copy,
    R: nalgebra::Dim,
    C: nalgebra::Dim,
    S: nalgebra::storage::Storage<f64, R, C>,
    nalgebra::DefaultAllocator: nalgebra::allocator::Allocator<R, C>,
{
    // √−1 exists only if T is complex.
    let unit = T::from_real(-1.0).try_sqrt();
    real.zip_map(imaginary, |real, imaginary| match unit {
        Some(unit) => T::from_real(real) + unit * T::from_real(imaginary),
        None => T::from_real(real),
    })
}
