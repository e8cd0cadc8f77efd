//! What a factorisation will cost, told by its symbolic phase.

use petsc_sys as sys;

use crate::error::{Result, check};
use crate::ksp::{MUMPS, factorises, is_known};
use crate::matrix::Matrix;
use crate::session::Session;

/// What MUMPS expects of a Cholesky factorisation, over all ranks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorEstimate {
    /// Entries of the factor.
    pub entries: f64,
    /// Floating-point operations.
    pub operations: f64,
    /// Memory of the factorisation, bytes.
    pub memory: f64,
}

/// Whether PETSc was built with MUMPS: without it, each of several ranks factorises all of a matrix for itself.
///
/// # Errors
/// PETSc's.
pub fn has_mumps(_session: &Session) -> Result<bool> {
    is_known(MUMPS, c"mpiaij")
}

/// The symbolic phase of MUMPS's Cholesky factorisation, without the numeric one; `None` where PETSc was built without MUMPS. Collective.
///
/// # Errors
/// PETSc's.
pub fn estimate_cholesky(matrix: &Matrix) -> Result<Option<FactorEstimate>> {
    if !factorises(MUMPS, matrix)? {
        return Ok(None);
    }
    let mut raw = std::ptr::null_mut();
    let kind = sys::MatFactorType::MAT_FACTOR_CHOLESKY;
    // SAFETY: the matrix is valid; the type is a C string.
    check(unsafe { sys::MatGetFactor(matrix.raw(), MUMPS.as_ptr(), kind, &raw mut raw) })?;
    let factor = Matrix::from_raw(raw, matrix.comm());
    // SAFETY: a struct of numbers, for which zero bits are a value.
    let mut info: sys::MatFactorInfo = unsafe { std::mem::zeroed() };
    // SAFETY: the struct is valid.
    check(unsafe { sys::MatFactorInfoInitialize(&raw mut info) })?;
    // SAFETY: all are valid; MUMPS orders by itself, so that no ordering is needed.
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
