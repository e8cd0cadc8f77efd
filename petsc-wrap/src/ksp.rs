//! Linear solvers.

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Diverged, Error, Result, check, require};
use crate::layout::Layout;
use crate::matrix::{MatrixView, is_aij};
use crate::object::{Lent, Object, viewed};
use crate::pc::Pc;
use crate::shell::SHELL;
use crate::text::{from_c, int, option_name, to_c};
use crate::vector::VectorView;

/// A linear solver with its preconditioner; its methods are those of [`KspView`].
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

/// When a linear solver stops; `None` leaves a limit as it is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tolerances {
    /// Residual norm relative to that of the right-hand side.
    pub relative: Option<f64>,
    /// Residual norm.
    pub absolute: Option<f64>,
    /// Residual norm relative to that of the right-hand side, beyond which the solver has diverged.
    pub divergence: Option<f64>,
    /// Iterations.
    pub iterations: Option<usize>,
}

/// The norm of the residual by which an iteration stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResidualNorm {
    /// That of the method.
    Default,
    /// None: all iterations are done.
    None,
    /// Of the preconditioned residual.
    Preconditioned,
    /// Of the residual.
    Unpreconditioned,
    /// In the inner product of the preconditioner.
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
    /// A solver with PETSc's defaults. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(comm: &Comm) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::KSPCreate(comm.petsc()?, &raw mut raw) })?;
        // SAFETY: the new solver is ours.
        Ok(unsafe { Self::from_raw(raw, comm) })
    }

    /// Takes over a solver of PETSc's.
    ///
    /// # Safety
    /// `raw` is a reference to a valid solver on `comm` that nobody else releases or uses while this lives. Its operators, where it has some, are
    /// square AIJ matrices on `comm`. Callbacks that it has may be called at any time.
    pub unsafe fn from_raw(raw: sys::KSP, comm: &Comm) -> Self {
        // SAFETY: by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// A solver that stays another's.
    ///
    /// # Safety
    /// As of [`Self::from_raw`], but that its owner keeps the reference during `'a`.
    pub(crate) unsafe fn lent<'a>(raw: sys::KSP, comm: &Comm) -> Lent<'a, Self> {
        // SAFETY: by the caller.
        Lent::new(Self(unsafe { Object::lent(raw, comm) }))
    }

    /// Destroys it at once, its factor too. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}

impl KspView {
    fn raw(&self) -> sys::KSP {
        self.inner().raw()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::KSP {
        self.raw()
    }

    /// The ranks it lives on.
    pub fn comm(&self) -> &Comm {
        self.inner().comm()
    }

    /// Options of this solver begin with the prefix: empty, or ending in an underscore.
    ///
    /// # Errors
    /// PETSc's, e.g. for a prefix that begins with a dash.
    pub fn set_options_prefix(&mut self, prefix: &str) -> Result<()> {
        let prefix = option_name(prefix)?;
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::KSPSetOptionsPrefix(self.raw(), prefix.as_ptr()) })
    }

    /// The operator of the system, and the matrix of which the preconditioner is made. The solver keeps both; where one has changed,
    /// the next solve sets up anew. Collective.
    ///
    /// # Errors
    /// Matrices that are not square and AIJ, or of another layout than each other or than those before; PETSc's.
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
        check(unsafe { sys::KSPSetOperators(self.raw(), operator.raw(), preconditioner.raw()) })
    }

    /// The operator and the preconditioner's matrix, where they are set.
    fn operators(&self) -> Result<Option<[sys::Mat; 2]>> {
        let (mut has_operator, mut has_matrix) = (sys::FALSE, sys::FALSE);
        // SAFETY: the solver is valid here and below.
        check(unsafe { sys::KSPGetOperatorsSet(self.raw(), &raw mut has_operator, &raw mut has_matrix) })?;
        if has_operator != sys::TRUE || has_matrix != sys::TRUE {
            return Ok(None);
        }
        let (mut operator, mut matrix) = (std::ptr::null_mut(), std::ptr::null_mut());
        // SAFETY: as above.
        check(unsafe { sys::KSPGetOperators(self.raw(), &raw mut operator, &raw mut matrix) })?;
        Ok(Some([operator, matrix]))
    }

    /// Who owns which rows of a matrix of this solver.
    ///
    /// # Safety
    /// The matrix is valid during `'a`, and on as many ranks as the solver.
    unsafe fn layout_of<'a>(&'a self, matrix: sys::Mat) -> Result<Layout<'a>> {
        let mut ranges = std::ptr::null();
        // SAFETY: by the caller.
        check(unsafe { sys::MatGetOwnershipRanges(matrix, &raw mut ranges) })?;
        // SAFETY: by the caller.
        Ok(unsafe { Layout::from_raw(self.comm(), ranges) })
    }

    /// Chooses the method (`cg`, `gmres`, `preonly`, …).
    ///
    /// # Errors
    /// PETSc's, e.g. for an unknown name.
    pub fn set_type(&mut self, name: &str) -> Result<()> {
        // SAFETY: the solver is valid; PETSc copies the string.
        check(unsafe { sys::KSPSetType(self.raw(), to_c(name).as_ptr()) })
    }

    /// Name of the method; empty where none is chosen.
    ///
    /// # Errors
    /// PETSc's.
    pub fn type_name(&self) -> Result<String> {
        let mut name = std::ptr::null();
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPGetType(self.raw(), &raw mut name) })?;
        // SAFETY: the name is valid while the solver is, or null.
        Ok(unsafe { from_c(name) })
    }

    /// When to stop.
    ///
    /// # Errors
    /// PETSc's, e.g. for a negative tolerance.
    pub fn set_tolerances(&mut self, tolerances: Tolerances) -> Result<()> {
        let same = f64::from(sys::PETSC_DEFAULT);
        let [relative, absolute, divergence] =
            [tolerances.relative, tolerances.absolute, tolerances.divergence].map(|limit| limit.unwrap_or(same));
        let iterations = tolerances.iterations.map_or(Ok(sys::PETSC_DEFAULT as Int), int)?;
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetTolerances(self.raw(), relative, absolute, divergence, iterations) })
    }

    /// By which norm to stop.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_residual_norm(&mut self, norm: ResidualNorm) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetNormType(self.raw(), norm.raw()) })
    }

    /// Whether a solve starts from the x that it is given, or from zero.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_initial_guess_nonzero(&mut self, from_x: bool) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetInitialGuessNonzero(self.raw(), if from_x { sys::TRUE } else { sys::FALSE }) })
    }

    /// Whatever the options database says of this solver and its preconditioner. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for unknown types among the options.
    pub fn set_from_options(&mut self) -> Result<()> {
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPSetFromOptions(self.raw()) })
    }

    /// The preconditioner.
    ///
    /// # Errors
    /// PETSc's.
    pub fn pc(&mut self) -> Result<Pc<'_>> {
        // SAFETY: the solver is valid, and borrowed by what is returned.
        unsafe { Pc::of(self.raw()) }
    }

    /// Solves operator·x = b; factorises when the matrix has changed. Collective.
    ///
    /// # Errors
    /// A solver without its operators; a matrix that is not assembled; vectors of another layout; PETSc's; [`Diverged`] with the reason.
    pub fn solve(&mut self, b: &VectorView, x: &mut VectorView) -> Result<()> {
        self.require_fit(b, x)?;
        let raw = self.raw();
        let own = OwnMemory::where_read(b)?;
        // SAFETY: all are valid, of one layout, and x is not b by the borrow rules. By some options PETSc writes to b, and writes back what was
        // there: nobody else sees b meanwhile, for its memory is not the one that is read.
        let solved = check(unsafe { sys::KSPSolve(raw, b.raw(), x.raw()) });
        drop(own);
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

    /// Refuses what PETSc would take on trust.
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
        // SAFETY: the solver keeps its matrices.
        if unsafe { is_aij(operators[1]) }? {
            return Ok(());
        }
        // SAFETY: the solver is valid.
        let kind = unsafe { Pc::of(self.raw()) }?.type_name()?;
        require(kind == SHELL, "the preconditioner is not for matrices of this storage")
    }

    /// Iterations of the last solve.
    ///
    /// # Errors
    /// PETSc's.
    pub fn iterations(&self) -> Result<usize> {
        // SAFETY: the solver is valid.
        unsafe { iterations_of(self.raw()) }
    }
}

