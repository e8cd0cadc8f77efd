//! Safe wrappers of PETSc's vectors, matrices, linear and nonlinear solvers and meshes, with one file for each class.
//!
//! - [`Session`] initialises MPI, then PETSc, and finalises them in reverse order. Every handle keeps it alive.
//! - Every call is checked; an [`Error`] carries PETSc's message and stack frames as owned text. Indices, layouts,
//!   types and states, which PETSc checks in debugging builds only, are checked here.
//! - Dropping a handle is not collective: the object is queued, and destroyed by [`Comm::collect_garbage`] or at the
//!   end of the session. So one rank may leave early with an error while the others continue.
//! - Handles are neither `Send` nor `Sync`: PETSc is not thread-safe.
//! - No safe call leads to undefined behaviour, as far as this is known of PETSc's methods that `set_type` admits. This
//!   does not cover [`options`], which can choose others.
//! - A solver in which PETSc itself has failed, and not a closure, is leaked, and returns an error in each call: PETSc
//!   leaves it half changed.
//! - Objects that PETSc lends are views ([`VectorView`], [`MatrixView`], [`KspView`]). The owned types deref to them,
//!   like `String` to `str`.
//! - `as_raw` returns the raw handle for a call of [`sys`] that is not wrapped, and the unsafe `from_raw` takes
//!   ownership of one.
//!
//! Functions marked "Collective" must be called by all ranks of their communicator, in the same order.

mod comm;
mod environment;
mod error;
mod factor;
mod gather;
mod gmsh;
mod ksp;
mod layout;
mod matrix;
mod memory;
mod null_space;
mod object;
pub mod options;
mod pc;
mod plex;
mod refused;
mod session;
mod shell;
mod snes;
mod text;
mod vector;

pub use comm::Comm;
pub use environment::set_default_environment;
pub use error::{Diverged, Error, Frame, Result};
pub use factor::{Factor, FactorEstimate, estimate_cholesky};
pub use gather::Gather;
pub use gmsh::{GmshMesh, PhysicalGroup};
pub use ksp::{Ksp, KspView, ResidualNorm, Tolerances};
pub use matrix::{Insert, Matrix, MatrixView, Row};
pub use memory::keep_freed_memory;
pub use mpi;
pub use null_space::NullSpace;
pub use object::Lent;
pub use pc::Pc;
pub use petsc_sys as sys;
pub use plex::{CellType, LabelledPoint, Numbering, Plex};
pub use session::{Session, petsc_version};
pub use shell::Preconditioner;
pub use snes::{CallbackResult, Lag, Progress, Snes, SnesTolerances, Trial};
pub use vector::{ReadGuard, Vector, VectorView, WriteGuard};

/// PETSc's index type: 32 or 64 bits, as PETSc was built.
pub type Int = petsc_sys::PetscInt;

/// Compiles the README's example with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
