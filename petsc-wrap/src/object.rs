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

    pub(crate) fn raw(&self) -> *mut T {
        self.raw.as_ptr()
    }

    pub(crate) fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Releases at once. Collective.
    pub(crate) fn destroy(self) -> Result<()> {
        let this = std::mem::ManuallyDrop::new(self);
        let mut object: sys::PetscObject = this.raw.as_ptr().cast();
        // SAFETY: every PETSc class starts with the object header; the reference is ours and `Drop` does not run. The
        // communicator, moved out below, is dropped afterwards.
        let result = check(unsafe { sys::PetscObjectDestroy(&raw mut object) });
        // SAFETY: `this` is never used again, so the field is read once.
        drop(unsafe { std::ptr::read(&raw const this.comm) });
        result
    }
}

impl<T> Drop for Object<T> {
    fn drop(&mut self) {
        let mut object: sys::PetscObject = self.raw.as_ptr().cast();
        // SAFETY: as in `destroy`; this call is not collective. Its only failure is lack of memory, which leaks.
        unsafe { sys::PetscObjectDelayedDestroy(&raw mut object) };
    }
}
