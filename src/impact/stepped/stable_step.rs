//! Stability limit of a scheme on a body, known before a run.

use crate::body::{Body, Inertia, LinearContact, largest_frequency};
use crate::error::Result;
use crate::scene::Scheme;
use crate::scheme::critical_frequency;

use crate::impact::parameters::ImpactParameters;

/// Returns the stability limit Ω_crit/ω_max (s) of the body with the impactor on it, at the contact stiffness of an
/// impact on a half-space. It is infinite for unconditionally stable schemes, 0 for schemes that are never stable. M is
/// the lumped mass if the body has one. Collective.
///
/// # Errors
/// If a PETSc call fails.
pub fn stable_step(body: &mut Body, parameters: &ImpactParameters, scheme: Scheme) -> Result<f64> {
    let critical = match scheme {
        Scheme::Newmark { beta, gamma } => critical_frequency(beta, gamma),
        Scheme::GeneralizedAlpha { .. } | Scheme::Energy => f64::INFINITY,
        Scheme::CentralDifference { .. } => critical_frequency(0.0, 0.5),
    };
    if critical == 0.0 || critical.is_infinite() {
        return Ok(critical);
    }
    let ImpactParameters { law, mass, contact_speed, .. } = parameters;
    let peak = law.force_law.peak_indentation(*mass, *contact_speed);
    let lumped = body.lumped.take();
    let inertia = || lumped.as_ref().map_or(Inertia::Consistent, |lumped| Inertia::Lumped(&lumped.mass));
    let mut tangent = law.steepest(peak);
    let mut largest = largest_frequency(body, inertia(), Some(LinearContact { tangent, mass: *mass }));
    if let (Ok(found), true) = (&largest, law.damping > 0.0) {
        // The damper's velocity is extrapolated. With the damper's constant c the stability limit is
        // (ω Δt)²/4 + c Δt/m = 1, the same as for an additional spring of stiffness 2 c ω.
        let damper = law.damped(peak, *contact_speed).viscosity;
        tangent += 2.0 * damper * found.bound;
        largest = largest_frequency(body, inertia(), Some(LinearContact { tangent, mass: *mass }));
    }
    body.lumped = lumped;
    Ok(critical / largest?.bound)
}
