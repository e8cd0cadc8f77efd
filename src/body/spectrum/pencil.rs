//! Operators K and M of a body, with or without the impactor attached.

use petsc_wrap::{Ksp, Matrix, Vector};

use crate::body::Body;
use crate::body::deviates::normal;
use crate::error::Result;

use super::{Inertia, LinearContact};

/// Eigenproblem K x = λ M x without the constrained unknowns. A motion consists of x of the body and q of the impactor;
/// q = 0 without contact.
pub struct Pencil<'a> {
    body: &'a mut Body,
    mass: Mass<'a>,
    contact: Option<LinearContact>,
    product: Vector,
}

enum Mass<'a> {
    Diagonal(&'a Vector),
    /// Constrained rows are rows of the identity.
    Matrix {
        matrix: Matrix,
        solver: Ksp,
    },
}

impl<'a> Pencil<'a> {
    /// Creates the operators and factorises M if it is consistent. Collective.
    pub fn new(body: &'a mut Body, inertia: Inertia<'a>, contact: Option<LinearContact>) -> Result<Self> {
        let mass = match inertia {
            Inertia::Lumped(diagonal) => Mass::Diagonal(diagonal),
            Inertia::Consistent => {
                let (matrix, solver) = body.mass_solver()?;
                Mass::Matrix { matrix, solver }
            }
        };
        let product = body.terms.load.duplicate()?;
        Ok(Self { body, mass, contact, product })
    }

    /// Creates a vector of the body's unknowns. Collective.
    pub fn vector(&self) -> Result<Vector> {
        Ok(self.product.duplicate()?)
    }

    /// Number of free unknowns, including the impactor. Collective.
    pub fn dimension(&self) -> Result<usize> {
        let free = &self.body.clamps.free;
        Ok(free.dot(free)?.round() as usize + usize::from(self.contact.is_some()))
    }

    /// Computes K (x, q), the forces on body and impactor, and returns the force on the impactor. Collective.
    pub fn stiffness(&mut self, (x, q): (&Vector, f64), force: &mut Vector) -> Result<f64> {
        let body = &mut *self.body;
        body.terms.elastic.mult(x, force)?;
        if let Some(support) = &body.terms.support {
            support.mult(x, &mut self.product)?;
            force.axpy(1.0, &self.product)?;
        }
        if let Some(pads) = &mut body.pads {
            pads.add_pressed(x, force)?;
        }
        let mut on_impactor = 0.0;
        if let Some(contact) = self.contact {
            let a = &body.terms.contact.force;
            on_impactor = contact.tangent * (q - a.dot(x)?);
            force.axpy(-on_impactor, a)?;
        }
        body.clamps.zero(force)?;
        Ok(on_impactor)
    }

    /// Computes M (x, q) and returns the impactor's part. Collective.
    pub fn mass(&self, (x, q): (&Vector, f64), momentum: &mut Vector) -> Result<f64> {
        match &self.mass {
            Mass::Diagonal(diagonal) => {
                momentum.copy_from(x)?;
                momentum.pointwise_mult(diagonal)?;
            }
            Mass::Matrix { matrix, .. } => matrix.mult(x, momentum)?,
        }
        Ok(self.impactor_mass() * q)
    }

    /// Computes (x, q) from M (x, q) and returns q. Collective.
    pub fn solve_mass(&mut self, (momentum, of_impactor): (&Vector, f64), x: &mut Vector) -> Result<f64> {
        match &mut self.mass {
            Mass::Diagonal(diagonal) => {
                x.copy_from(momentum)?;
                x.pointwise_divide(diagonal)?;
            }
            Mass::Matrix { solver, .. } => solver.solve(momentum, x)?,
        }
        Ok(of_impactor / self.impactor_mass())
    }

    /// Computes a random motion and returns q. Scaled by the square roots of M's diagonal, its components are similar
    /// to independent normal deviates. Collective.
    pub fn random(&mut self, x: &mut Vector) -> Result<f64> {
        x.copy_from(&self.body.deviates)?;
        match &self.mass {
            Mass::Diagonal(diagonal) => self.product.copy_from(diagonal)?,
            Mass::Matrix { matrix, .. } => matrix.diagonal(&mut self.product)?,
        }
        self.product.write()?.iter_mut().for_each(|mass| *mass = mass.sqrt());
        x.pointwise_divide(&self.product)?;
        self.body.clamps.zero(x)?;
        Ok(if self.contact.is_some() { normal(0) / self.impactor_mass().sqrt() } else { 0.0 })
    }

    /// Mass of the impactor. Without an impactor any number would do, because q remains zero.
    fn impactor_mass(&self) -> f64 {
        self.contact.map_or(1.0, |contact| contact.mass)
    }
}
