//! Linear solvers.

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Diverged, Error, Result, check, require};
use crate::layout::Layout;
use crate::matrix::{Matrix, MatrixView};
use crate::object::{Lent, Object, viewed};
use crate::pc::Pc;
use crate::shell::SHELL;
use crate::text::{from_c, int, option_name, type_name};
use crate::vector::VectorView;

/// A linear solver with its preconditioner. The view [`KspView`] has its methods.
///
/// ```
/// # fn main() -> petsc_wrap::Result<()> {
/// use petsc_wrap::{Ksp, Matrix, Session, Vector};
///
/// let session = Session::start(&[]).expect("the first session")?;
/// let comm = session.alone();
/// let matrix = Matrix::csr(&comm, &[0, 2, 4], &[0, 1, 0, 1], &[2.0, -1.0, -1.0, 2.0])?;
/// let mut solver = Ksp::new(&comm)?;
/// solver.set_operators(&matrix, &matrix)?;
/// solver.set_type("preonly")?;
/// solver.pc()?.set_type("lu")?;
/// let mut b = Vector::new(&comm, 2)?;
/// b.fill(1.0)?;
/// let mut x = b.duplicate()?;
/// solver.solve(&b, &mut x)?;
/// assert_eq!(*x.read()?, [1.0, 1.0]);
/// # Ok(())
/// # }
/// ```
pub struct Ksp(Object<sys::_p_KSP>);

/// A [`Ksp`], or the linear solver of a [`crate::Snes`], which cannot be moved out of it.
#[repr(transparent)]
pub struct KspView([Object<sys::_p_KSP>]);

viewed!(Ksp as KspView of Object<sys::_p_KSP>);

/// Stopping criteria of a linear solver; `None` leaves a limit unchanged.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tolerances {
    /// Residual norm relative to the norm of the right-hand side.
    pub relative: Option<f64>,
    /// Absolute residual norm.
    pub absolute: Option<f64>,
    /// Residual norm, relative to the norm of the right-hand side, above which the solver has diverged.
    pub divergence: Option<f64>,
    /// Largest number of iterations.
    pub iterations: Option<usize>,
}

/// Norm of the residual in the stopping criterion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResidualNorm {
    /// The default of the method.
    Default,
    /// No norm: all iterations are done.
    None,
    /// Norm of the preconditioned residual.
    Preconditioned,
    /// Norm of the true residual.
    Unpreconditioned,
    /// Norm in the inner product of the preconditioner.
    Natural,
}

impl ResidualNorm {
    fn raw(self) -> sys::KSPNormType {
        match self {
            Self::Default => sys::KSPNormType::KSP_NORM_DEFAULT,
            Self::None => sys::KSPNormType::KSP_NORM_NONE,
            Self::Preconditioned => sys::KSPNormType::KSP_NORM_PRECONDITIONED,
            Self::Unpreconditioned => sys::KSPNormType::KSP_NORM_UNPRECONDITIONED,
            Self::Natural => sys::KSPNormType::KSP_NORM_NATURAL,
        }
    }
}

impl Ksp {
    /// Creates a solver with PETSc's defaults. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn new(comm: &Comm) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::KSPCreate(comm.petsc()?, &raw mut raw) })?;
        // SAFETY: the new solver is ours.
        Ok(unsafe { Self::from_raw(raw, comm) })
    }

    /// Takes ownership of a PETSc solver.
    ///
    /// # Safety
    /// `raw` is a reference to a valid solver on `comm` that nobody else releases or uses while this lives. If it has
    /// operators, they are square AIJ matrices on `comm`. If it has callbacks, they may be called at any time.
    pub unsafe fn from_raw(raw: sys::KSP, comm: &Comm) -> Self {
        // SAFETY: guaranteed by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// A solver that belongs to a nonlinear solver.
    ///
    /// # Safety
    /// Same as [`Self::from_raw`], except that the owner keeps the reference during `'a`.
    pub(crate) unsafe fn lent<'a>(raw: sys::KSP, owner: &'a Object<sys::_p_SNES>) -> Lent<'a, Self> {
        // SAFETY: guaranteed by the caller.
        Lent::new(Self(unsafe { Object::lent(raw, owner.comm()) }.part_of(owner)))
    }

    /// Destroys the solver and its factor immediately. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}

