//! The body at rest under its loads, supports and pads, before the hit: K u + p(u) = f.
//!
//! K alone may be singular: a pane on strips is held by nothing along its plane, and pads let go. So each iteration minimises the
//! potential with a penalty on the way from the last one, ½ ε |u − uₙ|² in the norm of M (R. T. Rockafellar, Monotone operators and the
//! proximal point algorithm, SIAM J. Control Optim. 14, 1976): a step of an implicit scheme from rest. What vibrates with ω comes nearer
//! by the factor ε/(ε + ω²) or better; what nothing holds stays where it is, as long as nothing pushes it. On pads an iteration is one of
//! the semi-smooth Newton method, as far along its direction as the potential falls.

use petsc_wrap::{Comm, Ksp, Vector};

use crate::body::{Body, no_equilibrium};
use crate::error::Result;
use crate::scene::Newton;
use crate::scheme::newmark;

use super::implicit::ImplicitStepper;
use super::initial::{self, unbalanced};
use super::line_search::step_length;
use super::state::{Impactor, Moment};
use crate::impact::parameters::ImpactParameters;

/// The steps, s: ε = 4/Δt². Long ones first, in which slow vibrations come to rest. On pads the body falls by about g Δt²/4 and is
/// pushed back in each: shorter ones then take out what that leaves of rounding.
const STEPS: [f64; 4] = [2.0, 0.2, 0.02, 0.002];

/// Where the impactor is meanwhile, m.
const FAR: f64 = 1e6;

/// The forces left over, as a part of the loads.
const TOLERANCE: f64 = 1e-13;

/// What they may be where rounding does not let them become less.
const ROUNDING: f64 = 1e-7;

/// Iterations with one step at most.
const MOST: usize = 50;

/// ε on pads, 1/s².
const PENALTIES: [f64; 2] = [1.0, 1e4];

/// How far a body may sink into pads, m: what goes further is falling, or tips over.
const DEEPEST: f64 = 1.0;

/// u in equilibrium. Collective.
///
/// # Errors
/// A fault of `time.initial` where there is no equilibrium; PETSc's.
pub(super) fn find(comm: &Comm, body: &mut Body, parameters: &ImpactParameters) -> Result<Vector> {
    if body.pads.is_some() {
        return find_on_pads(body);
    }
    let parameters = ImpactParameters { speed: 0.0, gap: FAR, weight: 0.0, ..parameters.clone() };
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
        for _ in 0..MOST {
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
            // Rounding is all that is left, or what only a longer step brings nearer.
            if left > 0.5 * before {
                break;
            }
        }
        // What the longest step does not slow down is falling: shorter ones would do the same.
        if left > 0.5 * loads {
            return Err(no_equilibrium());
        }
    }
    if left > ROUNDING * loads || !left.is_finite() {
        return Err(no_equilibrium());
    }
    Ok(now.state.u)
}

/// The same on pads. Collective.
fn find_on_pads(body: &mut Body) -> Result<Vector> {
    let [mut u, mut trial, mut change, mut out, mut momentum] = {
        let zeros = || body.load.duplicate();
        [zeros()?, zeros()?, zeros()?, zeros()?, zeros()?]
    };
    u.copy_from(&body.clamps.displacement)?;
    let mut residual = left_over(body, &u, &mut out)?;
    let loads = residual.norm()?;
    let mut left = loads;
    let mut is_first = true;
    for penalty in PENALTIES {
        for _ in 0..MOST {
            if left <= TOLERANCE * loads {
                break;
            }
            // A body that touches its pads is best begun with as if it pressed them everywhere.
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
            // Rounding is all that is left.
            if left <= ROUNDING * loads && left > 0.5 * before {
                break;
            }
        }
    }
    if left > ROUNDING * loads { Err(no_equilibrium()) } else { Ok(u) }
}

/// The forces on the free unknowns at a displacement, f − K u − p(u). Collective.
fn left_over(body: &mut Body, u: &Vector, product: &mut Vector) -> Result<Vector> {
    let mut force = body.load.duplicate()?;
    // add_force adds p: the sign is turned by what follows.
    if let Some(pads) = &mut body.pads {
        pads.add_force(None, u, &mut force)?;
    }
    body.apply_elastic(u, product)?;
    force.axpy(1.0, product)?;
    if let Some(support) = &body.support {
        support.mult(u, product)?;
        force.axpy(1.0, product)?;
    }
    force.aypx(-1.0, &body.load)?;
    force.axpy(1.0, &body.support_load)?;
    body.clamps.zero(&mut force)?;
    Ok(force)
}

/// Takes all speed and acceleration out.
fn stop(moment: &mut Moment) -> Result<()> {
    moment.state.v.fill(0.0)?;
    moment.state.a.fill(0.0)?;
    moment.state.q = Impactor { position: 0.0, velocity: 0.0, acceleration: 0.0 };
    Ok(moment.inertia.fill(0.0)?)
}
