//! What every handle is: a counted reference to a PETSc object.

use std::ptr::NonNull;

use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{Result, check};

/// A reference to a PETSc object, released by a queue that is emptied collectively later.
pub(crate) struct Object<T> {
    raw: NonNull<T>,
    comm: Comm,
}

impl<T> Object<T> {
    /// Takes over one reference.
    ///
    /// `T` must be the opaque struct of a PETSc class (`_p_Vec`, …), and `raw` a reference that nobody else releases.
    pub(crate) fn new(raw: *mut T, comm: &Comm) -> Self {
        let raw = NonNull::new(raw).expect("PETSc returned success and no object");
        Self { raw, comm: comm.clone() }
    }

    /// Adds a reference to an object that PETSc lends to a callback, so that the handle may outlive the call.
    pub(crate) fn lent(raw: *mut T, comm: &Comm) -> Result<Self> {
        // SAFETY: every PETSc class starts with the object header, and the object lives at least for the call.
        check(unsafe { sys::PetscObjectReference(raw.cast()) })?;
        Ok(Self::new(raw, comm))
    }

    pub(crate) fn raw(&self) -> *mut T {
        self.raw.as_ptr()
    }

    pub(crate) fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Releases at once. Collective.
    pub(crate) fn destroy(self) -> Result<()> {
        let mut this = std::mem::ManuallyDrop::new(self);
        let mut object: sys::PetscObject = this.raw.as_ptr().cast();
        // SAFETY: every PETSc class starts with the object header; the reference is ours, and `drop` does not run.
        let released = check(unsafe { sys::PetscObjectDestroy(&raw mut object) });
        // SAFETY: `this` is not used again, so that its communicator is dropped once.
        unsafe { std::ptr::drop_in_place(&raw mut this.comm) };
        released
    }
}

impl<T> Drop for Object<T> {
    fn drop(&mut self) {
        let mut object: sys::PetscObject = self.raw.as_ptr().cast();
        if self.comm.size() == 1 {
            // Nobody to wait for.
            // SAFETY: as in `destroy`. An error has nobody to go to.
            unsafe { sys::PetscObjectDestroy(&raw mut object) };
        } else {
            // SAFETY: as in `destroy`; this call is not collective. Its only failure is lack of memory, which leaks.
            unsafe { sys::PetscObjectDelayedDestroy(&raw mut object) };
        }
    }
}
