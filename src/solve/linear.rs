//! Linear systems of symmetric positive definite matrices.

use petsc_wrap::{
    Comm, Factor, FactorEstimate, Ksp, KspView, MatrixView, Preconditioner, ResidualNorm, Result, Session, Tolerances,
    options,
};

use super::blocks::Triangle;
use super::incomplete::IncompleteCholesky;
use super::substructure::Substructures;

/// Relative residual at which iterative methods stop: PETSc's 1e-5 would be an error of that size in every step.
const ITERATIVE: f64 = 1e-12;

/// How a system is solved, where PETSc's options say nothing else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// One factorisation: by CHOLMOD on one rank. Several ranks have factors of their parts and of the interface between them
    /// (`solve/substructure`), where that is small; else they share one by MUMPS. Without MUMPS each of them has a factor of all by CHOLMOD, and without
    /// both by PETSc itself.
    Cholesky,
    /// Conjugate gradients from the given guess on, preconditioned with multigrid of smoothed aggregates (GAMG), which knows the matrix's
    /// near null space, down to a part of the right-hand side in the norm of the preconditioner, which is nearly that of the energy.
    Multigrid {
        /// That part.
        tolerance: f64,
    },
    /// The same, preconditioned with an incomplete Cholesky factor of each rank's rows in blocks of three, and products with one triangle: for
    /// operators that are not much stiffer than the mass in them ([`Method::for_stiffness`]). Options of PETSc's that name a method or a preconditioner take
    /// [`Method::Multigrid`] as what they change.
    Incomplete {
        /// That part.
        tolerance: f64,
    },
    /// Conjugate gradients, preconditioned with the diagonal: for matrices like that of the mass.
    Diagonal {
        /// Relative residual.
        tolerance: f64,
    },
}

/// Largest ratio tr K / (c₂ tr M) for which an incomplete factor is quicker than multigrid. Measured on a quarter of a plate of 0.1 m in quadratic
/// hexahedra: an iteration of multigrid costs more than 7.5 ones with the factor; multigrid takes 20, 26 and 32 iterations, the factor 23, 76 and
/// 90 at ratios of 1,700, 43,000 and 174,000. It is not known where it ends to be quicker.
const STIFFEST: f64 = 2e5;

/// Memory that the factor of a large matrix may take, over all ranks, bytes.
const LARGEST_FACTOR: f64 = 8e9;

impl Method {
    /// That for the dozens of solves with one matrix which a basis takes: a factor in the place of multigrid, where MUMPS expects it to fit. A plate of
    /// 307,000 unknowns takes 50 s with it, and more than six minutes with multigrid.
    pub fn for_basis(self, expected: Option<FactorEstimate>) -> Self {
        match (self, expected) {
            (Self::Multigrid { .. }, Some(factor)) if factor.memory <= LARGEST_FACTOR => Self::Cholesky,
            (method, _) => method,
        }
    }

    /// The quicker iteration for an operator K + c₂ M with tr K so many times c₂ tr M; other methods stay as they are.
    pub fn for_stiffness(self, ratio: f64) -> Self {
        match self {
            Self::Multigrid { tolerance } if ratio <= STIFFEST => Self::Incomplete { tolerance },
            method => method,
        }
    }
}

/// A solver whose options begin with `prefix` (empty, or ending in an underscore), by a method, or by whatever PETSc's options say. An
/// iterative method of theirs in the place of a factor stops at a relative residual of 1e-12, and one in the place of conjugate gradients at
/// theirs, in its own norm and from zero. Collective.
///
/// # Errors
/// PETSc's, e.g. for unknown types among the options.
pub fn solver(comm: &Comm, prefix: &str, matrix: &MatrixView, method: Method) -> Result<Ksp> {
    solver_of_nodes(comm, prefix, matrix, method, None)
}

/// [`solver`] of a matrix whose rows are by nodes, three unknowns each, where it is known where this rank's nodes lie (m): an incomplete factor
/// is better for it. Collective.
///
/// # Errors
/// As of [`solver`].
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
            let triangle = Triangle::new(matrix, places)?;
            let mut factor = IncompleteCholesky::new(&triangle);
            let operator = triangle.into_operator(matrix)?;
            ksp.set_closure(&operator, move |b, x| factor.solve(b, x))?;
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
        // Not every method has that norm, nor starts from a guess.
        ksp.set_residual_norm(ResidualNorm::Default)?;
        ksp.set_initial_guess_nonzero(false)?;
    }
    Ok(ksp)
}

/// Whether the preconditioner alone solves, as a factor does.
///
/// # Errors
/// PETSc's.
pub fn is_direct(ksp: &KspView) -> Result<bool> {
    Ok(ksp.type_name()? == "preonly")
}

/// Whether PETSc's options name a method or a preconditioner.
fn is_chosen(comm: &Comm, prefix: &str) -> Result<bool> {
    let is_set = |name: &str| options::is_set(comm.session(), &format!("-{prefix}{name}"));
    Ok(is_set("ksp_type")? || is_set("pc_type")? || is_set("pc_factor_mat_solver_type")?)
}

/// From the given guess on, and in the norm of the preconditioner.
fn start_from_guess(ksp: &mut KspView) -> Result<()> {
    ksp.set_residual_norm(ResidualNorm::Natural)?;
    ksp.set_initial_guess_nonzero(true)
}

/// Conjugate gradients with a preconditioner.
fn set_gradients(ksp: &mut KspView, preconditioner: &str) -> Result<()> {
    ksp.set_type("cg")?;
    ksp.pc()?.set_type(preconditioner)
}

/// Packages that factorise; MUMPS is parallel.
const CHOLMOD: &str = "cholmod";
const MUMPS: &str = "mumps";

/// Memory beyond what MUMPS expects to need, %. With its own 20 to 30 a factorisation on two ranks has run out of it once in a hundred.
pub(super) const MARGIN: u8 = 80;

/// Relative residual at which an iteration counts as a direct solve: rounding in a backward-stable one leaves about as much.
const DIRECT: f64 = 1e-13;

/// Conjugate gradients, preconditioned with Cholesky's method by MUMPS: with the matrix's own factor one iteration solves, with that of a
/// matrix nearby a few.
pub(super) fn set_refined_cholesky(ksp: &mut KspView, matrix: &MatrixView) -> Result<()> {
    ksp.set_type("cg")?;
    ksp.set_tolerances(Tolerances {
        relative: Some(DIRECT),
        absolute: None,
        // Residuals of conjugate gradients rise before they fall, by the root of the condition number: no sign of divergence.
        divergence: Some(f64::MAX),
        iterations: Some(100),
    })?;
    ksp.set_operators(matrix, matrix)?;
    precondition_by_cholesky(ksp, matrix, [MUMPS, CHOLMOD])
}

/// Whether the options have left [`set_refined_cholesky`] as it is.
pub(super) fn is_refined_cholesky(ksp: &mut KspView) -> Result<bool> {
    let is_gradients = ksp.type_name()? == "cg";
    Ok(is_gradients && ["cholesky", "redundant"].contains(&ksp.pc()?.type_name()?.as_str()))
}

/// Cholesky's method by the first of the packages that takes the matrix. Without any that takes one of several ranks each solves for all of
/// it, by CHOLMOD, or else by PETSc itself. The matrix is the solver's.
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

/// Whether PETSc was built with MUMPS: without it, each of several ranks factorises all of a matrix for itself.
///
/// # Errors
/// PETSc's.
pub fn has_mumps(session: &Session) -> Result<bool> {
    Factor::Cholesky.is_known(session, MUMPS, "mpiaij")
}
