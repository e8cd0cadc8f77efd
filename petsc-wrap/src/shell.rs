//! Preconditioners that are Rust closures.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{Result, USER_ERROR, check, require};
use crate::ksp::KspView;
use crate::matrix::{Matrix, MatrixView};

/// A preconditioner B: z ← B r on this rank's entries; the arguments are r and z.
pub type Preconditioner = Box<dyn FnMut(&[f64], &mut [f64])>;

/// Makes such a closure for a matrix; none where the matrix has none.
type Factorise = Box<dyn FnMut(&MatrixView) -> Result<Option<Preconditioner>>>;

/// What a preconditioner has.
struct Context {
    comm: Comm,
    factorise: Option<Factorise>,
    apply: Option<Preconditioner>,
}

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
        self.set_shell(operator, None, Some(Box::new(apply)))
    }

    /// As [`Self::set_closure`], but `factorise` makes the closure of the operator, before the first solve and again after each change of the
    /// operator. If it returns `None`, on all ranks, the solve fails like one with a factorisation of PETSc's that has failed. Collective.
    ///
    /// A closure that has a communicator holds the session open: destroy the solver, or call [`Comm::collect_garbage`], on all ranks before it ends.
    ///
    /// # Errors
    /// As of [`Self::set_closure`].
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
            let mut pc = self.pc()?;
            pc.set_type(SHELL)?;
            pc.as_raw()
        };
        let context = Box::new(Context { comm: self.comm().clone(), factorise, apply });
        // SAFETY: the preconditioner is valid and of type shell here and below; its functions look at the context set last.
        check(unsafe { sys::PCShellSetApply(pc, Some(call)) })?;
        // SAFETY: as above.
        check(unsafe { sys::PCShellSetSetUp(pc, Some(set_up)) })?;
        // A context that was there before goes now: PETSc calls this once, with the last one.
        // SAFETY: as above.
        unsafe { release(pc) };
        // SAFETY: the box is PETSc's until `release`.
        check(unsafe { sys::PCShellSetContext(pc, Box::into_raw(context).cast::<c_void>()) })?;
        // SAFETY: as above.
        check(unsafe { sys::PCShellSetDestroy(pc, Some(release)) })
    }
}

/// The type of these preconditioners.
pub(crate) const SHELL: &str = "shell";

/// The context of a preconditioner; null where there is none.
///
/// # Safety
/// The preconditioner is valid and of type shell.
unsafe fn context(pc: sys::PC) -> *mut Context {
    let mut context: *mut c_void = std::ptr::null_mut();
    // SAFETY: PETSc writes a pointer to where this one points.
    unsafe { sys::PCShellGetContext(pc, (&raw mut context).cast::<c_void>()) };
    context.cast::<Context>()
}

/// # Safety
/// For PETSc to call, on a preconditioner with a context or none.
unsafe extern "C" fn release(pc: sys::PC) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let context = unsafe { context(pc) };
    if !context.is_null() {
        // SAFETY: the box of `set_shell`, which nobody else has.
        drop(unsafe { Box::from_raw(context) });
        // SAFETY: as above.
        return unsafe { sys::PCShellSetContext(pc, std::ptr::null_mut()) };
    }
    0
}

/// # Safety
/// For PETSc to call, on a preconditioner with a context, before its first solve and where its matrix has changed.
unsafe extern "C" fn set_up(pc: sys::PC) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let context = unsafe { context(pc) };
    if context.is_null() {
        return USER_ERROR;
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
    // What was there goes first: there may be no room for both.
    *apply = None;
    // SAFETY: the matrix of `set_shell` or another of its layout, which the preconditioner keeps meanwhile.
    let matrix = unsafe { Matrix::lent(matrix, comm) };
    let Ok(Ok(made)) = catch_unwind(AssertUnwindSafe(|| factorise(&matrix))) else { return USER_ERROR };
    let reason = match made {
        Some(_) => sys::PCFailedReason::PC_NOERROR,
        None => sys::PCFailedReason::PC_FACTOR_NUMERIC_ZEROPIVOT,
    };
    *apply = made;
    // SAFETY: as above.
    unsafe { sys::PCSetFailedReason(pc, reason) }
}

/// # Safety
/// For PETSc to call, on a preconditioner with a context, with two vectors of the operator's layout.
unsafe extern "C" fn call(pc: sys::PC, r: sys::Vec, z: sys::Vec) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let context = unsafe { context(pc) };
    // PETSc does not set up again what was set up before it got this context.
    // SAFETY: a context is a box of `set_shell` until `release`.
    if !context.is_null() && unsafe { (*context).apply.is_none() } {
        // SAFETY: by the caller.
        let code = unsafe { set_up(pc) };
        if code != 0 {
            return code;
        }
    }
    if r == z {
        return USER_ERROR;
    }
    // SAFETY: as above; nobody else has it while PETSc applies the preconditioner.
    let Some(Context { apply, .. }) = (unsafe { context.as_mut() }) else { return USER_ERROR };
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
                // SAFETY: the arrays have as many entries, of two vectors, until they are restored.
                unsafe {
                    (
                        std::slice::from_raw_parts(from, count as usize),
                        std::slice::from_raw_parts_mut(to, count as usize),
                    )
                }
            } else {
                // (The closure may talk to those of other ranks.)
                Default::default()
            };
            match apply {
                Some(apply) => apply(from, to),
                // As PETSc's own without a factor: the solver sees the infinite norm, and asks what has failed.
                None => to.fill(f64::INFINITY),
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
