//! Data of one accepted step, as observers receive it.

use super::checkpoint::Visitor;
use crate::error::{Error, Result};

/// One accepted step: all values of a row of the recorded time series, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Step {
    /// Number of the step; 0 is the initial state.
    pub number: usize,
    /// Time, s.
    pub time: f64,
    /// Motion of the impactor along its direction of travel.
    pub impactor: Motion,
    /// State of the contact.
    pub contact: Contact,
    /// Energies of the whole body, the impactor and the contact.
    pub energy: Energy,
}

impl Step {
    /// Saves the step to a checkpoint or restores it.
    ///
    /// # Errors
    /// Same as [`Visitor`].
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
            ("impulse", &mut contact.impulse),
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
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Motion {
    /// Position q, m; 0 at t = 0.
    pub position: f64,
    /// Velocity q̇, m/s.
    pub velocity: f64,
    /// Deceleration F/m0 by the contact force, m/s²; positive in contact.
    pub acceleration: f64,
}

/// State of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Contact {
    /// Contact force F on the whole body, N.
    pub force: f64,
    /// Indentation α, m; negative while the bodies are apart.
    pub indentation: f64,
    /// Displacement of the surface under the impactor, aᵀu, m.
    pub surface_displacement: f64,
    /// Approach δ = q − gap − aᵀu, m. It equals α − c_l F, where c_l F is the local dent of the contact patch that aᵀu
    /// contains already.
    pub approach: f64,
    /// Rate of the approach, δ̇, m/s.
    pub rate: f64,
    /// Impulse ∫ F dt on the whole body since t = 0, N s.
    pub impulse: f64,
}

/// Energies of the whole body, J.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Energy {
    /// Kinetic energy ½ u̇ᵀMu̇ of the body.
    pub kinetic: f64,
    /// Elastic energy ½ uᵀKu of the body without its supports.
    pub elastic: f64,
    /// Potential of elastic supports and pads.
    pub support: f64,
    /// Kinetic energy ½ m0 q̇² of the impactor.
    pub impactor: f64,
    /// Potential of the contact law.
    pub contact: f64,
    /// Energy lost since t = 0 by dampers, contact damping, viscoelastic parts and outgoing waves.
    pub dissipated: f64,
    /// Work of body forces, tractions and the impactor's weight since t = 0.
    pub external: f64,
    /// Energy gained (negative: lost) by the time integration since t = 0, from the discrete equations of the scheme:
    /// total + dissipated − external − numerical remains at its initial value to rounding.
    pub numerical: f64,
    /// Total energy: kinetic + elastic + support + impactor + contact.
    pub total: f64,
}

/// Adds the number and the time (s) of a step to an error.
pub(super) fn at(error: Error, number: usize, time: f64) -> Error {
    let place = format!("step {number}, t = {time:.6e} s");
    match error {
        Error::Solve(message) => Error::Solve(format!("{place}: {message}")),
        Error::Unstable(message) => Error::Unstable(format!("{place}: {message}")),
        // Whether the other ranks have failed too is not known.
        Error::Petsc(error) => Error::Alone(Box::new(Error::Solve(format!("{place}: {error}")))),
        other => other,
    }
}
