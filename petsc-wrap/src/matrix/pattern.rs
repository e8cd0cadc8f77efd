//! Patterns (places of the entries) of AIJ matrices.

use petsc_sys as sys;

use super::MatrixView;
use crate::Int;
use crate::error::{Result, check, require};

/// The sequential matrices that make up this rank's part of an AIJ matrix.
pub(super) struct Blocks<'a> {
    pub raw: Vec<sys::Mat>,
    /// Global column numbers of the second matrix, which holds the columns of other ranks.
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
            // SAFETY: PETSc has this number of column numbers, and changes them only when it assembles.
            unsafe { std::slice::from_raw_parts(numbers, columns as usize) }
        };
        Ok(Self { raw: vec![own, others], numbers })
    }
}

impl MatrixView {
    /// Returns an error, on all ranks, if a row of this square matrix has no entry on the diagonal. Collective.
    pub(crate) fn require_diagonal(&self) -> Result<()> {
        self.require_assembled_aij()?;
        let has_all = Blocks::of(self).and_then(|blocks| {
            // SAFETY: the part belongs to the matrix, which is borrowed here.
            let Pattern { offsets, columns } = unsafe { Pattern::of(blocks.raw[0]) }?;
            let mut rows = offsets.windows(2).zip(0..);
            let has =
                |(ends, row): (&[Int], Int)| columns[ends[0] as usize..ends[1] as usize].binary_search(&row).is_ok();
            require(rows.all(has), "a row of the matrix has no entry on the diagonal")
        });
        self.comm().agree(has_all)
    }
}

/// Pattern of a sequential AIJ matrix.
pub(super) struct Pattern<'a> {
    pub offsets: &'a [Int],
    pub columns: &'a [Int],
}

impl Pattern<'_> {
    /// Pattern of an assembled AIJ matrix on one rank, or of a sequential part of one on several ranks.
    ///
    /// # Safety
    /// The matrix is valid, and neither changes nor is destroyed while this lives.
    pub unsafe fn of(matrix: sys::Mat) -> Result<Self> {
        let (mut rows, mut offsets, mut columns) = (0, std::ptr::null(), std::ptr::null());
        let (no, mut is_done) = (sys::FALSE, sys::FALSE);
        // SAFETY: the matrix and the out-pointers are valid. For indices from zero and the matrix as it is stored,
        // PETSc returns its own arrays.
        check(unsafe {
            sys::MatGetRowIJ(matrix, 0, no, no, &raw mut rows, &raw mut offsets, &raw mut columns, &raw mut is_done)
        })?;
        require(is_done == sys::TRUE, "PETSc does not tell the entries of this type of matrix")?;
        // SAFETY: there is one offset more than rows.
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
