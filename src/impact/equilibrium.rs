//! The body at rest under its loads, supports and pads, before the hit: K u + p(u) = f.
//!
//! K alone may be singular: a pane on strips is held by nothing along its plane, and pads let go. So each iteration minimises the
//! potential with a penalty on the way from the last one, ½ ε |u − uₙ|² in the norm of M (R. T. Rockafellar, Monotone operators and the
//! proximal point algorithm, SIAM J. Control Optim. 14, 1976): a step of an implicit scheme from rest. What vibrates with ω comes nearer
//! by the factor ε/(ε + ω²) or better; what nothing holds stays where it is, as long as nothing pushes it.

use petsc_wrap::{Comm, Vector};

use crate::body::{Body, no_equilibrium};
use crate::error::Result;
use crate::scene::Newton;
use crate::scheme::newmark;

use super::implicit::ImplicitStepper;
use super::initial::{self, unbalanced};
use super::setting::Setting;
use super::state::{Impactor, Moment};

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

/// u in equilibrium. Collective.
///
/// # Errors
/// A fault of `time.initial` where there is no equilibrium; PETSc's.
pub(super) fn find(comm: &Comm, body: &mut Body, setting: &Setting) -> Result<Vector> {
    let setting = Setting { speed: 0.0, gap: FAR, weight: 0.0, ..setting.clone() };
    body.equilibrium = None;
    let (mut now, mut next) = (Moment::zero(body)?, Moment::zero(body)?);
    initial::start(body, &setting, &mut now)?;
    let loads = now.inertia.norm()?;
    let tolerance = TOLERANCE * loads;
    let mut left = loads;
    for step in STEPS {
        if left <= tolerance {
            break;
        }
        let scheme = (newmark(0.25, 0.5), step);
        let mut stepper = ImplicitStepper::new(comm, body, &setting, scheme, (Newton::Condensed, tolerance))?;
        for _ in 0..MOST {
            if left <= tolerance {
                break;
            }
            stop(&mut now)?;
            now.update(body, setting.gap)?;
            stepper.advance(body, &setting, &now, &mut next)?;
            stop(&mut next)?;
            next.update(body, setting.gap)?;
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

/// Takes all speed and acceleration out.
fn stop(moment: &mut Moment) -> Result<()> {
    moment.state.v.fill(0.0)?;
    moment.state.a.fill(0.0)?;
    moment.state.q = Impactor { position: 0.0, velocity: 0.0, acceleration: 0.0 };
    Ok(moment.inertia.fill(0.0)?)
}
