//! Distributed sparse matrices (AIJ: compressed rows).

use std::ops::Range;

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, check, check_indices};
use crate::null_space::NullSpace;
use crate::object::Object;
use crate::vector::Vector;

/// What happens to an entry that is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Insert {
    /// The values are summed.
    Add,
    /// The new value stays.
    Replace,
}

impl Insert {
    pub(crate) fn raw(self) -> sys::InsertMode {
        match self {
            Self::Add => sys::InsertMode::ADD_VALUES,
            Self::Replace => sys::InsertMode::INSERT_VALUES,
        }
    }
}

/// A sparse matrix distributed by rows.
pub struct Matrix(Object<sys::_p_Mat>);

impl Matrix {
    /// An AIJ matrix without entries, `local` = rows and columns of this rank, with room for `diagonal[i]` entries of
    /// row `i` in this rank's columns and `off_diagonal[i]` in the others'. An entry without room is an error. Collective.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// When there are not as many counts as rows.
    pub fn aij(comm: &Comm, local: (usize, usize), diagonal: &[Int], off_diagonal: &[Int]) -> Result<Self> {
        assert_eq!((diagonal.len(), off_diagonal.len()), (local.0, local.0));
        let matrix = Self::create(comm, local, c"aij")?;
        // SAFETY: the slices hold one count a local row; PETSc ignores the call that is not of the matrix's type.
        check(unsafe { sys::MatSeqAIJSetPreallocation(matrix.raw(), 0, diagonal.as_ptr()) })?;
        // SAFETY: as above.
        check(unsafe { sys::MatMPIAIJSetPreallocation(matrix.raw(), 0, diagonal.as_ptr(), 0, off_diagonal.as_ptr()) })?;
        Ok(matrix)
    }

