//! Linear solvers.

use std::ffi::{CStr, CString};

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Diverged, Error, Result, check, owned};
use crate::matrix::Matrix;
use crate::object::Object;
use crate::vector::Vector;

/// Relative residual at which iterative methods stop: PETSc's 1e-5 would be an error of that size in every step.
const ITERATIVE: f64 = 1e-12;

/// How a symmetric positive definite system is solved, where PETSc's options say nothing else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// One factorisation, by CHOLMOD on one rank, where its solves are the fastest, else by MUMPS. Without MUMPS each of several ranks has
    /// a factor of all by CHOLMOD, and without both by PETSc itself.
    Cholesky,
    /// Conjugate gradients from the given guess on, preconditioned with multigrid of smoothed aggregates (GAMG), which knows the matrix's
    /// near null space, down to a part of the right-hand side in the norm of the preconditioner, which is nearly that of the energy.
    Multigrid {
        /// That part.
        tolerance: f64,
    },
    /// Conjugate gradients, preconditioned with the diagonal: for matrices like that of the mass.
    Diagonal {
        /// Relative residual.
        tolerance: f64,
    },
}

/// A linear solver with its preconditioner.
pub struct Ksp(Object<sys::_p_KSP>);

impl Ksp {
    /// [`Self::with`] Cholesky's method. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for unknown types among the options.
    pub fn new(comm: &Comm, prefix: &str, matrix: &Matrix) -> Result<Self> {
        Self::with(comm, prefix, matrix, Method::Cholesky)
    }

    /// A solver of a symmetric positive definite matrix, whose options begin with `prefix` (empty, or ending in an underscore), by a method,
    /// or whatever else by PETSc's options; an iterative one of theirs in the place of a factor stops at a relative residual of 1e-12, and
    /// one in the place of conjugate gradients at theirs, in its own norm and from zero. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for unknown types among the options.
    pub fn with(comm: &Comm, prefix: &str, matrix: &Matrix, method: Method) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the communicator is valid and the out-pointer too.
        check(unsafe { sys::KSPCreate(comm.raw(), &raw mut raw) })?;
        let ksp = Self(Object::new(raw, comm));
        let prefix = CString::new(prefix.replace('\0', "")).unwrap_or_default();
        // SAFETY: PETSc copies the string.
        check(unsafe { sys::KSPSetOptionsPrefix(raw, prefix.as_ptr()) })?;
        // SAFETY: all are valid; PETSc counts its own references.
        check(unsafe { sys::KSPSetOperators(raw, matrix.raw(), matrix.raw()) })?;
        let tolerance = match method {
            Method::Cholesky => {
                default_to_cholesky(raw, matrix)?;
                ITERATIVE
            }
            Method::Multigrid { tolerance } => {
                default_to_gradients(raw, c"gamg")?;
                // SAFETY: the solver is valid here and below.
                check(unsafe { sys::KSPSetNormType(raw, sys::KSPNormType::KSP_NORM_NATURAL) })?;
                // SAFETY: as above.
                check(unsafe { sys::KSPSetInitialGuessNonzero(raw, sys::TRUE) })?;
                tolerance
            }
            Method::Diagonal { tolerance } => {
                default_to_gradients(raw, c"jacobi")?;
                tolerance
            }
        };
        let same = f64::from(sys::PETSC_DEFAULT);
        // SAFETY: the solver is valid here and below.
        check(unsafe { sys::KSPSetTolerances(raw, tolerance, same, same, sys::PETSC_DEFAULT as Int) })?;
        // SAFETY: as above.
        check(unsafe { sys::KSPSetFromOptions(raw) })?;
        if matches!(method, Method::Multigrid { .. }) && !ksp.is("cg")? {
            // Not every method has that norm, nor starts from a guess.
            // SAFETY: as above.
            check(unsafe { sys::KSPSetNormType(raw, sys::KSPNormType::KSP_NORM_DEFAULT) })?;
            // SAFETY: as above.
            check(unsafe { sys::KSPSetInitialGuessNonzero(raw, sys::FALSE) })?;
        }
        Ok(ksp)
    }

    /// Solves self·x = b; factorises when the matrix has changed. Collective.
    ///
    /// # Errors
    /// PETSc's, or [`Diverged`] with the reason.
    pub fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        let raw = self.0.raw();
        // SAFETY: all are valid.
        check(unsafe { sys::KSPSolve(raw, b.raw(), x.raw()) })?;
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
        Err(Error::Diverged(Diverged { solver: "KSP", reason: reason_of(raw)?, iterations, norm }))
    }

    /// Whether the preconditioner alone solves, as a factor does.
    ///
    /// # Errors
    /// PETSc's.
    pub fn is_direct(&self) -> Result<bool> {
        self.is("preonly")
    }

    /// Whether its method has this name.
    fn is(&self, name: &str) -> Result<bool> {
        let mut kind = std::ptr::null();
        // SAFETY: the solver is valid; the name is static or null.
        check(unsafe { sys::KSPGetType(self.0.raw(), &raw mut kind) })?;
        Ok(owned(kind) == name)
    }

    /// Iterations of the last solve.
    ///
    /// # Errors
    /// PETSc's.
    pub fn iterations(&self) -> Result<usize> {
        let mut iterations = 0;
        // SAFETY: the solver is valid.
        check(unsafe { sys::KSPGetIterationNumber(self.0.raw(), &raw mut iterations) })?;
        Ok(iterations as usize)
    }

    /// Destroys it at once, its factor too. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn destroy(self) -> Result<()> {
        self.0.destroy()
    }
}

