//! The common base of all handles: a counted reference to a PETSc object, or an object that PETSc lends for a while.

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::rc::Rc;

use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{CLOSURE_ERROR, Result, check, require};

/// A reference to a PETSc object. When it is dropped, the object is put in a queue, which is emptied collectively
/// later.
pub(crate) struct Object<T> {
    raw: NonNull<T>,
    comm: Comm,
    /// Whether this handle must release the reference.
    is_owned: bool,
    /// Whether PETSc has failed inside a solve with this object. A nonlinear solver shares this with its linear solver.
    is_broken: Rc<Cell<bool>>,
}

impl<T> Object<T> {
    /// Takes ownership of one reference.
    ///
    /// # Safety
    /// `T` is the opaque struct of a PETSc class (`_p_Vec`, …), and `raw` a reference to a valid object on `comm` that
    /// nobody else releases.
    pub(crate) unsafe fn new(raw: *mut T, comm: &Comm) -> Self {
        let raw = NonNull::new(raw).expect("PETSc returned success and no object");
        Self { raw, comm: comm.clone(), is_owned: true, is_broken: Rc::default() }
    }

    /// Wraps an object that still belongs to another owner.
    ///
    /// # Safety
    /// Same as [`Self::new`], except that the owner keeps the object for as long as this handle lives.
    pub(crate) unsafe fn lent(raw: *mut T, comm: &Comm) -> Self {
        let raw = NonNull::new(raw).expect("PETSc lends an object");
        Self { raw, comm: comm.clone(), is_owned: false, is_broken: Rc::default() }
    }

    pub(crate) fn raw(&self) -> *mut T {
        self.raw.as_ptr()
    }

    pub(crate) fn comm(&self) -> &Comm {
        &self.comm
    }

    /// The object for a call of PETSc, unless PETSc has failed inside a solve with it.
    pub(crate) fn whole(&self) -> Result<*mut T> {
        require(
            !self.is_broken.get(),
            "PETSc failed in an earlier solve with this solver: it cannot be used any more",
        )?;
        Ok(self.raw())
    }

    /// Turns the return code of a solve with this object into a result.
    ///
    /// An error of PETSc's own leaves the object half changed: matrices may be exchanged, and freed memory may still be
    /// pointed to. Even its destruction can then crash. So it is never used again, and is leaked. An error of a closure
    /// comes back between PETSc's steps, where the admitted methods have nothing to undo.
    #[track_caller]
    pub(crate) fn solved(&self, code: sys::PetscErrorCode) -> Result<()> {
        self.is_broken.set(code != 0 && code != CLOSURE_ERROR);
        check(code)
    }

    /// Makes an error in a solve with this object also one of the object that lends it.
    pub(crate) fn part_of<U>(mut self, owner: &Object<U>) -> Self {
        self.is_broken = owner.is_broken.clone();
        self
    }

    /// Releases the reference immediately. Collective.
    pub(crate) fn destroy(mut self) -> Result<()> {
        if self.is_owned && !self.is_broken.get() {
            self.is_owned = false;
            let mut object: sys::PetscObject = self.raw.as_ptr().cast();
            // SAFETY: every PETSc class starts with the object header; the reference was ours, and `drop` leaves it.
            return check(unsafe { sys::PetscObjectDestroy(&raw mut object) });
        }
        Ok(())
    }
}

impl<T> Drop for Object<T> {
    fn drop(&mut self) {
        if !self.is_owned || self.is_broken.get() {
            return;
        }
        let mut object: sys::PetscObject = self.raw.as_ptr().cast();
        if self.comm.size() == 1 {
            // A single rank can destroy the object now: no other rank has to take part.
            // SAFETY: as in `destroy`. An error cannot be returned from here and is ignored.
            unsafe { sys::PetscObjectDestroy(&raw mut object) };
        } else {
            // SAFETY: as in `destroy`; this call is not collective. Its only failure is lack of memory, which leaks.
            unsafe { sys::PetscObjectDelayedDestroy(&raw mut object) };
        }
    }
}

/// An object that belongs to another owner: to a solver, or to PETSc during a callback.
///
/// It gives access to the view (`VectorView` of a `Vector`, `KspView` of a `Ksp`, …). A view cannot be moved, so the
/// object cannot be taken out or replaced by another.
pub struct Lent<'a, T> {
    object: T,
    owner: PhantomData<&'a mut ()>,
}

impl<T> Lent<'_, T> {
    /// `object` must come from [`Object::lent`], and its owner must be borrowed for as long as this lives.
    pub(crate) fn new(object: T) -> Self {
        Self { object, owner: PhantomData }
    }
}

impl<T: Deref> Deref for Lent<'_, T> {
    type Target = T::Target;

    fn deref(&self) -> &T::Target {
        &self.object
    }
}

impl<T: DerefMut> DerefMut for Lent<'_, T> {
    fn deref_mut(&mut self) -> &mut T::Target {
        &mut self.object
    }
}

/// Lets an owned class (a struct around one `$inner`) be used through its unsized view, like `String` through `str`.
///
/// A value that is not `Sized` cannot be swapped or replaced behind a `&mut`. A view is a slice of exactly one
/// `$inner`.
macro_rules! viewed {
    ($owned:ident as $view:ident of $inner:ty) => {
        impl $view {
            fn of(inner: &$inner) -> &Self {
                let slice = std::ptr::from_ref(std::slice::from_ref(inner));
                // SAFETY: the view is a transparent wrapper of such a slice.
                unsafe { &*(slice as *const Self) }
            }

            fn of_mut(inner: &mut $inner) -> &mut Self {
                let slice = std::ptr::from_mut(std::slice::from_mut(inner));
                // SAFETY: the view is a transparent wrapper of such a slice.
                unsafe { &mut *(slice as *mut Self) }
            }

            fn inner(&self) -> &$inner {
                &self.0[0]
            }
        }

        impl std::ops::Deref for $owned {
            type Target = $view;

            fn deref(&self) -> &$view {
                $view::of(&self.0)
            }
        }

        impl std::ops::DerefMut for $owned {
            fn deref_mut(&mut self) -> &mut $view {
                $view::of_mut(&mut self.0)
            }
        }
    };
}
pub(crate) use viewed;
