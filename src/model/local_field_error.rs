//! Estimates the error of the static local field that is added to the stresses near the impact point.
//!
//! The error has three causes, none of which depends on the cell size:
//!
//! - **Delay.** The static field responds to the force at once: the travel time of waves is neglected. A solid with a
//!   narrow enough disc computes the waves in its interlayers; a layerwise plate does not.
//! - **Edges.** The field of a plate is that of an infinite plate.
//! - **Relaxation.** The field uses one secant modulus for each viscoelastic layer, although the modulus falls during the
//!   contact.
//!
//! The factors of the first two were measured (docs/numerics.md, section on cells). It is an estimate, not a bound.

use crate::impact::{Errors, Trace, joined};
use crate::scene::{Contact, Geometry, Model, Scene};
use crate::space::evaluate::{Evaluator, TensionErrors};
use crate::space::plate::ShearTravelTimes;

/// Relative error of the tension due to the delay, divided by (t/T)²: t is the travel time of a shear wave through the
/// thickness, T the contact time on a half-space. With a disc half as wide, on which the body computes more of the field
/// with its waves, the tension near its peak changed by 1.3 to 2 times (t/T)².
const DELAY_FACTOR: f64 = 2.5;

/// t/T of the interlayers above which the error of a layerwise plate due to the delay grows linearly, not quadratically:
/// softer interlayers transmit less shear. It was fitted.
const LINEAR_DELAY_ABOVE: f64 = 0.04;

/// Largest radius of a solid's disc, over the thickness of the stack, with which the solid computes the waves in its
/// interlayers. With a radius of 1 and 2, tensions next to interlayers differed by at most 0.3%.
const WIDEST_DISC: f64 = 2.0;

/// Errors of the local field; only the tension has one. It counts as far as the stress opposite the impact point is the
/// largest one in the `force`, if that is known.
pub fn local_field_errors(
    scene: &Scene,
    theory: Model,
    evaluator: Option<&Evaluator>,
    force: Option<&Trace>,
) -> Errors {
    let TensionErrors { of_edges, of_relaxation, .. } = evaluator.map(Evaluator::tension_errors).unwrap_or_default();
    of_hit(joined(joined(delay_error(scene, theory), of_edges), of_relaxation), force)
}

/// Errors of the largest tension due to a relative error of the stress opposite the impact point.
pub(super) fn of_hit(error: f64, force: Option<&Trace>) -> Errors {
    let largest = Errors { stress: error, stress_history: error, ..Errors::default() };
    force.map_or(largest, |force| force.errors_of_largest_stress(error, 0.0))
}

/// Relative error of the tension due to the delay.
pub(super) fn delay_error(scene: &Scene, theory: Model) -> f64 {
    let ShearTravelTimes { plies, interlayers } = ShearTravelTimes::of(scene);
    let is_computed = theory == Model::Solid && !has_wide_disc(scene);
    let interlayers = if is_computed { 0.0 } else { interlayers };
    DELAY_FACTOR * (plies + interlayers) * (plies + interlayers.min(LINEAR_DELAY_ABOVE))
}

/// Whether a solid's disc is wider than that: with the law of a sphere on layers, or by `contact.disc_radius`.
fn has_wide_disc(scene: &Scene) -> bool {
    let given = if let Contact::Patch { disc, .. } = scene.contact { disc } else { None };
    let disc = scene.impactor.layered_contact().map(|layered| layered.disc).or(given);
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return false };
    disc.is_some_and(|disc| disc > WIDEST_DISC * size[axis])
}
