//! Runs in modal coordinates on several ranks: the first rank computes, and the others follow it.
//!
//! Each rank has the body in modal coordinates, but rounding may differ between ranks. Time steps depend on it. All ranks
//! therefore pass the first rank's steps to their observers.

use std::ops::ControlFlow;

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::agree::{decided, of_root};
use crate::error::Result;
use crate::impact::step::Step;
use crate::impact::{Count, Observer, Reading, TimeIntegration};

/// What the first rank asks of the observers of all ranks.
#[derive(Serialize, Deserialize)]
enum Call {
    Step(Box<Step>),
    IsInterrupted,
    End,
}

/// Observer of the first rank, which makes the other ranks call theirs.
struct Leader<'a> {
    comm: &'a Comm,
    observer: &'a mut dyn Observer,
}

impl Observer for Leader<'_> {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>> {
        of_root(self.comm, Some(Call::Step(Box::new(*step))));
        self.observer.step(step, reading)
    }

    fn is_interrupted(&mut self) -> bool {
        of_root(self.comm, Some(Call::IsInterrupted));
        self.observer.is_interrupted()
    }
}

/// Runs on the first rank; all observers receive its steps, and all ranks its outcome and its cost. Only the first rank
/// has readings. Collective.
///
/// # Errors
/// Same as [`TimeIntegration::run_watched`] on the first rank; errors of this rank's observer.
pub fn run(
    comm: &Comm,
    integration: &mut dyn TimeIntegration,
    observer: &mut dyn Observer,
) -> Result<(ControlFlow<()>, Count)> {
    let (mut ended, mut mine) = (None, Ok(()));
    if comm.is_root() {
        ended = Some(integration.run_watched(&mut Leader { comm, observer }));
        of_root(comm, Some(Call::End));
    } else {
        loop {
            match of_root(comm, None) {
                Call::Step(step) => {
                    let observed = observer.step(&step, &Reading::default()).map(|_| ());
                    mine = mine.and(observed);
                }
                // The first rank has the same answer.
                Call::IsInterrupted => _ = observer.is_interrupted(),
                Call::End => break,
            }
        }
    }
    let (is_over, count) = decided(comm, || {
        let flow = ended.unwrap_or(Ok(ControlFlow::Continue(())))?;
        Ok((flow.is_continue(), integration.count()))
    })?;
    mine?;
    Ok((if is_over { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }, count))
}
