//! Energy gate: stops a run whose energy balance fails.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::{Scene, Scheme};

use super::checkpoint::Visitor;
use super::observer::{Observed, Observer};
use super::step::Step;
use crate::impact::step::at;

/// Energy error at which a run counts as unstable if the scene sets no gate, relative to the initial energy plus the
/// largest work of the loads and of the impactor's weight. The worst error of a stable scheme is a small fraction of this;
/// an unstable scheme reaches a thousand times this within some tens of steps.
const BLOW_UP: f64 = 1.0;

/// The energy gate of a run.
#[derive(Debug)]
pub struct Gate {
    part: Option<f64>,
    initial: f64,
    /// Largest work of the loads and of the impactor's weight so far, J. An impactor that returns to its first position has done
    /// and undone it.
    work: f64,
    /// Advice to the user, appended to error messages.
    advice: String,
}

impl Gate {
    /// Builds the gate of a scene. Its limit is the given fraction of the initial energy plus the work, or [`BLOW_UP`] if
    /// none is given.
    pub(super) fn new(scene: &Scene) -> Self {
        Self { part: scene.solver.energy_gate, initial: 0.0, work: 0.0, advice: advice(scene) }
    }

    /// Whether the scene sets an energy gate.
    pub(super) fn is_set(&self) -> bool {
        self.part.is_some()
    }

    /// Checks a step and passes it to an observer; step 0 sets the initial energy.
    ///
    /// # Errors
    /// [`Error::Unstable`] if the energy balance of the step exceeds the limit or a value is not finite; any error of
    /// the observer.
    pub(super) fn tell(&mut self, observed: &Observed, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let Observed { step, reading } = observed;
        self.work = self.work.max(step.energy.external.abs());
        match step.number {
            0 => self.initial = step.energy.total + step.energy.dissipated - step.energy.external,
            number => self.check(step).map_err(|error| at(error, number, step.time))?,
        }
        observer.step(step, reading)
    }

    /// Saves the gate to a checkpoint or restores it.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.number("largest_work", &mut self.work)?;
        visitor.number("initial_energy", &mut self.initial)
    }

    /// Returns an error if the energy balance of a step exceeds the limit or a value is not finite.
    fn check(&self, step: &Step) -> Result<()> {
        let (energy, advice) = (&step.energy, &self.advice);
        if !(energy.total.is_finite() && step.contact.force.is_finite() && step.impactor.position.is_finite()) {
            return Err(Error::Unstable(format!(
                "the solution became NaN or infinite; the steps before it are kept. {advice}"
            )));
        }
        let balance = energy.total + energy.dissipated - energy.external - self.initial;
        let available = self.initial.abs() + self.work;
        if let Some(part) = self.part
            && balance.abs() > part * available
        {
            let (verb, amount) = if balance > 0.0 { ("gained", balance) } else { ("lost", -balance) };
            return Err(Error::Unstable(format!(
                "{:.2e} of the energy that there is {verb} by the time integration, and solver.energy_gate allows {part:e}. {advice}",
                amount / available
            )));
        }
        if self.part.is_none() && balance.abs() > BLOW_UP * available {
            return Err(Error::Unstable(format!(
                "spurious energy gain of {balance:.3e} J, more than the {available:.3e} J there are: the time integration is unstable. {advice}"
            )));
        }
        Ok(())
    }
}

/// Advice to the user for a run that fails the energy gate.
fn advice(scene: &Scene) -> String {
    let steps = match scene.time.step {
        Some(_) => "A smaller time.step",
        None => "A smaller accuracy.tolerance",
    };
    match scene.time.scheme {
        Scheme::Energy => format!("{steps} helps"),
        _ => format!("{steps}, or time.scheme = \"energy\", helps"),
    }
}
