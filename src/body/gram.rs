//! Inner products of many vectors with many.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use nalgebra::{DMatrix, DVector};
use petsc_wrap::{Comm, Vector};

use crate::error::Result;

/// Entries of a vector that are multiplied at a time: as many of some dozen vectors fit into a core's cache.
const CHUNK: usize = 1024;

/// Vectors that are multiplied by an operator at a time.
const BLOCK: usize = 32;

/// Inner products: a row for each of `left`, a column for each of `right`. Collective.
///
/// All are multiplied chunk by chunk, so that each vector is read from memory once and not once for each of the others. Entries where
/// all of `right` are zero, as of the products with a matrix of supports, are passed over.
///
/// # Errors
/// PETSc's.
fn gram(comm: &Comm, left: &[Vector], right: &[Vector]) -> Result<DMatrix<f64>> {
    let rows = left.iter().map(|vector| vector.read()).collect::<petsc_wrap::Result<Vec<_>>>()?;
    let columns = right.iter().map(|vector| vector.read()).collect::<petsc_wrap::Result<Vec<_>>>()?;
    let mut here = DMatrix::zeros(left.len(), right.len());
    let length = columns.first().map_or(0, |column| column.len());
    let entries: Vec<usize> = (0..length).filter(|&i| columns.iter().any(|column| column[i] != 0.0)).collect();
    for chunk in entries.chunks(CHUNK) {
        let rows = DMatrix::from_fn(left.len(), chunk.len(), |i, k| rows[i][chunk[k]]);
        let columns = DMatrix::from_fn(chunk.len(), right.len(), |k, j| columns[j][chunk[k]]);
        here.gemm(1.0, &rows, &columns, 1.0);
    }
    let mut all = DMatrix::zeros(left.len(), right.len());
    comm.mpi().all_reduce_into(here.as_slice(), all.as_mut_slice(), SystemOperation::sum());
    Ok(all)
}

/// VᵀAV of a symmetric operator on vectors: the columns from one on, down to the diagonal. Collective.
///
/// # Errors
/// The operator's; PETSc's.
pub fn forms(
    comm: &Comm,
    vectors: &[Vector],
    first: usize,
    apply: impl Fn(&Vector, &mut Vector) -> Result<()>,
) -> Result<DMatrix<f64>> {
    let count = vectors.len();
    let mut columns = DMatrix::zeros(count, count - first);
    for begin in (first..count).step_by(BLOCK) {
        let end = count.min(begin + BLOCK);
        let mut images = Vec::with_capacity(BLOCK);
        for vector in &vectors[begin..end] {
            let mut image = vector.duplicate()?;
            apply(vector, &mut image)?;
            images.push(image);
        }
        let products = gram(comm, &vectors[..end], &images)?;
        columns.view_mut((0, begin - first), (end, end - begin)).copy_from(&products);
    }
    Ok(columns)
}

/// Linear forms on a basis, a row each. Collective.
///
/// # Errors
/// PETSc's.
pub fn forms_on(forms: &[Vector], basis: &[Vector]) -> Result<DMatrix<f64>> {
    let mut rows = DMatrix::zeros(forms.len(), basis.len());
    for (i, form) in forms.iter().enumerate() {
        rows.set_row(i, &DVector::from_vec(form.dots(basis)?).transpose());
    }
    Ok(rows)
}
