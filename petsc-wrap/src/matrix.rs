//! Distributed sparse matrices (AIJ: compressed rows).

use std::ops::Range;

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, check, check_indices, require};
use crate::layout::Layout;
use crate::null_space::NullSpace;
use crate::object::{Lent, Object, viewed};
use crate::text::{from_c, int};
use crate::vector::VectorView;

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

/// A sparse matrix distributed by rows; its methods are those of [`MatrixView`].
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

/// A [`Matrix`], or one that PETSc lends to a closure: what it refers to cannot be moved, swapped or replaced.
#[repr(transparent)]
pub struct MatrixView([Object<sys::_p_Mat>]);

viewed!(Matrix as MatrixView of Object<sys::_p_Mat>);

impl Matrix {
    /// An AIJ matrix without entries, `local` = rows and columns of this rank, with room for `diagonal[i]` entries of
    /// row `i` in this rank's columns and `off_diagonal[i]` in the others'. An entry without room is an error. Collective.
    ///
    /// # Errors
    /// A negative count; PETSc's.
    ///
    /// # Panics
    /// When there are not as many counts as rows.
    pub fn aij(comm: &Comm, local: (usize, usize), diagonal: &[Int], off_diagonal: &[Int]) -> Result<Self> {
        assert_eq!((diagonal.len(), off_diagonal.len()), (local.0, local.0));
        require(diagonal.iter().chain(off_diagonal).all(|count| *count >= 0), "a count of entries is negative")?;
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
    /// A column out of range, or not beyond the one before it in its row; PETSc's.
    ///
    /// # Panics
    /// When the offsets are not those of as many columns and values.
    pub fn csr(comm: &Comm, offsets: &[Int], columns: &[Int], values: &[f64]) -> Result<Self> {
        let rows = offsets.len().checked_sub(1).expect("an offset more than rows");
        let last = offsets[rows] as usize;
        assert!(offsets[0] == 0 && offsets.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!((last, last), (columns.len(), values.len()));
        let ascends = |ends: &[Int]| columns[ends[0] as usize..ends[1] as usize].is_sorted_by(|a, b| a < b);
        require(offsets.windows(2).all(ascends), "the columns of a row do not ascend")?;
        if comm.size() == 1 {
            check_indices(columns, rows)?;
            // PETSc counts them anew when it assembles.
            let mut own = offsets.to_vec();
            let (i, j) = (own.as_mut_ptr(), columns.as_ptr().cast_mut());
            let (mut raw, n) = (std::ptr::null_mut(), int(rows)?);
            // SAFETY: the offsets are one more than the rows and lie within the columns and values, through which PETSc does not write
            // where the rows are full. It keeps the pointers: the matrix is only copied from, and is gone before the slices are.
            check(unsafe {
                sys::MatCreateSeqAIJWithArrays(comm.raw(), n, n, i, j, values.as_ptr().cast_mut(), &raw mut raw)
            })?;
            // (Entries set row by row take many times as long.)
            // SAFETY: the new matrix is ours.
            return unsafe { Self::from_raw(raw, comm) }.duplicate();
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
        let count = int(rows.len())? as sys::PetscCount;
        // SAFETY: both hold as many indices, within the matrix; PETSc may overwrite them, and does not keep them.
        check(unsafe { sys::MatSetPreallocationCOO(matrix.raw(), count, rows.as_mut_ptr(), columns.as_mut_ptr()) })?;
        // SAFETY: the matrix has its entries.
        check(unsafe { sys::MatZeroEntries(matrix.raw()) })?;
        matrix.assemble()?;
        Ok(matrix)
    }

    fn create(comm: &Comm, local: (usize, usize), kind: &std::ffi::CStr) -> Result<Self> {
        let (rows, columns, all) = (int(local.0)?, int(local.1)?, sys::PETSC_DETERMINE as Int);
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::MatCreate(comm.raw(), &raw mut raw) })?;
        // SAFETY: the new matrix is ours.
        let matrix = unsafe { Self::from_raw(raw, comm) };
        // SAFETY: a fresh matrix.
        check(unsafe { sys::MatSetSizes(raw, rows, columns, all, all) })?;
        // SAFETY: a fresh matrix and a C string.
        check(unsafe { sys::MatSetType(raw, kind.as_ptr()) })?;
        Ok(matrix)
    }

    /// Takes over a matrix of PETSc's.
    ///
    /// # Safety
    /// `raw` is a reference to a valid matrix on `comm`, its type set and its layouts set up (`MatSetUp` or a preallocation), which nobody else
    /// releases. Nobody else uses the matrix while this lives, but for solvers of this crate.
    pub unsafe fn from_raw(raw: sys::Mat, comm: &Comm) -> Self {
        // SAFETY: by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// A matrix that stays another's.
    ///
    /// # Safety
    /// As of [`Self::from_raw`], but that its owner keeps the reference during `'a`.
    pub(crate) unsafe fn lent<'a>(raw: sys::Mat, comm: &Comm) -> Lent<'a, Self> {
        // SAFETY: by the caller.
        Lent::new(Self(unsafe { Object::lent(raw, comm) }))
    }

    /// The Kronecker product of this matrix with the identity of the given size, for products with vectors: one stored entry serves
    /// all components of an unknown. It keeps this matrix's entries and takes them over, so that they stay as they are. Collective.
    ///
    /// # Errors
    /// A matrix that is not assembled or not AIJ; no component; more rows than PETSc's integers count; PETSc's.
    pub fn by_component(self, components: usize) -> Result<Self> {
        self.require_assembled_aij()?;
        require(components > 0, "a product with the identity of no component")?;
        let (rows, columns) = self.size();
        // PETSc multiplies sizes unchecked.
        int(rows.max(columns).saturating_mul(components))?;
        if components == 1 {
            // PETSc would return this very matrix.
            return Ok(self);
        }
        let mut raw = std::ptr::null_mut();
        // SAFETY: the matrix is valid, and PETSc counts the new one's reference to it; the out-pointer is valid.
        check(unsafe { sys::MatCreateMAIJ(self.raw(), int(components)?, &raw mut raw) })?;
        // SAFETY: a new matrix, which is ours.
        Ok(unsafe { Self::from_raw(raw, self.comm()) })
    }

    /// Destroys it at once. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}

impl MatrixView {
    pub(crate) fn raw(&self) -> sys::Mat {
        self.inner().raw()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::Mat {
        self.raw()
    }

    /// The ranks it lives on.
    pub fn comm(&self) -> &Comm {
        self.inner().comm()
    }

    /// Who owns which rows.
    pub(crate) fn row_layout(&self) -> Layout<'_> {
        let mut ranges = std::ptr::null();
        // SAFETY: the matrix is valid and has its layouts, so this cannot fail.
        unsafe { sys::MatGetOwnershipRanges(self.raw(), &raw mut ranges) };
        // SAFETY: the array of a matrix's layout stays as long as the layout, which only a call on `&mut self` exchanges.
        unsafe { Layout::from_raw(self.comm(), ranges) }
    }

    /// Who owns which columns.
    pub(crate) fn column_layout(&self) -> Layout<'_> {
        let mut ranges = std::ptr::null();
        // SAFETY: as in `row_layout`.
        unsafe { sys::MatGetOwnershipRangesColumn(self.raw(), &raw mut ranges) };
        // SAFETY: as in `row_layout`.
        unsafe { Layout::from_raw(self.comm(), ranges) }
    }

    /// Refuses a matrix whose rows are not laid out as its columns.
    pub(crate) fn require_square(&self) -> Result<()> {
        self.row_layout().require_same(self.column_layout())
    }

    /// Refuses a matrix whose entries are not stored by rows: PETSc calls functions that other types do not have.
    pub(crate) fn require_aij(&self) -> Result<()> {
        let mut name = std::ptr::null();
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatGetType(self.raw(), &raw mut name) })?;
        // SAFETY: the name is static or null.
        let name = unsafe { from_c(name) };
        // Variants of AIJ, chosen by an option, begin with its name.
        let is_aij = ["seqaij", "mpiaij"].iter().any(|aij| name.starts_with(aij));
        require(is_aij, &format!("not for matrices of type {name:?}, only for AIJ"))
    }

