//! C functions that PETSc calls during a solve, and which call Rust closures.

use std::any::Any;
use std::error::Error as StdError;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

use petsc_sys as sys;

use super::{CallbackResult, Progress, Snes, Trial};
use crate::comm::Comm;
use crate::error::{CLOSURE_ERROR, Result, check, require};
use crate::ksp::require_entries;
use crate::matrix::{Matrix, MatrixView};
use crate::vector::{Vector, VectorView};

/// The error or the panic that stopped a closure.
pub(super) enum Stop {
    Error(Box<dyn StdError>),
    Panic(Box<dyn Any + Send>),
}

/// Runs a closure and catches a panic, which must not reach C.
fn guard<T>(closure: impl FnOnce() -> CallbackResult<T>) -> std::result::Result<T, Stop> {
    match catch_unwind(AssertUnwindSafe(closure)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(Stop::Error(error)),
        Err(panic) => Err(Stop::Panic(panic)),
    }
}

/// The closures of a solve and the data they need, on the stack.
///
/// The line search calls back into the residual, so callbacks borrow single fields through the raw pointer, never the
/// whole struct.
pub(super) struct Context<R, J, L> {
    pub comm: Comm,
    pub residual: R,
    pub jacobian: J,
    pub search: L,
    pub stop: Option<Stop>,
}

impl<R, J, L> Context<R, J, L> {
    /// Stores the error or panic that stopped a closure, unless an earlier one is stored, and returns PETSc's error
    /// code.
    ///
    /// # Safety
    /// `this` is a solve's context, and nobody holds a reference to its field `stop`.
    unsafe fn keep(this: *mut Self, stop: Stop) -> sys::PetscErrorCode {
        // SAFETY: guaranteed by the caller.
        unsafe { (*this).stop.get_or_insert(stop) };
        CLOSURE_ERROR
    }
}

/// Installs the callbacks of a solve for as long as this lives.
pub(super) struct Callbacks<'a> {
    pub snes: &'a Snes,
}

impl Callbacks<'_> {
    pub fn set<R, J, L>(&self, matrix: sys::Mat, context: *mut Context<R, J, L>) -> Result<()>
    where
        R: FnMut(&VectorView, &mut VectorView) -> CallbackResult<()>,
        J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> CallbackResult<()>,
        L: for<'a> FnMut(&mut Trial<'a>) -> CallbackResult<f64>,
    {
        let (raw, pointer) = (self.snes.raw()?, context.cast::<c_void>());
        // SAFETY: the callbacks cast the context back to its type, and are removed before the context goes.
        check(unsafe { sys::SNESSetFunction(raw, std::ptr::null_mut(), Some(call_residual::<R, J, L>), pointer) })?;
        // SAFETY: as above.
        check(unsafe { sys::SNESSetJacobian(raw, matrix, matrix, Some(call_jacobian::<R, J, L>), pointer) })?;
        // SAFETY: as above; no effect if the line search is not of type shell.
        check(unsafe { sys::set_line_search(self.snes.line_search()?, Some(call_search::<R, J, L>), pointer) })
    }
}

impl Drop for Callbacks<'_> {
    /// Removes the callbacks. PETSc would call them later too, for example from a matrix-free Jacobian (`-snes_mf`) in
    /// a solve with the linear solver.
    fn drop(&mut self) {
        // A solver in which PETSc has failed keeps its callbacks, since nobody uses it any more.
        let (Ok(raw), none) = (self.snes.raw(), std::ptr::null_mut()) else { return };
        // SAFETY: the solver is valid here and below, and the new callbacks do not use a context.
        unsafe { sys::SNESSetFunction(raw, std::ptr::null_mut(), Some(no_residual), none) };
        // SAFETY: as above; null leaves the matrices unchanged.
        unsafe { sys::SNESSetJacobian(raw, std::ptr::null_mut(), std::ptr::null_mut(), Some(no_jacobian), none) };
        if let Ok(search) = self.snes.line_search() {
            // SAFETY: as above.
            unsafe { sys::set_line_search(search, Some(no_search), none) };
        }
    }
}

unsafe extern "C" fn no_residual(_: sys::SNES, _: sys::Vec, _: sys::Vec, _: *mut c_void) -> sys::PetscErrorCode {
    CLOSURE_ERROR
}

