//! Packages for factorisations, and estimates of the cost of a factorisation.

use petsc_sys as sys;

use crate::error::{Result, check};
use crate::matrix::{Matrix, MatrixView};
use crate::session::Session;
use crate::text::to_c;

/// Kind of factorisation of a square matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Factor {
    /// L U.
    Lu,
    /// L Lᵀ of a symmetric positive definite matrix.
    Cholesky,
}

impl Factor {
    fn raw(self) -> sys::MatFactorType {
        match self {
            Self::Lu => sys::MatFactorType::MAT_FACTOR_LU,
            Self::Cholesky => sys::MatFactorType::MAT_FACTOR_CHOLESKY,
        }
    }

    /// Whether PETSc was built with this package (`mumps`, `cholmod`, `petsc`, …) for this factorisation of matrices of
    /// this type (`seqaij`, `mpiaij`, …).
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn is_known(self, session: &Session, package: &str, matrix_type: &str) -> Result<bool> {
        session.petsc()?;
        let (package, matrix_type, none) = (to_c(package), to_c(matrix_type), std::ptr::null_mut());
        let mut is_there = sys::FALSE;
        // PETSc registers the packages only when its matrix classes are initialised, which would otherwise happen with
        // the first matrix.
        // SAFETY: PETSc is initialised.
        check(unsafe { sys::MatInitializePackage() })?;
        let (package, matrix_type) = (package.as_ptr(), matrix_type.as_ptr());
        let (kind, function) = (self.raw(), std::ptr::null_mut());
        // SAFETY: names and the out-pointer are valid, and null asks for nothing.
        check(unsafe { sys::MatSolverTypeGet(package, matrix_type, kind, none, &raw mut is_there, function) })?;
        Ok(is_there == sys::TRUE)
    }

    /// Whether PETSc was built with this package for this factorisation of matrices of the same type, on the same
    /// number of ranks.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn is_available(self, package: &str, matrix: &MatrixView) -> Result<bool> {
        let (package, mut is_there) = (to_c(package), sys::FALSE);
        // SAFETY: the matrix, the name and the out-pointer are valid.
        check(unsafe { sys::MatGetFactorAvailable(matrix.raw(), package.as_ptr(), self.raw(), &raw mut is_there) })?;
        Ok(is_there == sys::TRUE)
    }
}

/// MUMPS's estimate of the cost of a Cholesky factorisation, over all ranks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorEstimate {
    /// Number of entries of the factor.
    pub entries: f64,
    /// Number of floating-point operations.
    pub operations: f64,
    /// Memory of the factorisation in bytes.
    pub memory: f64,
}

/// Runs the symbolic phase of MUMPS's Cholesky factorisation, without the numeric one. Returns `None` if PETSc was
/// built without MUMPS. Collective.
///
/// # Errors
/// If the matrix is not square, assembled and AIJ, or if a PETSc call fails.
pub fn estimate_cholesky(matrix: &MatrixView) -> Result<Option<FactorEstimate>> {
    matrix.require_assembled_aij()?;
    matrix.require_square()?;
    if !Factor::Cholesky.is_available("mumps", matrix)? {
        return Ok(None);
    }
    let mut raw = std::ptr::null_mut();
    // SAFETY: the matrix is valid; the type is a C string.
    check(unsafe { sys::MatGetFactor(matrix.raw(), c"mumps".as_ptr(), Factor::Cholesky.raw(), &raw mut raw) })?;
    // SAFETY: the new factor is ours.
    let factor = unsafe { Matrix::from_raw(raw, matrix.comm()) };
    // SAFETY: a struct of numbers, for which all-zero bits are a valid value.
    let mut info: sys::MatFactorInfo = unsafe { std::mem::zeroed() };
    // SAFETY: the struct is valid.
    check(unsafe { sys::MatFactorInfoInitialize(&raw mut info) })?;
    // SAFETY: all are valid; MUMPS computes the ordering, so none is needed here.
    check(unsafe { sys::MatCholeskyFactorSymbolic(raw, matrix.raw(), std::ptr::null_mut(), &raw const info) })?;
    let global = |number| -> Result<f64> {
        let mut value = 0;
        // SAFETY: a MUMPS factor after its symbolic phase.
        check(unsafe { sys::MatMumpsGetInfog(raw, number, &raw mut value) })?;
        // MUMPS's convention: a negative count is in millions.
        Ok(if value < 0 { -(value as f64) * 1e6 } else { value as f64 })
    };
    let mut operations = 0.0;
    // SAFETY: as above.
    check(unsafe { sys::MatMumpsGetRinfog(raw, 1, &raw mut operations) })?;
    let estimate = FactorEstimate { entries: global(20)?, operations, memory: global(17)? * 1e6 };
    factor.destroy()?;
    Ok(Some(estimate))
}
