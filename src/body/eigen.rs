//! Eigenvalues and eigenvectors of dense matrices.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{
    ComputeEigenvectors, SelfAdjointEvdParams, evd_real, evd_scratch, self_adjoint_evd, self_adjoint_evd_scratch,
};
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Auto, Mat, MatMut, MatRef, Par};
use nalgebra::{Complex, DMatrix, DVector, SymmetricEigen};

/// Smallest number of rows for which blocked methods are used. They are faster from this size on.
const BLOCKED: usize = 64;

/// Returns the eigenvalues in ascending order, and unit eigenvectors as columns. Uncoupled blocks of rows, such as
/// symmetry classes, are solved separately: four blocks of a quarter of the size take a sixteenth of the time.
pub fn symmetric_eigen(matrix: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let blocks = coupled(&matrix);
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

/// Returns BᵀX for a positive semidefinite matrix A = BBᵀ ([`semidefinite_factor`]). Uncoupled blocks of rows are
/// factorised separately: four equal blocks take a sixteenth of the time.
pub fn semidefinite_factor_times(matrix: &DMatrix<f64>, columns: &DMatrix<f64>) -> DMatrix<f64> {
    let of_block = |rows: Vec<usize>| {
        let factor = semidefinite_factor(&matrix.select_rows(&rows).select_columns(&rows));
        factor.tr_mul(&columns.select_rows(&rows))
    };
    let products: Vec<_> = coupled(matrix).into_iter().map(of_block).collect();
    let mut product = DMatrix::zeros(products.iter().map(DMatrix::nrows).sum(), columns.ncols());
    let mut first = 0;
    for part in &products {
        product.rows_mut(first, part.nrows()).copy_from(part);
        first += part.nrows();
    }
    product
}

/// Returns B of a positive semidefinite matrix A = BBᵀ. The number of columns of B is the rank of A, to rounding.
pub fn semidefinite_factor(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let count = matrix.nrows();
    let least = count as f64 * f64::EPSILON * matrix.diagonal().amax();
    pivoted_factor(matrix, &DVector::repeat(count, 1.0), |left, _| left.max() <= least)
}

/// Returns the first columns of B of a positive semidefinite matrix A = BBᵀ, until a condition on the diagonal of the
/// remainder and on the number of columns is true, or nothing remains. Method: Cholesky factorisation, in which each
/// pivot has the largest product of its weight and its remaining diagonal entry (N. J. Higham, Accuracy and Stability of
/// Numerical Algorithms, 2002, 10.3).
pub fn pivoted_factor(
    matrix: &DMatrix<f64>,
    weights: &DVector<f64>,
    mut ends: impl FnMut(&DVector<f64>, usize) -> bool,
) -> DMatrix<f64> {
    let mut left = matrix.diagonal();
    let mut found: Vec<DVector<f64>> = Vec::new();
    while !left.is_empty() && !ends(&left, found.len()) {
        let pivot = left.component_mul(weights).imax();
        if left[pivot] <= 0.0 {
            break;
        }
        let mut next = matrix.column(pivot).into_owned();
        for known in &found {
            next.axpy(-known[pivot], known, 1.0);
        }
        next /= left[pivot].sqrt();
        left.zip_apply(&next, |left, entry| *left = (*left - entry * entry).max(0.0));
        // The pivot is eliminated exactly; rounding must not leave a remainder.
        left[pivot] = 0.0;
        found.push(next);
    }
    DMatrix::from_fn(matrix.nrows(), found.len(), |i, j| found[j][i])
}

/// Sorts eigenpairs by ascending eigenvalue.
fn ascending((values, vectors): (DVector<f64>, DMatrix<f64>)) -> (DVector<f64>, DMatrix<f64>) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    (values.select_rows(&order), vectors.select_columns(&order))
}

