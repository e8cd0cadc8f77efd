//! Who watches a run.

use std::ops::ControlFlow;

use crate::error::Result;

use super::checkpoint::Checkpoint;
use super::step::Step;

/// Who watches a run.
pub trait Observer {
    /// Takes the initial state and then every accepted step; says whether the run goes on.
    ///
    /// # Errors
    /// Any: it ends the run.
    fn step(&mut self, step: &Step) -> Result<ControlFlow<()>>;

    /// Hears after steps that the state is that of the last one it has taken, and may ask for the checkpoint from which a run goes on
    /// there. All ranks must ask alike. While the first contact may still be taken back, this is not called. `interrupted` tells that the
    /// run ends early, here.
    ///
    /// # Errors
    /// Any: it ends the run.
    fn settled(&mut self, interrupted: bool, checkpoint: &mut dyn FnMut() -> Result<Checkpoint>) -> Result<()>;
}

/// Who takes steps and nothing else.
pub(super) struct Told<F>(pub F);

impl<F: FnMut(&Step) -> Result<ControlFlow<()>>> Observer for Told<F> {
    fn step(&mut self, step: &Step) -> Result<ControlFlow<()>> {
        self.0(step)
    }

    fn settled(&mut self, _: bool, _: &mut dyn FnMut() -> Result<Checkpoint>) -> Result<()> {
        Ok(())
    }
}
