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
        let readers = &self.inner().readers;
        readers.set(readers.get() + 1);
        Ok(ReadGuard { vector: self, data, len: self.local_len() })
    }

    /// This rank's entries, writable, until the guard is dropped.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn write(&mut self) -> Result<WriteGuard<'_>> {
        let mut data = std::ptr::null_mut();
        // SAFETY: the vector is valid; the guard restores the array.
        check(unsafe { sys::VecGetArray(self.raw(), &raw mut data) })?;
        let len = self.local_len();
        Ok(WriteGuard { vector: self, data, len })
    }
}

/// Read-only view of a rank's entries.
pub struct ReadGuard<'a> {
    vector: &'a VectorView,
    data: *const f64,
    len: usize,
}

impl Deref for ReadGuard<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        if self.len == 0 {
            return &[];
        }
        // SAFETY: PETSc's array has `len` entries and stays until it is restored in `drop`.
        unsafe { std::slice::from_raw_parts(self.data, self.len) }
    }
}

impl Drop for ReadGuard<'_> {
    fn drop(&mut self) {
        // SAFETY: returns what `read` obtained.
        unsafe { sys::VecRestoreArrayRead(self.vector.raw(), &raw mut self.data) };
        let readers = &self.vector.inner().readers;
        readers.set(readers.get() - 1);
    }
}

/// Writable view of a rank's entries.
pub struct WriteGuard<'a> {
    vector: &'a mut VectorView,
    data: *mut f64,
    len: usize,
}

impl Deref for WriteGuard<'_> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        if self.len == 0 {
            return &[];
        }
        // SAFETY: PETSc's array has `len` entries and stays until it is restored in `drop`.
        unsafe { std::slice::from_raw_parts(self.data, self.len) }
    }
}

impl DerefMut for WriteGuard<'_> {
    fn deref_mut(&mut self) -> &mut [f64] {
        if self.len == 0 {
            return &mut [];
        }
        // SAFETY: as in `deref`; the vector is borrowed mutably.
        unsafe { std::slice::from_raw_parts_mut(self.data, self.len) }
    }
}

impl Drop for WriteGuard<'_> {
    fn drop(&mut self) {
        // SAFETY: returns what `write` obtained.
        unsafe { sys::VecRestoreArray(self.vector.raw(), &raw mut self.data) };
    }
}
