//! Newton's method with Rust closures.

mod callbacks;
mod trial;

use std::error::Error as StdError;
use std::panic::resume_unwind;

use petsc_sys as sys;

pub use trial::{Progress, Trial};

use callbacks::{Callbacks, Context, Stop};

use crate::Int;
use crate::comm::Comm;
use crate::error::{Diverged, Error, Result, check, require};
use crate::ksp::{Ksp, reason_of};
use crate::matrix::{Matrix, MatrixView};
use crate::object::{Lent, Object};
use crate::text::{from_c, int, option_name, type_name};
use crate::vector::VectorView;

/// Result of a closure that PETSc calls.
pub type CallbackResult<T> = std::result::Result<T, Box<dyn StdError>>;

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

/// Stopping criteria of a nonlinear solver; `None` leaves a limit unchanged.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SnesTolerances {
    /// Euclidean norm of the residual.
    pub absolute: Option<f64>,
    /// Euclidean norm of the residual relative to its norm at the start.
    pub relative: Option<f64>,
    /// Norm of a step relative to the norm of x.
    pub step: Option<f64>,
    /// Largest number of iterations.
    pub iterations: Option<usize>,
    /// Largest number of evaluations of the residual.
    pub evaluations: Option<usize>,
}

/// Number of Jacobians for which a preconditioner is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lag {
    /// The preconditioner is rebuilt for every n-th Jacobian.
    Every(usize),
    /// The preconditioner is kept.
    Keep,
    /// The preconditioner is rebuilt for the next Jacobian, and then kept.
    RebuildThenKeep,
}

impl Lag {
    /// PETSc's code of this choice.
    fn raw(self) -> Result<Int> {
        match self {
            Self::Every(jacobians) => int(jacobians),
            Self::Keep => Ok(-1),
            Self::RebuildThenKeep => Ok(-2),
        }
    }
}

