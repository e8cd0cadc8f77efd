//! Creation of matrices.

use petsc_sys as sys;

use super::Matrix;
use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, check, check_indices, require};
use crate::object::{Lent, Object};
use crate::text::int;

impl Matrix {
    /// Creates an AIJ matrix without entries. `local` is the number of rows and columns of this rank. There is room for
    /// `diagonal[i]` entries of row `i` in this rank's columns and for `off_diagonal[i]` in the others'. Setting an
    /// entry without room is an error. Collective.
    ///
    /// # Errors
    /// If a count is negative (on all ranks), or if a PETSc call fails.
    ///
    /// # Panics
    /// If the numbers of counts and rows differ.
    pub fn aij(comm: &Comm, local: (usize, usize), diagonal: &[Int], off_diagonal: &[Int]) -> Result<Self> {
        assert_eq!((diagonal.len(), off_diagonal.len()), (local.0, local.0));
        let is_good = diagonal.iter().chain(off_diagonal).all(|count| *count >= 0);
        comm.agree(require(is_good, "a count of entries is negative"))?;
        let matrix = Self::create(comm, local, c"aij")?;
        // SAFETY: the slices hold one count for each local row; PETSc ignores the call that is not for the matrix's
        // type.
        check(unsafe { sys::MatSeqAIJSetPreallocation(matrix.raw(), 0, diagonal.as_ptr()) })?;
        // SAFETY: as above.
        check(unsafe { sys::MatMPIAIJSetPreallocation(matrix.raw(), 0, diagonal.as_ptr(), 0, off_diagonal.as_ptr()) })?;
        Ok(matrix)
    }

