//! Who watches a run.

use std::ops::ControlFlow;

use crate::error::Result;

use super::checkpoint::Checkpoint;
use super::reading::Reading;
use super::step::Step;

/// Who watches a run. A closure on steps is one, too.
pub trait Observer {
    /// Takes the initial state and then every accepted step, with what was read of the body there; says whether the run goes on. The
    /// answer must be the same on all ranks.
    ///
    /// # Errors
    /// Any: it ends the run.
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>>;

    /// Is asked now and then whether the run is to end early, while no step can be told: the first contact may still be taken back, or
    /// all of the run is computed before its first step is told. The answer must be the same on all ranks.
    fn is_interrupted(&mut self) -> bool {
        false
    }

    /// Hears after steps that the state is that of the last one it has taken, and may ask for the checkpoint from which a run goes on
    /// there. All ranks must ask alike. While the first contact may still be taken back, this is not called. `interrupted` tells that the
    /// run ends early, here.
    ///
    /// # Errors
    /// Any: it ends the run.
    fn settled(&mut self, _interrupted: bool, _checkpoint: &mut dyn FnMut() -> Result<Checkpoint>) -> Result<()> {
        Ok(())
    }
}

impl<F: FnMut(&Step) -> Result<ControlFlow<()>>> Observer for F {
    fn step(&mut self, step: &Step, _: &Reading) -> Result<ControlFlow<()>> {
        self(step)
    }
}

/// Takes steps until a question, which gives the same answer on all ranks, is answered by yes.
pub struct Until<'a, F> {
    /// The question.
    pub interrupted: &'a dyn Fn() -> bool,
    /// Takes a step and what was read there.
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

/// A step with what was read of the body there.
#[derive(Debug, Clone, Default)]
pub(super) struct Observed {
    /// The step.
    pub step: Step,
    /// What was read.
    pub reading: Reading,
}
