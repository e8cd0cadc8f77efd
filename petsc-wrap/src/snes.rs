//! Newton's method with Rust closures.

use std::any::Any;
use std::error::Error as StdError;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Diverged, Error, Result, check, owned};
use crate::ksp::{default_to_refined_cholesky, is_refined_cholesky, reason_of};
use crate::matrix::Matrix;
use crate::object::Object;
use crate::options;
use crate::vector::Vector;

/// What a closure returns.
type Outcome<T> = std::result::Result<T, Box<dyn StdError>>;

/// A Newton solver that keeps its Jacobian matrix and linear solver from solve to solve.
///
/// The line search is a closure of the caller's unless `-snes_linesearch_type` names one of PETSc's.
pub struct Snes {
    object: Object<sys::_p_SNES>,
    jacobian: Matrix,
    /// Whether the linear solver's factor may serve more than one Jacobian.
    keep_factor: bool,
    /// Whether `-snes_atol` says when a solve has converged.
    tolerance_given: bool,
}

/// Iterations of a linear solve from which a new factor is cheaper: a factorisation costs ten solves or more.
const FEW: Int = 8;

/// What stopped a closure.
enum Stop {
    Error(Box<dyn StdError>),
    Panic(Box<dyn Any + Send>),
}

/// PETSC_ERR_USER: what PETSc gets to see of a [`Stop`].
const USER_ERROR: sys::PetscErrorCode = 83;

/// Runs a closure without letting a panic through to C.
fn guard<T>(closure: impl FnOnce() -> Outcome<T>) -> std::result::Result<T, Stop> {
    match catch_unwind(AssertUnwindSafe(closure)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(Stop::Error(error)),
        Err(panic) => Err(Stop::Panic(panic)),
    }
}

/// The closures and what they need, on the stack for a solve.
///
/// The line search calls back into the residual, so callbacks borrow single fields through the raw pointer, never all.
struct Context<R, J, L> {
    comm: Comm,
    residual: R,
    jacobian: J,
    search: L,
    keep_factor: bool,
    stop: Option<Stop>,
}

impl<R, J, L> Context<R, J, L> {
    /// Keeps what stopped a closure, unless an inner closure was stopped first, and tells PETSc.
    ///
    /// # Safety
    /// `this` is a solve's context, and nobody holds a reference to its field `stop`.
    unsafe fn keep(this: *mut Self, stop: Stop) -> sys::PetscErrorCode {
        // SAFETY: by the caller.
        unsafe { (*this).stop.get_or_insert(stop) };
        USER_ERROR
    }
}

