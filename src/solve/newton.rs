//! Newton's method with a factor that serves more than one Jacobian.

use petsc_wrap::{
    CallbackResult, Comm, Error, Lag, Matrix, MatrixView, Progress, Result, Snes, SnesTolerances, Trial, VectorView,
    options,
};

use super::linear::{MARGIN, is_refined_cholesky, set_refined_cholesky};

/// Iterations of a linear solve from which a new factor is cheaper: a factorisation costs ten solves or more.
const FEW: usize = 8;

/// A Newton solver for symmetric positive definite Jacobian matrices, which keeps its matrix and factor from solve to solve.
///
/// The line search is a closure of the caller's unless `-snes_linesearch_type` names one of PETSc's.
pub struct Newton {
    snes: Snes,
    /// Whether the linear solver's factor may serve more than one Jacobian.
    keep_factor: bool,
    /// Whether `-snes_atol` says when a solve has converged.
    tolerance_given: bool,
}

impl Newton {
    /// A solver for a Jacobian matrix, its entries all present.
    ///
    /// By default linear solves are to rounding: Cholesky's method by MUMPS, whose factor is kept as the preconditioner of conjugate gradients
    /// while these need but a few iterations. After a change of the matrix by rank r they need r + 1. With `-ksp_type preonly` every
    /// Jacobian is factorised. `-snes_…`, `-ksp_…` and `-pc_…` options override everything. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for unknown types among the options.
    pub fn new(comm: &Comm, jacobian: Matrix, absolute_tolerance: f64, max_iterations: usize) -> Result<Self> {
        let mut snes = Snes::new(comm)?;
        snes.set_type("newtonls")?;
        snes.set_line_search_type("shell")?;
        set_refined_cholesky(&mut snes.ksp()?, &jacobian)?;
        // Convergence by the residual's norm alone.
        snes.set_tolerances(SnesTolerances {
            absolute: Some(absolute_tolerance),
            relative: Some(0.0),
            step: Some(0.0),
            iterations: Some(max_iterations),
            evaluations: Some(petsc_wrap::Int::MAX as usize),
        })?;
        snes.set_jacobian(jacobian)?;
        snes.set_from_options()?;
        snes.ksp()?.pc()?.set_mumps_margin(MARGIN)?;
        let is_set = |name| options::is_set(comm.session(), name);
        let tolerance_given = is_set("-snes_atol")?;
        let keep_factor = is_refined_cholesky(&mut snes.ksp()?)? && !is_set("-snes_lag_preconditioner")?;
        Ok(Self { snes, keep_factor, tolerance_given })
    }

    /// Sets the residual's Euclidean norm below which a solve has converged, unless `-snes_atol` does.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_absolute_tolerance(&mut self, value: f64) -> Result<()> {
        if self.tolerance_given {
            return Ok(());
        }
        self.snes.set_tolerances(SnesTolerances { absolute: Some(value), ..Default::default() })
    }

    /// The residual's Euclidean norm below which a solve has converged.
    ///
    /// # Errors
    /// PETSc's.
    pub fn absolute_tolerance(&self) -> Result<f64> {
        self.snes.absolute_tolerance()
    }

    /// Solves residual(x) = 0 from the given x; returns the iterations. Collective.
    ///
    /// - `residual(x, f)` writes f; a NaN in it stops the solve.
    /// - `jacobian(x, j)` writes and assembles j; where it leaves j untouched, the last factorisation is used again.
    /// - `search(trial)` chooses the step length λ of x ← x + λ·direction.
    ///
    /// # Errors
    /// [`Error::Callback`] with a closure's own error, [`Error::Diverged`], or PETSc's. A closure's panic is resumed.
    pub fn solve<R, J, L>(
        &mut self,
        x: &mut VectorView,
        mut residual: R,
        mut jacobian: J,
        mut search: L,
    ) -> Result<usize>
    where
        R: FnMut(&VectorView, &mut VectorView) -> CallbackResult<()>,
        J: FnMut(&VectorView, &mut MatrixView) -> CallbackResult<()>,
        L: for<'a> FnMut(&mut Trial<'a>) -> CallbackResult<f64>,
    {
        let keep_factor = self.keep_factor;
        let keeping = |x: &VectorView, j: &mut MatrixView, progress: &mut Progress| {
            if keep_factor {
                keep_factor_while_it_serves(progress)?;
            }
            jacobian(x, j)
        };
        match self.snes.solve_with_search(x, &mut residual, keeping, &mut search) {
            // A factor kept from another Jacobian was no help: on from here with a new one for each.
            Err(Error::Diverged(failure)) if self.keep_factor && self.snes.linear_solve_failed()? => {
                self.snes.set_preconditioner_lag(Lag::Every(1))?;
                let renewing = |x: &VectorView, j: &mut MatrixView, _: &mut Progress| jacobian(x, j);
                Ok(failure.iterations + self.snes.solve_with_search(x, residual, renewing, search)?)
            }
            outcome => outcome,
        }
    }
}

/// Lets the linear solver keep its factor for the next Jacobian, unless the last one strained it.
fn keep_factor_while_it_serves(progress: &mut Progress) -> Result<()> {
    let lag = if progress.linear_iterations()? <= FEW { Lag::Keep } else { Lag::RebuildThenKeep };
    progress.set_preconditioner_lag(lag)
}
