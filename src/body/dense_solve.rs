//! Solution of dense linear systems, most of them small.

use faer::MatRef;
use faer::linalg::solvers::Solve as _;
use nalgebra::{DMatrix, DVector};

use super::axpy::Entry;

/// Largest number of rows for plain column-wise elimination. Above it, a blocked factorisation is faster despite its
/// set-up cost.
const SMALL: usize = 48;

/// Returns the solution of a linear system. It is not finite if the matrix is singular.
pub(super) fn solved<T: Entry>(mut matrix: DMatrix<T>, mut right: DVector<T>) -> DVector<T> {
    let count = right.len();
    if count <= SMALL {
        eliminate(matrix.as_mut_slice(), right.as_mut_slice());
        return right;
    }
    let matrix = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
    let solution = matrix.partial_piv_lu().solve(MatRef::from_column_major_slice(right.as_slice(), count, 1));
    DVector::from_fn(count, |i, _| solution[(i, 0)])
}

/// Gaussian elimination with partial pivoting. The right side is overwritten by the solution.
fn eliminate<T: Entry>(matrix: &mut [T], right: &mut [T]) {
    let count = right.len();
    for k in 0..count {
        let below = &matrix[k * count + k..(k + 1) * count];
        let (mut pivot, mut largest) = (k, 0.0);
        for (i, entry) in below.iter().enumerate() {
            let size = nalgebra::ComplexField::modulus_squared(*entry);
            if size > largest {
                (pivot, largest) = (k + i, size);
            }
        }
        if pivot != k {
            matrix[k * count..].chunks_exact_mut(count).for_each(|column| column.swap(k, pivot));
            right.swap(k, pivot);
        }
        let (column, later) = matrix[k * count..].split_at_mut(count);
        let inverse = <T as nalgebra::ComplexField>::from_real(1.0) / column[k];
        let factors = &mut column[k + 1..];
        factors.iter_mut().for_each(|factor| *factor *= inverse);
        for column in later.chunks_exact_mut(count).chain([&mut *right]) {
            let by = column[k];
            T::add_multiple(&mut column[k + 1..], -by, factors);
        }
    }
    for k in (0..count).rev() {
        let column = &matrix[k * count..(k + 1) * count];
        let found = right[k] / column[k];
        right[k] = found;
        T::add_multiple(&mut right[..k], -found, &column[..k]);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    /// Both methods solve systems that need pivoting, to rounding.
    #[test]
    fn products_with_solutions_are_the_right_sides() {
        for count in [1, 7, SMALL, SMALL + 5] {
            let matrix = DMatrix::from_fn(count, count, |i, j| {
                let one = ((3 * i + 7 * j * j) % 11) as f64 - 5.0;
                Complex::new(if i == j { 0.0 } else { one }, ((5 * i + j) % 13) as f64 + f64::from(u8::from(i == j)))
            });
            let right = DVector::from_fn(count, |i, _| Complex::new(i as f64, 1.0));
            let off = (&matrix * solved(matrix.clone(), right.clone()) - &right).norm();
            assert!(off < 1e-10 * right.norm().max(1.0), "{count}: {off:e}");
            let real = DMatrix::from_fn(count, count, |i, j| {
                ((3 * i + 7 * j * j) % 11) as f64 - 5.0 + 20.0 * f64::from(u8::from(i + j + 1 == count))
            });
            let right = DVector::from_fn(count, |i, _| 1.0 + i as f64);
            let off = (&real * solved(real.clone(), right.clone()) - &right).norm();
            assert!(off < 1e-10 * right.norm(), "{count}: {off:e}");
        }
    }
}
