//! Linear systems with symmetric positive definite matrices.

use petsc_wrap::{
    Comm, Factor, FactorEstimate, Ksp, KspView, MatrixView, Preconditioner, ResidualNorm, Result, Session, Tolerances,
    options,
};

use super::blocks::{SIZE, Triangle};
use super::incomplete::IncompleteCholesky;
use super::substructure::Substructures;

/// Relative residual at which iterative methods stop. With PETSc's default of 1e-5, every time step would have an error
/// of this size.
const ITERATIVE: f64 = 1e-12;

/// Method of solution, unless PETSc's options select another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// A Cholesky factorisation, on one rank by CHOLMOD. On several ranks, if the interface between their parts is
    /// small, each rank factorises its part and all share a factor of the interface (`solve/substructure`). If it is
    /// not small, MUMPS computes one distributed factor. Without MUMPS each rank factorises the whole matrix by
    /// CHOLMOD, and without both by PETSc.
    Cholesky,
    /// Conjugate gradients from the given initial guess, preconditioned with smoothed-aggregation multigrid (GAMG) and
    /// the near null space of the matrix. The residual is measured in the norm of the preconditioner, which is nearly
    /// the energy norm.
    Multigrid {
        /// Residual relative to the right-hand side at which the iteration stops.
        tolerance: f64,
    },
    /// Same as [`Method::Multigrid`], but preconditioned with an incomplete Cholesky factor of each rank's rows in
    /// blocks of three, and with products from one triangle of the matrix. For operators that are not much stiffer than
    /// their mass part ([`Method::for_stiffness`]). If PETSc's options name a method or a preconditioner, they are
    /// applied to [`Method::Multigrid`] instead.
    Incomplete {
        /// Residual relative to the right-hand side at which the iteration stops.
        tolerance: f64,
    },
    /// Conjugate gradients, preconditioned with the diagonal, for matrices such as the mass matrix.
    Diagonal {
        /// Relative residual at which the iteration stops.
        tolerance: f64,
    },
}

/// Largest ratio tr K / (c₂ tr M) for which an incomplete factor is used instead of multigrid. Measured on a quarter of
/// a plate of 0.1 m in quadratic hexahedra: an iteration of multigrid costs more than 7.5 iterations with the factor.
/// At ratios of 1,700, 43,000 and 174,000 multigrid takes 20, 26 and 32 iterations, the factor 23, 76 and 90. The ratio
/// above which multigrid is quicker is unknown.
const STIFFEST: f64 = 2e5;

/// Memory that the factor of a large matrix may use, over all ranks, bytes.
const LARGEST_FACTOR: f64 = 8e9;

impl Method {
    /// Method for the dozens of solves with one matrix needed for a basis. Multigrid is replaced by a Cholesky factor
    /// if the memory expected by MUMPS is small enough. A plate of 307,000 unknowns takes 50 s with the factor and more
    /// than six minutes with multigrid.
    pub fn for_basis(self, expected: Option<FactorEstimate>) -> Self {
        match (self, expected) {
            (Self::Multigrid { .. }, Some(factor)) if factor.memory <= LARGEST_FACTOR => Self::Cholesky,
            (method, _) => method,
        }
    }

    /// Returns the quicker iterative method for an operator K + c₂ M, where `ratio` is tr K / (c₂ tr M). Methods other
    /// than multigrid are unchanged.
    pub fn for_stiffness(self, ratio: f64) -> Self {
        match self {
            Self::Multigrid { tolerance } if ratio <= STIFFEST => Self::Incomplete { tolerance },
            method => method,
        }
    }
}

/// Creates a solver with a method, unless PETSc's options with `prefix` (empty, or ending in an underscore) select
/// another. If the options replace a factorisation by an iterative method, this stops at a relative residual of 1e-12.
/// If they replace conjugate gradients, the other method stops at the same tolerance, in its default norm, and starts
/// from zero. Collective.
///
/// # Errors
/// If a PETSc call fails, e.g. for unknown types in the options.
pub fn solver(comm: &Comm, prefix: &str, matrix: &MatrixView, method: Method) -> Result<Ksp> {
    solver_of_nodes(comm, prefix, matrix, method, None)
}

/// Same as [`solver`], for a matrix with rows ordered by node, three unknowns each. `places` are the positions of this
/// rank's nodes (m), if known; they improve the incomplete factor. Collective.
///
/// # Errors
/// Same as [`solver`].
pub fn solver_of_nodes(
    comm: &Comm,
    prefix: &str,
    matrix: &MatrixView,
    method: Method,
    places: Option<&[[f64; 3]]>,
) -> Result<Ksp> {
    let mut ksp = Ksp::new(comm)?;
    ksp.set_options_prefix(prefix)?;
    let mut method = method;
    if let Method::Incomplete { tolerance } = method
        && is_chosen(comm, prefix)?
    {
        method = Method::Multigrid { tolerance };
    }
    if !matches!(method, Method::Incomplete { .. }) {
        ksp.set_operators(matrix, matrix)?;
    }
    let tolerance = match method {
        Method::Cholesky => {
            ksp.set_type("preonly")?;
            if comm.size() > 1 && !is_chosen(comm, prefix)? && Substructures::is_suitable(matrix)? {
                ksp.set_factorisation(matrix, |matrix| {
                    let factors = Substructures::new(matrix)?;
                    Ok(factors.map(|mut factors| -> Preconditioner { Box::new(move |b, x| factors.solve(b, x)) }))
                })?;
            } else {
                precondition_by_cholesky(&mut ksp, matrix, [CHOLMOD, MUMPS])?;
            }
            ITERATIVE
        }
        Method::Multigrid { tolerance } => {
            set_gradients(&mut ksp, "gamg")?;
            start_from_guess(&mut ksp)?;
            tolerance
        }
        Method::Incomplete { tolerance } => {
            ksp.set_type("cg")?;
            let mut factor = IncompleteCholesky::new(Triangle::new(matrix, places)?);
            ksp.set_closure(&matrix.upper_triangle(SIZE)?, move |b, x| factor.solve(b, x))?;
            start_from_guess(&mut ksp)?;
            tolerance
        }
        Method::Diagonal { tolerance } => {
            set_gradients(&mut ksp, "jacobi")?;
            tolerance
        }
    };
    ksp.set_tolerances(Tolerances { relative: Some(tolerance), ..Default::default() })?;
    ksp.set_from_options()?;
    ksp.pc()?.set_mumps_margin(MARGIN)?;
    if matches!(method, Method::Multigrid { .. }) && ksp.type_name()? != "cg" {
        // Not every method supports this norm or an initial guess.
        ksp.set_residual_norm(ResidualNorm::Default)?;
        ksp.set_initial_guess_nonzero(false)?;
    }
    Ok(ksp)
}