/// Returns the eigenvalues in any order, and their eigenvectors.
fn of_block(matrix: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let count = matrix.nrows();
    if count >= BLOCKED {
        let view = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
        let mut choice = <SelfAdjointEvdParams as Auto<f64>>::auto();
        // Uses the QR method only. Divide and conquer (faer 0.24) finds wrong pairs if the eigenvalues have a wide
        // range. For 300 eigenvalues from 1 to 5e7, its residual is 4e-4 of the matrix norm, and the lowest eigenvalue
        // is wrong by a thousandth. For 516 eigenvalues, the lowest has the wrong sign.
        choice.recursion_threshold = usize::MAX;
        let scratch = self_adjoint_evd_scratch::<f64>(count, ComputeEigenvectors::Yes, Par::Seq, choice.into());
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        let (mut values, mut vectors) = (Diag::zeros(count), DMatrix::zeros(count, count));
        let out = Some(MatMut::from_column_major_slice_mut(vectors.as_mut_slice(), count, count));
        // The decomposition fails if the matrix is not finite.
        if self_adjoint_evd(view, values.as_mut(), out, Par::Seq, stack, choice.into()).is_ok() {
            return (DVector::from_fn(count, |i, _| values[i]), vectors);
        }
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(matrix);
    (eigenvalues, eigenvectors)
}

/// Eigenvalues and eigenvectors of a real unsymmetric matrix. In each conjugate pair, the eigenvalue with the positive
/// imaginary part is first.
pub struct GeneralEigen {
    values: Vec<Complex<f64>>,
    /// Unit eigenvectors as columns. A conjugate pair has one column for the real part and one for the imaginary part.
    vectors: Mat<f64>,
}

impl GeneralEigen {
    /// Computes the eigenpairs; `None` if this fails.
    pub fn new(matrix: &DMatrix<f64>) -> Option<Self> {
        let count = matrix.nrows();
        let view = MatRef::from_column_major_slice(matrix.as_slice(), count, count);
        let (mut real, mut imaginary, mut vectors) = (Diag::zeros(count), Diag::zeros(count), Mat::zeros(count, count));
        let (left, right) = (ComputeEigenvectors::No, ComputeEigenvectors::Yes);
        let scratch = evd_scratch::<f64>(count, left, right, Par::Seq, Default::default());
        let out = Some(vectors.as_mut());
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        evd_real(view, real.as_mut(), imaginary.as_mut(), None, out, Par::Seq, stack, Default::default()).ok()?;
        let values: Vec<_> = (0..count).map(|k| Complex::new(real[k], imaginary[k])).collect();
        let mut eigen = Self { values, vectors };
        eigen.normalize();
        Some(eigen)
    }

    /// Returns the eigenvalue λ_k.
    pub fn value(&self, k: usize) -> Complex<f64> {
        self.values[k]
    }

    /// Returns an entry of the k-th eigenvector. For a conjugate pair, k must be the first of the two.
    pub fn entry(&self, row: usize, k: usize) -> Complex<f64> {
        let imaginary = if self.values[k].im == 0.0 { 0.0 } else { self.vectors[(row, k + 1)] };
        Complex::new(self.vectors[(row, k)], imaginary)
    }

    /// Returns the coordinates of vectors (the columns of `of`) in the basis of eigenvectors. For a conjugate pair, the
    /// first row has the coordinate of the first eigenvector, and the second row is zero. `None` if the eigenvectors
    /// are linearly dependent.
    pub fn coordinates(&self, of: &DMatrix<f64>) -> Option<DMatrix<Complex<f64>>> {
        let (rows, columns) = of.shape();
        let mut parts = of.clone();
        PartialPivLu::new(self.vectors.as_ref()).solve_in_place(MatMut::from_column_major_slice_mut(
            parts.as_mut_slice(),
            rows,
            columns,
        ));
        let is_finite = parts.iter().all(|part| part.is_finite());
        // For a conjugate pair, a re + b im = 2 Re(z (re + i im)) with z = (a − ib)/2.
        let part = |k: usize, j: usize| match self.values[k].im {
            0.0 => Complex::new(parts[(k, j)], 0.0),
            im if im > 0.0 => Complex::new(0.5 * parts[(k, j)], -0.5 * parts[(k + 1, j)]),
            _ => Complex::new(0.0, 0.0),
        };
        is_finite.then(|| DMatrix::from_fn(rows, columns, part))
    }

    fn normalize(&mut self) {
        let count = self.values.len();
        for k in (0..count).filter(|k| self.values[*k].im >= 0.0) {
            let columns = if self.values[k].im > 0.0 { k..k + 2 } else { k..k + 1 };
            let square = |k: usize| (0..count).map(|i| self.vectors[(i, k)].powi(2)).sum::<f64>();
            let length = columns.clone().map(square).sum::<f64>().sqrt();
            columns.for_each(|k| (0..count).for_each(|i| self.vectors[(i, k)] /= length));
        }
    }
}

/// Returns the blocks of rows that are coupled by nonzero entries, each in ascending order.
pub fn coupled(matrix: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let mut open: Vec<usize> = (0..matrix.nrows()).collect();
    let mut blocks = Vec::new();
    while !open.is_empty() {
        // Starts from the first remaining row and collects all rows that are coupled to it.
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

    /// tridiag(−1, 2, −1) has the eigenvalues 4 sin²(jπ/2(n+1)), with both methods.
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

    /// A full matrix with eigenvalues from 1 to 5e7, a range typical of plates: each eigenvalue is accurate to the
    /// rounding of the largest. (Divide and conquer failed this test.)
    #[test]
    fn eigenvalues_of_a_wide_range() {
        let count = 300;
        let exact = |k: usize| 1.0 + 5e7 * (k as f64 / (count - 1) as f64).powi(3);
        let mut matrix = DMatrix::from_diagonal(&DVector::from_fn(count, |k, _| exact(k)));
        for turn in 1..=3 {
            let normal = DVector::from_fn(count, |i, _| ((i + 1) * turn) as f64).map(f64::sin).normalize();
            let mirror = DMatrix::identity(count, count) - 2.0 * &normal * normal.transpose();
            matrix = &mirror * matrix * &mirror;
        }
        matrix = 0.5 * (&matrix + matrix.transpose());
        let (values, vectors) = symmetric_eigen(matrix.clone());
        // About a hundred rounding errors for each entry.
        let rounding = 100.0 * f64::EPSILON * exact(count - 1);
        assert!(values.iter().enumerate().all(|(k, value)| (value - exact(k)).abs() < rounding), "{values}");
        assert!((&matrix * &vectors - &vectors * DMatrix::from_diagonal(&values)).amax() < rounding);
    }

    /// A V = V Λ and V V⁻¹ = 1 for a matrix with real eigenvalues and conjugate pairs.
    #[test]
    fn general_matrices_are_diagonalised() {
        let count = 12;
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            let skew = if i < j { 1.0 } else { -1.0 } / (1.0 + i.abs_diff(j) as f64);
            if i != j {
                skew
            } else if i < 6 {
                0.0
            } else {
                -5.0 * i as f64
            }
        });
        let eigen = GeneralEigen::new(&matrix).expect("eigenvalues");
        let inverse = eigen.coordinates(&DMatrix::identity(count, count)).expect("independent vectors");
        let mut sum: DMatrix<f64> = DMatrix::zeros(count, count);
        let mut product = sum.clone();
        let mut kinds = [0, 0];
        for k in (0..count).filter(|k| eigen.value(*k).im >= 0.0) {
            let counted = if eigen.value(k).im > 0.0 { 2.0 } else { 1.0 };
            kinds[counted as usize - 1] += 1;
            for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
                let part = eigen.entry(i, k) * inverse[(k, j)] * counted;
                sum[(i, j)] += part.re;
                product[(i, j)] += (part * eigen.value(k)).re;
            }
        }
        assert!(kinds[0] > 1 && kinds[1] > 1, "{kinds:?}");
        // Rounding of a matrix of norm fifty.
        assert!((sum - DMatrix::identity(count, count)).amax() < 1e-13 && (product - matrix).amax() < 1e-12);
    }

    /// BBᵀ reproduces the matrix, with as many columns as its rank. A zero matrix gives no columns.
    #[test]
    fn factors_of_a_semidefinite_matrix() {
        let rows = DMatrix::from_fn(3, 8, |i, j| ((i + 1) as f64 * (j + 2) as f64).sin());
        let matrix = rows.tr_mul(&rows);
        let factor = semidefinite_factor(&matrix);
        assert_eq!(factor.shape(), (8, 3));
        // Rounding of three terms of size one.
        assert!((&factor * factor.transpose() - matrix).amax() < 1e-14);
        assert_eq!(semidefinite_factor(&DMatrix::zeros(8, 8)).shape(), (8, 0));
    }

    /// A matrix of two blocks with interlaced rows: (BᵀX)ᵀ(BᵀX) equals XᵀAX.
    #[test]
    fn factors_of_blocks() {
        let rows =
            DMatrix::from_fn(4, 9, |i, j| if i % 2 == j % 2 { ((i + 1) as f64 * (j + 2) as f64).sin() } else { 0.0 });
        let matrix = rows.tr_mul(&rows);
        let columns = DMatrix::from_fn(9, 5, |i, j| ((2 * i + j) as f64).cos());
        let product = semidefinite_factor_times(&matrix, &columns);
        assert_eq!(product.shape(), (4, 5));
        // Rounding of about ten terms of size one.
        assert!((product.tr_mul(&product) - columns.tr_mul(&(matrix * &columns))).amax() < 1e-13);
    }

    /// A matrix of two blocks with interlaced rows: V is orthogonal and AV = VΛ.
    #[test]
    fn blocks_have_the_eigenvalues_of_all() {
        let matrix = DMatrix::from_fn(9, 9, |i, j| {
            if i % 2 == j % 2 { 1.0 / (1.0 + (i + j) as f64) + if i == j { i as f64 } else { 0.0 } } else { 0.0 }
        });
        assert_eq!(coupled(&matrix), [vec![0, 2, 4, 6, 8], vec![1, 3, 5, 7]]);
        let (values, vectors) = symmetric_eigen(matrix.clone());
        // Rounding of nine terms of size ten.
        assert!((vectors.tr_mul(&vectors) - DMatrix::identity(9, 9)).amax() < 1e-14);
        assert!((&matrix * &vectors - &vectors * DMatrix::from_diagonal(&values)).amax() < 1e-13);
    }
}
