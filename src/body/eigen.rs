//! Eigenvalues and vectors of dense symmetric matrices.

use faer::{MatRef, Side};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Rows from which on blocked methods are quicker.
const BLOCKED: usize = 64;

/// Eigenvalues, ascending, and unit eigenvectors by columns. Rows that no entry couples, such as those of a body's classes of motions, are
/// taken by themselves: four blocks of a quarter of the size take a sixteenth of the time.
pub fn symmetric_eigen(matrix: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let blocks = blocks(&matrix);
    if blocks.len() == 1 {
        return ascending(of_block(matrix));
    }
    let count = matrix.nrows();
    let (mut values, mut vectors, mut next) = (DVector::zeros(count), DMatrix::zeros(count, count), 0);
    for rows in blocks {
        let (of_rows, shapes) = of_block(matrix.select_rows(&rows).select_columns(&rows));
        for (value, shape) in of_rows.iter().zip(shapes.column_iter()) {
            values[next] = *value;
            rows.iter().zip(shape.iter()).for_each(|(&row, entry)| vectors[(row, next)] = *entry);
            next += 1;
        }
    }
    ascending((values, vectors))
}

/// The same by ascending eigenvalues.
fn ascending((values, vectors): (DVector<f64>, DMatrix<f64>)) -> (DVector<f64>, DMatrix<f64>) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    (values.select_rows(&order), vectors.select_columns(&order))
}

/// Eigenvalues in any order, and their vectors.
fn of_block(matrix: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let count = matrix.nrows();
    if count >= BLOCKED {
        let view = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
        // A matrix that is not finite has none.
        if let Ok(eigen) = view.self_adjoint_eigen(Side::Lower) {
            let (values, vectors) = (eigen.S(), eigen.U());
            return (DVector::from_fn(count, |i, _| values[i]), DMatrix::from_fn(count, count, |i, j| vectors[(i, j)]));
        }
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(matrix);
    (eigenvalues, eigenvectors)
}

/// Rows that are coupled by entries which are not zero, each block ascending.
fn blocks(matrix: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let mut open: Vec<usize> = (0..matrix.nrows()).collect();
    let mut blocks = Vec::new();
    while !open.is_empty() {
        // The first row that is left, and all that can be reached from it.
        let mut block = vec![open.remove(0)];
        let mut done = 0;
        while done < block.len() && !open.is_empty() {
            let column = matrix.column(block[done]);
            let (met, apart) = open.iter().partition(|&&row| column[row] != 0.0);
            block.extend::<Vec<usize>>(met);
            open = apart;
            done += 1;
        }
        block.sort_unstable();
        blocks.push(block);
    }
    blocks
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

    /// Two blocks with interlaced rows: V is orthogonal and AV = VΛ.
    #[test]
    fn blocks_have_the_eigenvalues_of_all() {
        let matrix = DMatrix::from_fn(9, 9, |i, j| {
            if i % 2 == j % 2 { 1.0 / (1.0 + (i + j) as f64) + if i == j { i as f64 } else { 0.0 } } else { 0.0 }
        });
        assert_eq!(blocks(&matrix), [vec![0, 2, 4, 6, 8], vec![1, 3, 5, 7]]);
        let (values, vectors) = symmetric_eigen(matrix.clone());
        // Rounding of nine terms of size ten.
        assert!((vectors.tr_mul(&vectors) - DMatrix::identity(9, 9)).amax() < 1e-14);
        assert!((&matrix * &vectors - &vectors * DMatrix::from_diagonal(&values)).amax() < 1e-13);
    }
}
