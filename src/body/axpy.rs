//! Vector updates y ← y + a x, with the widest SIMD instructions of the processor.

use nalgebra::{Complex, ComplexField, DMatrix, DVector};
use pulp::{Simd, WithSimd};

/// Scalar type of vector entries: real or complex.
pub(super) trait Entry: ComplexField<RealField = f64> + faer::traits::ComplexField + Copy {
    /// Computes y ← y + a x.
    fn add_multiple(to: &mut [Self], factor: Self, from: &[Self]);
}

struct Adding<'a, T> {
    to: &'a mut [T],
    factor: T,
    from: &'a [T],
}

impl Entry for f64 {
    fn add_multiple(to: &mut [Self], factor: Self, from: &[Self]) {
        pulp::Arch::new().dispatch(Adding { to, factor, from });
    }
}

impl Entry for Complex<f64> {
    fn add_multiple(to: &mut [Self], factor: Self, from: &[Self]) {
        pulp::Arch::new().dispatch(Adding { to, factor, from });
    }
}

impl WithSimd for Adding<'_, f64> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { to, factor, from } = self;
        let ((to, last_to), (from, last_from)) = (S::as_mut_simd_f64s(to), S::as_simd_f64s(from));
        let all = simd.splat_f64s(factor);
        to.iter_mut().zip(from).for_each(|(to, from)| *to = simd.mul_add_e_f64s(*from, all, *to));
        last_to.iter_mut().zip(last_from).for_each(|(to, from)| *to += factor * from);
    }
}

impl WithSimd for Adding<'_, Complex<f64>> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { to, factor, from } = self;
        let ((to, last_to), (from, last_from)) = (S::as_mut_simd_c64s(to), S::as_simd_c64s(from));
        let all = simd.splat_c64s(factor);
        to.iter_mut().zip(from).for_each(|(to, from)| *to = simd.mul_add_e_c64s(*from, all, *to));
        last_to.iter_mut().zip(last_from).for_each(|(to, from)| *to += factor * from);
    }
}

/// Returns the product A x.
pub(super) fn product(matrix: &DMatrix<f64>, vector: &DVector<f64>) -> DVector<f64> {
    // Without this check, the iterators would silently skip entries.
    assert_eq!(matrix.ncols(), vector.len(), "a matrix and a vector of other lengths");
    let mut sum = DVector::zeros(matrix.nrows());
    let columns = matrix.as_slice().chunks_exact(matrix.nrows().max(1));
    columns.zip(vector.iter()).for_each(|(column, factor)| f64::add_multiple(sum.as_mut_slice(), *factor, column));
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Real and complex vectors agree to rounding for full SIMD vectors and remainders.
    #[test]
    fn sums_are_those_of_the_entries() {
        for count in [0, 1, 3, 4, 11] {
            let real = DVector::from_fn(count, |i, _| 0.3 + i as f64);
            let mut sum = real.clone();
            f64::add_multiple(sum.as_mut_slice(), -0.7, real.as_slice());
            assert!((sum - &real * 0.3).norm() < 1e-14);
            let complex = real.map(|x| Complex::new(x, 1.0 - x));
            let (mut sum, factor) = (complex.clone(), Complex::new(0.2, -0.5));
            Complex::add_multiple(sum.as_mut_slice(), factor, complex.as_slice());
            assert!((sum - &complex * (factor + 1.0)).norm() < 1e-13);
            let matrix = DMatrix::from_fn(3, count, |i, j| (i + 2 * j) as f64);
            assert!((product(&matrix, &real) - &matrix * &real).norm() < 1e-12);
        }
    }
}
