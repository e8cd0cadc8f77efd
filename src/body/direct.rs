//! The direct solver of a small symmetric positive definite matrix, of which every rank has all.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{Llt as DenseLlt, Solve};
use faer::prelude::*;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Accum, MatMut, MatRef, Par, Side};
use nalgebra::DMatrix;
use petsc_wrap::{Int, Matrix, Row, Vector};

use super::Body;
use crate::error::{Error, Result};

/// Part of its entries that a matrix has from which on it is factorised and multiplied as a full one: splines of a high degree on few cells
/// couple nearly all unknowns, and full matrices are multiplied several times as quickly.
const FULL: f64 = 0.2;

/// Unknowns up to which that is so.
const MOST_OF_FULL: usize = 600;

/// A Cholesky factor of S(s), and K for products with many vectors.
pub struct Direct {
    factor: Factor,
    /// K of the elastic body by columns, where matrices are nearly full.
    elastic: Option<Vec<f64>>,
}

enum Factor {
    Full(DenseLlt<f64>),
    Sparse(Llt<usize, f64>),
    Single(Llt<usize, f32>),
}

/// With how many digits a sparse matrix is factorised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// All.
    Double,
    /// Half of them: a factor is read from memory once for each vector, which takes half the time then.
    Single,
}

/// Matrices with their factors in a sum, without what is held.
struct Sum<'a> {
    terms: Vec<(f64, &'a Matrix)>,
    is_held: Vec<bool>,
}

impl Direct {
    /// Factorises S(s) of a rate (1/s) of a body on one rank ([`Body::operator_at_rate`]).
    ///
    /// # Errors
    /// [`Error::Solve`] where the matrix is not positive definite; PETSc's.
    pub fn new(body: &Body, rate: f64, precision: Precision) -> Result<Self> {
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
        let sum = Sum { terms, is_held };
        let is_full = body.elastic.entries()? as f64 > FULL * (count * count) as f64;
        let none = |error: String| Error::Solve(format!("a body's matrix has no Cholesky factor: {error}"));
        if count <= MOST_OF_FULL && is_full {
            let [matrix, elastic] = sum.full()?;
            let factor = MatRef::from_column_major_slice(&matrix, count, count).llt(Side::Lower);
            let factor = Factor::Full(factor.map_err(|error| none(format!("{error:?}")))?);
            return Ok(Self { factor, elastic: Some(elastic) });
        }
        let matrix = sum.sparse()?;
        // (What single precision cannot factorise, double precision may.)
        if let (Precision::Single, Some(factor)) = (precision, single(&matrix)) {
            return Ok(Self { factor: Factor::Single(factor), elastic: None });
        }
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|error| none(format!("{error:?}")))?;
        Ok(Self { factor: Factor::Sparse(factor), elastic: None })
    }

    /// Whether its digits are those of single precision.
    pub fn is_single(&self) -> bool {
        matches!(self.factor, Factor::Single(_))
    }

    /// VᵀKV of the elastic body on vectors: the columns from one on, a row for each vector. `None` where K is not kept.
    ///
    /// # Errors
    /// PETSc's.
    pub fn elastic_forms(&self, vectors: &[Vector], first: usize) -> Result<Option<DMatrix<f64>>> {
        let (Some(elastic), Some(any)) = (&self.elastic, vectors.first()) else { return Ok(None) };
        let (rows, count) = (any.len(), vectors.len());
        let mut all = Vec::with_capacity(rows * count);
        for vector in vectors {
            all.extend_from_slice(&vector.read()?);
        }
        let (all, new) = (MatRef::from_column_major_slice(&all, rows, count), count - first);
        let (mut images, mut forms) = (DMatrix::zeros(rows, new), DMatrix::zeros(count, new));
        let elastic = MatRef::from_column_major_slice(elastic, rows, rows);
        let mut images = MatMut::from_column_major_slice_mut(images.as_mut_slice(), rows, new);
        matmul(images.rb_mut(), Accum::Replace, elastic, all.subcols(first, new), 1.0, Par::Seq);
        let into = MatMut::from_column_major_slice_mut(forms.as_mut_slice(), count, new);
        matmul(into, Accum::Replace, all.transpose(), images.rb(), 1.0, Par::Seq);
        Ok(Some(forms))
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
        let column = MatMut::from_column_major_slice_mut(x, count, 1);
        match &self.factor {
            Factor::Full(factor) => factor.solve_in_place(column),
            Factor::Sparse(factor) => factor.solve_in_place(column),
            Factor::Single(factor) => {
                // Numbers about 1 are within the range.
                let largest = x.iter().fold(f64::MIN_POSITIVE, |largest, entry| entry.abs().max(largest));
                let mut single: Vec<f32> = x.iter().map(|entry| (entry / largest) as f32).collect();
                factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut single, count, 1));
                x.iter_mut().zip(&single).for_each(|(entry, found)| *entry = largest * f64::from(*found));
            }
        }
    }
}

/// A factor in single precision, where there is one.
fn single(matrix: &SparseColMat<usize, f64>) -> Option<Llt<usize, f32>> {
    let (pattern, values) = matrix.as_ref().parts();
    let values = values.iter().map(|value| *value as f32).collect();
    SparseColMat::new(pattern.to_owned().ok()?, values).sp_cholesky(Side::Lower).ok()
}

impl Sum<'_> {
    /// The lower triangle, and the first of the terms with all of its entries, by columns.
    fn full(&self) -> Result<[Vec<f64>; 2]> {
        let count = self.is_held.len();
        let (mut sum, mut first) = (vec![0.0; count * count], vec![0.0; count * count]);
        let mut entries = Row::default();
        // Matrices are symmetric: rows are columns.
        for (i, column) in sum.chunks_exact_mut(count).enumerate() {
            for (number, (factor, matrix)) in self.terms.iter().enumerate() {
                matrix.row_into(i as Int, &mut entries)?;
                for (j, value) in entries.columns.iter().zip(&entries.values) {
                    let j = *j as usize;
                    if number == 0 {
                        first[i * count + j] = *value;
                    }
                    if j >= i && !self.is_left_out(i, j) {
                        column[j] += factor * value;
                    }
                }
            }
        }
        Ok([sum, first])
    }

    /// The lower triangle.
    fn sparse(&self) -> Result<SparseColMat<usize, f64>> {
        let count = self.is_held.len();
        // By columns, which are the rows of the upper one.
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        let (mut sums, mut is_in, mut found) = (vec![0.0; count], vec![false; count], Vec::new());
        let mut entries = Row::default();
        for i in 0..count {
            for (factor, matrix) in &self.terms {
                matrix.row_into(i as Int, &mut entries)?;
                for (column, value) in entries.columns.iter().zip(&entries.values) {
                    let j = *column as usize;
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
        let pattern = SymbolicSparseColMat::new_checked(count, count, starts, None, rows);
        Ok(SparseColMat::new(pattern, values))
    }

    /// Whether an entry couples what is held to the rest.
    fn is_left_out(&self, i: usize, j: usize) -> bool {
        j != i && (self.is_held[i] || self.is_held[j])
    }
}