    pub(crate) fn require_assembled_aij(&self) -> Result<()> {
        self.require_aij()?;
        require(self.is_assembled()?, "the matrix is not assembled")
    }

    /// Whether it is assembled: entries set since then are not part of it yet.
    ///
    /// # Errors
    /// PETSc's.
    pub fn is_assembled(&self) -> Result<bool> {
        let mut assembled = sys::FALSE;
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatAssembled(self.raw(), &raw mut assembled) })?;
        Ok(assembled == sys::TRUE)
    }

    /// A matrix of the same layout and entries, values copied. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn duplicate(&self) -> Result<Matrix> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the matrix is valid; PETSc refuses one that is not assembled.
        check(unsafe { sys::MatDuplicate(self.raw(), sys::MatDuplicateOption::MAT_COPY_VALUES, &raw mut raw) })?;
        // SAFETY: the new matrix is ours.
        Ok(unsafe { Matrix::from_raw(raw, self.comm()) })
    }

    /// This matrix of [`Matrix::csr`] with other values in the place of its own, given as there. Collective.
    ///
    /// # Errors
    /// Rows that are not those of the matrix, of which a rank among several sees its entries only; PETSc's.
    ///
    /// # Panics
    /// When there are not as many offsets, columns and values.
    pub fn with_values(&self, offsets: &[Int], columns: &[Int], values: &[f64]) -> Result<Matrix> {
        self.require_assembled_aij()?;
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
        // SAFETY: the matrix is ours and used for nothing else meanwhile.
        let is_same = unsafe { Pattern::of(matrix.raw()) }?.is(offsets, columns);
        require(is_same, "the rows have not the entries of the matrix")?;
        let mut array = std::ptr::null_mut();
        // SAFETY: an assembled AIJ matrix of one rank, whose values lie in the order of its rows.
        check(unsafe { sys::MatSeqAIJGetArray(matrix.raw(), &raw mut array) })?;
        // SAFETY: it has as many values, and the slices do not overlap.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), array, values.len()) };
        // SAFETY: the array is the one just taken.
        check(unsafe { sys::MatSeqAIJRestoreArray(matrix.raw(), &raw mut array) })?;
        Ok(matrix)
    }

    /// A copy of this symmetric matrix that stores one triangle by square blocks of the given size: its products read less than
    /// half of the memory. Collective.
    ///
    /// # Errors
    /// A matrix that is not square, assembled and AIJ; rows that are not whole blocks; PETSc's.
    ///
    /// # Panics
    /// Where this rank's rows are not of such blocks.
    pub fn upper_triangle(&self, block: usize) -> Result<Matrix> {
        self.require_assembled_aij()?;
        self.require_square()?;
        let (range, size) = (self.row_range(), int(block)?);
        require(block > 0 && (range.end - range.start) % size == 0, "the rows are not whole blocks")?;
        // Block rows, their numbers and values from the diagonal on. (PETSc's own conversion takes as long as assembling.)
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
    /// [`Self::assemble`] must follow. This is `MatSetValues`.
    ///
    /// # Errors
    /// An index out of range; PETSc's, e.g. for an entry without room.
    ///
    /// # Panics
    /// When there are not rows × columns values.
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
    /// Layouts that differ; a matrix that is not assembled; PETSc's.
    pub fn mult(&self, x: &VectorView, y: &mut VectorView) -> Result<()> {
        self.column_layout().require_same(x.layout())?;
        self.row_layout().require_same(y.layout())?;
        // SAFETY: all are valid; x and y differ by the borrow rules.
        check(unsafe { sys::MatMult(self.raw(), x.raw(), y.raw()) })
    }

    /// self ← other, both with the same entries. Collective.
    ///
    /// # Errors
    /// Layouts or entries that differ; a matrix that is not assembled or not AIJ; PETSc's.
    pub fn copy_from(&mut self, other: &MatrixView) -> Result<()> {
        self.require_like(other)?;
        require(self.has_entries_of(other)?, "the matrices have not the same entries")?;
        // SAFETY: both are valid.
        check(unsafe { sys::MatCopy(other.raw(), self.raw(), sys::MatStructure::SAME_NONZERO_PATTERN) })
    }

    /// self ← self + factor·other; the entries of `other` must be among those of `self`. Collective.
    ///
    /// # Errors
    /// Layouts that differ; a matrix that is not assembled or not AIJ; PETSc's.
    pub fn axpy(&mut self, factor: f64, other: &MatrixView) -> Result<()> {
        self.require_like(other)?;
        let structure = sys::MatStructure::SUBSET_NONZERO_PATTERN;
        // SAFETY: both are valid and different by the borrow rules.
        check(unsafe { sys::MatAXPY(self.raw(), factor, other.raw(), structure) })
    }

    /// Refuses another layout or type, and what is not assembled.
    fn require_like(&self, other: &Self) -> Result<()> {
        self.row_layout().require_same(other.row_layout())?;
        self.column_layout().require_same(other.column_layout())?;
        self.require_assembled_aij()?;
        other.require_assembled_aij()
    }

    /// Whether this rank's rows have their entries in the same places as those of `other`, an assembled AIJ matrix like this one.
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

    /// Sets rows and columns to zero except for `diagonal` on the diagonal; the entries stay in the pattern. Each rank
    /// may name any rows. Collective.
    ///
    /// # Errors
    /// A row out of range; a matrix that is not square, assembled and AIJ; PETSc's.
    pub fn zero_rows_columns(&mut self, rows: &[Int], diagonal: f64) -> Result<()> {
        self.require_assembled_aij()?;
        self.require_square()?;
        check_indices(rows, self.size().0)?;
        self.set_option(sys::MatOption::MAT_KEEP_NONZERO_PATTERN)?;
        let (n, none) = (int(rows.len())?, std::ptr::null_mut());
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
    /// A matrix that is not AIJ; blocks of nothing; PETSc's, e.g. where a rank's rows are not whole blocks.
    pub fn set_block_size(&mut self, size: usize) -> Result<()> {
        // Other types store blocks of their own size.
        self.require_aij()?;
        // PETSc divides by it.
        require(size > 0, "blocks of nothing")?;
        let size = int(size)?;
        // SAFETY: the matrix is valid and has its layout.
        check(unsafe { sys::MatSetBlockSize(self.raw(), size) })
    }

    /// Tells algebraic multigrid which vectors it must not lose on its coarse levels. Collective.
    ///
    /// # Errors
    /// A space of vectors of another layout than that of the rows; PETSc's.
    pub fn set_near_null_space(&mut self, space: &NullSpace) -> Result<()> {
        space.require_layout(self.row_layout())?;
        // SAFETY: both are valid; PETSc counts its own references.
        check(unsafe { sys::MatSetNearNullSpace(self.raw(), space.raw()) })
    }

    fn set_option(&mut self, option: sys::MatOption) -> Result<()> {
        // SAFETY: the matrix is valid.
        check(unsafe { sys::MatSetOption(self.raw(), option, sys::TRUE) })
    }

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

/// The sequential matrices of which this rank's part of an AIJ matrix consists.
struct Blocks<'a> {
    raw: Vec<sys::Mat>,
    /// Global numbers of the columns of the second one, in which other ranks' columns are.
    numbers: &'a [Int],
}

impl<'a> Blocks<'a> {
    fn of(matrix: &'a MatrixView) -> Result<Self> {
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
struct Pattern<'a> {
    offsets: &'a [Int],
    columns: &'a [Int],
}

impl Pattern<'_> {
    /// Of an assembled AIJ matrix on one rank, or a part of one on several.
    ///
    /// # Safety
    /// The matrix is valid, and neither changes nor goes while this lives.
    unsafe fn of(matrix: sys::Mat) -> Result<Self> {
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

    fn is(&self, offsets: &[Int], columns: &[Int]) -> bool {
        self.offsets == offsets && self.columns == columns
    }
}
