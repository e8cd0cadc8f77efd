//! Which steps a run takes.

use crate::body::Solid;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::{Scene, Scheme};

use super::setting::Setting;
use super::{controlled, explicit};

/// Which steps a run takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Plan {
    /// All of one size.
    Equal {
        /// Δt, s.
        step: f64,
    },
    /// Chosen by the error.
    Controlled {
        /// The first guess of the step in contact, s.
        first: f64,
        /// Wanted error of the acceleration over its peak.
        tolerance: f64,
    },
}

impl Plan {
    /// The steps of a scene: as it says, stable ones of an explicit scheme, or chosen. Collective.
    ///
    /// # Errors
    /// A fault of `time.step` where an explicit step is not stable; PETSc's.
    pub fn new(mesh: &Mesh, scene: &Scene, body: &mut Solid, setting: &Setting) -> Result<Self> {
        Ok(match (scene.time.scheme, scene.time.step) {
            (Scheme::CentralDifference { allow_unstable }, given) => {
                Self::Equal { step: explicit::step(mesh, body, setting, (given, allow_unstable))? }
            }
            (_, Some(step)) => Self::Equal { step },
            (_, None) => {
                let tolerance = scene.tolerance;
                Self::Controlled { first: controlled::first_step(setting, tolerance, scene.time.end), tolerance }
            }
        })
    }

    /// The step, or the first guess of the one in contact, s.
    pub fn step(&self) -> f64 {
        match *self {
            Self::Equal { step } | Self::Controlled { first: step, .. } => step,
        }
    }
}

/// Steps that reach the end; the last may pass it by less than a step.
pub fn steps(end: f64, step: f64) -> usize {
    // A part of 1e-9 of a step is rounding in end/step.
    (end / step - 1e-9).ceil().max(1.0) as usize
}
