//! One impact: body, impactor and contact law in time.
//!
//! M ü + C u̇ + K u + p(u) = a F(δ) + f,  m0 q̈ = −F(δ),  δ = q − gap − aᵀu  (10), (14), from rest at t = 0.

mod ledger;
mod newton;
mod state;
pub mod step;

use std::ops::ControlFlow;

use petsc_wrap::{Comm, Ksp, Vector};

use crate::body::Solid;
use crate::contact::{Hertz, hertz};
use crate::error::{Error, Result};
use crate::scene::{self, Scene};
use crate::scheme::Newmark;

use ledger::Ledger;
use newton::Newton;
pub use state::State;
use step::{Contact, Motion, Step};

/// Newton's residual, as a part of the largest force that a half-space would see.
const FORCE_TOLERANCE: f64 = 1e-10;

/// What rounding leaves of the residual, as a part of its largest term: more than the above where a slow impactor meets a body that is
/// bent or moves for other reasons.
const ROUNDING: f64 = 100.0 * f64::EPSILON;

/// A body under an impactor, ready to run.
pub struct Impact {
    body: Solid,
    impactor: scene::Impactor,
    law: Hertz,
    scheme: Newmark,
    step: f64,
    steps: usize,
    newton: Newton,
    /// [`FORCE_TOLERANCE`] in N.
    tolerance: f64,
    ledger: Ledger,
    state: State,
    /// What a step needs: the part of its equations without D, D itself, and a matrix's product.
    known: Vector,
    work: Vector,
    product: Vector,
    /// Newton iterations so far.
    pub iterations: usize,
}

impl Impact {
    /// An impact of the scene on its body: sets up the Newton matrix and the initial state. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(comm: &Comm, scene: &Scene, mut body: Solid) -> Result<Self> {
        let scene::Scheme::Newmark { beta, gamma } = scene.time.scheme else { unimplemented!() };
        let (impactor, scheme) = (scene.impactor.clone(), Newmark { beta, gamma });
        let law = Hertz { stiffness: impactor.stiffness };
        let step = scene.time.step.unwrap_or(1e-5);
        let update = scheme.update(step);
        let state = initial(comm, &mut body, &impactor, law)?;
        let tolerance = FORCE_TOLERANCE * hertz::peak_force(impactor.stiffness, impactor.mass, impactor.speed);
        let newton = Newton::new(comm, &body, update, impactor.mass, tolerance)?;
        let [known, work, product] = [body.load.duplicate()?, body.load.duplicate()?, body.load.duplicate()?];
        let ledger = Ledger::new(&body)?;
        Ok(Self {
            body,
            impactor,
            law,
            scheme,
            step,
            steps: steps(scene.time.end, step),
            newton,
            tolerance,
            ledger,
            state,
            known,
            work,
            product,
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
        &self.state
    }

    /// Takes another state for the initial one.
    pub fn set_state(&mut self, state: State) {
        self.state = state;
    }

    /// Runs to the end, or until `observe`, which gets the initial state and every accepted step, breaks off; tells which.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::Solve`] with step, time and residual where Newton's method does not converge; the observer's; PETSc's.
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        let mut flow = observe(&self.observed(0)?)?;
        for number in 1..=self.steps {
            if flow.is_break() {
                break;
            }
            self.advance(number)?;
            flow = observe(&self.observed(number)?)?;
        }
        Ok(flow)
    }

    /// One step of Newmark's method: solves for the increments D of u and q.
    fn advance(&mut self, number: usize) -> Result<()> {
        let update = self.scheme.update(self.step);
        let State { u, v, a, q } = &mut self.state;
        // What the equations at t_{n+1} hold without D: f + k ū − K u_n − M a* − C v*, with a* and v* the updates for D = 0.
        let known = &mut self.known;
        known.copy_from(&self.body.load)?;
        known.axpy(1.0, &self.body.support_load)?;
        let mut largest = known.norm()?;
        let mut subtract = |matrix: Option<&petsc_wrap::Matrix>, x: &Vector| -> Result<()> {
            largest = largest.max(subtract(known, matrix, x, &mut self.product)?);
            Ok(())
        };
        subtract(Some(&self.body.elastic), u)?;
        subtract(self.body.support.as_ref(), u)?;
        combine(&mut self.work, update.a, v, a)?;
        subtract(Some(&self.body.mass), &self.work)?;
        if self.body.damping.is_some() {
            combine(&mut self.work, update.v, v, a)?;
            subtract(self.body.damping.as_ref(), &self.work)?;
        }
        self.newton.set_tolerance(self.tolerance.max(ROUNDING * largest))?;
        self.body.clamps.zero(known)?;
        let (_, free) = update.apply(0.0, q.velocity, q.acceleration);
        let known_impactor = -self.impactor.mass * free;
        // Newton starts from the increment at constant acceleration.
        let (step, half) = (self.step, 0.5 * self.step * self.step);
        combine(&mut self.work, [step, half], v, a)?;
        let guess = step * q.velocity + half * q.acceleration;
        let approach = q.position - self.impactor.gap - self.body.localization.vector.dot(u)?;
        let problem =
            newton::Step { u, known: (known, known_impactor), approach, law: self.law, pads: self.body.pads.as_mut() };
        let (increment, iterations) = self
            .newton
            .solve(problem, (&mut self.work, guess))
            .map_err(|error| describe(error, number, number as f64 * self.step, self.newton.tolerance()))?;
        self.iterations += iterations;
        self.ledger.account(&self.body, &self.work, self.step)?;
        u.axpy(1.0, &self.work)?;
        // v ← c1 D + v*, a ← c2 D + a*
        combine(&mut self.product, update.a, v, a)?;
        self.product.axpy(update.c2, &self.work)?;
        v.scale(update.v[0])?;
        v.axpy(update.v[1], a)?;
        v.axpy(update.c1, &self.work)?;
        a.copy_from(&self.product)?;
        let (velocity, acceleration) = update.apply(increment, q.velocity, q.acceleration);
        *q = state::Impactor { position: q.position + increment, velocity, acceleration };
        Ok(())
    }

