//! Motion of body and impactor in one sequence of time steps.

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

/// The moment reached, and the energies exchanged since t = 0.
pub struct Trajectory {
    /// State and products at the time reached.
    pub now: Moment,
    next: Moment,
    energy_balance: EnergyBalance,
    /// Time reached, s.
    pub time: f64,
    /// Number of steps taken.
    pub steps: usize,
}

impl Trajectory {
    /// Starts a trajectory at t = 0. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn new(body: &mut Body, parameters: &ImpactParameters) -> Result<Self> {
        let mut now = Moment::zero(body)?;
        initial::start(body, parameters, &mut now)?;
        Ok(Self { now, next: Moment::zero(body)?, energy_balance: EnergyBalance::default(), time: 0.0, steps: 0 })
    }

    /// Takes one step, to a time (s); returns the number of Newton iterations. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] if the step cannot be solved or the contact law becomes invalid,
    /// [`crate::Error::Unstable`] if the motion has blown up; if a PETSc call fails.
    pub(super) fn advance(
        &mut self,
        stepper: &mut dyn Stepper,
        time: f64,
        body: &mut Body,
        parameters: &ImpactParameters,
    ) -> Result<usize> {
        let (number, wrong) = (self.steps + 1, |error| at(error, self.steps + 1, time));
        let (exchange, iterations) = stepper.advance(body, parameters, &self.now, &mut self.next).map_err(wrong)?;
        let Moment { approach, rate, .. } = self.next;
        parameters.admit(approach, rate, parameters.force(approach, rate)).map_err(wrong)?;
        self.energy_balance.account(exchange);
        std::mem::swap(&mut self.now, &mut self.next);
        (self.time, self.steps) = (time, number);
        Ok(iterations)
    }

    /// Overwrites this with another trajectory of the same body.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.now.copy_from(&other.now)?;
        (self.energy_balance, self.time, self.steps) = (other.energy_balance, other.time, other.steps);
        Ok(())
    }

    /// Saves the trajectory to a checkpoint or restores it.
    ///
    /// # Errors
    /// Same as [`Visitor`].
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        self.now.visit(visitor)?;
        self.energy_balance.visit(visitor)?;
        visitor.number("time", &mut self.time)?;
        visitor.count("steps", &mut self.steps)
    }

    /// Replaces the state reached. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn set_state(&mut self, state: State, body: &mut Body, parameters: &ImpactParameters) -> Result<()> {
        body.apply_mass(&state.a, &mut self.now.inertia)?;
        body.clamps.zero(&mut self.now.inertia)?;
        self.now.state = state;
        self.now.update(body, parameters.gap)
    }

    /// Contact force over the impactor's mass, m/s².
    pub(super) fn acceleration(&self, parameters: &ImpactParameters) -> f64 {
        parameters.force(self.now.approach, self.now.rate) / parameters.mass
    }

    /// Returns the present step for the observers. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
                force: parameters.multiplicity * force,
                indentation: parameters.law.indentation(*approach, force),
                surface_displacement: parameters.surface(*surface, force),
                approach: *approach,
                rate: *rate,
                impulse: parameters.impulse(state.q.velocity, self.time),
            },
            energy: self.energy_balance.energy(body, parameters, &self.now)?,
        })
    }
}
