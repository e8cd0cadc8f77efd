//! How this program solves its systems, on top of PETSc's solvers: which method and package by default, and to what tolerance.
//!
//! PETSc's options override all of it.

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
