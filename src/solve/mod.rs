//! Solution of linear and nonlinear systems on top of PETSc's solvers: default methods, packages and tolerances, which
//! PETSc's options override; and roots of functions of one variable.

mod blocks;
mod incomplete;
pub mod linear;
mod newton;
mod ordering;
pub mod root;
mod substructure;
pub mod triangle;

pub use linear::Method;
pub use newton::Newton;
