//! What every handle is: a counted reference to a PETSc object.

use std::ptr::NonNull;

use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{Result, check};

/// A reference to a PETSc object, released by a queue that is emptied collectively later.
pub(crate) struct Object<T> {
    raw: NonNull<T>,
    comm: Comm,
    /// Whether the reference is ours to release, or lent by PETSc for the time of a callback.
    owned: bool,
}

impl<T> Object<T> {
    /// Takes over one reference.
    ///
    /// `T` must be the opaque struct of a PETSc class (`_p_Vec`, …), and `raw` a reference that nobody else releases.
    pub(crate) fn new(raw: *mut T, comm: &Comm) -> Self {
        let raw = NonNull::new(raw).expect("PETSc returned success and no object");
        Self { raw, comm: comm.clone(), owned: true }
    }

    /// Uses a reference that PETSc keeps, for the time of a callback.
    pub(crate) fn lent(raw: *mut T, comm: &Comm) -> Self {
        let mut object = Self::new(raw, comm);
        object.owned = false;
        object
    }

    pub(crate) fn raw(&self) -> *mut T {
        self.raw.as_ptr()
    }

    pub(crate) fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Releases at once. Collective.
    pub(crate) fn destroy(mut self) -> Result<()> {
        let mut object: sys::PetscObject = self.raw.as_ptr().cast();
        if std::mem::take(&mut self.owned) {
            // SAFETY: every PETSc class starts with the object header; the reference was ours, and no longer is.
            check(unsafe { sys::PetscObjectDestroy(&raw mut object) })?;
        }
        Ok(())
    }
}

impl<T> Drop for Object<T> {
    fn drop(&mut self) {
        if !self.owned {
            return;
        }
        let mut object: sys::PetscObject = self.raw.as_ptr().cast();
        // SAFETY: as in `destroy`; this call is not collective. Its only failure is lack of memory, which leaks.
        unsafe { sys::PetscObjectDelayedDestroy(&raw mut object) };
    }
}
