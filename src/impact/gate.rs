//! Stops a run whose energy has gone wrong.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::{Scene, Scheme};

use super::checkpoint::Visitor;
use super::observer::{Observed, Observer};
use super::step::Step;
use crate::impact::step::at;

/// What may be made from nothing where the scene sets no gate, as a part of the energy that there is: a scheme at its
/// worst makes a small part of that, an unstable one a thousandfold within some tens of steps.
const BLOW_UP: f64 = 1.0;

/// The energy gate of a run.
#[derive(Debug)]
pub struct Gate {
    part: Option<f64>,
    initial: f64,
    /// What the user can do.
    advice: String,
}

impl Gate {
    /// The gate of a scene: at a part of the initial energy, or at a blow-up.
    pub(super) fn new(scene: &Scene) -> Self {
        Self { part: scene.solver.energy_gate, initial: 0.0, advice: advice(scene) }
    }

    /// Whether the scene sets it.
    pub(super) fn is_set(&self) -> bool {
        self.part.is_some()
    }

    /// Tells an observer a step that passes; the first one sets the energy that there is.
    ///
    /// # Errors
    /// [`Error::Unstable`] where the step's balance is off, or it is not a number; the observer's.
    pub(super) fn tell(&mut self, observed: &Observed, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let Observed { step, reading } = observed;
        match step.number {
            0 => self.initial = step.energy.total + step.energy.dissipated - step.energy.external,
            number => self.check(step).map_err(|error| at(error, number, step.time))?,
        }
        observer.step(step, reading)
    }

    /// To a checkpoint or from it.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.number("initial_energy", &mut self.initial)
    }

    /// Refuses a step whose balance is off, or which is not a number.
    fn check(&self, step: &Step) -> Result<()> {
        let (energy, advice) = (&step.energy, &self.advice);
        if !(energy.total.is_finite() && step.contact.force.is_finite() && step.impactor.position.is_finite()) {
            return Err(Error::Unstable(format!(
                "the solution became NaN or infinite; the steps before it are kept. {advice}"
            )));
        }
        let balance = energy.total + energy.dissipated - energy.external - self.initial;
        if let Some(part) = self.part
            && balance.abs() > part * self.initial.abs()
        {
            let (verb, amount) = if balance > 0.0 { ("gained", balance) } else { ("lost", -balance) };
            return Err(Error::Unstable(format!(
                "{:.2e} of the initial energy {verb} by the time integration, and solver.energy_gate allows {part:e}. {advice}",
                amount / self.initial
            )));
        }
        if self.part.is_none() && balance.abs() > BLOW_UP * (self.initial.abs() + energy.external.abs()) {
            return Err(Error::Unstable(format!(
                "spurious energy gain of {balance:.3e} J, more than the {:.3e} J there are: the time integration is unstable. {advice}",
                self.initial.abs() + energy.external.abs()
            )));
        }
        Ok(())
    }
}

/// What helps against energy that comes from nowhere.
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
