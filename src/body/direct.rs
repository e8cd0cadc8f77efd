//! Direct solver for a small symmetric positive definite matrix that every rank stores completely.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{MatMut, MatRef, Side};
use nalgebra_sparse::CsrMatrix;

use crate::error::{Error, Result};
use crate::solve::triangle::DenseCholesky;

/// Fraction of nonzero entries above which a matrix is factorised as dense. Splines of high degree on few cells couple
/// nearly all unknowns. For solids of 700 to 1,700 unknowns, the dense factorisation takes two thirds of the
/// instructions, and each solution a quarter more.
const FULL: f64 = 0.2;

/// Largest number of unknowns for which a matrix is factorised as dense.
const MOST_OF_FULL: usize = 2000;

/// Cholesky factor of a matrix.
pub struct Direct(Factor);

enum Factor {
    Full(DenseCholesky),
    Sparse(Llt<usize, f64>),
    Single(Llt<usize, f32>),
}

/// Floating-point precision of a sparse factorisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Double precision.
    Double,
    /// Single precision. Each solution reads the whole factor from memory once, so that it takes half the time.
    Single,
}

/// A linear combination of matrices without the constrained unknowns.
struct Sum<'a> {
    terms: &'a [(f64, &'a CsrMatrix<f64>)],
    is_held: Vec<bool>,
}

impl Direct {
    /// Factorises a linear combination of matrices, without the rows and columns of the constrained unknowns (`held`).
    /// The first matrix must have the most entries.
    ///
    /// # Errors
    /// [`Error::Solve`] if the matrix is not positive definite.
    pub fn new(terms: &[(f64, &CsrMatrix<f64>)], held: &[usize], precision: Precision) -> Result<Self> {
        let (count, entries) = terms.first().map_or((0, 0), |(_, first)| (first.nrows(), first.nnz()));
        let mut is_held = vec![false; count];
        held.iter().for_each(|row| is_held[*row] = true);
        let sum = Sum { terms, is_held };
        let none = |error: String| Error::Solve(format!("a body's matrix has no Cholesky factor: {error}"));
        if count <= MOST_OF_FULL && entries as f64 > FULL * (count * count) as f64 {
            let matrix = sum.full();
            let factor = MatRef::from_column_major_slice(&matrix, count, count).llt(Side::Lower);
            let factor = factor.map_err(|error| none(format!("{error:?}")))?;
            return Ok(Self(Factor::Full(DenseCholesky::new(factor.L()))));
        }
        let matrix = sum.sparse();
        // If single precision fails, double precision may still succeed.
        if let (Precision::Single, Some(factor)) = (precision, single(&matrix)) {
            return Ok(Self(Factor::Single(factor)));
        }
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|error| none(format!("{error:?}")))?;
        Ok(Self(Factor::Sparse(factor)))
    }

    /// Whether the factor is in single precision.
    pub fn is_single(&self) -> bool {
        matches!(self.0, Factor::Single(_))
    }

    /// Computes x ← A⁻¹ x.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        let count = x.len();
        match &self.0 {
            Factor::Full(factor) => factor.solve_in_place(x),
            Factor::Sparse(factor) => factor.solve_in_place(MatMut::from_column_major_slice_mut(x, count, 1)),
            Factor::Single(factor) => {
                // Scaling the entries to about 1 keeps them in the range of single precision.
                let largest = x.iter().fold(f64::MIN_POSITIVE, |largest, entry| entry.abs().max(largest));
                let mut single: Vec<f32> = x.iter().map(|entry| (entry / largest) as f32).collect();
                factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut single, count, 1));
                x.iter_mut().zip(&single).for_each(|(entry, found)| *entry = largest * f64::from(*found));
            }
        }
    }
}

/// Returns a factor in single precision, if the factorisation succeeds.
fn single(matrix: &SparseColMat<usize, f64>) -> Option<Llt<usize, f32>> {
    let (pattern, values) = matrix.as_ref().parts();
    let values = values.iter().map(|value| *value as f32).collect();
    SparseColMat::new(pattern.to_owned().ok()?, values).sp_cholesky(Side::Lower).ok()
}

impl Sum<'_> {
    /// Returns the lower triangle by columns, in a full array.
    fn full(&self) -> Vec<f64> {
        let count = self.is_held.len();
        let mut sum = vec![0.0; count * count];
        // The matrices are symmetric: their rows are their columns.
        for (i, column) in sum.chunks_exact_mut(count).enumerate() {
            for (factor, matrix) in self.terms {
                let row = matrix.row(i);
                for (&j, value) in row.col_indices().iter().zip(row.values()) {
                    if j >= i && !self.is_left_out(i, j) {
                        column[j] += factor * value;
                    }
                }
            }
        }
        sum
    }

    /// Returns the lower triangle as a sparse matrix.
    fn sparse(&self) -> SparseColMat<usize, f64> {
        let count = self.is_held.len();
        // The columns of the lower triangle are the rows of the upper one.
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        let (mut sums, mut is_in, mut found) = (vec![0.0; count], vec![false; count], Vec::new());
        for i in 0..count {
            for (factor, matrix) in self.terms {
                let row = matrix.row(i);
                for (&j, value) in row.col_indices().iter().zip(row.values()) {
                    if j < i || self.is_left_out(i, j) {
                        continue;
                    }
                    if !std::mem::replace(&mut is_in[j], true) {
                        found.push(j);
                    }
                    sums[j] += factor * value;
                }
            }
            found.sort_unstable();
            for j in found.drain(..) {
                rows.push(j);
                values.push(sums[j]);
                (sums[j], is_in[j]) = (0.0, false);
            }
            starts.push(rows.len());
        }
        SparseColMat::new(SymbolicSparseColMat::new_checked(count, count, starts, None, rows), values)
    }

    /// Whether an entry couples a constrained unknown to another unknown.
    fn is_left_out(&self, i: usize, j: usize) -> bool {
        j != i && (self.is_held[i] || self.is_held[j])
    }
}
