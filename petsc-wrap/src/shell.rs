//! Preconditioners that are Rust closures.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

use petsc_sys as sys;

use crate::error::{Result, USER_ERROR, check, require};
use crate::ksp::KspView;
use crate::matrix::MatrixView;

/// z ← B r on this rank's entries; the arguments are r and z.
type Apply = Box<dyn FnMut(&[f64], &mut [f64])>;

impl KspView {
    /// Sets the operator of the system, and a closure as its preconditioner: `apply(r, z)` writes z = B r of this rank's entries. The operator
    /// may be of [`MatrixView::upper_triangle`] or [`Matrix::closure`](crate::Matrix::closure), which no preconditioner of PETSc's gets to see
    /// here; a solve with another one is refused.
    /// The solver keeps the operator, and the closure until another preconditioner takes its place. A panic in the closure ends the solve with an
    /// error. Collective.
    ///
    /// # Errors
    /// Matrices that are not square and assembled, or of another layout than the operator before; PETSc's.
    pub fn set_closure(
        &mut self,
        operator: &MatrixView,
        apply: impl FnMut(&[f64], &mut [f64]) + 'static,
    ) -> Result<()> {
        require(operator.is_assembled()?, "the matrix is not assembled")?;
        self.set_both(operator, operator)?;
        let pc = {
            let mut pc = self.pc()?;
            pc.set_type(SHELL)?;
            pc.as_raw()
        };
        let apply: Box<Apply> = Box::new(Box::new(apply));
        // SAFETY: the preconditioner is valid and of type shell here and below; its functions look at the context set last.
        check(unsafe { sys::PCShellSetApply(pc, Some(call)) })?;
        // A closure that was there before goes now: PETSc calls this once, with the last context.
        // SAFETY: as above.
        unsafe { release(pc) };
        // SAFETY: the box is PETSc's until `release`.
        check(unsafe { sys::PCShellSetContext(pc, Box::into_raw(apply).cast::<c_void>()) })?;
        // SAFETY: as above.
        check(unsafe { sys::PCShellSetDestroy(pc, Some(release)) })
    }
}

/// The type of these preconditioners.
pub(crate) const SHELL: &str = "shell";

/// The closure of a preconditioner; null where there is none.
///
/// # Safety
/// The preconditioner is valid and of type shell.
unsafe fn closure(pc: sys::PC) -> *mut Apply {
    let mut context: *mut c_void = std::ptr::null_mut();
    // SAFETY: PETSc writes a pointer to where this one points.
    unsafe { sys::PCShellGetContext(pc, (&raw mut context).cast::<c_void>()) };
    context.cast::<Apply>()
}

/// # Safety
/// For PETSc to call, on a preconditioner with a closure or none.
unsafe extern "C" fn release(pc: sys::PC) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let apply = unsafe { closure(pc) };
    if !apply.is_null() {
        // SAFETY: the box of `set_closure`, which nobody else has.
        drop(unsafe { Box::from_raw(apply) });
        // SAFETY: as above.
        return unsafe { sys::PCShellSetContext(pc, std::ptr::null_mut()) };
    }
    0
}

/// # Safety
/// For PETSc to call, on a preconditioner with a closure, with two vectors of the operator's layout.
unsafe extern "C" fn call(pc: sys::PC, r: sys::Vec, z: sys::Vec) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let apply = unsafe { closure(pc) };
    if apply.is_null() || r == z {
        return USER_ERROR;
    }
    let (mut count, mut from, mut to) = (0, std::ptr::null(), std::ptr::null_mut());
    // SAFETY: PETSc's vectors are valid here and below.
    let mut code = unsafe { sys::VecGetLocalSize(r, &raw mut count) };
    if code != 0 {
        return code;
    }
    // SAFETY: as above.
    code = unsafe { sys::VecGetArrayRead(r, &raw mut from) };
    if code != 0 {
        return code;
    }
    // SAFETY: as above.
    code = unsafe { sys::VecGetArray(z, &raw mut to) };
    if code == 0 {
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            if count > 0 {
                // SAFETY: the arrays have as many entries, of two vectors, until they are restored.
                let from = unsafe { std::slice::from_raw_parts(from, count as usize) };
                // SAFETY: as above.
                let to = unsafe { std::slice::from_raw_parts_mut(to, count as usize) };
                // SAFETY: the box lives until `release`, and PETSc applies one preconditioner at a time.
                unsafe { (*apply)(from, to) };
            }
        }));
        // SAFETY: the array is the one just taken.
        code = unsafe { sys::VecRestoreArray(z, &raw mut to) };
        if outcome.is_err() {
            code = USER_ERROR;
        }
    }
    // SAFETY: the array is the one taken above.
    let restored = unsafe { sys::VecRestoreArrayRead(r, &raw mut from) };
    if code == 0 { restored } else { code }
}