impl Snes {
    /// A solver for a symmetric positive definite Jacobian matrix (its entries all present).
    ///
    /// By default Newton's method with linear solves to rounding: Cholesky's method by MUMPS, whose factor is kept as the
    /// preconditioner of conjugate gradients while these need but a few iterations. After a change of the matrix by rank r they need
    /// r + 1. With `-ksp_type preonly` every Jacobian is factorised. `-snes_…`, `-ksp_…` and `-pc_…` options override everything. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for unknown types among the options.
    pub fn new(comm: &Comm, jacobian: Matrix, absolute_tolerance: f64, max_iterations: usize) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::SNESCreate(comm.raw(), &raw mut raw) })?;
        let object = Object::new(raw, comm);
        // SAFETY: the solver is valid here and below; the type is a C string.
        check(unsafe { sys::SNESSetType(raw, c"newtonls".as_ptr()) })?;
        let mut search = std::ptr::null_mut();
        // SAFETY: the line search belongs to the solver.
        check(unsafe { sys::SNESGetLineSearch(raw, &raw mut search) })?;
        // SAFETY: as above.
        check(unsafe { sys::SNESLineSearchSetType(search, c"shell".as_ptr()) })?;
        let mut ksp = std::ptr::null_mut();
        // SAFETY: the linear solver belongs to the solver.
        check(unsafe { sys::SNESGetKSP(raw, &raw mut ksp) })?;
        default_to_refined_cholesky(ksp, &jacobian)?;
        let mut snes = Self { object, jacobian, keep_factor: false, tolerance_given: false };
        snes.set_tolerances(absolute_tolerance, max_iterations)?;
        // SAFETY: the matrix is valid and kept by `snes`; the callback is set by each solve.
        check(unsafe {
            sys::SNESSetJacobian(raw, snes.jacobian.raw(), snes.jacobian.raw(), None, std::ptr::null_mut())
        })?;
        // SAFETY: the solver is valid.
        check(unsafe { sys::SNESSetFromOptions(raw) })?;
        snes.tolerance_given = options::is_set(comm.session(), "-snes_atol")?;
        snes.keep_factor = is_refined_cholesky(ksp)? && !options::is_set(comm.session(), "-snes_lag_preconditioner")?;
        Ok(snes)
    }

    /// Convergence by the residual's Euclidean norm alone.
    fn set_tolerances(&self, absolute: f64, max_iterations: usize) -> Result<()> {
        let unlimited = Int::MAX;
        // SAFETY: the solver is valid.
        check(unsafe {
            sys::SNESSetTolerances(self.object.raw(), absolute, 0.0, 0.0, max_iterations as Int, unlimited)
        })
    }

    /// Sets the residual's Euclidean norm below which a solve has converged, unless `-snes_atol` does.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_absolute_tolerance(&mut self, value: f64) -> Result<()> {
        if self.tolerance_given {
            return Ok(());
        }
        let (same, count) = (f64::from(sys::PETSC_DEFAULT), sys::PETSC_DEFAULT as Int);
        // SAFETY: the solver is valid; PETSc's mark leaves the other limits as they are.
        check(unsafe { sys::SNESSetTolerances(self.object.raw(), value, same, same, count, count) })
    }

    /// The residual's Euclidean norm below which a solve has converged.
    ///
    /// # Errors
    /// PETSc's.
    pub fn absolute_tolerance(&self) -> Result<f64> {
        let (mut value, none) = (0.0, std::ptr::null_mut());
        let (raw, unasked) = (self.object.raw(), std::ptr::null_mut());
        // SAFETY: the solver is valid; null asks for nothing.
        check(unsafe { sys::SNESGetTolerances(raw, &raw mut value, none, none, unasked, unasked) })?;
        Ok(value)
    }

    /// Solves residual(x) = 0 from the given x; returns the iterations. Collective.
    ///
    /// - `residual(x, f)` writes f; a NaN in it stops the solve.
    /// - `jacobian(x, j)` writes and assembles j; where it leaves j untouched, the last factorisation is used again.
    /// - `search(trial)` chooses the step length λ of x ← x + λ·direction.
    ///
    /// # Errors
    /// [`Error::Callback`] with a closure's own error, [`Error::Diverged`], or PETSc's. A closure's panic is resumed.
    pub fn solve<R, J, L>(&mut self, x: &mut Vector, residual: R, jacobian: J, search: L) -> Result<usize>
    where
        R: FnMut(&Vector, &mut Vector) -> Outcome<()>,
        J: FnMut(&Vector, &mut Matrix) -> Outcome<()>,
        L: FnMut(&mut Trial) -> Outcome<f64>,
    {
        let comm = self.object.comm().clone();
        let mut context = Context { comm, residual, jacobian, search, keep_factor: self.keep_factor, stop: None };
        match self.attempt(x, &mut context) {
            // A factor kept from another Jacobian was no help: on from here with a new one for each.
            Err(Error::Diverged(failure)) if self.keep_factor && self.linear_solve_failed()? => {
                context.keep_factor = false;
                // SAFETY: the solver is valid.
                check(unsafe { sys::SNESSetLagPreconditioner(self.object.raw(), 1) })?;
                Ok(failure.iterations + self.attempt(x, &mut context)?)
            }
            outcome => outcome,
        }
    }

    fn attempt<R, J, L>(&self, x: &mut Vector, context: &mut Context<R, J, L>) -> Result<usize>
    where
        R: FnMut(&Vector, &mut Vector) -> Outcome<()>,
        J: FnMut(&Vector, &mut Matrix) -> Outcome<()>,
        L: FnMut(&mut Trial) -> Outcome<f64>,
    {
        let (raw, jacobian_raw) = (self.object.raw(), self.jacobian.raw());
        let pointer = std::ptr::from_mut(context).cast::<c_void>();
        // SAFETY: the callbacks are called during SNESSolve only, while `context` lives, and cast it back to its type.
        check(unsafe { sys::SNESSetFunction(raw, std::ptr::null_mut(), Some(call_residual::<R, J, L>), pointer) })?;
        // SAFETY: as above.
        check(unsafe {
            sys::SNESSetJacobian(raw, jacobian_raw, jacobian_raw, Some(call_jacobian::<R, J, L>), pointer)
        })?;
        let mut search = std::ptr::null_mut();
        // SAFETY: the line search belongs to the solver.
        check(unsafe { sys::SNESGetLineSearch(raw, &raw mut search) })?;
        // SAFETY: as above; of no effect where the options name another line search.
        check(unsafe { sys::set_line_search(search, Some(call_search::<R, J, L>), pointer) })?;
        // SAFETY: all are valid; b = 0.
        let solved = check(unsafe { sys::SNESSolve(raw, std::ptr::null_mut(), x.raw()) });
        match context.stop.take() {
            Some(Stop::Panic(panic)) => resume_unwind(panic),
            Some(Stop::Error(error)) => return Err(Error::Callback(error)),
            None => solved?,
        }
        self.outcome()
    }

    fn reason(&self) -> Result<sys::SNESConvergedReason> {
        let mut reason = sys::SNESConvergedReason(0);
        // SAFETY: the solver is valid and has solved.
        check(unsafe { sys::SNESGetConvergedReason(self.object.raw(), &raw mut reason) })?;
        Ok(reason)
    }

    fn linear_solve_failed(&self) -> Result<bool> {
        Ok(self.reason()? == sys::SNESConvergedReason::SNES_DIVERGED_LINEAR_SOLVE)
    }

    fn outcome(&self) -> Result<usize> {
        let raw = self.object.raw();
        let (mut iterations, mut norm) = (0, 0.0);
        // SAFETY: the solver is valid and has solved; the out-pointers are valid, here and below.
        check(unsafe { sys::SNESGetIterationNumber(raw, &raw mut iterations) })?;
        let iterations = iterations as usize;
        if self.reason()?.0 > 0 {
            return Ok(iterations);
        }
        // SAFETY: as above.
        check(unsafe { sys::SNESGetFunctionNorm(raw, &raw mut norm) })?;
        let mut text = std::ptr::null();
        // SAFETY: as above; the text is static.
        check(unsafe { sys::SNESGetConvergedReasonString(raw, &raw mut text) })?;
        let mut text = owned(text);
        if self.linear_solve_failed()? {
            let mut ksp = std::ptr::null_mut();
            // SAFETY: the linear solver belongs to the solver.
            check(unsafe { sys::SNESGetKSP(raw, &raw mut ksp) })?;
            text = format!("{text}: {}", reason_of(ksp)?);
        }
        Err(Error::Diverged(Diverged { solver: "SNES", reason: text, iterations, norm }))
    }
}

