//! Estimates the error of the static local field that is added to the stresses near the impact point.
//!
//! The error has three causes, none of which depends on the cell size:
//!
//! - **Delay.** The field follows the force without the travel time of waves. A solid computes the waves in its
//!   interlayers, a layerwise plate does not.
//! - **Edges.** The field of a plate is that of a plate without edges.
//! - **Relaxation.** Viscoelastic layers have one secant modulus in the field, although it falls during the contact.
//!
//! The factors were measured (docs/numerics.md, section on cells). It is an estimate, not a bound.

use crate::impact::{Errors, joined};
use crate::scene::{Contact, Geometry, Model, Scene};
use crate::space::evaluate::{Evaluator, TensionErrors};
use crate::space::plate::ShearTravelTimes;

/// Relative error of the tension by the delay, divided by the square of the travel time of a shear wave through the
/// thickness, which is relative to the contact time on a half-space. With the pressure on a disc half as wide, which
/// leaves more of the field to the body, the tension near its peak changed by 1.3 to 2 times that square.
const DELAY_FACTOR: f64 = 2.5;

/// Travel time through the interlayers above which the error of a layerwise plate by the delay grows linearly, not
/// quadratically: softer interlayers transmit less shear. It was fitted.
const LINEAR_DELAY_ABOVE: f64 = 0.04;

/// Radius of a solid's disc, over the thickness of the stack, up to which it computes the waves in its interlayers. With
/// a radius of 1 and 2, tensions next to interlayers differed by at most 0.3%.
const WIDEST_DISC: f64 = 2.0;

/// Errors of the local field; only the tension has one.
pub(super) fn local_field_errors(scene: &Scene, theory: Model, evaluator: Option<&Evaluator>) -> Errors {
    let TensionErrors { of_edges, of_relaxation, .. } = evaluator.map(Evaluator::tension_errors).unwrap_or_default();
    let stress = joined(joined(delay_error(scene, theory), of_edges), of_relaxation);
    Errors { stress, ..Errors::default() }
}

/// Relative error of the tension by the delay.
pub(super) fn delay_error(scene: &Scene, theory: Model) -> f64 {
    let ShearTravelTimes { plies, interlayers } = ShearTravelTimes::of(scene);
    let is_computed = theory == Model::Solid && !has_wide_disc(scene);
    let interlayers = if is_computed { 0.0 } else { interlayers };
    DELAY_FACTOR * (plies + interlayers) * (plies + interlayers.min(LINEAR_DELAY_ABOVE))
}

/// Whether a solid's disc is wider than the widest one with which the waves in interlayers were compared. It is under soft
/// outer layers, or if the scene gives a radius.
fn has_wide_disc(scene: &Scene) -> bool {
    let given = if let Contact::Patch { disc, .. } = scene.contact { disc } else { None };
    let disc = scene.impactor.layered_contact().map(|layered| layered.disc).or(given);
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return false };
    disc.is_some_and(|disc| disc > WIDEST_DISC * size[axis])
}
