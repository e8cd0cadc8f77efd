//! Newton's method with Rust closures.

use std::any::Any;
use std::error::Error as StdError;
use std::ffi::c_void;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Diverged, Error, Result, check, require};
use crate::ksp::{Ksp, iterations_of, reason_of};
use crate::matrix::{Matrix, MatrixView};
use crate::object::{Lent, Object};
use crate::text::{from_c, int, option_name, to_c};
use crate::vector::{Vector, VectorView};

/// What a closure returns.
pub type Outcome<T> = std::result::Result<T, Box<dyn StdError>>;

/// A nonlinear solver that keeps its Jacobian matrix and linear solver from solve to solve.
///
/// ```
/// # fn main() -> petsc_wrap::Result<()> {
/// use petsc_wrap::{Insert, Matrix, Session, Snes, Vector};
///
/// let session = Session::start(&[]).expect("the first session")?;
/// let comm = session.alone();
/// let mut solver = Snes::new(&comm)?;
/// solver.set_jacobian(Matrix::aij(&comm, (1, 1), &[1], &[0])?)?;
/// let mut x = Vector::new(&comm, 1)?;
/// x.fill(1.0)?;
/// // x² = 2
/// solver.solve(
///     &mut x,
///     |x, f| Ok(f.write()?[0] = x.read()?[0].powi(2) - 2.0),
///     |x, j, _| {
///         j.set_values(&[0], &[0], &[2.0 * x.read()?[0]], Insert::Replace)?;
///         Ok(j.assemble()?)
///     },
/// )?;
/// assert!((x.read()?[0] - 2_f64.sqrt()).abs() < 1e-8);
/// # Ok(())
/// # }
/// ```
pub struct Snes {
    object: Object<sys::_p_SNES>,
    jacobian: Option<Matrix>,
}

/// When a nonlinear solver stops; `None` leaves a limit as it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SnesTolerances {
    /// Euclidean norm of the residual.
    pub absolute: Option<f64>,
    /// The same relative to that at the start.
    pub relative: Option<f64>,
    /// Norm of a step relative to that of x.
    pub step: Option<f64>,
    /// Iterations.
    pub iterations: Option<usize>,
    /// Evaluations of the residual.
    pub evaluations: Option<usize>,
}

/// For how many Jacobians a preconditioner serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lag {
    /// It is made anew for every so many Jacobians.
    Every(usize),
    /// It is kept for ever.
    Never,
    /// It is made anew for the next Jacobian, and then kept.
    Once,
}

impl Lag {
    /// PETSc's number.
    fn raw(self) -> Result<Int> {
        match self {
            Self::Every(jacobians) => int(jacobians),
            Self::Never => Ok(-1),
            Self::Once => Ok(-2),
        }
    }
}

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

