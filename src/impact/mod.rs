//! One impact: body, impactor and contact law in time.
//!
//! M ü + C u̇ + K u + p(u) = a F(δ) + f,  m0 q̈ = −F(δ),  δ = q − gap − aᵀu  (10), (14), from rest at t = 0.

mod condensed;
mod full;
mod gate;
mod implicit;
mod initial;
mod ledger;
mod setting;
mod state;
pub mod step;

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::body::Solid;
use crate::contact::hertz;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::scheme::Implicit;

use gate::Gate;
use implicit::Stepper;
use ledger::Ledger;
pub use setting::Setting;
use state::Moment;
pub use state::{Impactor, State};
use step::{Contact, Motion, Step};

/// Newton's residual, as a part of the largest force that a half-space would see.
const FORCE_TOLERANCE: f64 = 1e-10;

/// A body under an impactor, ready to run.
pub struct Impact {
    body: Solid,
    setting: Setting,
    stepper: Stepper,
    steps: usize,
    gate: Gate,
    ledger: Ledger,
    /// The state reached, and room for the next.
    now: Moment,
    next: Moment,
    /// Newton iterations so far.
    pub iterations: usize,
}

impl Impact {
    /// An impact of the scene on its body: sets up the solver and the initial state. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(comm: &Comm, scene: &Scene, mut body: Solid) -> Result<Self> {
        let setting = Setting::new(&scene.impactor, &body);
        let scheme = Implicit::new(scene.time.scheme).expect("implicit");
        let step = scene.time.step.unwrap_or(1e-5);
        let mut now = Moment::zero(&body)?;
        initial::start(comm, &mut body, &setting, &mut now)?;
        let next = Moment::zero(&body)?;
        let tolerance = FORCE_TOLERANCE * hertz::peak_force(setting.law.hertz.stiffness, setting.mass, setting.speed);
        let stepper = Stepper::new(comm, &body, setting, (scheme, step), scene.solver.newton, tolerance)?;
        Ok(Self {
            steps: steps(scene.time.end, step),
            gate: Gate::new(scene.solver.energy_gate),
            ledger: Ledger::default(),
            body,
            setting,
            stepper,
            now,
            next,
            iterations: 0,
        })
    }

    /// Number of steps to the end.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// The body.
    pub fn body(&self) -> &Solid {
        &self.body
    }

    /// The state reached.
    pub fn state(&self) -> &State {
        &self.now.state
    }

    /// Takes another state for the initial one. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn set_state(&mut self, state: State) -> Result<()> {
        self.body.mass.mult(&state.a, &mut self.now.inertia)?;
        self.body.clamps.zero(&mut self.now.inertia)?;
        self.now.state = state;
        self.now.update(&mut self.body, self.setting.gap)
    }

    /// Runs to the end, or until `observe`, which gets the initial state and every accepted step, breaks off; tells which.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Solve`] with step and time where a step is not solved, the contact law is left or the energy gate
    /// closes; the observer's; PETSc's.
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        let start = self.observed(0, 0.0)?;
        self.gate.open(&start);
        let mut flow = observe(&start)?;
        for number in 1..=self.steps {
            if flow.is_break() {
                break;
            }
            let time = number as f64 * self.stepper.step();
            self.advance().map_err(|error| at(error, number, time))?;
            let step = self.observed(number, time)?;
            self.gate.check(&step).map_err(|error| at(error, number, time))?;
            flow = observe(&step)?;
        }
        Ok(flow)
    }

    /// One step.
    fn advance(&mut self) -> Result<()> {
        let (exchange, iterations) = self.stepper.advance(&mut self.body, &self.setting, &self.now, &mut self.next)?;
        self.setting.admit(self.next.approach)?;
        self.iterations += iterations;
        self.ledger.account(exchange);
        std::mem::swap(&mut self.now, &mut self.next);
        Ok(())
    }

    /// The state as observers see it.
    fn observed(&self, number: usize, time: f64) -> Result<Step> {
        let Setting { law, mass, copies, .. } = self.setting;
        let Moment { state, surface, approach, .. } = &self.now;
        let force = law.force(*approach);
        Ok(Step {
            number,
            time,
            impactor: Motion { position: state.q.position, velocity: state.q.velocity, acceleration: force / mass },
            contact: Contact {
                force: copies * force,
                indentation: law.indentation(*approach),
                surface_displacement: *surface,
            },
            energy: self.ledger.energy(&self.body, &self.setting, &self.now)?,
        })
    }
}

/// Steps that reach the end; the last may pass it by less than a step.
pub fn steps(end: f64, step: f64) -> usize {
    // A part of 1e-9 of a step is rounding in end/step.
    (end / step - 1e-9).ceil().max(1.0) as usize
}

/// A failure told with step and time.
fn at(error: Error, number: usize, time: f64) -> Error {
    let place = format!("step {number}, t = {time:.6e} s");
    match error {
        Error::Solve(message) => Error::Solve(format!("{place}: {message}")),
        // Whether other ranks have it too is not known.
        Error::Petsc(error) => Error::Alone(Box::new(Error::Solve(format!("{place}: {error}")))),
        other => other,
    }
}