/// Another memory of a vector's own for its entries, while a read guard looks at the first.
struct OwnMemory<'a> {
    vector: &'a VectorView,
    /// PETSc's meanwhile.
    _entries: Vec<f64>,
}

impl<'a> OwnMemory<'a> {
    /// Of no cost where nobody reads. It is not collective, since others may read on other ranks.
    fn where_read(vector: &'a VectorView) -> Result<Option<Self>> {
        if !vector.is_read() {
            return Ok(None);
        }
        let mut entries = vector.read()?.to_vec();
        // SAFETY: as many entries as the vector has, which stay until `drop` gives the vector its own memory back.
        check(unsafe { sys::VecPlaceArray(vector.raw(), entries.as_mut_ptr()) })?;
        Ok(Some(Self { vector, _entries: entries }))
    }
}

impl Drop for OwnMemory<'_> {
    fn drop(&mut self) {
        // SAFETY: the vector is valid; an error has nobody to go to.
        unsafe { sys::VecResetArray(self.vector.raw()) };
    }
}

/// Iterations of a solver's last solve.
///
/// # Safety
/// The solver is valid.
pub(crate) unsafe fn iterations_of(ksp: sys::KSP) -> Result<usize> {
    let mut iterations = 0;
    // SAFETY: by the caller.
    check(unsafe { sys::KSPGetIterationNumber(ksp, &raw mut iterations) })?;
    Ok(iterations as usize)
}

/// PETSc's name of why the solver stopped.
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
