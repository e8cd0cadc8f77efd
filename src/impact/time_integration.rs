//! Common interface of the methods of time integration: step by step in the unknowns of the body, or in modal
//! coordinates.

use std::ops::ControlFlow;

use crate::error::Result;
use crate::scene::Vec3;

use super::checkpoint::{Checkpoint, Visitor};
use super::{Observer, Plan, Readout, Steps, Trace};

/// A body and an impactor, ready for a run.
pub trait TimeIntegration {
    /// Steps of equal or of controlled size; `None` in modal coordinates with steps controlled by the error.
    fn plan(&self) -> Option<Plan>;

    /// Number of steps of the run, if it is known in advance.
    fn steps(&self) -> Option<usize>;

    /// Cost of the runs so far.
    fn count(&self) -> Count;

    /// Contact force of the last run and its time steps; `None` before it, and for steps in the unknowns of a body.
    fn force(&self) -> Option<&(Trace, Steps)> {
        None
    }

    /// Positions of this rank's nodes, m; `None` for a body without a mesh.
    fn nodes(&self) -> Option<&[Vec3]>;

    /// Sets the values to be read from the body at each step of the next runs. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    fn set_readout(&mut self, readout: Readout) -> Result<()>;

    /// Makes the next run continue from a checkpoint of the same scene; the observer then receives only later steps.
    /// Collective.
    ///
    /// # Errors
    /// [`crate::Error::Output`] if the checkpoint does not fit; if a PETSc call fails.
    fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()>;

    /// Runs to the end or until the observer breaks off, and returns which of the two. The observer receives the
    /// initial state and every accepted step. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] with step and time if a step cannot be solved or the contact law becomes invalid;
    /// [`crate::Error::Unstable`] if the energy gate stops the run; any error of the observer; if a PETSc call fails.
    fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>>;
}

/// Cost of a run and its estimated error.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub struct Count {
    /// Number of steps taken, including rejected steps and the steps of an error estimate. Each is one linear solve in
    /// the condensed step, and a few solves with pads.
    pub solves: usize,
    /// Number of Newton iterations.
    pub iterations: usize,
    /// Estimated error of the acceleration over its peak, if the steps are controlled by it.
    pub error: Option<f64>,
    /// Estimated error of the largest tension in the first contact over its peak.
    pub stress_error: Option<f64>,
    /// Estimated error of the largest tension in the whole run over its peak.
    pub stress_history_error: Option<f64>,
    /// Estimated error of the deflection under the impactor over its largest value.
    pub deflection_error: Option<f64>,
}

impl Count {
    /// Saves the counts to a checkpoint or restores them.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.count("solves", &mut self.solves)?;
        visitor.count("iterations", &mut self.iterations)?;
        let mut error = self.error.unwrap_or(f64::NAN);
        visitor.number("error", &mut error)?;
        self.error = (!error.is_nan()).then_some(error);
        Ok(())
    }
}
