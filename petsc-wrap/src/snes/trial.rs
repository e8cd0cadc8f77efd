//! The state of a solver that a closure can use while the solver calls it.

use std::marker::PhantomData;

use petsc_sys as sys;

use super::{Lag, Snes};
use crate::comm::Comm;
use crate::error::{Result, check, require};
use crate::ksp::iterations_of;
use crate::object::Lent;
use crate::vector::Vector;

/// A solver between two iterations, as seen by the closure for the Jacobian.
pub struct Progress<'a> {
    snes: sys::SNES,
    solver: PhantomData<&'a mut Snes>,
}

impl Progress<'_> {
    /// `snes` is a solver that has called a closure. The result must not outlive that call.
    pub(super) fn new(snes: sys::SNES) -> Self {
        Self { snes, solver: PhantomData }
    }

    /// Number of iterations of the last linear solve.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn linear_iterations(&self) -> Result<usize> {
        let mut ksp = std::ptr::null_mut();
        // SAFETY: the solver is the one that calls; the linear solver belongs to it.
        check(unsafe { sys::SNESGetKSP(self.snes, &raw mut ksp) })?;
        // SAFETY: as above.
        unsafe { iterations_of(ksp) }
    }

    /// Sets the number of Jacobians, beginning with this one, for which a preconditioner is used.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for `Every(0)`.
    pub fn set_preconditioner_lag(&mut self, lag: Lag) -> Result<()> {
        // SAFETY: the solver is the one that calls.
        check(unsafe { sys::SNESSetLagPreconditioner(self.snes, lag.raw()?) })
    }
}

/// A Newton direction along which a line search looks for its step length.
///
/// The residual is taken as the gradient of a potential Π, so [`Trial::slope`] is dΠ/dλ. The lifetime of a trial is the
/// call of one closure, so no trial can replace another.
pub struct Trial<'a> {
    search: sys::SNESLineSearch,
    snes: sys::SNES,
    x: Lent<'a, Vector>,
    f: Lent<'a, Vector>,
    /// PETSc's direction: x ← x − λ y.
    y: Lent<'a, Vector>,
    w: Lent<'a, Vector>,
    g: Lent<'a, Vector>,
    /// The λ at which w and g hold the point and the residual; `None` if there is none yet.
    at: Option<f64>,
    call: PhantomData<fn(&'a ()) -> &'a ()>,
}

impl Trial<'_> {
    /// Wraps a line search.
    ///
    /// # Safety
    /// Used only during the call of a solver's line search.
    pub(super) unsafe fn new(search: sys::SNESLineSearch, comm: &Comm) -> Result<Self> {
        let mut snes = std::ptr::null_mut();
        // SAFETY: guaranteed by the caller.
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

    /// Scalar product of the residual and the direction at x + λ·direction. Collective.
    ///
    /// # Errors
    /// If the residual closure or a PETSc call fails.
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

    /// Moves the solver's point and residual to this step length.
    pub(super) fn accept(&mut self, length: f64) -> Result<()> {
        self.evaluate(length)?;
        self.x.copy_from(&self.w)?;
        self.f.copy_from(&self.g)?;
        let (x, f, y) = (self.x.norm()?, self.f.norm()?, length.abs() * self.y.norm()?);
        // SAFETY: the line search is PETSc's, and is used during its own call, here and below.
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
