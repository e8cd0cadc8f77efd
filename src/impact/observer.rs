//! Observers of a run.

use std::ops::ControlFlow;

use crate::error::Result;

use super::checkpoint::Checkpoint;
use super::reading::Reading;
use super::step::Step;

/// Observer of a run. Closures that take a step implement it.
pub trait Observer {
    /// Receives the initial state, and then every accepted step with the values read from the body. Returns whether the
    /// run continues. The answer must be the same on all ranks.
    ///
    /// # Errors
    /// Any error ends the run.
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>>;

    /// Whether the run shall end early. It is called from time to time while no step can be passed on: while the first
    /// contact may still be repeated, or while the whole run is computed before its first step is passed on. The answer
    /// must be the same on all ranks.
    fn is_interrupted(&mut self) -> bool {
        false
    }

    /// Called when the state of the simulation is the last step received. The observer may request a checkpoint from
    /// which a run can continue. All ranks must make the same request. The method is not called while the first contact
    /// may still be repeated. `interrupted` is true if the run ends early at this step.
    ///
    /// # Errors
    /// Any error ends the run.
    fn settled(&mut self, _interrupted: bool, _checkpoint: &mut dyn FnMut() -> Result<Checkpoint>) -> Result<()> {
        Ok(())
    }
}

impl<F: FnMut(&Step) -> Result<ControlFlow<()>>> Observer for F {
    fn step(&mut self, step: &Step, _: &Reading) -> Result<ControlFlow<()>> {
        self(step)
    }
}

/// Observer that receives steps until a question is answered with yes; the answer must be the same on all ranks.
pub struct Until<'a, F> {
    /// The question: whether the run shall end.
    pub interrupted: &'a dyn Fn() -> bool,
    /// Receives a step and the values read from the body.
    pub take: F,
}

impl<F: FnMut(&Step, &Reading)> Observer for Until<'_, F> {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>> {
        (self.take)(step, reading);
        Ok(if self.is_interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    fn is_interrupted(&mut self) -> bool {
        (self.interrupted)()
    }
}

/// A step with the values read from the body.
#[derive(Debug, Clone, Default)]
pub(super) struct Observed {
    /// The step: motion of the impactor, contact and energies.
    pub step: Step,
    /// Values read from the body at this step.
    pub reading: Reading,
}
