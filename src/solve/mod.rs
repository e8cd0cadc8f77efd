//! Solution of linear and nonlinear systems on top of PETSc's solvers: default methods, packages and tolerances, which
//! PETSc's options override; and roots of functions of one variable.

mod blocks;
mod incomplete;
mod lanes;
pub mod linear;
mod newton;
mod nodal_product;
mod ordering;
pub mod root;
mod substructure;
pub mod triangle;

pub use linear::Method;
pub use newton::Newton;
pub use nodal_product::nodal_product;
