//! What the ways to move a body have in common: step by step in its unknowns, or in modal coordinates.

use std::ops::ControlFlow;

use crate::error::Result;
use crate::scene::Vec3;

use super::checkpoint::{Checkpoint, Visitor};
use super::{Observer, Plan, Readout};

/// A body and an impactor that are ready to move.
pub trait TimeIntegration {
    /// Steps of one size or chosen ones; `None` for modal coordinates in steps chosen by the error.
    fn plan(&self) -> Option<Plan>;

    /// Number of steps to the end, where it is known.
    fn steps(&self) -> Option<usize>;

    /// What the runs have cost so far.
    fn count(&self) -> Count;

    /// Where this rank's nodes lie, m; `None` for a body without a mesh.
    fn nodes(&self) -> Option<&[Vec3]>;

    /// Has a run read the body at each step that it tells. Collective.
    ///
    /// # Errors
    /// PETSc's.
    fn set_readout(&mut self, readout: Readout) -> Result<()>;

    /// Has the next run go on from a checkpoint of the same scene, and tell the steps after it. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Output`] where the checkpoint does not fit; PETSc's.
    fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()>;

    /// Runs to the end, or until the observer, who gets the initial state and every accepted step, breaks off; tells which. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] with step and time where a step is not solved or the contact law is left, [`crate::Error::Unstable`] where
    /// the energy gate closes; the observer's; PETSc's.
    fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>>;
}

/// What was done for a run.
#[derive(Debug, Clone, Copy, Default)]
pub struct Count {
    /// Steps taken, rejected ones and those of an error estimate included: each is one linear solve in the condensed step, a few with
    /// pads.
    pub solves: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Estimated error of the acceleration over its peak, where steps are chosen by it.
    pub error: Option<f64>,
    /// The same of the largest tension in the first contact.
    pub stress_error: Option<f64>,
}

impl Count {
    /// To a checkpoint or from it.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.count("solves", &mut self.solves)?;
        visitor.count("iterations", &mut self.iterations)?;
        let mut error = self.error.unwrap_or(f64::NAN);
        visitor.number("error", &mut error)?;
        self.error = (!error.is_nan()).then_some(error);
        Ok(())
    }
}