    /// Creates the assembled AIJ matrix with these rows of this rank, and the same number of columns. Row `i` has the
    /// `columns`, ascending, and `values` from `offsets[i]` to `offsets[i + 1]`. Collective.
    ///
    /// # Errors
    /// If a column is out of range, or not larger than the one before it in its row (on all ranks), or if a PETSc call
    /// fails.
    ///
    /// # Panics
    /// If the offsets do not fit the numbers of columns and values.
    pub fn csr(comm: &Comm, offsets: &[Int], columns: &[Int], values: &[f64]) -> Result<Self> {
        let rows = offsets.len().checked_sub(1).expect("an offset more than rows");
        let last = offsets[rows] as usize;
        assert!(offsets[0] == 0 && offsets.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!((last, last), (columns.len(), values.len()));
        let ascends = |ends: &[Int]| columns[ends[0] as usize..ends[1] as usize].is_sorted_by(|a, b| a < b);
        let ascending = require(offsets.windows(2).all(ascends), "the columns of a row do not ascend");
        if comm.size() == 1 {
            ascending.and_then(|()| check_indices(columns, rows))?;
            // PETSc writes new counts to this array when it assembles.
            let mut own = offsets.to_vec();
            let (i, j) = (own.as_mut_ptr(), columns.as_ptr().cast_mut());
            let (mut raw, n) = (std::ptr::null_mut(), int(rows)?);
            // SAFETY: the offsets are one more than the rows and lie within the columns and values. PETSc does not
            // write to columns and values if the rows are full. It keeps the pointers: the matrix is only copied, and
            // is destroyed before the slices go.
            check(unsafe {
                sys::MatCreateSeqAIJWithArrays(comm.petsc()?, n, n, i, j, values.as_ptr().cast_mut(), &raw mut raw)
            })?;
            // (Setting entries row by row takes many times as long.)
            // SAFETY: the new matrix is ours.
            return unsafe { Self::from_raw(raw, comm) }.duplicate();
        }
        let matrix = Self::create(comm, (rows, rows), c"aij")?;
        // SAFETY: sizes are set.
        check(unsafe { sys::MatSetUp(matrix.raw()) })?;
        comm.agree(ascending.and_then(|()| check_indices(columns, matrix.size().1)))?;
        let [i, j] = [offsets, columns].map(<[Int]>::as_ptr);
        // SAFETY: the offsets are one more than the rows and lie within the columns and values, which PETSc copies.
        check(unsafe { sys::MatMPIAIJSetPreallocationCSR(matrix.raw(), i, j, values.as_ptr()) })?;
        Ok(matrix)
    }

    /// Creates an AIJ matrix of zeros, with an entry for each pair of a row and a column given on any rank. `local` is
    /// the number of rows and columns of this rank. Pairs may be repeated, and their rows may belong to any rank.
    /// Collective.
    ///
    /// # Errors
    /// If an index is out of range (on all ranks), or if a PETSc call fails.
    ///
    /// # Panics
    /// If the numbers of rows and columns in the pairs differ.
    pub fn of_pairs(comm: &Comm, local: (usize, usize), mut rows: Vec<Int>, mut columns: Vec<Int>) -> Result<Self> {
        assert_eq!(rows.len(), columns.len());
        let mut matrix = Self::create(comm, local, c"aij")?;
        // SAFETY: sizes are set.
        check(unsafe { sys::MatSetUp(matrix.raw()) })?;
        let size = matrix.size();
        comm.agree(check_indices(&rows, size.0).and_then(|()| check_indices(&columns, size.1)))?;
        let count = int(rows.len())? as sys::PetscCount;
        // SAFETY: both hold this number of indices, within the matrix; PETSc may overwrite them, and does not keep
        // them.
        check(unsafe { sys::MatSetPreallocationCOO(matrix.raw(), count, rows.as_mut_ptr(), columns.as_mut_ptr()) })?;
        // SAFETY: the matrix has its entries.
        check(unsafe { sys::MatZeroEntries(matrix.raw()) })?;
        matrix.assemble()?;
        Ok(matrix)
    }

    pub(super) fn create(comm: &Comm, local: (usize, usize), kind: &std::ffi::CStr) -> Result<Self> {
        let (rows, columns, all) = (int(local.0)?, int(local.1)?, sys::PETSC_DETERMINE as Int);
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::MatCreate(comm.petsc()?, &raw mut raw) })?;
        // SAFETY: the new matrix is ours.
        let matrix = unsafe { Self::from_raw(raw, comm) };
        // SAFETY: a fresh matrix.
        check(unsafe { sys::MatSetSizes(raw, rows, columns, all, all) })?;
        // SAFETY: a fresh matrix and a C string.
        check(unsafe { sys::MatSetType(raw, kind.as_ptr()) })?;
        Ok(matrix)
    }

    /// Takes ownership of a PETSc matrix.
    ///
    /// # Safety
    /// `raw` is a reference to a valid matrix on `comm`, its type set and its layouts set up (`MatSetUp` or a
    /// preallocation), which nobody else releases. While this lives, nobody else uses the matrix, except for solvers of
    /// this crate.
    pub unsafe fn from_raw(raw: sys::Mat, comm: &Comm) -> Self {
        // SAFETY: guaranteed by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// A matrix that still belongs to another owner.
    ///
    /// # Safety
    /// Same as [`Self::from_raw`], except that the owner keeps the reference during `'a`.
    pub(crate) unsafe fn lent<'a>(raw: sys::Mat, comm: &Comm) -> Lent<'a, Self> {
        // SAFETY: guaranteed by the caller.
        Lent::new(Self(unsafe { Object::lent(raw, comm) }))
    }

    /// Returns the Kronecker product of this matrix with the identity of the given size, for products with vectors: one
    /// stored entry serves all components of an unknown. The product takes ownership of this matrix and uses its
    /// entries, so they cannot change any more. Collective.
    ///
    /// # Errors
    /// If the matrix is not assembled or not AIJ, if `components` is 0, if there are more rows than PETSc's integers
    /// can count, or if a PETSc call fails.
    pub fn by_component(self, components: usize) -> Result<Self> {
        self.require_assembled_aij()?;
        require(components > 0, "a product with the identity of no component")?;
        let (rows, columns) = self.size();
        // PETSc multiplies the sizes without an overflow check.
        int(rows.max(columns).saturating_mul(components))?;
        if components == 1 {
            // PETSc would return this same matrix.
            return Ok(self);
        }
        let mut raw = std::ptr::null_mut();
        // SAFETY: the matrix is valid, and PETSc counts the new one's reference to it; the out-pointer is valid.
        check(unsafe { sys::MatCreateMAIJ(self.raw(), int(components)?, &raw mut raw) })?;
        // SAFETY: a new matrix, which is ours.
        Ok(unsafe { Self::from_raw(raw, self.comm()) })
    }

    /// Destroys the object immediately. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}
