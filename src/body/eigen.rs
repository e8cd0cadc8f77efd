//! Eigenvalues and vectors of dense symmetric matrices.

use faer::{MatRef, Side};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Rows from which on blocked methods are quicker.
const BLOCKED: usize = 64;

/// Eigenvalues, ascending, and unit eigenvectors by columns.
pub fn symmetric_eigen(matrix: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let count = matrix.nrows();
    if count >= BLOCKED {
        let view = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
        // A matrix that is not finite has none.
        if let Ok(eigen) = view.self_adjoint_eigen(Side::Lower) {
            let (values, vectors) = (eigen.S(), eigen.U());
            return (DVector::from_fn(count, |i, _| values[i]), DMatrix::from_fn(count, count, |i, j| vectors[(i, j)]));
        }
    }
    let eigen = SymmetricEigen::new(matrix);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
    (eigen.eigenvalues.select_rows(&order), eigen.eigenvectors.select_columns(&order))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// tridiag(−1, 2, −1) has the eigenvalues 4 sin²(jπ/2(n+1)), by either method.
    #[test]
    fn eigenvalues_of_a_chain_of_springs() {
        for count in [BLOCKED - 1, BLOCKED, 3 * BLOCKED] {
            let chain = DMatrix::from_fn(count, count, |i, j| match i.abs_diff(j) {
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            });
            let (values, vectors) = symmetric_eigen(chain.clone());
            for (j, value) in values.iter().enumerate() {
                let angle = std::f64::consts::PI * (j + 1) as f64 / (count + 1) as f64;
                // Rounding of a matrix of norm 4.
                assert!((value - 4.0 * (0.5 * angle).sin().powi(2)).abs() < 1e-13);
            }
            let off = &chain * &vectors - &vectors * DMatrix::from_diagonal(&values);
            assert!(off.amax() < 1e-13 && (vectors.tr_mul(&vectors) - DMatrix::identity(count, count)).amax() < 1e-13);
        }
    }
}
