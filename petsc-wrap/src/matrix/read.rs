//! What is read of a matrix: rows, the diagonal, sums.

use petsc_sys as sys;

use super::MatrixView;
use crate::Int;
use crate::error::{Result, check};
use crate::vector::VectorView;

/// A copy of a row of a matrix.
///
/// A copy, since a solver may write to its matrix (`-ksp_diagonal_scale`), and PETSc has one buffer for all rows of a distributed matrix.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// Global column numbers, ascending.
    pub columns: Vec<Int>,
    /// Values, in the order of the columns.
    pub values: Vec<f64>,
}

impl MatrixView {
    /// A copy of one of this rank's rows, sorted by column.
    ///
    /// # Errors
    /// Another rank's row; a matrix that is not assembled or not AIJ; PETSc's.
    pub fn row(&self, row: Int) -> Result<Row> {
        let mut copy = Row::default();
        self.row_into(row, &mut copy)?;
        Ok(copy)
    }

    /// [`Self::row`] in the place of another, whose memory it uses again.
    ///
    /// # Errors
    /// As of [`Self::row`].
    pub fn row_into(&self, row: Int, into: &mut Row) -> Result<()> {
        self.require_assembled_aij()?;
        let (mut n, mut columns, mut values) = (0, std::ptr::null(), std::ptr::null());
        // SAFETY: the matrix is valid; PETSc refuses other ranks' rows.
        check(unsafe { sys::MatGetRow(self.raw(), row, &raw mut n, &raw mut columns, &raw mut values) })?;
        into.columns.clear();
        into.values.clear();
        if n > 0 {
            // SAFETY: PETSc's arrays have `n` entries and stay until they are restored.
            into.columns.extend_from_slice(unsafe { std::slice::from_raw_parts(columns, n as usize) });
            // SAFETY: as above.
            into.values.extend_from_slice(unsafe { std::slice::from_raw_parts(values, n as usize) });
        }
        // SAFETY: gives back what was got.
        check(unsafe { sys::MatRestoreRow(self.raw(), row, &raw mut n, &raw mut columns, &raw mut values) })
    }

    /// Square root of the sum of squares of all entries. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn norm_frobenius(&self) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatNorm(self.raw(), sys::NormType::NORM_FROBENIUS, &raw mut value) })?;
        Ok(value)
    }

    /// Copies the diagonal into a vector with the layout of the rows. Collective.
    ///
    /// # Errors
    /// A vector of another layout; a matrix that is not square, assembled and AIJ; PETSc's.
    pub fn diagonal(&self, into: &mut VectorView) -> Result<()> {
        self.require_assembled_aij()?;
        self.require_square()?;
        self.row_layout().require_same(into.layout())?;
        // SAFETY: the matrix is assembled, the vector valid and of its layout.
        check(unsafe { sys::MatGetDiagonal(self.raw(), into.raw()) })
    }

    /// Sum of the diagonal. Collective.
    ///
    /// # Errors
    /// A matrix that is not square, assembled and AIJ; PETSc's.
    pub fn trace(&self) -> Result<f64> {
        self.require_assembled_aij()?;
        self.require_square()?;
        let mut value = 0.0;
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatGetTrace(self.raw(), &raw mut value) })?;
        Ok(value)
    }

    /// Entries stored on all ranks. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn entries(&self) -> Result<u64> {
        // SAFETY: a struct of floating-point numbers, for which zero bits are a value.
        let mut info: sys::MatInfo = unsafe { std::mem::zeroed() };
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatGetInfo(self.raw(), sys::MatInfoType::MAT_GLOBAL_SUM, &raw mut info) })?;
        Ok(info.nz_used as u64)
    }
}