/// Whether the solver applies only the preconditioner, as with a factorisation.
///
/// # Errors
/// If a PETSc call fails.
pub fn is_direct(ksp: &KspView) -> Result<bool> {
    Ok(ksp.type_name()? == "preonly")
}

/// Whether PETSc's options name a method, a preconditioner or a factorisation package.
fn is_chosen(comm: &Comm, prefix: &str) -> Result<bool> {
    let is_set = |name: &str| options::is_set(comm.session(), &format!("-{prefix}{name}"));
    Ok(is_set("ksp_type")? || is_set("pc_type")? || is_set("pc_factor_mat_solver_type")?)
}

/// Makes the solver start from the given initial guess and measure residuals in the norm of the preconditioner.
fn start_from_guess(ksp: &mut KspView) -> Result<()> {
    ksp.set_residual_norm(ResidualNorm::Natural)?;
    ksp.set_initial_guess_nonzero(true)
}

/// Sets conjugate gradients with a preconditioner.
fn set_gradients(ksp: &mut KspView, preconditioner: &str) -> Result<()> {
    ksp.set_type("cg")?;
    ksp.pc()?.set_type(preconditioner)
}

/// Packages for Cholesky factorisation; MUMPS is parallel.
const CHOLMOD: &str = "cholmod";
const MUMPS: &str = "mumps";

/// Memory in addition to the estimate of MUMPS, %. With its default of 20 to 30, one in a hundred factorisations on two
/// ranks ran out of memory.
pub(super) const MARGIN: u8 = 80;

/// Relative residual at which an iteration counts as a direct solve. Rounding in a backward-stable direct solve leaves
/// about as much.
const DIRECT: f64 = 1e-13;

/// Sets conjugate gradients, preconditioned with a Cholesky factor by MUMPS. With the factor of the same matrix one
/// iteration suffices, with the factor of a similar matrix a few.
pub(super) fn set_refined_cholesky(ksp: &mut KspView, matrix: &MatrixView) -> Result<()> {
    ksp.set_type("cg")?;
    ksp.set_tolerances(Tolerances {
        relative: Some(DIRECT),
        absolute: None,
        // Residuals of conjugate gradients may first rise by the root of the condition number; this is not divergence.
        divergence: Some(f64::MAX),
        iterations: Some(100),
    })?;
    ksp.set_operators(matrix, matrix)?;
    precondition_by_cholesky(ksp, matrix, [MUMPS, CHOLMOD])
}

/// Whether PETSc's options have left the settings of [`set_refined_cholesky`] unchanged.
pub(super) fn is_refined_cholesky(ksp: &mut KspView) -> Result<bool> {
    let is_gradients = ksp.type_name()? == "cg";
    Ok(is_gradients && ["cholesky", "redundant"].contains(&ksp.pc()?.type_name()?.as_str()))
}

/// Sets a Cholesky factorisation by the first of the packages that supports the matrix. If none supports a matrix
/// distributed over several ranks, each rank factorises the whole matrix, by CHOLMOD or else by PETSc. The matrix must
/// be the operator of the solver.
fn precondition_by_cholesky(ksp: &mut KspView, matrix: &MatrixView, packages: [&str; 2]) -> Result<()> {
    let mut pc = ksp.pc()?;
    let mut package = None;
    for name in packages {
        if package.is_none() && Factor::Cholesky.is_available(name, matrix)? {
            package = Some(name);
        }
    }
    let mut each;
    let pc = if package.is_none() && matrix.comm().size() > 1 {
        pc.set_type("redundant")?;
        each = pc.redundant_pc()?;
        package = Factor::Cholesky.is_known(matrix.comm().session(), CHOLMOD, "seqaij")?.then_some(CHOLMOD);
        &mut each
    } else {
        &mut pc
    };
    pc.set_type("cholesky")?;
    package.map_or(Ok(()), |name| pc.set_factor_package(name))
}

/// Whether PETSc was built with MUMPS. Without MUMPS, each of several ranks factorises the whole matrix.
///
/// # Errors
/// If a PETSc call fails.
pub fn has_mumps(session: &Session) -> Result<bool> {
    Factor::Cholesky.is_known(session, MUMPS, "mpiaij")
}
