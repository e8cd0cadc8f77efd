//! The direct solver of a small symmetric positive definite matrix, of which every rank has all.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{MatMut, Side};
use petsc_wrap::{Int, Matrix, Row, Vector};

use super::Body;
use crate::error::{Error, Result};

/// A Cholesky factor.
pub struct Direct {
    factor: Llt<usize, f64>,
}

impl Direct {
    /// Factorises S(s) of a rate (1/s) of a body on one rank ([`Body::operator_at_rate`]).
    ///
    /// # Errors
    /// [`Error::Solve`] where the matrix is not positive definite; PETSc's.
    pub fn new(body: &Body, rate: f64) -> Result<Self> {
        let relaxing = body.relaxations.iter();
        let relaxing = relaxing.map(|part| (part.chain.transformed_terms(rate), &part.distortion));
        let terms: Vec<(f64, &Matrix)> = [
            Some((1.0, &body.elastic)),
            Some((rate * rate, &body.mass)),
            body.support.as_ref().map(|support| (1.0, support)),
            body.damping.as_ref().map(|damping| (rate, damping)),
        ]
        .into_iter()
        .flatten()
        .chain(relaxing)
        .collect();
        let count = body.unknowns();
        let mut is_held = vec![false; count];
        body.clamps.rows.iter().for_each(|row| is_held[*row as usize] = true);
        // The lower triangle by columns, which are the rows of the upper one.
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        let (mut sums, mut is_in, mut found) = (vec![0.0; count], vec![false; count], Vec::new());
        let mut entries = Row::default();
        for i in 0..count {
            for (factor, matrix) in &terms {
                matrix.row_into(i as Int, &mut entries)?;
                for (column, value) in entries.columns.iter().zip(&entries.values) {
                    let j = *column as usize;
                    if j < i || (j != i && (is_held[i] || is_held[j])) {
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
        let matrix = SparseColMat::new(SymbolicSparseColMat::new_checked(count, count, starts, None, rows), values);
        let factor = matrix.sp_cholesky(Side::Lower);
        let factor =
            factor.map_err(|error| Error::Solve(format!("a body's matrix has no Cholesky factor: {error:?}")))?;
        Ok(Self { factor })
    }

    /// x of A x = b.
    ///
    /// # Errors
    /// PETSc's.
    pub fn solve(&self, b: &Vector, x: &mut Vector) -> Result<()> {
        x.copy_from(b)?;
        self.solve_in_place(&mut x.write()?);
        Ok(())
    }

    /// x ← A⁻¹ x.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        let count = x.len();
        self.factor.solve_in_place(MatMut::from_column_major_slice_mut(x, count, 1));
    }
}
