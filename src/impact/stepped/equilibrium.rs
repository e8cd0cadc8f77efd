//! Equilibrium of the body under its loads, supports and pads, before the impact: K u + p(u) = f.
//!
//! K alone may be singular: a pane on strips is not supported along its plane, and pads can lift off. Therefore each
//! iteration minimises the potential plus a penalty on the distance from the last iterate, ½ ε |u − uₙ|² in the norm of
//! M (R. T. Rockafellar, Monotone operators and the proximal point algorithm, SIAM J. Control Optim. 14, 1976). This is
//! a step of an implicit scheme from rest. The error of a vibration of frequency ω decreases by the factor ε/(ε + ω²)
//! or better; unsupported motions remain where they are unless they are loaded. On pads an iteration is one of the
//! semi-smooth Newton method, with a step length that minimises the potential.

use petsc_wrap::{Comm, Ksp, Vector};

use crate::body::{Body, no_equilibrium};
use crate::error::Result;
use crate::scene::Newton;
use crate::scheme::newmark;

use super::implicit::ImplicitStepper;
use super::initial::{self, unbalanced};
use super::line_search::step_length;
use super::state::{Impactor, Moment};
use super::step_sizes::Stepper;
use crate::impact::parameters::ImpactParameters;

/// Time steps Δt, s: ε = 4/Δt². Long steps come first and bring slow vibrations to rest; shorter steps then reduce the
/// residual further.
const STEPS: [f64; 4] = [2.0, 0.2, 0.02, 0.002];

/// Gap of the impactor during the search, m: far away, so that it does not touch the body.
const FAR_GAP: f64 = 1e6;

/// Residual forces that count as zero, relative to the loads.
const TOLERANCE: f64 = 1e-13;

/// Largest residual forces that are accepted in any case if smaller ones are not reached, relative to the loads.
const ROUNDING: f64 = 1e-7;

/// Largest residual forces that are accepted if they are not above the estimated rounding, relative to the loads.
const LARGEST_ROUNDING: f64 = 1e-4;

/// Largest number of iterations with one time step.
const MAX_ITERATIONS: usize = 500;

/// Residual forces over the ones before the iteration, above which [`MAX_ITERATIONS`] iterations do not reach
/// [`ROUNDING`].
const SLOWEST: f64 = 0.968;

/// Largest number of iterations with one penalty.
const MAX_PAD_ITERATIONS: usize = 50;

/// Penalties ε on pads, 1/s².
const PENALTIES: [f64; 2] = [1.0, 1e4];

/// Largest displacement of a body on pads, m; a body that moves further is falling or tips over.
const DEEPEST: f64 = 1.0;

/// Returns u in equilibrium. Collective.
///
/// # Errors
/// A fault of `time.initial` if there is no equilibrium; if a PETSc call fails.
pub(super) fn find(comm: &Comm, body: &mut Body, parameters: &ImpactParameters) -> Result<Vector> {
    if body.pads.is_some() {
        return find_on_pads(body);
    }
    let parameters = ImpactParameters { speed: 0.0, gap: FAR_GAP, weight: 0.0, ..parameters.clone() };
    body.equilibrium = None;
    let (mut now, mut next) = (Moment::zero(body)?, Moment::zero(body)?);
    initial::start(body, &parameters, &mut now)?;
    let loads = now.inertia.norm()?;
    let tolerance = TOLERANCE * loads;
    let mut left = loads;
    for step in STEPS {
        if left <= tolerance {
            break;
        }
        let scheme = (newmark(0.25, 0.5), step);
        let mut stepper = ImplicitStepper::new(comm, body, &parameters, scheme, (Newton::Condensed, tolerance))?;
        for _ in 0..MAX_ITERATIONS {
            if left <= tolerance {
                break;
            }
            stop(&mut now)?;
            now.update(body, parameters.gap)?;
            stepper.advance(body, &parameters, &now, &mut next)?;
            stop(&mut next)?;
            next.update(body, parameters.gap)?;
            unbalanced(body, 0.0, &mut next)?;
            let before = std::mem::replace(&mut left, next.inertia.norm()?);
            std::mem::swap(&mut now, &mut next);
            let is_rounding = left <= ROUNDING * loads && left > 0.5 * before;
            // Slower vibrations need longer steps, and unsupported motions have no rest.
            if is_rounding || left > SLOWEST * before {
                break;
            }
        }
        // If the longest step hardly reduces the residual forces, the body is falling; shorter steps would not change
        // this.
        if left > 0.5 * loads {
            return Err(no_equilibrium());
        }
    }
    let rounding = rounding(body, &now.state.u)?.min(LARGEST_ROUNDING * loads).max(ROUNDING * loads);
    if left > rounding || !left.is_finite() {
        return Err(no_equilibrium());
    }
    Ok(now.state.u)
}

