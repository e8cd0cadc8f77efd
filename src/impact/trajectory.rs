//! The motion of body and impactor as one choice of steps gives it.

use crate::body::Body;
use crate::error::{Error, Result};

use super::checkpoint::Carrier;
use super::initial;
use super::ladder::Stepper;
use super::ledger::Ledger;
use super::observer::Observed;
use super::reading::{Reader, Reading};
use super::setting::Setting;
use super::state::{Moment, State};
use super::step::{Contact, Motion, Step};

/// The moment reached, and what was exchanged on the way.
pub struct Trajectory {
    /// The moment reached.
    pub now: Moment,
    next: Moment,
    ledger: Ledger,
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
    pub(super) fn new(body: &mut Body, setting: &Setting) -> Result<Self> {
        let mut now = Moment::zero(body)?;
        initial::start(body, setting, &mut now)?;
        Ok(Self { now, next: Moment::zero(body)?, ledger: Ledger::default(), time: 0.0, steps: 0 })
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
        setting: &Setting,
    ) -> Result<usize> {
        let (number, wrong) = (self.steps + 1, |error| at(error, self.steps + 1, time));
        let (exchange, iterations) = stepper.advance(body, setting, &self.now, &mut self.next).map_err(wrong)?;
        setting.admit(self.next.approach, self.next.rate).map_err(wrong)?;
        self.ledger.account(exchange);
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
        (self.ledger, self.time, self.steps) = (other.ledger, other.time, other.steps);
        Ok(())
    }

    /// To a checkpoint or from it.
    ///
    /// # Errors
    /// Those of [`Carrier`].
    pub(super) fn carry(&mut self, carrier: &mut Carrier) -> Result<()> {
        self.now.carry(carrier)?;
        self.ledger.carry(carrier)?;
        carrier.number("time", &mut self.time)?;
        carrier.count("steps", &mut self.steps)
    }

    /// Takes another state in place of the one reached. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn set_state(&mut self, state: State, body: &mut Body, setting: &Setting) -> Result<()> {
        body.apply_mass(&state.a, &mut self.now.inertia)?;
        body.clamps.zero(&mut self.now.inertia)?;
        self.now.state = state;
        self.now.update(body, setting.gap)
    }

    /// F over the impactor's mass, m/s².
    pub(super) fn acceleration(&self, setting: &Setting) -> f64 {
        setting.force(self.now.approach, self.now.rate) / setting.mass
    }

    /// The moment as observers see it. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn observed(&self, body: &Body, setting: &Setting, reader: &mut Option<Reader>) -> Result<Observed> {
        let step = self.step(body, setting)?;
        let reading = match reader {
            Some(reader) => reader.read(&step, &self.now.state)?,
            None => Reading::default(),
        };
        Ok(Observed { step, reading })
    }

    fn step(&self, body: &Body, setting: &Setting) -> Result<Step> {
        let Moment { state, surface, approach, rate, .. } = &self.now;
        let force = setting.force(*approach, *rate);
        Ok(Step {
            number: self.steps,
            time: self.time,
            impactor: Motion {
                position: state.q.position,
                velocity: state.q.velocity,
                acceleration: force / setting.mass,
            },
            contact: Contact {
                force: setting.copies * force,
                indentation: setting.law.indentation(*approach, force),
                surface_displacement: *surface,
                approach: *approach,
                rate: *rate,
            },
            energy: self.ledger.energy(body, setting, &self.now)?,
        })
    }
}

/// A failure told with step and time.
pub(super) fn at(error: Error, number: usize, time: f64) -> Error {
    let place = format!("step {number}, t = {time:.6e} s");
    match error {
        Error::Solve(message) => Error::Solve(format!("{place}: {message}")),
        Error::Unstable(message) => Error::Unstable(format!("{place}: {message}")),
        // Whether other ranks have it too is not known.
        Error::Petsc(error) => Error::Alone(Box::new(Error::Solve(format!("{place}: {error}")))),
        other => other,
    }
}
