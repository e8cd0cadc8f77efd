//! An assembled body with all its unknowns, either in this process or in PETSc.

use petsc_wrap::Comm;

use super::{Body, LinearBody, LocalBody};
use crate::error::Result;

/// An assembled body and its storage.
pub enum Assembled {
    /// Stored as plain arrays in this process.
    Local(Box<LocalBody>),
    /// Stored in PETSc objects.
    InPetsc(Box<Body>),
}

impl Assembled {
    /// Returns the interface for building reduced bases.
    pub fn linear(&self) -> &dyn LinearBody {
        match self {
            Self::Local(body) => &**body,
            Self::InPetsc(body) => &**body,
        }
    }

    /// Converts the body to PETSc storage, as needed for time steps in all unknowns. `alone` is the communicator of
    /// this process.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn in_petsc(self, alone: &Comm) -> Result<Box<Body>> {
        match self {
            Self::Local(body) => Ok(Box::new(Body::of(alone, body.system())?)),
            Self::InPetsc(body) => Ok(body),
        }
    }
}