unsafe extern "C" fn call_residual<R, J, L>(
    snes: sys::SNES,
    x: sys::Vec,
    f: sys::Vec,
    context: *mut c_void,
) -> sys::PetscErrorCode
where
    R: FnMut(&Vector, &mut Vector) -> Outcome<()>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: `solve` passed its context of this type; the residual is not re-entered, and the communicator never written.
    let (comm, residual) = unsafe { (&(*context).comm, &mut (*context).residual) };
    let outcome = guard(|| {
        let x = Vector::lent(x, comm)?;
        let mut f = Vector::lent(f, comm)?;
        residual(&x, &mut f)?;
        let undefined = f.read()?.iter().any(|value| value.is_nan());
        Ok(undefined)
    });
    match outcome {
        Ok(false) => 0,
        // SAFETY: the solver is the one that called; PETSc turns it into a reason on all ranks.
        Ok(true) => unsafe { sys::SNESSetFunctionDomainError(snes) },
        // SAFETY: no reference to `stop` is live.
        Err(stop) => unsafe { Context::keep(context, stop) },
    }
}

/// Lets the linear solver keep its factor for the next Jacobian, unless the last one strained it.
fn keep_factor_while_it_serves(snes: sys::SNES) -> Result<()> {
    let (mut ksp, mut iterations) = (std::ptr::null_mut(), 0);
    // SAFETY: the solver is the one that calls; the linear solver belongs to it.
    check(unsafe { sys::SNESGetKSP(snes, &raw mut ksp) })?;
    // SAFETY: as above.
    check(unsafe { sys::KSPGetIterationNumber(ksp, &raw mut iterations) })?;
    // PETSc's codes: −1 keep, −2 renew once and keep.
    let lag = if iterations <= FEW { -1 } else { -2 };
    // SAFETY: as above.
    check(unsafe { sys::SNESSetLagPreconditioner(snes, lag) })
}

