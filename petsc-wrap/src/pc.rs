//! Preconditioners.

use std::marker::PhantomData;

use petsc_sys as sys;

use crate::error::{Result, check, require};
use crate::text::{from_c, type_name};

/// The preconditioner of a linear solver, for setting its options.
pub struct Pc<'a> {
    raw: sys::PC,
    owner: PhantomData<&'a mut ()>,
}

impl Pc<'_> {
    /// Returns the preconditioner of a solver.
    ///
    /// # Safety
    /// `ksp` is a valid solver, borrowed for as long as this lives.
    pub(crate) unsafe fn of(ksp: sys::KSP) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        // SAFETY: the solver is valid, and the preconditioner belongs to it.
        check(unsafe { sys::KSPGetPC(ksp, &raw mut raw) })?;
        Ok(Self { raw, owner: PhantomData })
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::PC {
        self.raw
    }

    /// Chooses the method: `none`, `jacobi`, `bjacobi`, `ilu`, `lu`, `cholesky`, `redundant` or `gamg`.
    ///
    /// # Errors
    /// If the name is another one, or if a PETSc call fails.
    pub fn set_type(&mut self, name: &str) -> Result<()> {
        let admitted = ["none", "jacobi", "bjacobi", "ilu", "lu", "cholesky", "redundant", "gamg"];
        let name = type_name(name, &admitted)?;
        // SAFETY: the preconditioner is valid; PETSc copies the string.
        check(unsafe { sys::PCSetType(self.raw, name.as_ptr()) })
    }

    /// Name of the method; empty if none is chosen.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn type_name(&self) -> Result<String> {
        let mut name = std::ptr::null();
        // SAFETY: the preconditioner is valid.
        check(unsafe { sys::PCGetType(self.raw, &raw mut name) })?;
        // SAFETY: the name is valid while the preconditioner is, or null.
        Ok(unsafe { from_c(name) })
    }

    /// Chooses the package for the factorisation: `petsc`, `cholmod` or `mumps`. No effect if the method does not
    /// factorise.
    ///
    /// # Errors
    /// If the name is another one, or if a PETSc call fails.
    pub fn set_factor_package(&mut self, name: &str) -> Result<()> {
        let name = type_name(name, &["petsc", "cholmod", "mumps"])?;
        // SAFETY: the preconditioner is valid; PETSc copies the string.
        check(unsafe { sys::PCFactorSetMatSolverType(self.raw, name.as_ptr()) })
    }

    /// Makes MUMPS allocate this percentage of memory beyond its estimate (its control parameter 14), unless
    /// `-mat_mumps_icntl_14` sets another value. The memory needed for pivoting is not known in advance, and a
    /// factorisation that runs out of memory fails. No effect if another package factorises. Collective.
    ///
    /// # Errors
    /// If the solver has no operators, or if a PETSc call fails.
    pub fn set_mumps_margin(&mut self, percent: u8) -> Result<()> {
        let mut name = std::ptr::null();
        // SAFETY: the preconditioner is valid here and below; other methods leave the name null.
        check(unsafe { sys::PCFactorGetMatSolverType(self.raw, &raw mut name) })?;
        // SAFETY: the name is null, or valid while the preconditioner's package stays.
        if unsafe { from_c(name) } != "mumps" {
            return Ok(());
        }
        let (mut operator, mut matrix) = (sys::FALSE, sys::FALSE);
        // SAFETY: as above.
        check(unsafe { sys::PCGetOperatorsSet(self.raw, &raw mut operator, &raw mut matrix) })?;
        // PETSc makes the factor for the matrix without checking that there is one.
        require(matrix == sys::TRUE, "the solver has no operator yet")?;
        // SAFETY: there is a matrix.
        check(unsafe { sys::PCFactorSetUpMatSolverType(self.raw) })?;
        let mut factor = std::ptr::null_mut();
        // SAFETY: the factor was just made; it belongs to the preconditioner.
        check(unsafe { sys::PCFactorGetMatrix(self.raw, &raw mut factor) })?;
        // SAFETY: the factor is from MUMPS, which has this parameter.
        check(unsafe { sys::MatMumpsSetIcntl(factor, 14, sys::PetscInt::from(percent)) })
    }

    /// For the method `redundant`: the preconditioner with which each rank, or group of ranks, solves the whole system.
    /// Collective.
    ///
    /// # Errors
    /// If the method is another one, the solver has no operators, or a PETSc call fails.
    pub fn redundant_pc(&mut self) -> Result<Pc<'_>> {
        let (mut operator, mut matrix) = (sys::FALSE, sys::FALSE);
        // SAFETY: the preconditioner is valid here and below.
        check(unsafe { sys::PCGetOperatorsSet(self.raw, &raw mut operator, &raw mut matrix) })?;
        // PETSc uses the matrix without checking that there is one.
        require(matrix == sys::TRUE, "the solver has no operator yet")?;
        let mut each = std::ptr::null_mut();
        // SAFETY: as above; the inner solver belongs to the preconditioner.
        check(unsafe { sys::PCRedundantGetKSP(self.raw, &raw mut each) })?;
        // SAFETY: the inner solver lives as long as the method is not changed, and only a call on `self` changes it.
        unsafe { Pc::of(each) }
    }
}