/// Estimates the rounding of the forces K u, N. A rigid translation causes no forces, so the computed ones are rounding.
/// On soft supports a stiff body moves so far that this rounding is not small compared with the loads. Zero for a reduced
/// body, whose few unknowns have no such rounding. Collective.
fn rounding(body: &Body, u: &Vector) -> Result<f64> {
    let translation = body.terms.translation.norm_max()?;
    if translation == 0.0 {
        return Ok(0.0);
    }
    let mut forces = body.terms.load.duplicate()?;
    body.apply_elastic(&body.terms.translation, &mut forces)?;
    body.clamps.zero(&mut forces)?;
    Ok(forces.norm()? * u.norm_max()? / translation)
}

/// Same as [`find`] for a body on pads. Collective.
fn find_on_pads(body: &mut Body) -> Result<Vector> {
    let [mut u, mut trial, mut change, mut out, mut momentum] = {
        let zeros = || body.terms.load.duplicate();
        [zeros()?, zeros()?, zeros()?, zeros()?, zeros()?]
    };
    u.copy_from(&body.clamps.displacement)?;
    let mut residual = left_over(body, &u, &mut out)?;
    let loads = residual.norm()?;
    let mut left = loads;
    let mut is_first = true;
    for penalty in PENALTIES {
        for _ in 0..MAX_PAD_ITERATIONS {
            if left <= TOLERANCE * loads {
                break;
            }
            // The first iteration takes the pads as pressed everywhere, which is a good start for a body that touches
            // its pads.
            let matrix = body.operator_on_pads(penalty, (!is_first).then_some(&u))?;
            is_first = false;
            let mut solver: Ksp = body.solver(&matrix)?;
            solver.solve(&residual, &mut change)?;
            solver.destroy()?;
            matrix.destroy()?;
            body.apply_mass(&change, &mut momentum)?;
            let of_penalty = penalty * momentum.dot(&change)?;
            let length = step_length(|length| {
                trial.copy_from(&u)?;
                trial.axpy(length, &change)?;
                Ok::<f64, crate::Error>(length * of_penalty - left_over(body, &trial, &mut out)?.dot(&change)?)
            })?;
            u.axpy(length, &change)?;
            residual = left_over(body, &u, &mut out)?;
            let before = std::mem::replace(&mut left, residual.norm()?);
            if u.norm_max()? > DEEPEST || !left.is_finite() {
                return Err(no_equilibrium());
            }
            // Only rounding is left.
            if left <= ROUNDING * loads && left > 0.5 * before {
                break;
            }
        }
    }
    if left > ROUNDING * loads { Err(no_equilibrium()) } else { Ok(u) }
}

/// Forces on the free unknowns at a displacement, f − K u − p(u). Collective.
fn left_over(body: &mut Body, u: &Vector, product: &mut Vector) -> Result<Vector> {
    let mut force = body.terms.load.duplicate()?;
    // add_force adds p; aypx below changes the sign.
    if let Some(pads) = &mut body.pads {
        pads.add_force(None, u, &mut force)?;
    }
    body.apply_elastic(u, product)?;
    force.axpy(1.0, product)?;
    if let Some(support) = &body.terms.support {
        support.mult(u, product)?;
        force.axpy(1.0, product)?;
    }
    force.aypx(-1.0, &body.terms.load)?;
    force.axpy(1.0, &body.terms.support_load)?;
    body.clamps.zero(&mut force)?;
    Ok(force)
}

/// Sets all velocities, accelerations and inertia forces to zero.
fn stop(moment: &mut Moment) -> Result<()> {
    moment.state.v.fill(0.0)?;
    moment.state.a.fill(0.0)?;
    moment.state.q = Impactor { position: 0.0, velocity: 0.0, acceleration: 0.0 };
    Ok(moment.inertia.fill(0.0)?)
}