/// The line search of a solve without one of its own.
type NoSearch = fn(&mut Trial<'_>) -> Outcome<f64>;

impl Snes {
    /// A solver with PETSc's defaults. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(comm: &Comm) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::SNESCreate(comm.raw(), &raw mut raw) })?;
        // SAFETY: the new solver is ours.
        Ok(Self { object: unsafe { Object::new(raw, comm) }, jacobian: None })
    }

    fn raw(&self) -> sys::SNES {
        self.object.raw()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::SNES {
        self.raw()
    }

    /// The ranks it lives on.
    pub fn comm(&self) -> &Comm {
        self.object.comm()
    }

    /// Chooses the method (`newtonls`, `newtontr`, …).
    ///
    /// # Errors
    /// PETSc's, e.g. for an unknown name.
    pub fn set_type(&mut self, name: &str) -> Result<()> {
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::SNESSetType(self.raw(), to_c(name).as_ptr()) })
    }

    /// Options of this solver begin with the prefix: empty, or ending in an underscore.
    ///
    /// # Errors
    /// PETSc's, e.g. for a prefix that begins with a dash.
    pub fn set_options_prefix(&mut self, prefix: &str) -> Result<()> {
        let prefix = option_name(prefix)?;
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::SNESSetOptionsPrefix(self.raw(), prefix.as_ptr()) })
    }

    fn line_search(&self) -> Result<sys::SNESLineSearch> {
        let mut search = std::ptr::null_mut();
        // SAFETY: the solver is valid; the line search belongs to it.
        check(unsafe { sys::SNESGetLineSearch(self.raw(), &raw mut search) })?;
        Ok(search)
    }

    /// Chooses the line search (`bt`, `basic`, …); `shell` is the closure of [`Self::solve_with_search`].
    ///
    /// # Errors
    /// PETSc's, e.g. for an unknown name.
    pub fn set_line_search_type(&mut self, name: &str) -> Result<()> {
        // SAFETY: the line search is valid; PETSc copies the string.
        check(unsafe { sys::SNESLineSearchSetType(self.line_search()?, to_c(name).as_ptr()) })
    }

    /// The linear solver.
    ///
    /// # Errors
    /// PETSc's.
    pub fn ksp(&mut self) -> Result<Lent<'_, Ksp>> {
        let mut ksp = std::ptr::null_mut();
        // SAFETY: the linear solver belongs to the solver, is on its ranks and stays while that is borrowed.
        check(unsafe { sys::SNESGetKSP(self.raw(), &raw mut ksp) })?;
        // SAFETY: as above; what it calls back outside a solve are functions that return an error.
        Ok(unsafe { Ksp::lent(ksp, self.comm()) })
    }

    /// When to stop.
    ///
    /// # Errors
    /// PETSc's, e.g. for a negative tolerance.
    pub fn set_tolerances(&mut self, tolerances: SnesTolerances) -> Result<()> {
        let same = f64::from(sys::PETSC_DEFAULT);
        let [absolute, relative, step] =
            [tolerances.absolute, tolerances.relative, tolerances.step].map(|limit| limit.unwrap_or(same));
        let count = |limit: Option<usize>| limit.map_or(Ok(sys::PETSC_DEFAULT as Int), int);
        let (iterations, evaluations) = (count(tolerances.iterations)?, count(tolerances.evaluations)?);
        // SAFETY: the solver is valid; PETSc's mark leaves the other limits as they are.
        check(unsafe { sys::SNESSetTolerances(self.raw(), absolute, relative, step, iterations, evaluations) })
    }

    /// The residual's Euclidean norm below which a solve has converged.
    ///
    /// # Errors
    /// PETSc's.
    pub fn absolute_tolerance(&self) -> Result<f64> {
        let (mut value, none) = (0.0, std::ptr::null_mut());
        let (raw, unasked) = (self.raw(), std::ptr::null_mut());
        // SAFETY: the solver is valid; null asks for nothing.
        check(unsafe { sys::SNESGetTolerances(raw, &raw mut value, none, none, unasked, unasked) })?;
        Ok(value)
    }

    /// For how many Jacobians a preconditioner serves.
    ///
    /// # Errors
    /// PETSc's, e.g. for every zeroth.
    pub fn set_preconditioner_lag(&mut self, lag: Lag) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::SNESSetLagPreconditioner(self.raw(), lag.raw()?) })
    }

    /// Takes over the matrix for the Jacobian, all its entries present. Collective.
    ///
    /// # Errors
    /// A matrix that is not square and AIJ, on other ranks, or of another layout than the one before; PETSc's.
    pub fn set_jacobian(&mut self, matrix: Matrix) -> Result<()> {
        matrix.require_aij()?;
        matrix.require_square()?;
        require(self.comm().is_congruent(matrix.comm()), "the matrix lives on other ranks than the solver")?;
        if let Some(before) = &self.jacobian {
            matrix.row_layout().require_same(before.row_layout())?;
        }
        // SAFETY: all are valid; PETSc counts its own references. The callback is set by each solve.
        check(unsafe { sys::SNESSetJacobian(self.raw(), matrix.raw(), matrix.raw(), None, std::ptr::null_mut()) })?;
        self.jacobian = Some(matrix);
        Ok(())
    }

    /// Whatever the options database says of this solver, its line search and its linear solver. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for unknown types among the options.
    pub fn set_from_options(&mut self) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::SNESSetFromOptions(self.raw()) })
    }

    /// Solves residual(x) = 0 from the given x; returns the iterations. Collective.
    ///
    /// - `residual(x, f)` writes f; a NaN in it stops the solve.
    /// - `jacobian(x, j, progress)` writes and assembles j; where it leaves j untouched, the last factorisation is used again.
    ///
    /// # Errors
    /// A solver without its Jacobian; x of another layout; [`Error::Callback`] with a closure's own error, [`Error::Diverged`], or PETSc's.
    /// A closure's panic is resumed.
    pub fn solve<R, J>(&mut self, x: &mut VectorView, residual: R, jacobian: J) -> Result<usize>
    where
        R: FnMut(&VectorView, &mut VectorView) -> Outcome<()>,
        J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> Outcome<()>,
    {
        let none: NoSearch = |_| Err("the line search is of type shell, and the solve is without one".into());
        self.solve_with_search(x, residual, jacobian, none)
    }

    /// [`Self::solve`] where `search(trial)` chooses the step length λ of x ← x + λ·direction, if the line search is of type `shell`. Collective.
    ///
    /// # Errors
    /// As of [`Self::solve`].
    pub fn solve_with_search<R, J, L>(
        &mut self,
        x: &mut VectorView,
        residual: R,
        jacobian: J,
        search: L,
    ) -> Result<usize>
    where
        R: FnMut(&VectorView, &mut VectorView) -> Outcome<()>,
        J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> Outcome<()>,
        L: for<'a> FnMut(&mut Trial<'a>) -> Outcome<f64>,
    {
        let Some(matrix) = &self.jacobian else {
            return require(false, "the solver has no Jacobian matrix yet").map(|()| 0);
        };
        matrix.row_layout().require_same(x.layout())?;
        let comm = self.comm().clone();
        let mut context = Context { comm, residual, jacobian, search, stop: None };
        let pointer = std::ptr::from_mut(&mut context);
        // From here on PETSc knows the context; `callbacks` takes it away from PETSc however this ends.
        let callbacks = Callbacks { snes: self };
        let solved = callbacks.set(matrix.raw(), pointer).and_then(|()| {
            // SAFETY: all are valid; b = 0. The closures cannot reach the solver or x, which are borrowed.
            check(unsafe { sys::SNESSolve(callbacks.snes.raw(), std::ptr::null_mut(), x.raw()) })
        });
        drop(callbacks);
        match context.stop.take() {
            Some(Stop::Panic(panic)) => resume_unwind(panic),
            Some(Stop::Error(error)) => return Err(Error::Callback(error)),
            None => solved?,
        }
        self.outcome()
    }

    fn reason(&self) -> Result<sys::SNESConvergedReason> {
        let mut reason = sys::SNESConvergedReason(0);
        // SAFETY: the solver is valid.
        check(unsafe { sys::SNESGetConvergedReason(self.raw(), &raw mut reason) })?;
        Ok(reason)
    }

    /// Whether a linear solve that failed has ended the last solve.
    ///
    /// # Errors
    /// PETSc's.
    pub fn linear_solve_failed(&self) -> Result<bool> {
        Ok(self.reason()? == sys::SNESConvergedReason::SNES_DIVERGED_LINEAR_SOLVE)
    }

    fn outcome(&self) -> Result<usize> {
        let raw = self.raw();
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
        // SAFETY: as above.
        check(unsafe { sys::SNESGetConvergedReasonString(raw, &raw mut text) })?;
        // SAFETY: the text is static.
        let mut reason = unsafe { from_c(text) };
        if self.linear_solve_failed()? {
            let mut ksp = std::ptr::null_mut();
            // SAFETY: the linear solver belongs to the solver.
            check(unsafe { sys::SNESGetKSP(raw, &raw mut ksp) })?;
            // SAFETY: as above.
            reason = format!("{reason}: {}", unsafe { reason_of(ksp) }?);
        }
        Err(Error::Diverged(Diverged { solver: "SNES", reason, iterations, norm }))
    }

    /// Destroys it at once, with its Jacobian and its factor. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn destroy(self) -> Result<()> {
        self.object.destroy()?;
        self.jacobian.map_or(Ok(()), Matrix::destroy)
    }
}

