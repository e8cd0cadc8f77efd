//! Stops a run whose energy has gone wrong.

use crate::error::{Error, Result};

use super::step::Step;

/// What may be made from nothing where the scene sets no gate, as a part of the energy that there is: a scheme at its
/// worst makes a small part of that, an unstable one a thousandfold within some tens of steps.
const BLOW_UP: f64 = 1.0;

/// The energy gate of a run.
#[derive(Debug)]
pub struct Gate {
    part: Option<f64>,
    initial: f64,
}

impl Gate {
    /// A gate that stops at a part of the initial energy; without one, at a blow-up.
    pub(super) fn new(part: Option<f64>) -> Self {
        Self { part, initial: 0.0 }
    }

    /// Takes the initial energy.
    pub(super) fn open(&mut self, start: &Step) {
        self.initial = start.energy.total + start.energy.dissipated - start.energy.external;
    }

    /// Refuses a step whose balance is off, or which is not a number.
    ///
    /// # Errors
    /// [`Error::Unstable`].
    pub(super) fn check(&self, step: &Step) -> Result<()> {
        let energy = &step.energy;
        if !(energy.total.is_finite() && step.contact.force.is_finite() && step.impactor.position.is_finite()) {
            return Err(Error::Unstable(format!(
                "the solution is no number any more; the steps before it are kept. {ADVICE}"
            )));
        }
        let balance = energy.total + energy.dissipated - energy.external - self.initial;
        if let Some(part) = self.part
            && balance.abs() > part * self.initial.abs()
        {
            let (verb, amount) = if balance > 0.0 { ("gained", balance) } else { ("lost", -balance) };
            return Err(Error::Unstable(format!(
                "{:.3} % of the initial energy {verb} by the time integration, and solver.energy_gate allows {:.3} %. {ADVICE}",
                100.0 * amount / self.initial,
                100.0 * part
            )));
        }
        if self.part.is_none() && balance > BLOW_UP * (self.initial.abs() + energy.external.abs()) {
            return Err(Error::Unstable(format!(
                "the time integration has made {balance:.3e} J from nothing, more than the {:.3e} J there are: it is unstable. {ADVICE}",
                self.initial.abs() + energy.external.abs()
            )));
        }
        Ok(())
    }
}

const ADVICE: &str = "A smaller time.step, or time.scheme = \"energy\", helps";