unsafe extern "C" fn no_jacobian(
    _: sys::SNES,
    _: sys::Vec,
    _: sys::Mat,
    _: sys::Mat,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    CLOSURE_ERROR
}

unsafe extern "C" fn no_search(_: sys::SNESLineSearch, _: *mut c_void) -> sys::PetscErrorCode {
    CLOSURE_ERROR
}

/// Returns an error if PETSc lends the same object twice, once for writing.
fn require_different<T>(a: *mut T, b: *mut T) -> Result<()> {
    require(a != b, "PETSc asks for a result in the place of an argument")
}

unsafe extern "C" fn call_residual<R, J, L>(
    snes: sys::SNES,
    x: sys::Vec,
    f: sys::Vec,
    context: *mut c_void,
) -> sys::PetscErrorCode
where
    R: FnMut(&VectorView, &mut VectorView) -> CallbackResult<()>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: `solve_with_search` passed its context of this type; the residual is not re-entered, and the communicator never written.
    let (comm, residual) = unsafe { (&(*context).comm, &mut (*context).residual) };
    let outcome = guard(|| {
        require_different(x, f)?;
        // SAFETY: PETSc keeps both during this call; only the caller uses f.
        let (x, mut f) = unsafe { (Vector::lent(x, comm), Vector::lent(f, comm)) };
        residual(&x, &mut f)?;
        let undefined = f.read()?.iter().any(|value| value.is_nan());
        Ok(undefined)
    });
    match outcome {
        Ok(false) => 0,
        // SAFETY: the solver is the one that called; PETSc turns the domain error into a reason on all ranks.
        Ok(true) => unsafe { sys::SNESSetFunctionDomainError(snes) },
        // SAFETY: no reference to `stop` is live.
        Err(stop) => unsafe { Context::keep(context, stop) },
    }
}

unsafe extern "C" fn call_jacobian<R, J, L>(
    snes: sys::SNES,
    x: sys::Vec,
    operator: sys::Mat,
    matrix: sys::Mat,
    context: *mut c_void,
) -> sys::PetscErrorCode
where
    J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> CallbackResult<()>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: as in `call_residual`.
    let (comm, jacobian) = unsafe { (&(*context).comm, &mut (*context).jacobian) };
    let outcome = guard(|| {
        // SAFETY: PETSc keeps both during this call; the borrowed solver owns the matrix.
        let (x, mut j) = unsafe { (Vector::lent(x, comm), Matrix::lent(matrix, comm)) };
        // An unchanged matrix keeps its state counter, which tells PETSc that the factorisation is still valid.
        jacobian(&x, &mut j, &mut Progress::new(snes))?;
        let mut ksp = std::ptr::null_mut();
        // SAFETY: the solver is valid during its call; the linear solver belongs to it.
        check(unsafe { sys::SNESGetKSP(snes, &raw mut ksp) })?;
        // SAFETY: as above.
        unsafe { require_entries(ksp, &j) }?;
        if operator != matrix {
            // A matrix-free operator (`-snes_mf_operator`) stores its linearisation point when it is assembled.
            let kind = sys::MatAssemblyType::MAT_FINAL_ASSEMBLY;
            // SAFETY: the operator is valid during this call, here and below.
            check(unsafe { sys::MatAssemblyBegin(operator, kind) })?;
            // SAFETY: as above.
            check(unsafe { sys::MatAssemblyEnd(operator, kind) })?;
        }
        Ok(())
    });
    match outcome {
        Ok(()) => 0,
        // SAFETY: no reference to `stop` is live.
        Err(stop) => unsafe { Context::keep(context, stop) },
    }
}

unsafe extern "C" fn call_search<R, J, L>(search: sys::SNESLineSearch, context: *mut c_void) -> sys::PetscErrorCode
where
    L: for<'a> FnMut(&mut Trial<'a>) -> CallbackResult<f64>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: as in `call_residual`, which this calls and which borrows other fields.
    let (comm, closure) = unsafe { (&(*context).comm, &mut (*context).search) };
    let outcome = guard(|| {
        // SAFETY: the line search is PETSc's, and is used during its own call.
        let mut trial = unsafe { Trial::new(search, comm) }?;
        let length = closure(&mut trial)?;
        Ok(trial.accept(length)?)
    });
    match outcome {
        Ok(()) => 0,
        // SAFETY: no reference to `stop` is live.
        Err(stop) => unsafe { Context::keep(context, stop) },
    }
}
