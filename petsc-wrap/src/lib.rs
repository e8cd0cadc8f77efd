//! The part of PETSc that ricochet uses, made safe; a file a class.
//!
//! - [`Session`] initialises MPI, then PETSc, and finalises them in reverse. Every handle keeps it alive.
//! - Every call is checked; an [`Error`] carries PETSc's message and stack frames as owned text.
//! - Dropping a handle is not collective: the object is queued and destroyed by [`Comm::collect_garbage`] or at the end
//!   of the session. So one rank may leave early with an error while the others go on.
//! - Handles are neither `Send` nor `Sync`: PETSc is not thread-safe.

mod comm;
mod error;
mod factor;
mod gather;
mod ksp;
mod matrix;
mod null_space;
mod object;
pub mod options;
mod plex;
mod session;
mod snes;
mod vector;

pub use comm::Comm;
pub use error::{Diverged, Error, Frame, Result};
pub use factor::{FactorEstimate, estimate_cholesky, has_mumps};
pub use gather::Gather;
pub use ksp::{Ksp, Method};
pub use matrix::{Insert, Matrix, Row};
pub use mpi;
pub use null_space::NullSpace;
pub use plex::{CellType, Numbering, Plex};
pub use session::{Session, petsc_version};
pub use snes::{Snes, Trial};
pub use vector::{ReadGuard, Vector, WriteGuard};

/// PETSc's index type: 32 or 64 bits, as PETSc was built.
pub type Int = petsc_sys::PetscInt;
