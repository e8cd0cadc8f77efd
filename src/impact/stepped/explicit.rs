//! One step of the central difference method with lumped mass: no system is solved, and the force is evaluated at the
//! new displacement.

use petsc_wrap::Vector;

use crate::body::{Body, Lumped};
use crate::error::Result;
use crate::scene::{Fault, Scheme};
use crate::scheme::{CentralDifference, Implicit, newmark};

use super::energy_balance::{Exchange, Work, exchange};
use super::relaxation::Relaxed;
use super::stable_step::stable_step;
use super::state::{Impactor, Moment};
use super::step_sizes::Stepper;
use crate::impact::parameters::ImpactParameters;

/// Step taken if none is given, relative to the estimated stability limit. The margin covers the uncertainty of the
/// estimate.
const STEP_OVER_LIMIT: f64 = 0.95;

/// The central difference method at one step size.
pub struct ExplicitStepper {
    scheme: CentralDifference,
    /// First v_{n+1/2}, m/s; then D, m.
    half: Vector,
    force: Vector,
    pads: Option<Vector>,
}

impl ExplicitStepper {
    pub(super) fn new(body: &Body, step: f64) -> Result<Self> {
        let zeros = || body.terms.load.duplicate();
        let pads = body.pads.as_ref().map(|_| zeros()).transpose()?;
        Ok(Self { scheme: CentralDifference { step }, half: zeros()?, force: zeros()?, pads })
    }
}

impl Stepper for ExplicitStepper {
    /// # Panics
    /// If the body has no lumped mass.
    fn advance(
        &mut self,
        body: &mut Body,
        parameters: &ImpactParameters,
        from: &Moment,
        to: &mut Moment,
    ) -> Result<(Exchange, usize)> {
        let (scheme, state) = (self.scheme, &from.state);
        predict(scheme, from, to, &mut self.half)?;
        let (position, q_half) = scheme.predict(state.q.position, state.q.velocity, state.q.acceleration);
        to.state.q.position = position;
        to.state.v.copy_from(&self.half)?;
        to.update(body, parameters.gap)?;
        // Only the velocity at the middle of the step is known; it is extrapolated with the old acceleration.
        let rate = match parameters.law.damping {
            0.0 => 0.0,
            _ => q_half - to.surface_rate(body)? + 0.5 * scheme.step * from.acceleration(body)?,
        };
        let contact = parameters.law.damped(to.approach, rate);
        // Force f + a F − K u − p at the new displacement; the dampers' force is part of the correction.
        let force = &mut self.force;
        force.copy_from(&body.terms.load)?;
        force.axpy(1.0, &body.terms.support_load)?;
        force.axpy(contact.force, &body.terms.contact.force)?;
        force.axpy(-1.0, &to.products.elastic)?;
        if let Some(support) = &to.products.support {
            force.axpy(-1.0, support)?;
        }
        if let (Some(pads), Some(push)) = (&mut body.pads, &mut self.pads) {
            push.fill(0.0)?;
            pads.add_force(None, &to.state.u, push)?;
            force.axpy(-1.0, push)?;
        }
        body.clamps.zero(force)?;
        let lumped = body.lumped.as_ref().expect("an explicit scheme's body has a lumped mass");
        correct(scheme, lumped, (&self.half, &self.force), to)?;
        let (velocity, acceleration) = scheme.correct(q_half, parameters.weight - contact.force, parameters.mass, 0.0);
        to.state.q = Impactor { position, velocity, acceleration };
        to.rate = velocity - to.surface_rate(body)?;
        body.apply_mass(&to.state.v, &mut to.products.momentum)?;
        body.apply_mass(&to.state.a, &mut to.inertia)?;
        if let Some(product) = &mut to.products.damping {
            body.apply_damping(&to.state.v, product)?;
        }
        // Increment D for the energy balance.
        self.half.copy_from(&to.state.u)?;
        self.half.axpy(-1.0, &state.u)?;
        let (force, damping) = (contact.force, contact.force - contact.elastic);
        let work =
            Work { increment: &self.half, force, damping, relaxed: Relaxed::default(), pads: self.pads.as_ref() };
        let family = Implicit { beta: 0.0, ..newmark(0.25, 0.5) };
        let exchange = exchange(body, parameters, (&family, scheme.step), (from, to), work, &mut self.force)?;
        Ok((exchange, 0))
    }
}

/// Computes u_{n+1} and v_{n+1/2} of the body.
fn predict(scheme: CentralDifference, from: &Moment, to: &mut Moment, half: &mut Vector) -> Result<()> {
    let (u, v, a) = (from.state.u.read()?, from.state.v.read()?, from.state.a.read()?);
    let (mut new, mut half) = (to.state.u.write()?, half.write()?);
    for i in 0..u.len() {
        (new[i], half[i]) = scheme.predict(u[i], v[i], a[i]);
    }
    Ok(())
}

/// Computes u̇_{n+1} and ü_{n+1} of the body from v_{n+1/2} and the force.
fn correct(
    scheme: CentralDifference,
    lumped: &Lumped,
    (half, force): (&Vector, &Vector),
    to: &mut Moment,
) -> Result<()> {
    let (half, force, mass) = (half.read()?, force.read()?, lumped.mass.read()?);
    let damping = lumped.damping.as_ref().map(|damping| damping.read()).transpose()?;
    let (mut v, mut a) = (to.state.v.write()?, to.state.a.write()?);
    for i in 0..half.len() {
        let damping = damping.as_ref().map_or(0.0, |damping| damping[i]);
        (v[i], a[i]) = scheme.correct(half[i], force[i], mass[i], damping);
    }
    Ok(())
}

/// Returns the step (s) of an explicit run. A given step must be stable unless `allow_unstable` is set; without a given
/// step, a stable one is chosen. Collective.
///
/// # Errors
/// A fault of `time.step` if it is not stable; if a PETSc call fails.
pub(super) fn step(
    body: &mut Body,
    parameters: &ImpactParameters,
    (given, allow_unstable): (Option<f64>, bool),
) -> Result<f64> {
    if let (Some(step), true) = (given, allow_unstable) {
        return Ok(step);
    }
    let limit = stable_step(body, parameters, Scheme::CentralDifference { allow_unstable })?;
    let Some(step) = given else { return Ok(STEP_OVER_LIMIT * limit) };
    if step <= limit {
        return Ok(step);
    }
    Err(Fault::new(
        "time.step",
        format!(
            "the central difference is stable up to a step of {limit:.3e} s on this mesh, 2/ω_max with ω_max = {:.3e} rad/s, \
             and the step is {step:.3e} s",
            2.0 / limit
        ),
        "a smaller step, none at all (then it is chosen), an implicit scheme, or `allow_unstable = true` to see it fail",
    )
    .into())
}
