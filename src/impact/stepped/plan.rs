//! Choice of the time steps of a run.

use crate::body::Body;
use crate::error::Result;
use crate::scene::{Fault, Scene, Scheme};
use crate::scheme::critical_frequency;

use super::{controlled, explicit};
use crate::impact::parameters::ImpactParameters;

/// Choice of the time steps of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Plan {
    /// Steps of one size.
    Equal {
        /// Step size Δt, s.
        step: f64,
    },
    /// Steps controlled by the estimated error.
    Controlled {
        /// First guess of the step in contact, s.
        first: f64,
    },
}

impl Plan {
    /// Returns the plan of a scene: the given step, a stable step of an explicit scheme, or steps controlled by the
    /// error. Collective.
    ///
    /// # Errors
    /// A fault of `time.step` if an explicit step is not stable, or of another key if the steps cannot be chosen; if a
    /// PETSc call fails.
    pub fn new(scene: &Scene, body: &mut Body, parameters: &ImpactParameters) -> Result<Self> {
        Ok(match (scene.time.scheme, scene.time.step) {
            (Scheme::CentralDifference { allow_unstable }, given) => {
                let step = explicit::step(body, parameters, (given, allow_unstable))?;
                Self::Equal { step: step.min(scene.time.end) }
            }
            (_, Some(step)) => Self::Equal { step },
            (scheme, None) => {
                check_stable(scheme)?;
                Self::Controlled { first: controlled::first_step(parameters, scene.tolerance, scene.time.end)? }
            }
        })
    }

    /// Step size, or first guess of the step in contact, s.
    pub fn step(&self) -> f64 {
        match *self {
            Self::Equal { step } | Self::Controlled { first: step } => step,
        }
    }
}

/// Returns an error for a scheme that is not stable at every step size.
fn check_stable(scheme: Scheme) -> Result<()> {
    let Scheme::Newmark { beta, gamma } = scheme else { return Ok(()) };
    let (key, message) = match critical_frequency(beta, gamma) {
        limit if limit.is_infinite() => return Ok(()),
        0.0 => ("time.gamma", "with γ below 1/2 every vibration grows: no step can be chosen for it"),
        _ => (
            "time.beta",
            "with 2β below γ Newmark's method has a largest stable step, which steps chosen by the error do not keep",
        ),
    };
    Err(Fault::new(key, message, "a `time.step` of your own, or 2β ≥ γ ≥ 1/2; `ricochet stability` shows the limits")
        .into())
}

/// Number of steps that reach the end; the last may pass it by less than a step.
pub fn steps(end: f64, step: f64) -> usize {
    // A fraction of 1e-9 of a step is rounding in end/step.
    (end / step - 1e-9).ceil().max(1.0) as usize
}