/// The callbacks of a solve, for as long as this lives.
struct Callbacks<'a> {
    snes: &'a Snes,
}

impl Callbacks<'_> {
    fn set<R, J, L>(&self, matrix: sys::Mat, context: *mut Context<R, J, L>) -> Result<()>
    where
        R: FnMut(&VectorView, &mut VectorView) -> Outcome<()>,
        J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> Outcome<()>,
        L: for<'a> FnMut(&mut Trial<'a>) -> Outcome<f64>,
    {
        let (raw, pointer) = (self.snes.raw(), context.cast::<c_void>());
        // SAFETY: the callbacks cast the context back to its type, and are taken away before it goes.
        check(unsafe { sys::SNESSetFunction(raw, std::ptr::null_mut(), Some(call_residual::<R, J, L>), pointer) })?;
        // SAFETY: as above.
        check(unsafe { sys::SNESSetJacobian(raw, matrix, matrix, Some(call_jacobian::<R, J, L>), pointer) })?;
        // SAFETY: as above; of no effect where the line search is not of type shell.
        check(unsafe { sys::set_line_search(self.snes.line_search()?, Some(call_search::<R, J, L>), pointer) })
    }
}

impl Drop for Callbacks<'_> {
    /// PETSc would call the solver's functions later too: a matrix-free Jacobian (`-snes_mf`) in a solve with the linear solver, say.
    fn drop(&mut self) {
        let (raw, none) = (self.snes.raw(), std::ptr::null_mut());
        // SAFETY: the solver is valid here and below, and these callbacks do not look at a context.
        unsafe { sys::SNESSetFunction(raw, std::ptr::null_mut(), Some(no_residual), none) };
        // SAFETY: as above; null leaves the matrices as they are.
        unsafe { sys::SNESSetJacobian(raw, std::ptr::null_mut(), std::ptr::null_mut(), Some(no_jacobian), none) };
        if let Ok(search) = self.snes.line_search() {
            // SAFETY: as above.
            unsafe { sys::set_line_search(search, Some(no_search), none) };
        }
    }
}