unsafe extern "C" fn call_jacobian<R, J, L>(
    snes: sys::SNES,
    x: sys::Vec,
    _operator: sys::Mat,
    matrix: sys::Mat,
    context: *mut c_void,
) -> sys::PetscErrorCode
where
    J: FnMut(&Vector, &mut Matrix) -> Outcome<()>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: as in `call_residual`.
    let (comm, jacobian, keep_factor) = unsafe { (&(*context).comm, &mut (*context).jacobian, (*context).keep_factor) };
    let outcome = guard(|| {
        let x = Vector::lent(x, comm)?;
        let mut matrix = Matrix::lent(matrix, comm)?;
        if keep_factor {
            keep_factor_while_it_serves(snes)?;
        }
        // An untouched matrix keeps its state counter, by which PETSc sees that the factorisation still holds.
        jacobian(&x, &mut matrix)
    });
    match outcome {
        Ok(()) => 0,
        // SAFETY: no reference to `stop` is live.
        Err(stop) => unsafe { Context::keep(context, stop) },
    }
}

unsafe extern "C" fn call_search<R, J, L>(search: sys::SNESLineSearch, context: *mut c_void) -> sys::PetscErrorCode
where
    L: FnMut(&mut Trial) -> Outcome<f64>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: as in `call_residual`, which this calls and which borrows other fields.
    let (comm, closure) = unsafe { (&(*context).comm, &mut (*context).search) };
    let outcome = guard(|| {
        let mut trial = Trial::new(search, comm)?;
        let length = closure(&mut trial)?;
        Ok(trial.accept(search, length)?)
    });
    match outcome {
        Ok(()) => 0,
        // SAFETY: no reference to `stop` is live.
        Err(stop) => unsafe { Context::keep(context, stop) },
    }
}

/// A Newton direction along which a line search looks for its step length.
///
/// The residual is meant as the gradient of a potential Π: [`Trial::slope`] is dΠ/dλ.
pub struct Trial {
    snes: sys::SNES,
    x: Vector,
    f: Vector,
    /// PETSc's direction: x ← x − λ y.
    y: Vector,
    w: Vector,
    g: Vector,
    /// The λ for which w and g hold point and residual.
    at: Option<f64>,
}

impl Trial {
    fn new(search: sys::SNESLineSearch, comm: &Comm) -> Result<Self> {
        let mut snes = std::ptr::null_mut();
        // SAFETY: PETSc's line search, during its own call.
        check(unsafe { sys::SNESLineSearchGetSNES(search, &raw mut snes) })?;
        let mut raw = [std::ptr::null_mut(); 5];
        let [x, f, y, w, g] = &mut raw;
        // SAFETY: as above; the vectors are lent.
        check(unsafe { sys::SNESLineSearchGetVecs(search, x, f, y, w, g) })?;
        let [x, f, y, w, g] = raw.map(|v| Vector::lent(v, comm));
        Ok(Self { snes, x: x?, f: f?, y: y?, w: w?, g: g?, at: None })
    }

    /// Residual·direction at x + λ·direction. Collective.
    ///
    /// # Errors
    /// The residual closure's, or PETSc's.
    pub fn slope(&mut self, length: f64) -> Result<f64> {
        if length == 0.0 {
            return Ok(-self.f.dot(&self.y)?);
        }
        self.evaluate(length)?;
        Ok(-self.g.dot(&self.y)?)
    }

    fn evaluate(&mut self, length: f64) -> Result<()> {
        if self.at == Some(length) {
            return Ok(());
        }
        self.w.copy_from(&self.x)?;
        self.w.axpy(-length, &self.y)?;
        // SAFETY: all are valid; the residual callback is set.
        check(unsafe { sys::SNESComputeFunction(self.snes, self.w.raw(), self.g.raw()) })?;
        self.at = Some(length);
        Ok(())
    }

    /// Moves the solver's point and residual there.
    fn accept(&mut self, search: sys::SNESLineSearch, length: f64) -> Result<()> {
        self.evaluate(length)?;
        self.x.copy_from(&self.w)?;
        self.f.copy_from(&self.g)?;
        let (x, f, y) = (self.x.norm()?, self.f.norm()?, length.abs() * self.y.norm()?);
        // SAFETY: PETSc's line search, during its own call.
        check(unsafe { sys::SNESLineSearchSetLambda(search, length) })?;
        // SAFETY: as above.
        check(unsafe { sys::SNESLineSearchSetNorms(search, x, f, y) })?;
        let reason = if f.is_finite() {
            sys::SNESLineSearchReason::SNES_LINESEARCH_SUCCEEDED
        } else {
            sys::SNESLineSearchReason::SNES_LINESEARCH_FAILED_NANORINF
        };
        // SAFETY: as above.
        check(unsafe { sys::SNESLineSearchSetReason(search, reason) })
    }
}