/// One application of Cholesky's method, by CHOLMOD where that takes the matrix, else by MUMPS (which is parallel); options override it.
fn default_to_cholesky(ksp: sys::KSP, matrix: &Matrix) -> Result<()> {
    // SAFETY: `ksp` is valid; the type is a C string.
    check(unsafe { sys::KSPSetType(ksp, c"preonly".as_ptr()) })?;
    precondition_by_cholesky(ksp, matrix, [CHOLMOD, MUMPS])
}

/// Conjugate gradients with a preconditioner; options override it.
fn default_to_gradients(ksp: sys::KSP, kind: &CStr) -> Result<()> {
    // SAFETY: `ksp` is valid here and below; types are C strings.
    check(unsafe { sys::KSPSetType(ksp, c"cg".as_ptr()) })?;
    // SAFETY: as above; the preconditioner belongs to the solver.
    check(unsafe { sys::PCSetType(preconditioner(ksp)?, kind.as_ptr()) })
}

/// Conjugate gradients, by default preconditioned with Cholesky's method by MUMPS: with the matrix's own factor one
/// iteration solves, with that of a matrix nearby a few.
pub(crate) fn default_to_refined_cholesky(ksp: sys::KSP, matrix: &Matrix) -> Result<()> {
    // SAFETY: `ksp` is valid here and below; types are C strings.
    check(unsafe { sys::KSPSetType(ksp, c"cg".as_ptr()) })?;
    let (default, most) = (f64::from(sys::PETSC_DEFAULT), 100);
    // Residuals of conjugate gradients rise before they fall, by the root of the condition number: no sign of divergence.
    let any_growth = f64::MAX;
    // SAFETY: as above.
    check(unsafe { sys::KSPSetTolerances(ksp, DIRECT, default, any_growth, most) })?;
    // SAFETY: all are valid; PETSc counts its own references.
    check(unsafe { sys::KSPSetOperators(ksp, matrix.raw(), matrix.raw()) })?;
    precondition_by_cholesky(ksp, matrix, [MUMPS, CHOLMOD])
}

/// Relative residual at which an iteration counts as a direct solve: rounding in a backward-stable one leaves about as much.
const DIRECT: f64 = 1e-13;

const CHOLMOD: &CStr = c"cholmod";
pub(crate) const MUMPS: &CStr = c"mumps";

