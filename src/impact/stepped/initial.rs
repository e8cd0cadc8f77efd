//! State at t = 0.

use crate::body::Body;
use crate::error::Result;

use super::state::{Impactor, Moment};
use crate::impact::parameters::ImpactParameters;

/// Sets the state at t = 0. If the body has an equilibrium, it starts there without acceleration. Otherwise it is
/// undeformed and at rest, with constrained unknowns at ū, and the acceleration follows from the forces:
/// M ü = a F + f − K u − p(u). Collective.
///
/// # Errors
/// If a PETSc call fails.
pub(super) fn start(body: &mut Body, parameters: &ImpactParameters, moment: &mut Moment) -> Result<()> {
    moment.state.u.copy_from(body.equilibrium.as_ref().unwrap_or(&body.clamps.displacement))?;
    moment.state.q = Impactor { position: 0.0, velocity: parameters.speed, acceleration: 0.0 };
    moment.update(body, parameters.gap)?;
    // Zero, unless a prescribed displacement pushes the surface against the impactor at t = 0.
    let contact = parameters.force(moment.approach, moment.rate);
    moment.state.q.acceleration = (parameters.weight - contact) / parameters.mass;
    if body.equilibrium.is_some() {
        return Ok(());
    }
    unbalanced(body, contact, moment)?;
    let force = &mut moment.inertia;
    if let Some(lumped) = &body.lumped {
        moment.state.a.copy_from(force)?;
        moment.state.a.pointwise_divide(&lumped.mass)?;
    } else if force.norm_max()? > 0.0 {
        let (mass, mut ksp) = body.mass_solver()?;
        ksp.solve(force, &mut moment.state.a)?;
        ksp.destroy()?;
        mass.destroy()?;
    }
    Ok(())
}

/// Stores the forces on the free unknowns, a F + f − K u − C u̇ − p(u), in the inertia of a moment. Collective.
///
/// # Errors
/// If a PETSc call fails.
pub(super) fn unbalanced(body: &mut Body, contact: f64, moment: &mut Moment) -> Result<()> {
    let force = &mut moment.inertia;
    force.fill(0.0)?;
    // add_force adds p; aypx below changes the sign.
    if let Some(pads) = &mut body.pads {
        pads.add_force(None, &moment.state.u, force)?;
    }
    force.aypx(-1.0, &body.terms.load)?;
    force.axpy(1.0, &body.terms.support_load)?;
    moment.products.add_internal(-1.0, force)?;
    force.axpy(contact, &body.terms.contact.force)?;
    Ok(body.clamps.zero(force)?)
}