impl KspView {
    fn raw(&self) -> Result<sys::KSP> {
        self.inner().whole()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::KSP {
        self.inner().raw()
    }

    /// The communicator of this object.
    pub fn comm(&self) -> &Comm {
        self.inner().comm()
    }

    /// Sets the prefix of this solver's options: empty, or a name that ends in an underscore.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a prefix that begins with a dash.
    pub fn set_options_prefix(&mut self, prefix: &str) -> Result<()> {
        let prefix = option_name(prefix)?;
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::KSPSetOptionsPrefix(self.raw()?, prefix.as_ptr()) })
    }

    /// Sets the operator of the system, and the matrix from which the preconditioner is made. The solver keeps both. If
    /// one has changed, the next solve sets up the preconditioner again. Collective.
    ///
    /// # Errors
    /// If the matrices are not square and AIJ, if their layouts differ from each other or from the layout of the
    /// matrices before, or if a PETSc call fails.
    pub fn set_operators(&mut self, operator: &MatrixView, preconditioner: &MatrixView) -> Result<()> {
        operator.require_aij()?;
        preconditioner.require_aij()?;
        self.set_both(operator, preconditioner)
    }

    pub(crate) fn set_both(&mut self, operator: &MatrixView, preconditioner: &MatrixView) -> Result<()> {
        operator.require_square()?;
        preconditioner.require_square()?;
        let layout = operator.row_layout();
        layout.require_same(preconditioner.row_layout())?;
        require(self.comm().is_congruent(operator.comm()), "the matrix lives on other ranks than the solver")?;
        if let Some([before, _]) = self.operators()? {
            // SAFETY: the solver keeps the matrix.
            layout.require_same(unsafe { self.layout_of(before) }?)?;
        }
        // SAFETY: all are valid; PETSc counts its own references.
        check(unsafe { sys::KSPSetOperators(self.raw()?, operator.raw(), preconditioner.raw()) })
    }

    /// Returns the operator and the preconditioner's matrix, if they are set.
    fn operators(&self) -> Result<Option<[sys::Mat; 2]>> {
        let (mut has_operator, mut has_matrix) = (sys::FALSE, sys::FALSE);
        // SAFETY: the solver is valid here and below.
        check(unsafe { sys::KSPGetOperatorsSet(self.raw()?, &raw mut has_operator, &raw mut has_matrix) })?;
        if has_operator != sys::TRUE || has_matrix != sys::TRUE {
            return Ok(None);
        }
        let (mut operator, mut matrix) = (std::ptr::null_mut(), std::ptr::null_mut());
        // SAFETY: as above.
        check(unsafe { sys::KSPGetOperators(self.raw()?, &raw mut operator, &raw mut matrix) })?;
        Ok(Some([operator, matrix]))
    }

    /// Row layout of a matrix of this solver.
    ///
    /// # Safety
    /// The matrix is valid during `'a`, and on the same number of ranks as the solver.
    unsafe fn layout_of<'a>(&'a self, matrix: sys::Mat) -> Result<Layout<'a>> {
        let mut ranges = std::ptr::null();
        // SAFETY: guaranteed by the caller.
        check(unsafe { sys::MatGetOwnershipRanges(matrix, &raw mut ranges) })?;
        // SAFETY: guaranteed by the caller.
        Ok(unsafe { Layout::from_raw(self.comm(), ranges) })
    }

    /// Chooses the method: `preonly`, `cg`, `minres`, `gmres`, `fgmres` or `bcgs`.
    ///
    /// # Errors
    /// If the name is another one, or if a PETSc call fails.
    pub fn set_type(&mut self, name: &str) -> Result<()> {
        let name = type_name(name, &["preonly", "cg", "minres", "gmres", "fgmres", "bcgs"])?;
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::KSPSetType(self.raw()?, name.as_ptr()) })
    }

    /// Name of the method; empty if none is chosen.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn type_name(&self) -> Result<String> {
        let mut name = std::ptr::null();
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPGetType(self.raw()?, &raw mut name) })?;
        // SAFETY: the name is valid while the solver is, or null.
        Ok(unsafe { from_c(name) })
    }

    /// Sets the stopping criteria.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a negative tolerance.
    pub fn set_tolerances(&mut self, tolerances: Tolerances) -> Result<()> {
        let same = f64::from(sys::PETSC_DEFAULT);
        let [relative, absolute, divergence] =
            [tolerances.relative, tolerances.absolute, tolerances.divergence].map(|limit| limit.unwrap_or(same));
        let iterations = tolerances.iterations.map_or(Ok(sys::PETSC_DEFAULT as Int), int)?;
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetTolerances(self.raw()?, relative, absolute, divergence, iterations) })
    }

    /// Sets the norm of the stopping criterion.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn set_residual_norm(&mut self, norm: ResidualNorm) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetNormType(self.raw()?, norm.raw()) })
    }

    /// Sets whether a solve starts from the given x (`true`) or from zero.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn set_initial_guess_nonzero(&mut self, from_x: bool) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetInitialGuessNonzero(self.raw()?, if from_x { sys::TRUE } else { sys::FALSE }) })
    }

    /// Applies the options database to this solver and its preconditioner. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for unknown types among the options.
    pub fn set_from_options(&mut self) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetFromOptions(self.raw()?) })
    }

    /// The preconditioner.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn pc(&mut self) -> Result<Pc<'_>> {
        // SAFETY: the solver is valid, and borrowed by the returned preconditioner.
        unsafe { Pc::of(self.raw()?) }
    }

    /// Solves operator·x = b; factorises again if the matrix has changed. Collective.
    ///
    /// # Errors
    /// If the solver has no operators, the matrix is not assembled, a row has no entry on the diagonal (which `none`,
    /// `jacobi`, `lu` and `cholesky` do not need), or a vector has another layout. If a PETSc call fails: then the solver
    /// cannot be used any more. [`Diverged`] with the reason if the solver does not converge.
    pub fn solve(&mut self, b: &VectorView, x: &mut VectorView) -> Result<()> {
        self.require_fit(b, x)?;
        let raw = self.raw()?;
        // With some options PETSc writes to the right-hand side and later restores it. Others may be reading b.
        let mut own = b.duplicate()?;
        own.copy_from(b)?;
        // SAFETY: all are valid, different and of one layout.
        let solved = self.inner().solved(unsafe { sys::KSPSolve(raw, own.raw(), x.raw()) });
        own.destroy()?;
        solved?;
        let mut reason = sys::KSPConvergedReason(0);
        // SAFETY: the solver is valid and has solved.
        check(unsafe { sys::KSPGetConvergedReason(raw, &raw mut reason) })?;
        if reason.0 > 0 {
            return Ok(());
        }
        let mut norm = 0.0;
        // SAFETY: as above.
        check(unsafe { sys::KSPGetResidualNorm(raw, &raw mut norm) })?;
        let iterations = self.iterations()?;
        // SAFETY: as above.
        let reason = unsafe { reason_of(raw) }?;
        Err(Error::Diverged(Diverged { solver: "KSP", reason, iterations, norm }))
    }

    /// Checks the arguments that PETSc would use unchecked.
    fn require_fit(&self, b: &VectorView, x: &VectorView) -> Result<()> {
        let Some(operators) = self.operators()? else { return require(false, "the solver has no operator yet") };
        for matrix in operators {
            // SAFETY: the solver keeps its matrices, and they live on its ranks.
            let layout = unsafe { self.layout_of(matrix) }?;
            layout.require_same(b.layout())?;
            layout.require_same(x.layout())?;
            let mut assembled = sys::FALSE;
            // SAFETY: as above.
            check(unsafe { sys::MatAssembled(matrix, &raw mut assembled) })?;
            require(assembled == sys::TRUE, "the matrix is not assembled")?;
        }
        // SAFETY: the solver keeps its matrices, which live on its ranks.
        let matrix = unsafe { Matrix::lent(operators[1], self.comm()) };
        if matrix.require_aij().is_ok() {
            // SAFETY: the solver is valid.
            return unsafe { require_entries(self.raw()?, &matrix) };
        }
        // SAFETY: as above.
        let kind = unsafe { Pc::of(self.raw()?) }?.type_name()?;
        require(kind.as_bytes() == SHELL.to_bytes(), "the preconditioner is not for matrices of this storage")
    }

    /// Number of iterations of the last solve.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn iterations(&self) -> Result<usize> {
        // SAFETY: the solver is valid.
        unsafe { iterations_of(self.raw()?) }
    }
}

