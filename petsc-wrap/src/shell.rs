//! Preconditioners that are Rust closures.

use std::ffi::{CStr, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{CLOSURE_ERROR, Result, check, require};
use crate::ksp::KspView;
use crate::matrix::{Matrix, MatrixView};

/// A preconditioner B: z ← B r on this rank's entries; the arguments are r and z.
pub type Preconditioner = Box<dyn FnMut(&[f64], &mut [f64])>;

/// Makes such a closure for a matrix; returns `None` if the factorisation of the matrix fails.
type Factorise = Box<dyn FnMut(&MatrixView) -> Result<Option<Preconditioner>>>;

/// The context that PETSc passes to the functions of a preconditioner.
struct Context {
    comm: Comm,
    factorise: Option<Factorise>,
    apply: Option<Preconditioner>,
}

impl KspView {
    /// Sets the operator of the system and a closure as its preconditioner: `apply(r, z)` writes z = B r for this
    /// rank's entries. The operator may come from [`MatrixView::upper_triangle`] or
    /// [`Matrix::closure`](crate::Matrix::closure). PETSc's own preconditioners cannot use such an operator; a solve
    /// with one of them returns an error. The solver keeps the operator. It keeps the closure until another
    /// preconditioner replaces it. A panic in the closure ends the solve with an error. Collective.
    ///
    /// # Errors
    /// If the matrix is not square and assembled, or has another layout than the operator before, or if a PETSc call
    /// fails.
    pub fn set_closure(
        &mut self,
        operator: &MatrixView,
        apply: impl FnMut(&[f64], &mut [f64]) + 'static,
    ) -> Result<()> {
        self.set_shell(operator, None, Some(Box::new(apply)))
    }

    /// Same as [`Self::set_closure`], but `factorise` makes the closure from the operator. It is called before the
    /// first solve and again after each change of the operator. If it returns `None` on all ranks, the solve fails in
    /// the same way as with a failed PETSc factorisation. Collective.
    ///
    /// A closure that holds a communicator keeps the session open. In that case destroy the solver, or call
    /// [`Comm::collect_garbage`], on all ranks before the session ends.
    ///
    /// # Errors
    /// Same as [`Self::set_closure`].
    pub fn set_factorisation(
        &mut self,
        operator: &MatrixView,
        factorise: impl FnMut(&MatrixView) -> Result<Option<Preconditioner>> + 'static,
    ) -> Result<()> {
        self.set_shell(operator, Some(Box::new(factorise)), None)
    }

    fn set_shell(
        &mut self,
        operator: &MatrixView,
        factorise: Option<Factorise>,
        apply: Option<Preconditioner>,
    ) -> Result<()> {
        require(operator.is_assembled()?, "the matrix is not assembled")?;
        self.set_both(operator, operator)?;
        let pc = {
            let pc = self.pc()?.as_raw();
            // SAFETY: the preconditioner is valid; the type is a C string.
            check(unsafe { sys::PCSetType(pc, SHELL.as_ptr()) })?;
            pc
        };
        let context = Box::new(Context { comm: self.comm().clone(), factorise, apply });
        // SAFETY: the preconditioner is valid and of type shell here and below; its functions use the context that was
        // set last.
        check(unsafe { sys::PCShellSetApply(pc, Some(call)) })?;
        // SAFETY: as above.
        check(unsafe { sys::PCShellSetSetUp(pc, Some(set_up)) })?;
        // An earlier context is released here, because PETSc calls `release` only once, with the last context.
        // SAFETY: as above.
        unsafe { release(pc) };
        // SAFETY: PETSc owns the box until `release`.
        check(unsafe { sys::PCShellSetContext(pc, Box::into_raw(context).cast::<c_void>()) })?;
        // SAFETY: as above.
        check(unsafe { sys::PCShellSetDestroy(pc, Some(release)) })
    }
}

/// PETSc's type name of these preconditioners.
pub(crate) const SHELL: &CStr = c"shell";

/// Returns the context of a preconditioner; null if it has none.
///
/// # Safety
/// The preconditioner is valid and of type shell.
unsafe fn context(pc: sys::PC) -> *mut Context {
    let mut context: *mut c_void = std::ptr::null_mut();
    // SAFETY: PETSc writes a pointer to where this one points.
    unsafe { sys::PCShellGetContext(pc, (&raw mut context).cast::<c_void>()) };
    context.cast::<Context>()
}

/// Frees the context.
///
/// # Safety
/// To be called by PETSc, on a preconditioner with or without a context.
unsafe extern "C" fn release(pc: sys::PC) -> sys::PetscErrorCode {
    // SAFETY: guaranteed by the caller.
    let context = unsafe { context(pc) };
    if !context.is_null() {
        // SAFETY: the box was made in `set_shell`, and nobody else has it.
        drop(unsafe { Box::from_raw(context) });
        // SAFETY: as above.
        return unsafe { sys::PCShellSetContext(pc, std::ptr::null_mut()) };
    }
    0
}

/// Makes the closure from the current matrix.
///
/// # Safety
/// To be called by PETSc, on a preconditioner with a context, before its first solve and after a change of its matrix.
unsafe extern "C" fn set_up(pc: sys::PC) -> sys::PetscErrorCode {
    // SAFETY: guaranteed by the caller.
    let context = unsafe { context(pc) };
    if context.is_null() {
        return CLOSURE_ERROR;
    }
    // SAFETY: the box lives until `release`, and PETSc sets up and applies one preconditioner at a time.
    let Context { comm, factorise, apply } = unsafe { &mut *context };
    let Some(factorise) = factorise else { return 0 };
    let (mut operator, mut matrix) = (std::ptr::null_mut(), std::ptr::null_mut());
    // SAFETY: the preconditioner is valid here and below.
    let code = unsafe { sys::PCGetOperators(pc, &raw mut operator, &raw mut matrix) };
    if code != 0 {
        return code;
    }
    // The old closure is dropped first: there may be no memory for both.
    *apply = None;
    // SAFETY: the matrix given to `set_shell` or another of the same layout, which the preconditioner keeps during this
    // call.
    let matrix = unsafe { Matrix::lent(matrix, comm) };
    let Ok(Ok(made)) = catch_unwind(AssertUnwindSafe(|| factorise(&matrix))) else { return CLOSURE_ERROR };
    let reason = match made {
        Some(_) => sys::PCFailedReason::PC_NOERROR,
        None => sys::PCFailedReason::PC_FACTOR_NUMERIC_ZEROPIVOT,
    };
    *apply = made;
    // SAFETY: as above.
    unsafe { sys::PCSetFailedReason(pc, reason) }
}

/// Applies the closure.
///
/// # Safety
/// To be called by PETSc, on a preconditioner with a context, with two vectors of the operator's layout.
unsafe extern "C" fn call(pc: sys::PC, r: sys::Vec, z: sys::Vec) -> sys::PetscErrorCode {
    // SAFETY: guaranteed by the caller.
    let context = unsafe { context(pc) };
    // PETSc does not call the set-up again if the preconditioner was set up before it got this context.
    // SAFETY: a context is a box of `set_shell` until `release`.
    if !context.is_null() && unsafe { (*context).apply.is_none() } {
        // SAFETY: guaranteed by the caller.
        let code = unsafe { set_up(pc) };
        if code != 0 {
            return code;
        }
    }
    if r == z {
        return CLOSURE_ERROR;
    }
    // SAFETY: as above; nobody else has it while PETSc applies the preconditioner.
    let Some(Context { apply, .. }) = (unsafe { context.as_mut() }) else { return CLOSURE_ERROR };
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
            let (from, to): (&[f64], &mut [f64]) = if count > 0 {
                // SAFETY: the arrays belong to two different vectors, have this number of entries, and stay valid until
                // they are restored.
                unsafe {
                    (
                        std::slice::from_raw_parts(from, count as usize),
                        std::slice::from_raw_parts_mut(to, count as usize),
                    )
                }
            } else {
                // (The closure may communicate with the closures of other ranks.)
                Default::default()
            };
            match apply {
                Some(apply) => apply(from, to),
                // PETSc's own preconditioners do the same without a factor: the solver sees the infinite norm, and asks
                // for the reason of the failure.
                None => to.fill(f64::INFINITY),
            }
        }));
        // SAFETY: the array is the one just taken.
        code = unsafe { sys::VecRestoreArray(z, &raw mut to) };
        if outcome.is_err() {
            code = CLOSURE_ERROR;
        }
    }
    // SAFETY: the array is the one taken above.
    let restored = unsafe { sys::VecRestoreArrayRead(r, &raw mut from) };
    if code == 0 { restored } else { code }
}
