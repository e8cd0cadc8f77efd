//! Discretisations (spaces) over which the description of a body is integrated.
//!
//! A space supplies the quadrature points of its surface ([`Space`]); [`SurfaceTerms`] integrates every support and
//! load over them. Each kind of space is a module, which also provides its mass, its elasticity, the unknowns
//! constrained by clamps, and its impact point. [`evaluate`] computes displacements and stresses at points of any
//! space.

mod clip;
pub mod evaluate;
pub mod finite_element;
mod grading;
mod grid;
mod loaded_face;
mod parity;
pub mod parts;
pub mod plate;
pub mod spline;
mod terms;

use petsc_wrap::Int;

use crate::description::{Part, Place};
use crate::error::Result;
use crate::form::SurfaceElement;

pub use terms::SurfaceTerms;

/// Ratio of one size of cells to the next larger one. Cells are chosen among these sizes only, so that of two tolerances the
/// smaller one never takes fewer cells.
pub const RUNG: f64 = 0.85;

/// The largest power of [`RUNG`] that is not above a factor.
pub fn rung_below(factor: f64) -> f64 {
    RUNG.powf((factor.ln() / RUNG.ln() - 1e-9).ceil())
}

/// Receives the values of an element with the global numbers of its n unknowns: n values of a vector, or n² values of a
/// matrix by rows.
pub type Add<'a> = dyn FnMut(&[Int], &[f64]) -> Result<()> + 'a;

/// Receives an element of the surface with the global numbers of its unknowns.
pub type Visit<'a> = dyn FnMut(&[Int], &SurfaceElement) -> Result<()> + 'a;

/// A discretisation over which the terms of a description are integrated.
pub trait Space {
    /// A symmetric matrix of all unknowns.
    type Matrix;
    /// A vector of all unknowns.
    type Vector;

    /// Calls `visit` with each surface element of a place, in the modelled part of the body and on this rank.
    ///
    /// # Errors
    /// If `visit` fails.
    fn visit(&self, place: &Place, visit: &mut Visit) -> Result<()>;

    /// Same as [`Self::visit`], with a lower-order quadrature for an integrand that is not smooth, where more points
    /// gain little.
    ///
    /// # Errors
    /// If `visit` fails.
    fn visit_roughly(&self, place: &Place, visit: &mut Visit) -> Result<()> {
        self.visit(place, visit)
    }

    /// Adds ∫ f·v dV of the body forces f of the parts.
    ///
    /// # Errors
    /// If `add` fails, or if a cell is tangled (inverted).
    fn body_force(&self, parts: &[Part], add: &mut Add) -> Result<()>;

    /// Returns the sum of all that `fill` adds. Collective.
    ///
    /// # Errors
    /// If `fill` or a PETSc call fails.
    fn vector(&self, fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Self::Vector>;

    /// Returns the sum of all that `fill` adds, element by element, at some places. Collective.
    ///
    /// # Errors
    /// If `fill` or a PETSc call fails.
    fn matrix(&self, places: &[&Place], fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Self::Matrix>;

    /// Returns the sum of a number over the ranks that share the body. Collective.
    fn sum(&self, here: f64) -> f64;
}
