//! Solution of linear and nonlinear systems on top of PETSc's solvers: default methods, packages and tolerances.
//!
//! PETSc's options override all of these defaults.

mod blocks;
mod incomplete;
mod lanes;
pub mod linear;
mod newton;
mod ordering;
mod substructure;
pub mod triangle;

pub use linear::Method;
pub use newton::Newton;
