//! Newton's method with a factor that is used for several Jacobians.

use petsc_wrap::{
    CallbackResult, Comm, Error, Lag, Matrix, MatrixView, Progress, Result, Snes, SnesTolerances, Trial, VectorView,
    options,
};

use super::linear::{MARGIN, is_refined_cholesky, set_refined_cholesky};

/// Largest number of iterations of a linear solve for which the factor is kept. With more, a new factor is cheaper: a
/// factorisation costs ten solves or more.
const MAX_ITERATIONS_WITH_KEPT_FACTOR: usize = 8;

/// Newton solver for symmetric positive definite Jacobian matrices, which keeps its matrix and factor between solves.
///
/// The line search is a closure of the caller, unless `-snes_linesearch_type` names a line search of PETSc.
pub struct Newton {
    snes: Snes,
    /// Whether the factor of the linear solver may be used for several Jacobians.
    keep_factor: bool,
    /// Whether `-snes_atol` determines when a solve has converged.
    tolerance_given: bool,
}

impl Newton {
    /// Creates a solver for a Jacobian matrix in which all entries of the sparsity pattern exist.
    ///
    /// By default linear systems are solved to rounding: a Cholesky factor by MUMPS is kept as the preconditioner of
    /// conjugate gradients while these need only a few iterations. If the matrix changes by rank r, they need r + 1.
    /// With `-ksp_type preonly` every Jacobian is factorised. Options `-snes_…`, `-ksp_…` and `-pc_…` override
    /// everything. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for unknown types in the options.
    pub fn new(comm: &Comm, jacobian: Matrix, absolute_tolerance: f64, max_iterations: usize) -> Result<Self> {
        let mut snes = Snes::new(comm)?;
        snes.set_type("newtonls")?;
        snes.set_line_search_type("shell")?;
        set_refined_cholesky(&mut snes.ksp()?, &jacobian)?;
        // Convergence is decided by the norm of the residual alone.
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

    /// Sets the Euclidean norm of the residual below which a solve has converged, unless `-snes_atol` sets it.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn set_absolute_tolerance(&mut self, value: f64) -> Result<()> {
        if self.tolerance_given {
            return Ok(());
        }
        self.snes.set_tolerances(SnesTolerances { absolute: Some(value), ..Default::default() })
    }

    /// Euclidean norm of the residual below which a solve has converged.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn absolute_tolerance(&self) -> Result<f64> {
        self.snes.absolute_tolerance()
    }

    /// Solves residual(x) = 0 from the given x and returns the number of iterations. Collective.
    ///
    /// - `residual(x, f)` writes f; a NaN in f stops the solve.
    /// - `jacobian(x, j)` writes and assembles j; if it leaves j unchanged, the last factorisation is used again.
    /// - `search(trial)` chooses the step length λ of x ← x + λ·direction.
    ///
    /// # Errors
    /// [`Error::Callback`] if a closure returns an error, [`Error::Diverged`] if the iteration diverges, or if a PETSc
    /// call fails. A panic of a closure is resumed.
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
            // The factor of another Jacobian was too inaccurate. The solve continues with a new factor for each
            // Jacobian.
            Err(Error::Diverged(failure)) if self.keep_factor && self.snes.linear_solve_failed()? => {
                self.snes.set_preconditioner_lag(Lag::Every(1))?;
                let renewing = |x: &VectorView, j: &mut MatrixView, _: &mut Progress| jacobian(x, j);
                Ok(failure.iterations + self.snes.solve_with_search(x, residual, renewing, search)?)
            }
            outcome => outcome,
        }
    }
}

/// Keeps the factor of the linear solver for the next Jacobian, unless the last linear solve took too many iterations.
fn keep_factor_while_it_serves(progress: &mut Progress) -> Result<()> {
    let lag =
        if progress.linear_iterations()? <= MAX_ITERATIONS_WITH_KEPT_FACTOR { Lag::Keep } else { Lag::RebuildThenKeep };
    progress.set_preconditioner_lag(lag)
}
