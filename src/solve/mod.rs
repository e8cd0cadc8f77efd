//! How this program solves its systems, on top of PETSc's solvers: which method and package by default, and to what tolerance.
//!
//! PETSc's options override all of it.

mod incomplete;
pub mod linear;
mod newton;

pub use incomplete::IncompleteCholesky;
pub use linear::Method;
pub use newton::Newton;
