//! The motion of body and impactor as one choice of steps gives it.

use crate::body::Body;
use crate::error::Result;

use super::energy_balance::EnergyBalance;
use super::initial;
use super::state::{Moment, State};
use super::step_sizes::Stepper;
use crate::impact::checkpoint::Visitor;
use crate::impact::observer::Observed;
use crate::impact::parameters::ImpactParameters;
use crate::impact::reading::{Reader, Reading};
use crate::impact::step::{Contact, Motion, Step, at};

/// The moment reached, and what was exchanged on the way.
pub struct Trajectory {
    /// The moment reached.
    pub now: Moment,
    next: Moment,
    energy_balance: EnergyBalance,
    /// Time, s.
    pub time: f64,
    /// Steps taken.
    pub steps: usize,
}

impl Trajectory {
    /// At t = 0. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn new(body: &mut Body, parameters: &ImpactParameters) -> Result<Self> {
        let mut now = Moment::zero(body)?;
        initial::start(body, parameters, &mut now)?;
        Ok(Self { now, next: Moment::zero(body)?, energy_balance: EnergyBalance::default(), time: 0.0, steps: 0 })
    }

    /// One step, to a time (s); returns the Newton iterations. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] where the step is not solved or leaves the contact law; PETSc's.
    pub(super) fn advance(
        &mut self,
        stepper: &mut Stepper,
        time: f64,
        body: &mut Body,
        parameters: &ImpactParameters,
    ) -> Result<usize> {
        let (number, wrong) = (self.steps + 1, |error| at(error, self.steps + 1, time));
        let (exchange, iterations) = stepper.advance(body, parameters, &self.now, &mut self.next).map_err(wrong)?;
        parameters.admit(self.next.approach, self.next.rate).map_err(wrong)?;
        self.energy_balance.account(exchange);
        std::mem::swap(&mut self.now, &mut self.next);
        (self.time, self.steps) = (time, number);
        Ok(iterations)
    }

    /// Becomes a copy of another one of the same body.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.now.copy_from(&other.now)?;
        (self.energy_balance, self.time, self.steps) = (other.energy_balance, other.time, other.steps);
        Ok(())
    }

    /// To a checkpoint or from it.
    ///
    /// # Errors
    /// Those of [`Visitor`].
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        self.now.visit(visitor)?;
        self.energy_balance.visit(visitor)?;
        visitor.number("time", &mut self.time)?;
        visitor.count("steps", &mut self.steps)
    }

    /// Takes another state in place of the one reached. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn set_state(&mut self, state: State, body: &mut Body, parameters: &ImpactParameters) -> Result<()> {
        body.apply_mass(&state.a, &mut self.now.inertia)?;
        body.clamps.zero(&mut self.now.inertia)?;
        self.now.state = state;
        self.now.update(body, parameters.gap)
    }

    /// F over the impactor's mass, m/s².
    pub(super) fn acceleration(&self, parameters: &ImpactParameters) -> f64 {
        parameters.force(self.now.approach, self.now.rate) / parameters.mass
    }

    /// The moment as observers see it. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn observed(
        &self,
        body: &Body,
        parameters: &ImpactParameters,
        reader: &mut Option<Reader>,
    ) -> Result<Observed> {
        let step = self.step(body, parameters)?;
        let reading = match reader {
            Some(reader) => reader.read(&step, &self.now.state)?,
            None => Reading::default(),
        };
        Ok(Observed { step, reading })
    }

    fn step(&self, body: &Body, parameters: &ImpactParameters) -> Result<Step> {
        let Moment { state, surface, approach, rate, .. } = &self.now;
        let force = parameters.force(*approach, *rate);
        Ok(Step {
            number: self.steps,
            time: self.time,
            impactor: Motion {
                position: state.q.position,
                velocity: state.q.velocity,
                acceleration: force / parameters.mass,
            },
            contact: Contact {
                force: parameters.copies * force,
                indentation: parameters.law.indentation(*approach, force),
                surface_displacement: *surface,
                approach: *approach,
                rate: *rate,
            },
            energy: self.energy_balance.energy(body, parameters, &self.now)?,
        })
    }
}