/// Cholesky's method by the first of the packages that takes the matrix. Without any that takes one of several ranks each solves for all of
/// it, by CHOLMOD, or else by PETSc itself. The matrix is the solver's.
fn precondition_by_cholesky(ksp: sys::KSP, matrix: &Matrix, packages: [&CStr; 2]) -> Result<()> {
    let mut pc = preconditioner(ksp)?;
    let mut package = None;
    for name in packages {
        if package.is_none() && factorises(name, matrix)? {
            package = Some(name);
        }
    }
    if package.is_none() && matrix.comm().size() > 1 {
        // SAFETY: the preconditioner is valid and has its matrix; the type is a C string.
        check(unsafe { sys::PCSetType(pc, c"redundant".as_ptr()) })?;
        let mut each = std::ptr::null_mut();
        // SAFETY: as above; the solver of each rank belongs to the preconditioner.
        check(unsafe { sys::PCRedundantGetKSP(pc, &raw mut each) })?;
        pc = preconditioner(each)?;
        package = is_known(CHOLMOD, c"seqaij")?.then_some(CHOLMOD);
    }
    // SAFETY: the preconditioner is valid here and below, and names are C strings.
    check(unsafe { sys::PCSetType(pc, c"cholesky".as_ptr()) })?;
    match package {
        // SAFETY: as above.
        Some(name) => check(unsafe { sys::PCFactorSetMatSolverType(pc, name.as_ptr()) }),
        None => Ok(()),
    }
}

/// Whether PETSc has a package for Cholesky's method that takes matrices of a type.
pub(crate) fn is_known(package: &CStr, matrix: &CStr) -> Result<bool> {
    let (kind, none) = (sys::MatFactorType::MAT_FACTOR_CHOLESKY, std::ptr::null_mut());
    let mut is_there = sys::FALSE;
    // Packages are known from the first matrix on.
    // SAFETY: PETSc is initialised.
    check(unsafe { sys::MatInitializePackage() })?;
    let (package, matrix) = (package.as_ptr(), matrix.as_ptr());
    // SAFETY: names and the out-pointer are valid, and null asks for nothing.
    check(unsafe { sys::MatSolverTypeGet(package, matrix, kind, none, &raw mut is_there, std::ptr::null_mut()) })?;
    Ok(is_there == sys::TRUE)
}

/// Whether PETSc has a package for Cholesky's method that takes a matrix of this type on this number of ranks.
pub(crate) fn factorises(package: &CStr, matrix: &Matrix) -> Result<bool> {
    let (kind, mut is_there) = (sys::MatFactorType::MAT_FACTOR_CHOLESKY, sys::FALSE);
    // SAFETY: the matrix, the name and the out-pointer are valid.
    check(unsafe { sys::MatGetFactorAvailable(matrix.raw(), package.as_ptr(), kind, &raw mut is_there) })?;
    Ok(is_there == sys::TRUE)
}

fn preconditioner(ksp: sys::KSP) -> Result<sys::PC> {
    let mut pc = std::ptr::null_mut();
    // SAFETY: the solver is valid, and the preconditioner belongs to it.
    check(unsafe { sys::KSPGetPC(ksp, &raw mut pc) })?;
    Ok(pc)
}

/// Whether the options have left [`default_to_refined_cholesky`] as it is.
pub(crate) fn is_refined_cholesky(ksp: sys::KSP) -> Result<bool> {
    let (mut ksp_type, mut pc_type) = (std::ptr::null(), std::ptr::null());
    // SAFETY: `ksp` is valid here and below; the names are static or null.
    check(unsafe { sys::KSPGetType(ksp, &raw mut ksp_type) })?;
    // SAFETY: as above.
    check(unsafe { sys::PCGetType(preconditioner(ksp)?, &raw mut pc_type) })?;
    Ok(owned(ksp_type) == "cg" && ["cholesky", "redundant"].contains(&owned(pc_type).as_str()))
}

/// PETSc's name of why the solver stopped.
pub(crate) fn reason_of(ksp: sys::KSP) -> Result<String> {
    let mut text = std::ptr::null();
    // SAFETY: the solver is valid; the text is static.
    check(unsafe { sys::KSPGetConvergedReasonString(ksp, &raw mut text) })?;
    let mut failed = sys::PCFailedReason(0);
    // SAFETY: as above.
    check(unsafe { sys::PCGetFailedReason(preconditioner(ksp)?, &raw mut failed) })?;
    let cause = match failed {
        sys::PCFailedReason::PC_FACTOR_STRUCT_ZEROPIVOT | sys::PCFailedReason::PC_FACTOR_NUMERIC_ZEROPIVOT => {
            " (zero pivot: the matrix is singular)"
        }
        sys::PCFailedReason::PC_FACTOR_OUTMEMORY => " (out of memory in the factorisation)",
        _ => "",
    };
    Ok(owned(text) + cause)
}