/// Type of the line search of a solve that has no search closure.
type NoSearch = fn(&mut Trial<'_>) -> CallbackResult<f64>;

impl Snes {
    /// Creates a solver with PETSc's defaults. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn new(comm: &Comm) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::SNESCreate(comm.petsc()?, &raw mut raw) })?;
        // SAFETY: the new solver is ours.
        Ok(Self { object: unsafe { Object::new(raw, comm) }, jacobian: None })
    }

    fn raw(&self) -> Result<sys::SNES> {
        self.object.whole()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::SNES {
        self.object.raw()
    }

    /// The communicator of this object.
    pub fn comm(&self) -> &Comm {
        self.object.comm()
    }

    /// Chooses the method: `newtonls` (Newton's with a line search) or `ksponly` (one step of it).
    ///
    /// # Errors
    /// If the name is another one, or if a PETSc call fails.
    pub fn set_type(&mut self, name: &str) -> Result<()> {
        let name = type_name(name, &["newtonls", "ksponly"])?;
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::SNESSetType(self.raw()?, name.as_ptr()) })
    }

    /// Sets the prefix of this solver's options: empty, or a name that ends in an underscore.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a prefix that begins with a dash.
    pub fn set_options_prefix(&mut self, prefix: &str) -> Result<()> {
        let prefix = option_name(prefix)?;
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::SNESSetOptionsPrefix(self.raw()?, prefix.as_ptr()) })
    }

    fn line_search(&self) -> Result<sys::SNESLineSearch> {
        let mut search = std::ptr::null_mut();
        // SAFETY: the solver is valid; the line search belongs to it.
        check(unsafe { sys::SNESGetLineSearch(self.raw()?, &raw mut search) })?;
        Ok(search)
    }

    /// Chooses the line search: `basic`, `bt`, `l2`, `cp`, or `shell`, which calls the closure of
    /// [`Self::solve_with_search`].
    ///
    /// # Errors
    /// If the name is another one, or if a PETSc call fails.
    pub fn set_line_search_type(&mut self, name: &str) -> Result<()> {
        let name = type_name(name, &["basic", "bt", "l2", "cp", "shell"])?;
        // SAFETY: the line search is valid; PETSc copies the string.
        check(unsafe { sys::SNESLineSearchSetType(self.line_search()?, name.as_ptr()) })
    }

    /// The linear solver.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn ksp(&mut self) -> Result<Lent<'_, Ksp>> {
        let mut ksp = std::ptr::null_mut();
        // SAFETY: the linear solver belongs to the nonlinear solver, is on the same ranks, and stays while the
        // nonlinear solver is borrowed.
        check(unsafe { sys::SNESGetKSP(self.raw()?, &raw mut ksp) })?;
        // SAFETY: as above; outside a solve its callbacks are functions that return an error.
        Ok(unsafe { Ksp::lent(ksp, &self.object) })
    }

    /// Sets the stopping criteria.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a negative tolerance.
    pub fn set_tolerances(&mut self, tolerances: SnesTolerances) -> Result<()> {
        let same = f64::from(sys::PETSC_DEFAULT);
        let [absolute, relative, step] =
            [tolerances.absolute, tolerances.relative, tolerances.step].map(|limit| limit.unwrap_or(same));
        let count = |limit: Option<usize>| limit.map_or(Ok(sys::PETSC_DEFAULT as Int), int);
        let (iterations, evaluations) = (count(tolerances.iterations)?, count(tolerances.evaluations)?);
        // SAFETY: the solver is valid; PETSc's default mark leaves the other limits unchanged.
        check(unsafe { sys::SNESSetTolerances(self.raw()?, absolute, relative, step, iterations, evaluations) })
    }

    /// Euclidean norm of the residual below which a solve has converged.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn absolute_tolerance(&self) -> Result<f64> {
        let (mut value, none) = (0.0, std::ptr::null_mut());
        let (raw, unasked) = (self.raw()?, std::ptr::null_mut());
        // SAFETY: the solver is valid; a null pointer requests nothing.
        check(unsafe { sys::SNESGetTolerances(raw, &raw mut value, none, none, unasked, unasked) })?;
        Ok(value)
    }

    /// Sets the number of Jacobians for which a preconditioner is used.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for `Every(0)`.
    pub fn set_preconditioner_lag(&mut self, lag: Lag) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::SNESSetLagPreconditioner(self.raw()?, lag.raw()?) })
    }

    /// Takes ownership of the matrix for the Jacobian, which must have all its entries. Collective.
    ///
    /// # Errors
    /// If the matrix is not square and AIJ, is on other ranks, or has another layout than the one before, or if a PETSc
    /// call fails.
    pub fn set_jacobian(&mut self, matrix: Matrix) -> Result<()> {
        matrix.require_aij()?;
        matrix.require_square()?;
        require(self.comm().is_congruent(matrix.comm()), "the matrix lives on other ranks than the solver")?;
        if let Some(before) = &self.jacobian {
            matrix.row_layout().require_same(before.row_layout())?;
        }
        // SAFETY: all are valid; PETSc counts its own references. The callback is set by each solve.
        check(unsafe { sys::SNESSetJacobian(self.raw()?, matrix.raw(), matrix.raw(), None, std::ptr::null_mut()) })?;
        self.jacobian = Some(matrix);
        Ok(())
    }

    /// Applies the options database to this solver, its line search and its linear solver. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for unknown types among the options.
    pub fn set_from_options(&mut self) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::SNESSetFromOptions(self.raw()?) })
    }

    /// Solves residual(x) = 0 from the given x; returns the number of iterations. Collective.
    ///
    /// - `residual(x, f)` writes f; a NaN in it stops the solve.
    /// - `jacobian(x, j, progress)` writes and assembles j. If it leaves j unchanged, the last factorisation is used
    ///   again.
    ///
    /// # Errors
    /// If the solver has no Jacobian, x has another layout, or a PETSc call fails; [`Error::Callback`] with a closure's
    /// own error; [`Error::Diverged`]. A panic of a closure is resumed.
    pub fn solve<R, J>(&mut self, x: &mut VectorView, residual: R, jacobian: J) -> Result<usize>
    where
        R: FnMut(&VectorView, &mut VectorView) -> CallbackResult<()>,
        J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> CallbackResult<()>,
    {
        let none: NoSearch = |_| Err("the line search is of type shell, and the solve is without one".into());
        self.solve_with_search(x, residual, jacobian, none)
    }

    /// Same as [`Self::solve`], but `search(trial)` chooses the step length λ of x ← x + λ·direction, if the line
    /// search is of type `shell`. Collective.
    ///
    /// # Errors
    /// Same as [`Self::solve`].
    pub fn solve_with_search<R, J, L>(
        &mut self,
        x: &mut VectorView,
        residual: R,
        jacobian: J,
        search: L,
    ) -> Result<usize>
    where
        R: FnMut(&VectorView, &mut VectorView) -> CallbackResult<()>,
        J: FnMut(&VectorView, &mut MatrixView, &mut Progress<'_>) -> CallbackResult<()>,
        L: for<'a> FnMut(&mut Trial<'a>) -> CallbackResult<f64>,
    {
        let Some(matrix) = &self.jacobian else {
            return require(false, "the solver has no Jacobian matrix yet").map(|()| 0);
        };
        matrix.row_layout().require_same(x.layout())?;
        let comm = self.comm().clone();
        let mut context = Context { comm, residual, jacobian, search, stop: None };
        let pointer = std::ptr::from_mut(&mut context);
        // From here on PETSc knows the context. Dropping `callbacks` removes it, whatever the outcome.
        let (raw, callbacks) = (self.raw()?, Callbacks { snes: self });
        let solved = callbacks.set(matrix.raw(), pointer).and_then(|()| {
            // SAFETY: all are valid; b = 0. The closures cannot reach the solver or x, which are borrowed.
            self.object.solved(unsafe { sys::SNESSolve(raw, std::ptr::null_mut(), x.raw()) })
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
        check(unsafe { sys::SNESGetConvergedReason(self.raw()?, &raw mut reason) })?;
        Ok(reason)
    }

    /// Whether the last solve ended because a linear solve failed.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn linear_solve_failed(&self) -> Result<bool> {
        Ok(self.reason()? == sys::SNESConvergedReason::SNES_DIVERGED_LINEAR_SOLVE)
    }

    fn outcome(&self) -> Result<usize> {
        let raw = self.raw()?;
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

    /// Destroys the solver immediately, with its Jacobian and its factor. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn destroy(self) -> Result<()> {
        self.object.destroy()?;
        self.jacobian.map_or(Ok(()), Matrix::destroy)
    }
}
