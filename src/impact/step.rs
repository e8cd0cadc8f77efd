//! One accepted step, as observers see it.

use super::checkpoint::Visitor;
use crate::error::{Error, Result};

/// One accepted step: everything that a series holds of it. SI units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Number of the step; 0 is the initial state.
    pub number: usize,
    /// Time, s.
    pub time: f64,
    /// The impactor along its direction of travel.
    pub impactor: Motion,
    /// The contact.
    pub contact: Contact,
    /// The energies.
    pub energy: Energy,
}

impl Step {
    /// To a checkpoint or from it.
    ///
    /// # Errors
    /// Those of [`Visitor`].
    pub fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        let Self { number, time, impactor, contact, energy } = self;
        visitor.count("number", number)?;
        let numbers = [
            ("time", time),
            ("position", &mut impactor.position),
            ("velocity", &mut impactor.velocity),
            ("acceleration", &mut impactor.acceleration),
            ("force", &mut contact.force),
            ("indentation", &mut contact.indentation),
            ("surface_displacement", &mut contact.surface_displacement),
            ("approach", &mut contact.approach),
            ("rate", &mut contact.rate),
            ("kinetic", &mut energy.kinetic),
            ("elastic", &mut energy.elastic),
            ("support", &mut energy.support),
            ("impactor", &mut energy.impactor),
            ("contact", &mut energy.contact),
            ("dissipated", &mut energy.dissipated),
            ("external", &mut energy.external),
            ("numerical", &mut energy.numerical),
            ("total", &mut energy.total),
        ];
        numbers.into_iter().try_for_each(|(name, value)| visitor.number(name, value))
    }
}

/// Motion of the impactor along its direction of travel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// q, m.
    pub position: f64,
    /// q̇, m/s.
    pub velocity: f64,
    /// F/m0, m/s²: the deceleration, positive in contact.
    pub acceleration: f64,
}

/// State of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contact {
    /// F, N.
    pub force: f64,
    /// α, m; negative while the bodies are apart.
    pub indentation: f64,
    /// aᵀu, m.
    pub surface_displacement: f64,
    /// δ = q − gap − aᵀu, m: α, less the part of a patch's own dent.
    pub approach: f64,
    /// δ̇, m/s.
    pub rate: f64,
}

/// Energies, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// ½ u̇ᵀMu̇ of the body.
    pub kinetic: f64,
    /// ½ uᵀKu of the body without its supports.
    pub elastic: f64,
    /// Potential of elastic supports and pads.
    pub support: f64,
    /// ½ m0 q̇².
    pub impactor: f64,
    /// Potential of the contact law.
    pub contact: f64,
    /// Lost in dampers since t = 0.
    pub dissipated: f64,
    /// Work of body forces and tractions since t = 0.
    pub external: f64,
    /// Made (or, negative, lost) by the time integration since t = 0: what its own equations say, so that
    /// total + dissipated − external − numerical stays at its initial value to rounding.
    pub numerical: f64,
    /// kinetic + elastic + support + impactor + contact.
    pub total: f64,
}

/// An error with the step and the time that it happened at.
pub(super) fn at(error: Error, number: usize, time: f64) -> Error {
    let place = format!("step {number}, t = {time:.6e} s");
    match error {
        Error::Solve(message) => Error::Solve(format!("{place}: {message}")),
        Error::Unstable(message) => Error::Unstable(format!("{place}: {message}")),
        // Whether other ranks have it too is not known.
        Error::Petsc(error) => Error::Alone(Box::new(Error::Solve(format!("{place}: {error}")))),
        other => other,
    }
}