unsafe extern "C" fn no_residual(_: sys::SNES, _: sys::Vec, _: sys::Vec, _: *mut c_void) -> sys::PetscErrorCode {
    USER_ERROR
}

unsafe extern "C" fn no_jacobian(
    _: sys::SNES,
    _: sys::Vec,
    _: sys::Mat,
    _: sys::Mat,
    _: *mut c_void,
) -> sys::PetscErrorCode {
    USER_ERROR
}

unsafe extern "C" fn no_search(_: sys::SNESLineSearch, _: *mut c_void) -> sys::PetscErrorCode {
    USER_ERROR
}

/// Whether PETSc lends the same object twice, once to be written.
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
    R: FnMut(&VectorView, &mut VectorView) -> Outcome<()>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: `solve_with_search` passed its context of this type; the residual is not re-entered, and the communicator never written.
    let (comm, residual) = unsafe { (&(*context).comm, &mut (*context).residual) };
    let outcome = guard(|| {
        require_different(x, f)?;
        // SAFETY: PETSc keeps both during this call; f is the caller's alone.
        let (x, mut f) = unsafe { (Vector::lent(x, comm), Vector::lent(f, comm)) };
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

unsafe extern "C" fn call_jacobian<R, J, L>(
    snes: sys::SNES,
    x: sys::Vec,
    operator: sys::Mat,
    matrix: sys::Mat,
    context: *mut c_void,
) -> sys::PetscErrorCode
where
    J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> Outcome<()>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: as in `call_residual`.
    let (comm, jacobian) = unsafe { (&(*context).comm, &mut (*context).jacobian) };
    let outcome = guard(|| {
        // SAFETY: PETSc keeps both during this call; the solver, borrowed, owns the matrix.
        let (x, mut j) = unsafe { (Vector::lent(x, comm), Matrix::lent(matrix, comm)) };
        // An untouched matrix keeps its state counter, by which PETSc sees that the factorisation still holds.
        jacobian(&x, &mut j, &mut Progress { snes, solver: PhantomData })?;
        if operator != matrix {
            // A matrix-free operator (`-snes_mf_operator`) takes its point when it is assembled.
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
    L: for<'a> FnMut(&mut Trial<'a>) -> Outcome<f64>,
{
    let context = context.cast::<Context<R, J, L>>();
    // SAFETY: as in `call_residual`, which this calls and which borrows other fields.
    let (comm, closure) = unsafe { (&(*context).comm, &mut (*context).search) };
    let outcome = guard(|| {
        // SAFETY: PETSc's line search, during its own call.
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

/// A solver between two of its iterations, as the closure for the Jacobian sees it.
pub struct Progress<'a> {
    snes: sys::SNES,
    solver: PhantomData<&'a mut Snes>,
}

impl Progress<'_> {
    /// Iterations of the last linear solve.
    ///
    /// # Errors
    /// PETSc's.
    pub fn linear_iterations(&self) -> Result<usize> {
        let mut ksp = std::ptr::null_mut();
        // SAFETY: the solver is the one that calls; the linear solver belongs to it.
        check(unsafe { sys::SNESGetKSP(self.snes, &raw mut ksp) })?;
        // SAFETY: as above.
        unsafe { iterations_of(ksp) }
    }

    /// For how many Jacobians, beginning with this one, a preconditioner serves.
    ///
    /// # Errors
    /// PETSc's, e.g. for every zeroth.
    pub fn set_preconditioner_lag(&mut self, lag: Lag) -> Result<()> {
        // SAFETY: the solver is the one that calls.
        check(unsafe { sys::SNESSetLagPreconditioner(self.snes, lag.raw()?) })
    }
}

/// A Newton direction along which a line search looks for its step length.
///
/// The residual is meant as the gradient of a potential Π: [`Trial::slope`] is dΠ/dλ. A trial belongs to the call of one closure: its lifetime is
/// that call's alone, so that none can take the place of another.
pub struct Trial<'a> {
    search: sys::SNESLineSearch,
    snes: sys::SNES,
    x: Lent<'a, Vector>,
    f: Lent<'a, Vector>,
    /// PETSc's direction: x ← x − λ y.
    y: Lent<'a, Vector>,
    w: Lent<'a, Vector>,
    g: Lent<'a, Vector>,
    /// The λ for which w and g hold point and residual.
    at: Option<f64>,
    call: PhantomData<fn(&'a ()) -> &'a ()>,
}

impl Trial<'_> {
    /// # Safety
    /// During the call of a solver's line search, which lasts longer than this.
    unsafe fn new(search: sys::SNESLineSearch, comm: &Comm) -> Result<Self> {
        let mut snes = std::ptr::null_mut();
        // SAFETY: by the caller.
        check(unsafe { sys::SNESLineSearchGetSNES(search, &raw mut snes) })?;
        let mut raw = [std::ptr::null_mut(); 5];
        let [x, f, y, w, g] = &mut raw;
        // SAFETY: as above.
        check(unsafe { sys::SNESLineSearchGetVecs(search, x, f, y, w, g) })?;
        let is_apart = (1..5).all(|i| !raw[..i].contains(&raw[i]));
        require(is_apart && !raw.contains(&std::ptr::null_mut()), "the line search has not five vectors")?;
        // SAFETY: the line search keeps its five vectors during the call.
        let [x, f, y, w, g] = raw.map(|vector| unsafe { Vector::lent(vector, comm) });
        Ok(Self { search, snes, x, f, y, w, g, at: None, call: PhantomData })
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
    fn accept(&mut self, length: f64) -> Result<()> {
        self.evaluate(length)?;
        self.x.copy_from(&self.w)?;
        self.f.copy_from(&self.g)?;
        let (x, f, y) = (self.x.norm()?, self.f.norm()?, length.abs() * self.y.norm()?);
        // SAFETY: PETSc's line search, during its own call, here and below.
        check(unsafe { sys::SNESLineSearchSetLambda(self.search, length) })?;
        // SAFETY: as above.
        check(unsafe { sys::SNESLineSearchSetNorms(self.search, x, f, y) })?;
        let reason = if f.is_finite() {
            sys::SNESLineSearchReason::SNES_LINESEARCH_SUCCEEDED
        } else {
            sys::SNESLineSearchReason::SNES_LINESEARCH_FAILED_NANORINF
        };
        // SAFETY: as above.
        check(unsafe { sys::SNESLineSearchSetReason(self.search, reason) })
    }
}
