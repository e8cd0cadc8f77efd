//! Distributed sparse matrices (AIJ: compressed rows).

mod closure;
mod copy;
mod create;
mod pattern;
mod read;

use std::ops::Range;

use petsc_sys as sys;

use pattern::{Blocks, Pattern};
pub use read::Row;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, check, check_indices, require};
use crate::layout::Layout;
use crate::null_space::NullSpace;
use crate::object::{Object, viewed};
use crate::text::{from_c, int};
use crate::vector::VectorView;

/// Treatment of an entry that already has a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Insert {
    /// The values are summed.
    Add,
    /// The new value replaces the old one.
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

/// A sparse matrix distributed by rows. The view [`MatrixView`] has its methods.
///
/// ```
/// # fn main() -> petsc_wrap::Result<()> {
/// use petsc_wrap::{Matrix, Session};
///
/// let session = Session::start(&[]).expect("the first session")?;
/// // [2 −1; −1 2] on this rank alone.
/// let matrix = Matrix::csr(&session.alone(), &[0, 2, 4], &[0, 1, 0, 1], &[2.0, -1.0, -1.0, 2.0])?;
/// assert_eq!(matrix.trace()?, 4.0);
/// assert_eq!(matrix.row(1)?.values, [-1.0, 2.0]);
/// # Ok(())
/// # }
/// ```
pub struct Matrix(Object<sys::_p_Mat>);

/// A [`Matrix`], or one that PETSc lends to a closure: the object behind it cannot be moved, swapped or replaced.
#[repr(transparent)]
pub struct MatrixView([Object<sys::_p_Mat>]);

viewed!(Matrix as MatrixView of Object<sys::_p_Mat>);

impl MatrixView {
    pub(crate) fn raw(&self) -> sys::Mat {
        self.inner().raw()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::Mat {
        self.raw()
    }

    /// The communicator of this object.
    pub fn comm(&self) -> &Comm {
        self.inner().comm()
    }

    /// Distribution of the rows over the ranks.
    pub(crate) fn row_layout(&self) -> Layout<'_> {
        let mut ranges = std::ptr::null();
        // SAFETY: the matrix is valid and has its layouts, so this cannot fail.
        unsafe { sys::MatGetOwnershipRanges(self.raw(), &raw mut ranges) };
        // SAFETY: the array of a matrix's layout stays as long as the layout, which only a call on `&mut self`
        // exchanges.
        unsafe { Layout::from_raw(self.comm(), ranges) }
    }