/// Returns an error, on all ranks, if the preconditioner needs entries that this square AIJ matrix does not have. The
/// smoother of multigrid reads the diagonal entry of each row, and in a row without one what lies behind its entries;
/// each rank's solver under `redundant` may be multigrid too. Incomplete factors, which are the default, would fail on
/// one rank alone. Collective.
///
/// # Safety
/// The solver is valid.
pub(crate) unsafe fn require_entries(ksp: sys::KSP, matrix: &MatrixView) -> Result<()> {
    // SAFETY: guaranteed by the caller.
    let kind = unsafe { Pc::of(ksp) }?.type_name()?;
    let needs_diagonal = ["", "ilu", "bjacobi", "redundant", "gamg"].contains(&&*kind);
    if needs_diagonal { matrix.require_diagonal() } else { Ok(()) }
}

/// Number of iterations of a solver's last solve.
///
/// # Safety
/// The solver is valid.
pub(crate) unsafe fn iterations_of(ksp: sys::KSP) -> Result<usize> {
    let mut iterations = 0;
    // SAFETY: guaranteed by the caller.
    check(unsafe { sys::KSPGetIterationNumber(ksp, &raw mut iterations) })?;
    Ok(iterations as usize)
}

/// PETSc's name of the reason why the solver stopped.
///
/// # Safety
/// The solver is valid.
pub(crate) unsafe fn reason_of(ksp: sys::KSP) -> Result<String> {
    let mut text = std::ptr::null();
    // SAFETY: the solver is valid; the text is static.
    check(unsafe { sys::KSPGetConvergedReasonString(ksp, &raw mut text) })?;
    let (mut failed, mut pc) = (sys::PCFailedReason(0), std::ptr::null_mut());
    // SAFETY: as above; the preconditioner belongs to the solver.
    check(unsafe { sys::KSPGetPC(ksp, &raw mut pc) })?;
    // SAFETY: as above.
    check(unsafe { sys::PCGetFailedReason(pc, &raw mut failed) })?;
    let cause = match failed {
        sys::PCFailedReason::PC_FACTOR_STRUCT_ZEROPIVOT | sys::PCFailedReason::PC_FACTOR_NUMERIC_ZEROPIVOT => {
            " (zero pivot: the matrix is singular)"
        }
        sys::PCFailedReason::PC_FACTOR_OUTMEMORY => " (out of memory in the factorisation)",
        _ => "",
    };
    // SAFETY: a static text.
    Ok(unsafe { from_c(text) } + cause)
}