    /// The assembled AIJ matrix with these rows of this rank, and as many columns: its row `i` has the `columns`, ascending, and `values`
    /// from `offsets[i]` to `offsets[i + 1]`. Collective.
    ///
    /// # Errors
    /// A column out of range; PETSc's.
    ///
    /// # Panics
    /// When the offsets are not those of as many columns and values.
    pub fn csr(comm: &Comm, offsets: &[Int], columns: &[Int], values: &[f64]) -> Result<Self> {
        let rows = offsets.len() - 1;
        let last = offsets[rows] as usize;
        assert!(offsets[0] == 0 && offsets.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!((last, last), (columns.len(), values.len()));
        if comm.size() == 1 {
            check_indices(columns, rows)?;
            // PETSc counts them anew when it assembles.
            let mut own = offsets.to_vec();
            let (i, j) = (own.as_mut_ptr(), columns.as_ptr().cast_mut());
            let (mut raw, n) = (std::ptr::null_mut(), rows as Int);
            // SAFETY: the offsets are one more than the rows and lie within the columns and values, through which PETSc does not write
            // where the rows are full. It keeps the pointers: the matrix is only copied from, and is gone before the slices are.
            check(unsafe {
                sys::MatCreateSeqAIJWithArrays(comm.raw(), n, n, i, j, values.as_ptr().cast_mut(), &raw mut raw)
            })?;
            // (Entries set row by row take many times as long.)
            return Self::from_raw(raw, comm).duplicate();
        }
        let matrix = Self::create(comm, (rows, rows), c"aij")?;
        // SAFETY: sizes are set.
        check(unsafe { sys::MatSetUp(matrix.raw()) })?;
        check_indices(columns, matrix.size().1)?;
        let [i, j] = [offsets, columns].map(<[Int]>::as_ptr);
        // SAFETY: the offsets are one more than the rows and lie within the columns and values, which PETSc copies.
        check(unsafe { sys::MatMPIAIJSetPreallocationCSR(matrix.raw(), i, j, values.as_ptr()) })?;
        Ok(matrix)
    }

    /// This matrix of [`Matrix::csr`] with other values in the place of its own, given as there. Collective.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// When the rows are not those of the matrix.
    pub fn with_values(&self, offsets: &[Int], columns: &[Int], values: &[f64]) -> Result<Self> {
        let mut matrix = self.duplicate()?;
        let range = matrix.row_range();
        assert_eq!((offsets.len(), columns.len()), ((range.end - range.start) as usize + 1, values.len()));
        if self.comm().size() > 1 {
            for (row, ends) in range.zip(offsets.windows(2)) {
                let own = ends[0] as usize..ends[1] as usize;
                matrix.set_values(&[row], &columns[own.clone()], &values[own], Insert::Replace)?;
            }
            matrix.assemble()?;
            return Ok(matrix);
        }
        assert_eq!(self.entries()?, values.len() as u64);
        let mut array = std::ptr::null_mut();
        // SAFETY: an assembled AIJ matrix of one rank, whose values lie in the order of its rows.
        check(unsafe { sys::MatSeqAIJGetArray(matrix.raw(), &raw mut array) })?;
        // SAFETY: it has as many values, and the slices do not overlap.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), array, values.len()) };
        // SAFETY: the array is the one just taken.
        check(unsafe { sys::MatSeqAIJRestoreArray(matrix.raw(), &raw mut array) })?;
        Ok(matrix)
    }

    /// An AIJ matrix of zeros, `local` = rows and columns of this rank, with an entry wherever some rank names its row and column;
    /// pairs may come more than once, and with any rank's rows. Collective.
    ///
    /// # Errors
    /// An index out of range; PETSc's.
    ///
    /// # Panics
    /// When there are not as many rows as columns.
    pub fn of_pairs(comm: &Comm, local: (usize, usize), mut rows: Vec<Int>, mut columns: Vec<Int>) -> Result<Self> {
        assert_eq!(rows.len(), columns.len());
        let mut matrix = Self::create(comm, local, c"aij")?;
        // SAFETY: sizes are set.
        check(unsafe { sys::MatSetUp(matrix.raw()) })?;
        let size = matrix.size();
        check_indices(&rows, size.0)?;
        check_indices(&columns, size.1)?;
        let count = rows.len() as sys::PetscCount;
        // SAFETY: both hold as many indices, within the matrix; PETSc may overwrite them, and does not keep them.
        check(unsafe { sys::MatSetPreallocationCOO(matrix.raw(), count, rows.as_mut_ptr(), columns.as_mut_ptr()) })?;
        // SAFETY: the matrix has its entries.
        check(unsafe { sys::MatZeroEntries(matrix.raw()) })?;
        matrix.assemble()?;
        Ok(matrix)
    }

    fn create(comm: &Comm, local: (usize, usize), kind: &std::ffi::CStr) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::MatCreate(comm.raw(), &raw mut raw) })?;
        let matrix = Self(Object::new(raw, comm));
        let all = sys::PETSC_DETERMINE as Int;
        // SAFETY: a fresh matrix.
        check(unsafe { sys::MatSetSizes(raw, local.0 as Int, local.1 as Int, all, all) })?;
        // SAFETY: a fresh matrix and a C string.
        check(unsafe { sys::MatSetType(raw, kind.as_ptr()) })?;
        Ok(matrix)
    }

    pub(crate) fn from_raw(raw: sys::Mat, comm: &Comm) -> Self {
        Self(Object::new(raw, comm))
    }

    pub(crate) fn lent(raw: sys::Mat, comm: &Comm) -> Result<Self> {
        Ok(Self(Object::lent(raw, comm)?))
    }

    pub(crate) fn raw(&self) -> sys::Mat {
        self.0.raw()
    }

    /// The ranks it lives on.
    pub fn comm(&self) -> &Comm {
        self.0.comm()
    }

    /// A matrix of the same layout and entries, values copied. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn duplicate(&self) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the matrix is valid and assembled.
        check(unsafe { sys::MatDuplicate(self.raw(), sys::MatDuplicateOption::MAT_COPY_VALUES, &raw mut raw) })?;
        Ok(Self(Object::new(raw, self.comm())))
    }

    /// The Kronecker product of this matrix with the identity of the given size, for products with vectors: one stored entry serves
    /// all components of an unknown. It refers to this matrix's entries. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn by_component(&self, components: usize) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the matrix is valid, and PETSc counts the new one's reference to it; the out-pointer is valid.
        check(unsafe { sys::MatCreateMAIJ(self.raw(), components as Int, &raw mut raw) })?;
        Ok(Self(Object::new(raw, self.comm())))
    }

    /// A copy of this symmetric matrix that stores one triangle by square blocks of the given size: its products read less than
    /// half of the memory. Collective.
    ///
    /// # Errors
    /// PETSc's.
    ///
    /// # Panics
    /// Where this rank's rows are not of such blocks.
    pub fn upper_triangle(&self, block: usize) -> Result<Self> {
        let (range, size) = (self.row_range(), block as Int);
        // Block rows, their numbers and values from the diagonal on. (PETSc's own conversion takes as long as assembling.)
        let mut count = 0;
        for first in range.clone().step_by(block) {
            count += block * self.row(first)?.columns().iter().filter(|column| **column >= first).count();
        }
        let (mut offsets, mut columns) = (vec![0], Vec::with_capacity(count / (block * block)));
        let mut values = Vec::with_capacity(count);
        let mut rows: Vec<Vec<f64>> = vec![Vec::new(); block];
        for first in range.clone().step_by(block) {
            let begin = columns.len();
            for (i, kept) in rows.iter_mut().enumerate() {
                let row = self.row(first + i as Int)?;
                let skipped = row.columns().partition_point(|column| *column < first);
                let upper = &row.columns()[skipped..];
                if i == 0 {
                    columns.extend(upper.iter().step_by(block).map(|column| column / size));
                }
                let blocks = columns[begin..].iter().flat_map(|column| (0..size).map(move |j| size * column + j));
                assert!(upper.iter().copied().eq(blocks), "row {first} and the next ones are not of blocks");
                kept.clear();
                kept.extend_from_slice(&row.values()[skipped..]);
            }
            for at in (0..rows[0].len()).step_by(block) {
                rows.iter().for_each(|row| values.extend_from_slice(&row[at..at + block]));
            }
            offsets.push(columns.len() as Int);
        }
        let local = (range.end - range.start) as usize;
        let matrix = Self::create(self.comm(), (local, local), c"sbaij")?;
        let (i, j, v) = (offsets.as_ptr(), columns.as_ptr(), values.as_ptr());
        // SAFETY: there is an offset more than block rows, they lie within the columns, each of which has a block of values; PETSc copies
        // them. It ignores the call that is not of the matrix's type.
        check(unsafe { sys::MatSeqSBAIJSetPreallocationCSR(matrix.raw(), size, i, j, v) })?;
        // SAFETY: as above.
        check(unsafe { sys::MatMPISBAIJSetPreallocationCSR(matrix.raw(), size, i, j, v) })?;
        Ok(matrix)
    }

    /// Global size: rows, columns.
    pub fn size(&self) -> (usize, usize) {
        let (mut rows, mut columns) = (0, 0);
        // SAFETY: the matrix is valid and has its layout, so this cannot fail.
        unsafe { sys::MatGetSize(self.raw(), &raw mut rows, &raw mut columns) };
        (rows as usize, columns as usize)
    }

    /// Global numbers of this rank's rows.
    pub fn row_range(&self) -> Range<Int> {
        let (mut begin, mut end) = (0, 0);
        // SAFETY: the matrix is valid and has its layout, so this cannot fail.
        unsafe { sys::MatGetOwnershipRange(self.raw(), &raw mut begin, &raw mut end) };
        begin..end
    }

    /// Adds or replaces a dense block (`values` by rows), on any rank's rows.
    /// [`Matrix::assemble`] must follow. This is `MatSetValues`.
    ///
    /// # Errors
    /// An index out of range; PETSc's, e.g. for an entry without room.
    ///
    /// # Panics
    /// When there are not rows × columns values.
    pub fn set_values(&mut self, rows: &[Int], columns: &[Int], values: &[f64], mode: Insert) -> Result<()> {
        assert_eq!(rows.len() * columns.len(), values.len());
        let size = self.size();
        check_indices(rows, size.0)?;
        check_indices(columns, size.1)?;
        let (m, n) = (rows.len() as Int, columns.len() as Int);
        // SAFETY: the slices hold m, n and m·n entries, indices within the matrix.
        check(unsafe {
            sys::MatSetValues(self.raw(), m, rows.as_ptr(), n, columns.as_ptr(), values.as_ptr(), mode.raw())
        })
    }

    /// Sends entries to their ranks and closes the pattern. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn assemble(&mut self) -> Result<()> {
        let kind = sys::MatAssemblyType::MAT_FINAL_ASSEMBLY;
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatAssemblyBegin(self.raw(), kind) })?;
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatAssemblyEnd(self.raw(), kind) })
    }

    /// y ← self·x. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for different layouts.
    pub fn mult(&self, x: &Vector, y: &mut Vector) -> Result<()> {
        // SAFETY: all are valid; x and y differ by the borrow rules.
        check(unsafe { sys::MatMult(self.raw(), x.raw(), y.raw()) })
    }

    /// self ← other, both with the same entries. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn copy_from(&mut self, other: &Matrix) -> Result<()> {
        // SAFETY: both are valid.
        check(unsafe { sys::MatCopy(other.raw(), self.raw(), sys::MatStructure::SAME_NONZERO_PATTERN) })
    }

    /// self ← self + factor·other; the entries of `other` must be among those of `self`. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn axpy(&mut self, factor: f64, other: &Matrix) -> Result<()> {
        let structure = sys::MatStructure::SUBSET_NONZERO_PATTERN;
        // SAFETY: both are valid and different by the borrow rules.
        check(unsafe { sys::MatAXPY(self.raw(), factor, other.raw(), structure) })
    }

    /// Sets rows and columns to zero except for `diagonal` on the diagonal; the entries stay in the pattern. Each rank
    /// may name any rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zero_rows_columns(&mut self, rows: &[Int], diagonal: f64) -> Result<()> {
        check_indices(rows, self.size().0)?;
        self.set_option(sys::MatOption::MAT_KEEP_NONZERO_PATTERN)?;
        let (n, none) = (rows.len() as Int, std::ptr::null_mut());
        // SAFETY: the slice holds `n` rows; no vectors are given.
        check(unsafe { sys::MatZeroRowsColumns(self.raw(), n, rows.as_ptr(), diagonal, none, none) })
    }

    /// Says that the matrix is, and stays, symmetric and positive definite, so that Cholesky's method applies.
    ///
    /// # Errors
    /// PETSc's.
    pub fn declare_positive_definite(&mut self) -> Result<()> {
        self.set_option(sys::MatOption::MAT_SYMMETRIC)?;
        self.set_option(sys::MatOption::MAT_SYMMETRY_ETERNAL)?;
        self.set_option(sys::MatOption::MAT_SPD)
    }

    /// Says that unknowns come in blocks, as the components at a node; copies of the matrix know it too. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. where a rank's rows are not whole blocks.
    pub fn set_block_size(&mut self, size: usize) -> Result<()> {
        // SAFETY: the matrix is valid and has its layout.
        check(unsafe { sys::MatSetBlockSize(self.raw(), size as Int) })
    }

    /// Tells algebraic multigrid which vectors it must not lose on its coarse levels. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_near_null_space(&mut self, space: &NullSpace) -> Result<()> {
        // SAFETY: both are valid; PETSc counts its own references.
        check(unsafe { sys::MatSetNearNullSpace(self.raw(), space.raw()) })
    }

    fn set_option(&mut self, option: sys::MatOption) -> Result<()> {
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatSetOption(self.raw(), option, sys::TRUE) })
    }

    /// One of this rank's rows, sorted by column.
    ///
    /// # Errors
    /// PETSc's, e.g. for another rank's row, or while another [`Row`] of this matrix lives.
    pub fn row(&self, row: Int) -> Result<Row<'_>> {
        let (mut n, mut columns, mut values) = (0, std::ptr::null(), std::ptr::null());
        // SAFETY: the matrix is valid; the guard restores.
        check(unsafe { sys::MatGetRow(self.raw(), row, &raw mut n, &raw mut columns, &raw mut values) })?;
        Ok(Row { matrix: self, row, len: n as usize, columns, values })
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
    /// PETSc's, e.g. for another layout.
    pub fn diagonal(&self, into: &mut Vector) -> Result<()> {
        // SAFETY: the matrix is assembled, the vector valid; PETSc checks the layouts.
        check(unsafe { sys::MatGetDiagonal(self.raw(), into.raw()) })
    }

    /// Sum of the diagonal. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn trace(&self) -> Result<f64> {
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

    /// Destroys it at once. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}

/// A row of a matrix.
pub struct Row<'a> {
    matrix: &'a Matrix,
    row: Int,
    len: usize,
    columns: *const Int,
    values: *const f64,
}

impl Row<'_> {
    /// Global column numbers.
    pub fn columns(&self) -> &[Int] {
        if self.len == 0 {
            return &[];
        }
        // SAFETY: PETSc's array has `len` entries and stays until it is restored in `drop`.
        unsafe { std::slice::from_raw_parts(self.columns, self.len) }
    }

    /// Values, in the order of the columns.
    pub fn values(&self) -> &[f64] {
        if self.len == 0 {
            return &[];
        }
        // SAFETY: PETSc's array has `len` entries and stays until it is restored in `drop`.
        unsafe { std::slice::from_raw_parts(self.values, self.len) }
    }
}

impl Drop for Row<'_> {
    fn drop(&mut self) {
        let mut n = self.len as Int;
        // SAFETY: gives back what `row` got.
        unsafe {
            sys::MatRestoreRow(self.matrix.raw(), self.row, &raw mut n, &raw mut self.columns, &raw mut self.values)
        };
    }
}
