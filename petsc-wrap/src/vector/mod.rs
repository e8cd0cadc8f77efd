//! Distributed vectors.

mod entries;

use std::ops::Range;

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, check, check_indices};
use crate::layout::Layout;
use crate::matrix::Insert;
use crate::object::{Lent, Object, viewed};
use crate::text::int;

pub use entries::{ReadGuard, WriteGuard};

/// A vector distributed by contiguous ranges over the ranks of its communicator. The view [`VectorView`] has its
/// methods.
///
/// ```
/// # fn main() -> petsc_wrap::Result<()> {
/// use petsc_wrap::{Session, Vector};
///
/// let session = Session::start(&[]).expect("the first session")?;
/// let mut x = Vector::new(&session.world(), 3)?;
/// x.write()?.copy_from_slice(&[1.0, 2.0, 2.0]);
/// assert_eq!(x.norm()?, 3.0);
/// # Ok(())
/// # }
/// ```
pub struct Vector(Object<sys::_p_Vec>);

/// A [`Vector`], or one that PETSc lends to a closure: the object behind it cannot be moved, swapped or replaced.
///
/// Two vectors fit each other if they live on the same ranks and have the same number of entries on each rank. All
/// methods that take another vector return [`crate::Error::Invalid`], on all ranks, if it does not fit.
#[repr(transparent)]
pub struct VectorView([Object<sys::_p_Vec>]);

viewed!(Vector as VectorView of Object<sys::_p_Vec>);

