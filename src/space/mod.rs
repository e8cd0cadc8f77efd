//! Discretisations of a body, on which its description is integrated.
//!
//! A space gives quadrature points of its surface ([`Space`]); every support and load is integrated over these in one place
//! ([`SurfaceTerms`]). Each space is a folder, which also knows its mass, its elasticity, which unknowns a clamp holds, and where it is
//! hit. [`evaluate`] reads displacements and stresses at points of any of them.

mod clip;
pub mod evaluate;
pub mod finite_element;
mod grading;
mod grid;
mod parity;
pub mod plate;
pub mod spline;
mod terms;

use petsc_wrap::Int;

use crate::description::{Part, Place};
use crate::error::Result;
use crate::form::SurfaceElement;

pub use plate::OF_CONTACT;
pub use terms::SurfaceTerms;

/// Takes the values of an element with the global numbers of its unknowns: n values of a vector, or n² of a matrix by rows.
pub type Add<'a> = dyn FnMut(&[Int], &[f64]) -> Result<()> + 'a;

/// Takes an element of the surface with the global numbers of its unknowns.
pub type Visit<'a> = dyn FnMut(&[Int], &SurfaceElement) -> Result<()> + 'a;

/// What a discretisation gives for the terms of a description.
pub trait Space {
    /// A symmetric matrix of all unknowns.
    type Matrix;
    /// A vector of all unknowns.
    type Vector;

    /// Visits a place of the surface, element by element: of the modelled part of the body, on this rank.
    ///
    /// # Errors
    /// The visitor's.
    fn visit(&self, place: &Place, visit: &mut Visit) -> Result<()>;

    /// The same with quadrature for an integrand that is not smooth, where more points gain little.
    ///
    /// # Errors
    /// The visitor's.
    fn visit_roughly(&self, place: &Place, visit: &mut Visit) -> Result<()> {
        self.visit(place, visit)
    }

    /// Adds ∫ f·v dV of the forces on the parts' volumes.
    ///
    /// # Errors
    /// Those of `add`; a tangled cell.
    fn body_force(&self, parts: &[Part], add: &mut Add) -> Result<()>;

    /// The sum of what `fill` adds. Collective.
    ///
    /// # Errors
    /// Those of `fill`; PETSc's.
    fn vector(&self, fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Self::Vector>;

    /// The sum of what `fill` adds, element by element, at some places. Collective.
    ///
    /// # Errors
    /// Those of `fill`; PETSc's.
    fn matrix(&self, places: &[&Place], fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Self::Matrix>;

    /// The sum of a number over the ranks that share the body. Collective.
    fn sum(&self, here: f64) -> f64;
}