    /// Distribution of the columns over the ranks.
    pub(crate) fn column_layout(&self) -> Layout<'_> {
        let mut ranges = std::ptr::null();
        // SAFETY: as in `row_layout`.
        unsafe { sys::MatGetOwnershipRangesColumn(self.raw(), &raw mut ranges) };
        // SAFETY: as in `row_layout`.
        unsafe { Layout::from_raw(self.comm(), ranges) }
    }

    /// Returns an error if rows and columns have different layouts.
    pub(crate) fn require_square(&self) -> Result<()> {
        self.row_layout().require_same(self.column_layout())
    }

    /// Returns an error if the matrix is not stored by rows (AIJ): PETSc would call functions that other types do not
    /// have.
    pub(crate) fn require_aij(&self) -> Result<()> {
        // SAFETY: the matrix is valid.
        let name = unsafe { type_name(self.raw()) }?;
        // An option can choose a variant, whose name begins with the same letters.
        let is_aij = ["seqaij", "mpiaij"].iter().any(|aij| name.starts_with(aij));
        require(is_aij, &format!("not for matrices of type {name:?}, only for AIJ"))
    }

    pub(crate) fn require_assembled_aij(&self) -> Result<()> {
        self.require_aij()?;
        require(self.is_assembled()?, "the matrix is not assembled")
    }

    /// Whether the matrix is assembled. Entries set since the last assembly are not part of it yet.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn is_assembled(&self) -> Result<bool> {
        let mut assembled = sys::FALSE;
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatAssembled(self.raw(), &raw mut assembled) })?;
        Ok(assembled == sys::TRUE)
    }

    /// Global numbers of rows and of columns.
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

    /// Adds or replaces a dense block (`values` by rows), on rows of any rank. [`Self::assemble`] must follow. This is
    /// `MatSetValues`.
    ///
    /// # Errors
    /// If an index is out of range, or if a PETSc call fails, e.g. for an entry without room.
    ///
    /// # Panics
    /// If the number of values is not rows × columns.
    pub fn set_values(&mut self, rows: &[Int], columns: &[Int], values: &[f64], mode: Insert) -> Result<()> {
        assert_eq!(rows.len().checked_mul(columns.len()), Some(values.len()));
        self.require_aij()?;
        let size = self.size();
        check_indices(rows, size.0)?;
        check_indices(columns, size.1)?;
        let (m, n) = (int(rows.len())?, int(columns.len())?);
        // SAFETY: the slices hold m, n and m·n entries, indices within the matrix.
        check(unsafe {
            sys::MatSetValues(self.raw(), m, rows.as_ptr(), n, columns.as_ptr(), values.as_ptr(), mode.raw())
        })
    }

    /// Sends entries to their ranks and fixes the pattern. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
    /// If the layouts differ, the matrix is not assembled, or a PETSc call fails.
    pub fn mult(&self, x: &VectorView, y: &mut VectorView) -> Result<()> {
        self.column_layout().require_same(x.layout())?;
        self.row_layout().require_same(y.layout())?;
        // SAFETY: all are valid; x and y differ by the borrow rules.
        check(unsafe { sys::MatMult(self.raw(), x.raw(), y.raw()) })
    }

    /// self ← other, both with the same pattern. Collective.
    ///
    /// # Errors
    /// If the layouts or patterns differ, a matrix is not assembled or not AIJ, or a PETSc call fails.
    pub fn copy_from(&mut self, other: &MatrixView) -> Result<()> {
        self.require_like(other)?;
        require(self.has_entries_of(other)?, "the matrices have not the same entries")?;
        // SAFETY: both are valid.
        check(unsafe { sys::MatCopy(other.raw(), self.raw(), sys::MatStructure::SAME_NONZERO_PATTERN) })
    }

    /// self ← self + factor·other; `self` must have an entry wherever `other` has one. Collective.
    ///
    /// # Errors
    /// If the layouts differ, a matrix is not assembled or not AIJ, or a PETSc call fails.
    pub fn axpy(&mut self, factor: f64, other: &MatrixView) -> Result<()> {
        self.require_like(other)?;
        let structure = sys::MatStructure::SUBSET_NONZERO_PATTERN;
        // SAFETY: both are valid and different by the borrow rules.
        check(unsafe { sys::MatAXPY(self.raw(), factor, other.raw(), structure) })
    }

    /// Returns an error if the other matrix has another layout or type, or if either is not assembled.
    fn require_like(&self, other: &Self) -> Result<()> {
        self.row_layout().require_same(other.row_layout())?;
        self.column_layout().require_same(other.column_layout())?;
        self.require_assembled_aij()?;
        other.require_assembled_aij()
    }

    /// Whether this rank's rows have their entries in the same places as the rows of `other`, an assembled AIJ matrix
    /// like this one.
    fn has_entries_of(&self, other: &Self) -> Result<bool> {
        let (mine, others) = (Blocks::of(self)?, Blocks::of(other)?);
        for (a, b) in mine.raw.into_iter().zip(others.raw) {
            // SAFETY: both belong to matrices that are borrowed here.
            let (a, b) = unsafe { (Pattern::of(a)?, Pattern::of(b)?) };
            if !a.is(b.offsets, b.columns) {
                return Ok(false);
            }
        }
        Ok(mine.numbers == others.numbers)
    }

    /// Sets rows and columns to zero, and their diagonal entries to `diagonal`. The entries stay in the pattern. Each
    /// rank may give any rows. Collective.
    ///
    /// # Errors
    /// If a row is out of range (on all ranks), the matrix is not square, assembled and AIJ, or a PETSc call fails.
    pub fn zero_rows_columns(&mut self, rows: &[Int], diagonal: f64) -> Result<()> {
        self.require_assembled_aij()?;
        self.require_square()?;
        self.comm().agree(check_indices(rows, self.size().0))?;
        self.set_option(sys::MatOption::MAT_KEEP_NONZERO_PATTERN)?;
        let (n, none) = (int(rows.len())?, std::ptr::null_mut());
        // SAFETY: the slice holds `n` rows; no vectors are given.
        check(unsafe { sys::MatZeroRowsColumns(self.raw(), n, rows.as_ptr(), diagonal, none, none) })
    }

    /// Declares that the matrix is, and stays, symmetric and positive definite, so that Cholesky's method can be used.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn declare_positive_definite(&mut self) -> Result<()> {
        self.set_option(sys::MatOption::MAT_SYMMETRIC)?;
        self.set_option(sys::MatOption::MAT_SYMMETRY_ETERNAL)?;
        self.set_option(sys::MatOption::MAT_SPD)
    }

    /// Declares that unknowns come in blocks, such as the components at a node. Copies of the matrix keep the block
    /// size. Collective.
    ///
    /// # Errors
    /// If the matrix is not AIJ, `size` is 0, or a PETSc call fails, e.g. because a rank's rows are not whole blocks.
    pub fn set_block_size(&mut self, size: usize) -> Result<()> {
        // Other types have a block size of their storage.
        self.require_aij()?;
        // PETSc divides by the size.
        require(size > 0, "blocks of nothing")?;
        let size = int(size)?;
        // SAFETY: the matrix is valid and has its layout.
        check(unsafe { sys::MatSetBlockSize(self.raw(), size) })
    }

    /// Sets the vectors that algebraic multigrid must represent on its coarse levels. Collective.
    ///
    /// # Errors
    /// If the vectors of the space have another layout than the rows, or if a PETSc call fails.
    pub fn set_near_null_space(&mut self, space: &NullSpace) -> Result<()> {
        space.require_layout(self.row_layout())?;
        // SAFETY: both are valid; PETSc counts its own references.
        check(unsafe { sys::MatSetNearNullSpace(self.raw(), space.raw()) })
    }

    fn set_option(&mut self, option: sys::MatOption) -> Result<()> {
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatSetOption(self.raw(), option, sys::TRUE) })
    }
}

/// PETSc's name of a matrix's type.
///
/// # Safety
/// The matrix is valid.
unsafe fn type_name(matrix: sys::Mat) -> Result<String> {
    let mut name = std::ptr::null();
    // SAFETY: guaranteed by the caller.
    check(unsafe { sys::MatGetType(matrix, &raw mut name) })?;
    // SAFETY: the name is static or null.
    Ok(unsafe { from_c(name) })
}