impl Vector {
    /// Creates a vector of zeros with `local` entries on this rank. Collective.
    ///
    /// # Errors
    /// If there are more entries than PETSc's integers can count, or if a PETSc call fails.
    pub fn new(comm: &Comm, local: usize) -> Result<Self> {
        let local = int(local)?;
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::VecCreate(comm.petsc()?, &raw mut raw) })?;
        // SAFETY: the new vector is ours.
        let vector = unsafe { Self::from_raw(raw, comm) };
        // SAFETY: `raw` is a fresh vector.
        check(unsafe { sys::VecSetSizes(raw, local, sys::PETSC_DETERMINE as Int) })?;
        // SAFETY: as above; the type's name is a C string.
        check(unsafe { sys::VecSetType(raw, c"standard".as_ptr()) })?;
        Ok(vector)
    }

    /// Takes ownership of a PETSc vector.
    ///
    /// # Safety
    /// `raw` is a reference to a valid vector on `comm`, set up, of type `seq` or `mpi`, which nobody else releases.
    /// Nobody else uses the vector while this lives.
    pub unsafe fn from_raw(raw: sys::Vec, comm: &Comm) -> Self {
        // SAFETY: guaranteed by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// A vector that still belongs to another owner.
    ///
    /// # Safety
    /// Same as [`Self::from_raw`], except that the owner keeps the reference during `'a`.
    pub(crate) unsafe fn lent<'a>(raw: sys::Vec, comm: &Comm) -> Lent<'a, Self> {
        // SAFETY: guaranteed by the caller.
        Lent::new(Self(unsafe { Object::lent(raw, comm) }))
    }

    /// Destroys the object immediately. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}

impl VectorView {
    pub(crate) fn raw(&self) -> sys::Vec {
        self.inner().raw()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::Vec {
        self.raw()
    }

    /// The communicator of this object.
    pub fn comm(&self) -> &Comm {
        self.inner().comm()
    }

    /// Distribution of the entries over the ranks.
    pub(crate) fn layout(&self) -> Layout<'_> {
        let mut ranges = std::ptr::null();
        // SAFETY: the vector is valid and set up, so this cannot fail.
        unsafe { sys::VecGetOwnershipRanges(self.raw(), &raw mut ranges) };
        // SAFETY: the array of a vector's layout stays as long as the vector.
        unsafe { Layout::from_raw(self.comm(), ranges) }
    }

    /// Returns a vector of zeros with the same layout. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn duplicate(&self) -> Result<Vector> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecDuplicate(self.raw(), &raw mut raw) })?;
        // SAFETY: the new vector is ours.
        let mut vector = unsafe { Vector::from_raw(raw, self.comm()) };
        vector.fill(0.0)?;
        Ok(vector)
    }

    /// Number of entries on all ranks.
    pub fn len(&self) -> usize {
        let mut size = 0;
        // SAFETY: the vector is valid and set up, so this cannot fail.
        unsafe { sys::VecGetSize(self.raw(), &raw mut size) };
        size as usize
    }

    /// Whether the vector has no entry on any rank.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Global indices of this rank's entries.
    pub fn range(&self) -> Range<Int> {
        let (mut begin, mut end) = (0, 0);
        // SAFETY: the vector is valid and set up, so this cannot fail.
        unsafe { sys::VecGetOwnershipRange(self.raw(), &raw mut begin, &raw mut end) };
        begin..end
    }

    /// Sets every entry to the value.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn fill(&mut self, value: f64) -> Result<()> {
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecSet(self.raw(), value) })
    }

    /// self ← other.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn copy_from(&mut self, other: &VectorView) -> Result<()> {
        self.layout().require_same(other.layout())?;
        // SAFETY: both vectors are valid.
        check(unsafe { sys::VecCopy(other.raw(), self.raw()) })
    }

    /// self ← self + factor·other.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn axpy(&mut self, factor: f64, other: &VectorView) -> Result<()> {
        self.layout().require_same(other.layout())?;
        // SAFETY: both vectors are valid and, by the borrow rules, different.
        check(unsafe { sys::VecAXPY(self.raw(), factor, other.raw()) })
    }

    /// self ← factor·self + other.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn aypx(&mut self, factor: f64, other: &VectorView) -> Result<()> {
        self.layout().require_same(other.layout())?;
        // SAFETY: both vectors are valid and, by the borrow rules, different.
        check(unsafe { sys::VecAYPX(self.raw(), factor, other.raw()) })
    }

    /// self ← factor·self.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn scale(&mut self, factor: f64) -> Result<()> {
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecScale(self.raw(), factor) })
    }

    /// selfᵀother, the same on every rank. Collective.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn dot(&self, other: &VectorView) -> Result<f64> {
        self.layout().require_same(other.layout())?;
        let mut value = 0.0;
        // SAFETY: both vectors are valid.
        check(unsafe { sys::VecDot(self.raw(), other.raw(), &raw mut value) })?;
        Ok(value)
    }

    /// self ← self·other, entry by entry.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn pointwise_mult(&mut self, other: &VectorView) -> Result<()> {
        self.layout().require_same(other.layout())?;
        // SAFETY: both vectors are valid; PETSc lets the result be one of the factors.
        check(unsafe { sys::VecPointwiseMult(self.raw(), self.raw(), other.raw()) })
    }

    /// self ← self/other, entry by entry; 0 if the entry of `other` is 0.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn pointwise_divide(&mut self, other: &VectorView) -> Result<()> {
        self.layout().require_same(other.layout())?;
        // SAFETY: both vectors are valid; PETSc lets the result be the dividend.
        check(unsafe { sys::VecPointwiseDivide(self.raw(), self.raw(), other.raw()) })?;
        // In newer versions of PETSc 0/0 is 1.
        let (mut quotients, divisors) = (self.write()?, other.read()?);
        let of_zero = quotients.iter_mut().zip(divisors.iter()).filter(|(_, divisor)| **divisor == 0.0);
        of_zero.for_each(|(quotient, _)| *quotient = 0.0);
        Ok(())
    }

    /// selfᵀother for each of the others, in one reduction; the same on every rank. Collective.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn dots(&self, others: &[&VectorView]) -> Result<Vec<f64>> {
        let raw = self.raw_of(others)?;
        let mut values = vec![0.0; others.len()];
        // SAFETY: all vectors are valid, and there is one place for a value for each of them.
        check(unsafe { sys::VecMDot(self.raw(), int(raw.len())?, raw.as_ptr(), values.as_mut_ptr()) })?;
        Ok(values)
    }

    /// self ← self + Σ factor·other, in fewer passes over the memory than one [`Self::axpy`] for each.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn add_combination(&mut self, terms: &[(f64, &VectorView)]) -> Result<()> {
        let (factors, others): (Vec<f64>, Vec<&VectorView>) = terms.iter().copied().unzip();
        let mut raw = self.raw_of(&others)?;
        // SAFETY: all vectors are valid and, by the borrow rules, none is the result; there is one factor for each.
        check(unsafe { sys::VecMAXPY(self.raw(), int(raw.len())?, factors.as_ptr(), raw.as_mut_ptr()) })
    }

    /// self ← Σ factor·other; 0 without terms.
    ///
    /// # Errors
    /// If the layouts differ, or if a PETSc call fails.
    pub fn set_combination(&mut self, terms: &[(f64, &VectorView)]) -> Result<()> {
        let Some(((factor, first), others)) = terms.split_first() else { return self.fill(0.0) };
        self.layout().require_same(first.layout())?;
        // SAFETY: both vectors are valid and, by the borrow rules, different. PETSc does not read the result if its factor
        // is 0.
        check(unsafe { sys::VecAXPBY(self.raw(), *factor, 0.0, first.raw()) })?;
        self.add_combination(others)
    }

    /// Raw handles of vectors, which must have this one's layout.
    fn raw_of(&self, others: &[&VectorView]) -> Result<Vec<sys::Vec>> {
        let of_one = |other: &&VectorView| {
            self.layout().require_same(other.layout())?;
            Ok(other.raw())
        };
        others.iter().map(of_one).collect()
    }

    /// Euclidean norm. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn norm(&self) -> Result<f64> {
        self.norm_of(sys::NormType::NORM_2)
    }

    /// Largest absolute value. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn norm_max(&self) -> Result<f64> {
        self.norm_of(sys::NormType::NORM_INFINITY)
    }

    fn norm_of(&self, kind: sys::NormType) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecNorm(self.raw(), kind, &raw mut value) })?;
        Ok(value)
    }

    /// Adds to or replaces entries by global index. [`Self::assemble`] must follow.
    ///
    /// # Errors
    /// If an index is out of range, or if a PETSc call fails.
    ///
    /// # Panics
    /// If the numbers of values and indices differ.
    pub fn set_values(&mut self, indices: &[Int], values: &[f64], mode: Insert) -> Result<()> {
        assert_eq!(indices.len(), values.len());
        check_indices(indices, self.len())?;
        let n = int(indices.len())?;
        // SAFETY: both slices hold `n` entries, indices within the vector.
        check(unsafe { sys::VecSetValues(self.raw(), n, indices.as_ptr(), values.as_ptr(), mode.raw()) })
    }

    /// Sends entries to their ranks. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn assemble(&mut self) -> Result<()> {
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecAssemblyBegin(self.raw()) })?;
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecAssemblyEnd(self.raw()) })
    }

    fn local_len(&self) -> usize {
        let range = self.range();
        (range.end - range.start) as usize
    }
}
