//! Copies of a matrix: identical, with other values, or with one triangle only.

use petsc_sys as sys;

use super::pattern::Pattern;
use super::{Insert, Matrix, MatrixView, Row, type_name};
use crate::Int;
use crate::error::{Result, check, require};
use crate::text::int;

impl MatrixView {
    /// Returns a matrix of the same layout, pattern and values. Collective.
    ///
    /// # Errors
    /// If the matrix is a [`Matrix::closure`], which has no entries, or if a PETSc call fails.
    pub fn duplicate(&self) -> Result<Matrix> {
        // SAFETY: the matrix is valid.
        let name = unsafe { type_name(self.raw()) }?;
        // PETSc would give the copy the same closure.
        require(name != "shell", "an operator without entries has no copy")?;
        let mut raw = std::ptr::null_mut();
        // SAFETY: the matrix is valid; PETSc refuses one that is not assembled.
        check(unsafe { sys::MatDuplicate(self.raw(), sys::MatDuplicateOption::MAT_COPY_VALUES, &raw mut raw) })?;
        // SAFETY: the new matrix is ours.
        Ok(unsafe { Matrix::from_raw(raw, self.comm()) })
    }

    /// Returns a copy of this matrix of [`Matrix::csr`] with other values, given in the same form. Collective.
    ///
    /// # Errors
    /// If the rows on this rank do not have the pattern of the matrix, or if a PETSc call fails. The other ranks do not
    /// learn of it.
    ///
    /// # Panics
    /// If the numbers of offsets, columns and values do not fit each other.
    pub fn with_values(&self, offsets: &[Int], columns: &[Int], values: &[f64]) -> Result<Matrix> {
        self.require_assembled_aij()?;
        let mut matrix = self.duplicate()?;
        let range = matrix.row_range();
        assert_eq!((offsets.len(), columns.len()), ((range.end - range.start) as usize + 1, values.len()));
        if self.comm().size() > 1 {
            let mut present = Row::default();
            for (row, ends) in range.zip(offsets.windows(2)) {
                let own = ends[0] as usize..ends[1] as usize;
                self.row_into(row, &mut present)?;
                require(present.columns == columns[own.clone()], "the rows have not the entries of the matrix")?;
                matrix.set_values(&[row], &columns[own.clone()], &values[own], Insert::Replace)?;
            }
            matrix.assemble()?;
            return Ok(matrix);
        }
        // SAFETY: this function owns the matrix, and it is used for nothing else during the call.
        let is_same = unsafe { Pattern::of(matrix.raw()) }?.is(offsets, columns);
        require(is_same, "the rows have not the entries of the matrix")?;
        let mut array = std::ptr::null_mut();
        // SAFETY: an assembled AIJ matrix of one rank, whose values lie in the order of its rows.
        check(unsafe { sys::MatSeqAIJGetArray(matrix.raw(), &raw mut array) })?;
        // SAFETY: the array has this number of values, and the slices do not overlap.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), array, values.len()) };
        // SAFETY: the array is the one just taken.
        check(unsafe { sys::MatSeqAIJRestoreArray(matrix.raw(), &raw mut array) })?;
        Ok(matrix)
    }

    /// Returns a copy of this symmetric matrix that stores one triangle in square blocks of the given size. Its
    /// products read less than half of the memory. Collective.
    ///
    /// # Errors
    /// If the matrix is not square, assembled and AIJ, if its rows are not whole blocks, or if a PETSc call fails.
    ///
    /// # Panics
    /// If this rank's rows do not consist of such blocks.
    pub fn upper_triangle(&self, block: usize) -> Result<Matrix> {
        self.require_assembled_aij()?;
        self.require_square()?;
        let (range, size) = (self.row_range(), int(block)?);
        require(block > 0 && (range.end - range.start) % size == 0, "the rows are not whole blocks")?;
        // Block rows: column numbers and values from the diagonal on. (PETSc's own conversion takes as long as
        // assembling.)
        let (mut count, mut row) = (0, Row::default());
        for first in range.clone().step_by(block) {
            self.row_into(first, &mut row)?;
            count += block * row.columns.iter().filter(|column| **column >= first).count();
        }
        let (mut offsets, mut columns) = (vec![0], Vec::with_capacity(count / (block * block)));
        let mut values = Vec::with_capacity(count);
        let mut rows: Vec<Vec<f64>> = vec![Vec::new(); block];
        for first in range.clone().step_by(block) {
            let begin = columns.len();
            for (i, kept) in rows.iter_mut().enumerate() {
                self.row_into(first + i as Int, &mut row)?;
                let skipped = row.columns.partition_point(|column| *column < first);
                let upper = &row.columns[skipped..];
                if i == 0 {
                    columns.extend(upper.iter().step_by(block).map(|column| column / size));
                }
                let blocks = columns[begin..].iter().flat_map(|column| (0..size).map(move |j| size * column + j));
                assert!(upper.iter().copied().eq(blocks), "row {first} and the next ones are not of blocks");
                kept.clear();
                kept.extend_from_slice(&row.values[skipped..]);
            }
            for at in (0..rows[0].len()).step_by(block) {
                rows.iter().for_each(|row| values.extend_from_slice(&row[at..at + block]));
            }
            offsets.push(columns.len() as Int);
        }
        let local = (range.end - range.start) as usize;
        let matrix = Matrix::create(self.comm(), (local, local), c"sbaij")?;
        let (i, j, v) = (offsets.as_ptr(), columns.as_ptr(), values.as_ptr());
        // SAFETY: there is one offset more than block rows. The offsets lie within the columns, and each column has a
        // block of values. PETSc copies all of them, and ignores the one of the two calls that is not for the matrix's
        // type.
        check(unsafe { sys::MatSeqSBAIJSetPreallocationCSR(matrix.raw(), size, i, j, v) })?;
        // SAFETY: as above.
        check(unsafe { sys::MatMPISBAIJSetPreallocationCSR(matrix.raw(), size, i, j, v) })?;
        Ok(matrix)
    }
}
