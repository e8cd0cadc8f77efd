//! The largest step that theory allows a scheme on a body, known before anything is run.

use crate::body::{Body, Inertia, LinearContact, largest_frequency};
use crate::error::Result;
use crate::scene::Scheme;
use crate::scheme::critical_frequency;

use crate::impact::parameters::ImpactParameters;

/// Ω_crit/ω_max (s) of the body with the impactor on it, at the stiffness that an impact on a half-space would reach; infinite
/// for schemes that are stable at every step, 0 for those that are at none. M is the lumped one where the body has it. Collective.
///
/// # Errors
/// PETSc's.
pub fn stable_step(body: &mut Body, parameters: &ImpactParameters, scheme: Scheme) -> Result<f64> {
    let critical = match scheme {
        Scheme::Newmark { beta, gamma } => critical_frequency(beta, gamma),
        Scheme::GeneralizedAlpha { .. } | Scheme::Energy => f64::INFINITY,
        Scheme::CentralDifference { .. } => critical_frequency(0.0, 0.5),
    };
    if critical == 0.0 || critical.is_infinite() {
        return Ok(critical);
    }
    let ImpactParameters { law, mass, speed, .. } = parameters;
    let peak = law.force_law.peak_indentation(*mass, *speed);
    let lumped = body.lumped.take();
    let inertia = || lumped.as_ref().map_or(Inertia::Consistent, |lumped| Inertia::Lumped(&lumped.mass));
    let mut tangent = law.steepest(peak);
    let mut largest = largest_frequency(body, inertia(), Some(LinearContact { tangent, mass: *mass }));
    if let (Ok(found), true) = (&largest, law.damping > 0.0) {
        // The damper's velocity is extrapolated: with c of the damper the step bears (ω Δt)²/4 + c Δt/m = 1, as a spring of 2 c ω has it.
        let damper = law.damped(peak, *speed).viscosity;
        tangent += 2.0 * damper * found.bound;
        largest = largest_frequency(body, inertia(), Some(LinearContact { tangent, mass: *mass }));
    }
    body.lumped = lumped;
    Ok(critical / largest?.bound)
}
