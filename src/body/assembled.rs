//! A body in its unknowns, where it is.

use petsc_wrap::Comm;

use super::{Body, LinearBody, LocalBody};
use crate::error::Result;

/// A body as its space gives it.
pub enum Assembled {
    /// As numbers of this process.
    Local(Box<LocalBody>),
    /// As PETSc holds it.
    InPetsc(Box<Body>),
}

impl Assembled {
    /// What bases grow in.
    pub fn linear(&self) -> &dyn LinearBody {
        match self {
            Self::Local(body) => &**body,
            Self::InPetsc(body) => &**body,
        }
    }

    /// What steps in its unknowns need; `alone` is this process.
    ///
    /// # Errors
    /// PETSc's.
    pub fn in_petsc(self, alone: &Comm) -> Result<Box<Body>> {
        match self {
            Self::Local(body) => Ok(Box::new(Body::of(alone, body.system())?)),
            Self::InPetsc(body) => Ok(body),
        }
    }
}