    /// The state as observers see it.
    fn observed(&mut self, number: usize) -> Result<Step> {
        let surface_displacement = self.body.localization.vector.dot(&self.state.u)?;
        let q = self.state.q;
        let indentation = q.position - self.impactor.gap - surface_displacement;
        let force = self.law.force(indentation);
        let energy = self.ledger.energy(
            &mut self.body,
            &self.state,
            0.5 * self.impactor.mass * q.velocity * q.velocity,
            self.law.potential(indentation),
        )?;
        Ok(Step {
            number,
            time: number as f64 * self.step,
            impactor: Motion { position: q.position, velocity: q.velocity, acceleration: force / self.impactor.mass },
            contact: Contact { force, indentation, surface_displacement },
            energy,
        })
    }
}

/// Steps that reach the end; the last may pass it by less than a step.
pub fn steps(end: f64, step: f64) -> usize {
    // A part of 1e-9 of a step is rounding in end/step.
    (end / step - 1e-9).ceil().max(1.0) as usize
}

/// out ← αv + βa with the factors α, β.
fn combine(out: &mut Vector, factors: [f64; 2], v: &Vector, a: &Vector) -> Result<()> {
    out.copy_from(v)?;
    out.scale(factors[0])?;
    out.axpy(factors[1], a)?;
    Ok(())
}

/// out ← out − matrix·x, nothing without a matrix; the norm of what was subtracted.
fn subtract(out: &mut Vector, matrix: Option<&petsc_wrap::Matrix>, x: &Vector, product: &mut Vector) -> Result<f64> {
    let Some(matrix) = matrix else { return Ok(0.0) };
    matrix.mult(x, product)?;
    out.axpy(-1.0, product)?;
    Ok(product.norm()?)
}

/// At rest and undeformed, held unknowns at ū; the acceleration is that of the forces, M ü = a F + f − K u − p(u).
fn initial(comm: &Comm, body: &mut Solid, impactor: &scene::Impactor, law: Hertz) -> Result<State> {
    let mut u = body.load.duplicate()?;
    u.copy_from(&body.clamps.displacement)?;
    let mut force = body.load.duplicate()?;
    let mut product = body.load.duplicate()?;
    // add_force adds p: the sign is turned by what follows.
    if let Some(pads) = &mut body.pads {
        pads.add_force(&u, &mut force)?;
    }
    force.aypx(-1.0, &body.load)?;
    force.axpy(1.0, &body.support_load)?;
    for matrix in [Some(&body.elastic), body.support.as_ref()] {
        subtract(&mut force, matrix, &u, &mut product)?;
    }
    // Nothing, unless a held surface is pushed towards the impactor from the start.
    let a = &body.localization.vector;
    let contact = law.force(-impactor.gap - a.dot(&u)?);
    force.axpy(contact, a)?;
    body.clamps.zero(&mut force)?;
    let mut a = force.duplicate()?;
    if force.norm_max()? > 0.0 {
        let mut mass = body.mass.duplicate()?;
        mass.zero_rows_columns(&body.clamps.rows, 1.0)?;
        mass.declare_positive_definite()?;
        let mut ksp = Ksp::new(comm, "mass_", &mass)?;
        ksp.solve(&force, &mut a)?;
        ksp.destroy()?;
        mass.destroy()?;
    }
    let v = u.duplicate()?;
    let q = state::Impactor { position: 0.0, velocity: impactor.speed, acceleration: -contact / impactor.mass };
    Ok(State { u, v, a, q })
}

/// A failure told with step and time, and a solver's with its residual.
fn describe(error: petsc_wrap::Error, number: usize, time: f64, tolerance: petsc_wrap::Result<f64>) -> Error {
    let place = format!("step {number}, t = {time:.6e} s");
    match error {
        petsc_wrap::Error::Diverged(failure) => Error::Solve(format!(
            "{place}: Newton's method did not converge: {} after {} iterations, residual {:.3e} N (wanted: {:.3e} N). \
             A smaller time.step helps in most cases; -snes_monitor shows the iterations",
            failure.reason,
            failure.iterations,
            failure.norm,
            tolerance.unwrap_or_default()
        )),
        other => match Error::from(other) {
            // Whether other ranks have it too is not known.
            Error::Petsc(error) => Error::Alone(Box::new(Error::Solve(format!("{place}: {error}")))),
            told => told,
        },
    }
}
