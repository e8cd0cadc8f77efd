//! Access to a rank's entries of a vector as a slice.

use std::ops::{Deref, DerefMut};

use petsc_sys as sys;

use super::VectorView;
use crate::error::{Result, check};

impl VectorView {
    /// This rank's entries, read-only, until the guard is dropped.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn read(&self) -> Result<ReadGuard<'_>> {
        let mut data = std::ptr::null();
        // SAFETY: the vector is valid; the guard restores the array.
        check(unsafe { sys::VecGetArrayRead(self.raw(), &raw mut data) })?;
        let entries = match self.local_len() {
            0 => &[],
            // SAFETY: PETSc's array has `len` entries and stays while the vector lives. PETSc writes to it only in
            // calls that take the vector by `&mut`.
            len => unsafe { std::slice::from_raw_parts(data, len) },
        };
        Ok(ReadGuard { vector: self, entries })
    }

    /// This rank's entries, writable, until the guard is dropped.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn write(&mut self) -> Result<WriteGuard<'_>> {
        let mut data = std::ptr::null_mut();
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecGetArray(self.raw(), &raw mut data) })?;
        let mut restored = data;
        // The array is restored before it is written: this makes PETSc forget the norms that it knows, also if the
        // guard is leaked. Nobody can ask for a norm while the guard borrows the vector.
        // SAFETY: as above.
        check(unsafe { sys::VecRestoreArray(self.raw(), &raw mut restored) })?;
        Ok(WriteGuard(match self.local_len() {
            0 => &mut [],
            // SAFETY: the array has `len` entries. A vector of type `seq` or `mpi` keeps it, at the same place, as long
            // as it lives, and it is borrowed mutably.
            len => unsafe { std::slice::from_raw_parts_mut(data, len) },
        }))
    }
}

/// Read-only view of a rank's entries.
pub struct ReadGuard<'a> {
    vector: &'a VectorView,
    entries: &'a [f64],
}

impl Deref for ReadGuard<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        self.entries
    }
}

impl Drop for ReadGuard<'_> {
    fn drop(&mut self) {
        let mut data = self.entries.as_ptr();
        // SAFETY: the vector is valid; its entries were obtained by `read`. (PETSc does not use the pointer.)
        unsafe { sys::VecRestoreArrayRead(self.vector.raw(), &raw mut data) };
    }
}

/// Writable view of a rank's entries.
pub struct WriteGuard<'a>(&'a mut [f64]);

impl Deref for WriteGuard<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        self.0
    }
}

impl DerefMut for WriteGuard<'_> {
    fn deref_mut(&mut self) -> &mut [f64] {
        self.0
    }
}
