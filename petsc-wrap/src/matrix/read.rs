//! Reading a matrix: rows, the diagonal, sums.

use petsc_sys as sys;

use super::MatrixView;
use crate::Int;
use crate::error::{Result, check};
use crate::vector::VectorView;

/// A copy of a row of a matrix.
///
/// It is a copy because a solver may write to its matrix (`-ksp_diagonal_scale`), and because PETSc has one buffer for
/// all rows of a distributed matrix.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Row {
    /// Global column numbers, ascending.
    pub columns: Vec<Int>,
    /// Values, in the order of the columns.
    pub values: Vec<f64>,
}

impl MatrixView {
    /// Returns a copy of one of this rank's rows, sorted by column.
    ///
    /// # Errors
    /// If the row belongs to another rank, the matrix is not assembled or not AIJ, or a PETSc call fails.
    pub fn row(&self, row: Int) -> Result<Row> {
        let mut copy = Row::default();
        self.row_into(row, &mut copy)?;
        Ok(copy)
    }

    /// Same as [`Self::row`], but reuses the memory of an existing row.
    ///
    /// # Errors
    /// Same as [`Self::row`].
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
        // SAFETY: returns what was obtained above.
        check(unsafe { sys::MatRestoreRow(self.raw(), row, &raw mut n, &raw mut columns, &raw mut values) })
    }

    /// Frobenius norm: the square root of the sum of squares of all entries. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn norm_frobenius(&self) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatNorm(self.raw(), sys::NormType::NORM_FROBENIUS, &raw mut value) })?;
        Ok(value)
    }

    /// Copies the diagonal into a vector with the layout of the rows. Collective.
    ///
    /// # Errors
    /// If the vector has another layout, the matrix is not square, assembled and AIJ, or a PETSc call fails.
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
    /// If the matrix is not square, assembled and AIJ, or if a PETSc call fails.
    pub fn trace(&self) -> Result<f64> {
        self.require_assembled_aij()?;
        self.require_square()?;
        let mut value = 0.0;
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatGetTrace(self.raw(), &raw mut value) })?;
        Ok(value)
    }

    /// Number of stored entries on all ranks. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn entries(&self) -> Result<u64> {
        // SAFETY: a struct of floating-point numbers, for which all-zero bits are a valid value.
        let mut info: sys::MatInfo = unsafe { std::mem::zeroed() };
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatGetInfo(self.raw(), sys::MatInfoType::MAT_GLOBAL_SUM, &raw mut info) })?;
        Ok(info.nz_used as u64)
    }
}
