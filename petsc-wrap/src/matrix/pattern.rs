//! Where AIJ matrices have their entries.

use petsc_sys as sys;

use super::MatrixView;
use crate::Int;
use crate::error::{Result, check, require};

/// The sequential matrices of which this rank's part of an AIJ matrix consists.
pub(super) struct Blocks<'a> {
    pub raw: Vec<sys::Mat>,
    /// Global numbers of the columns of the second one, in which other ranks' columns are.
    pub numbers: &'a [Int],
}

impl<'a> Blocks<'a> {
    pub fn of(matrix: &'a MatrixView) -> Result<Self> {
        if matrix.comm().size() == 1 {
            return Ok(Self { raw: vec![matrix.raw()], numbers: &[] });
        }
        let (mut own, mut others, mut numbers) = (std::ptr::null_mut(), std::ptr::null_mut(), std::ptr::null());
        // SAFETY: an assembled AIJ matrix of several ranks, to which the parts belong.
        check(unsafe { sys::MatMPIAIJGetSeqAIJ(matrix.raw(), &raw mut own, &raw mut others, &raw mut numbers) })?;
        let (mut rows, mut columns) = (0, 0);
        // SAFETY: the part is valid.
        check(unsafe { sys::MatGetSize(others, &raw mut rows, &raw mut columns) })?;
        let numbers = if columns == 0 {
            &[]
        } else {
            // SAFETY: PETSc numbers as many columns, anew only when it assembles.
            unsafe { std::slice::from_raw_parts(numbers, columns as usize) }
        };
        Ok(Self { raw: vec![own, others], numbers })
    }
}

/// Where a sequential AIJ matrix has its entries.
pub(super) struct Pattern<'a> {
    pub offsets: &'a [Int],
    pub columns: &'a [Int],
}

impl Pattern<'_> {
    /// Of an assembled AIJ matrix on one rank, or a part of one on several.
    ///
    /// # Safety
    /// The matrix is valid, and neither changes nor goes while this lives.
    pub unsafe fn of(matrix: sys::Mat) -> Result<Self> {
        let (mut rows, mut offsets, mut columns) = (0, std::ptr::null(), std::ptr::null());
        let (no, mut is_done) = (sys::FALSE, sys::FALSE);
        // SAFETY: the matrix is valid and the out-pointers too; from zero on, as they are, PETSc returns its own arrays.
        check(unsafe {
            sys::MatGetRowIJ(matrix, 0, no, no, &raw mut rows, &raw mut offsets, &raw mut columns, &raw mut is_done)
        })?;
        require(is_done == sys::TRUE, "PETSc does not tell the entries of this type of matrix")?;
        // SAFETY: there is an offset more than rows.
        let offsets = unsafe { std::slice::from_raw_parts(offsets, rows as usize + 1) };
        let count = offsets[rows as usize] as usize;
        let columns = if count == 0 {
            &[]
        } else {
            // SAFETY: the last offset is the number of columns.
            unsafe { std::slice::from_raw_parts(columns, count) }
        };
        Ok(Self { offsets, columns })
    }

    pub fn is(&self, offsets: &[Int], columns: &[Int]) -> bool {
        self.offsets == offsets && self.columns == columns
    }
}
