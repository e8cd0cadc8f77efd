//! Conditions under which a scene can or must use modal coordinates.

use super::super::values::WordOrWhole;
use super::super::{Geometry, Impactor, Model, Reduction, SceneError, Source, Support, Time, raw};

/// Largest √(k/(ρ h)) T of pads for which a basis represents the lift-off of the body, as observed. T is the contact
/// time on a half-space.
const STIFFEST: f64 = 300.0;

/// Largest pad stiffness for which a basis is accurate, N/m³. Infinite for a mesh file.
pub(super) fn stiffest(geometry: &Geometry, density: f64, impactor: &Impactor) -> f64 {
    let Geometry::Box { size, .. } = geometry else { return f64::INFINITY };
    let thickness = size.iter().copied().fold(f64::INFINITY, f64::min);
    density * thickness * (STIFFEST / impactor.contact_time()).powi(2)
}

/// First key that excludes modal coordinates, with the reason. `stiffest` is the result of [`stiffest`].
pub(super) fn against(
    raw: &raw::Scene,
    (model, reduction): (Model, Reduction),
    supports: &[Support],
    stiffest: f64,
) -> Option<(String, String)> {
    if raw.solver.newton.as_deref() == Some("full") {
        let reason = "the full Newton's method solves for all unknowns, which modal coordinates are not".to_owned();
        return Some(("solver.newton".to_owned(), reason));
    }
    if matches!(model, Model::HalfSpace | Model::InfinitePlate) {
        return None;
    }
    if reduction == Reduction::None {
        let reason = "modal coordinates are those of a reduced body".to_owned();
        return Some(("body.reduction".to_owned(), reason));
    }
    without_modes(supports, stiffest)
}

/// First support that does not allow modal coordinates, with the reason.
fn without_modes(supports: &[Support], stiffest: f64) -> Option<(String, String)> {
    supports
        .iter()
        .enumerate()
        .find_map(|(i, support)| against_modes(support, stiffest).map(|reason| (format!("support.{i}.kind"), reason)))
}

/// Refuses a given number of basis vectors for a body that has no basis.
///
/// # Errors
/// If a number of vectors is given and a support does not allow modal coordinates.
pub(super) fn basis(
    source: &Source,
    reduction: Reduction,
    supports: &[Support],
    stiffest: f64,
) -> Result<(), SceneError> {
    match (reduction, without_modes(supports, stiffest)) {
        (Reduction::Vectors(_), Some((key, reason))) => {
            let help = "\"none\", or \"auto\", which is the same here".to_owned();
            Err(source.conflict("body.reduction", &key, reason, help))
        }
        _ => Ok(()),
    }
}

/// Reason why a support does not allow modal coordinates; `None` if it does.
fn against_modes(support: &Support, stiffest: f64) -> Option<String> {
    if support.may_lift_off() && (0..3).any(|axis| support.stiffness_along(axis) > stiffest) {
        return Some(format!(
            "a pad stiffer than {stiffest:.1e} N/m3 is a wall for this impact, and no basis knows how a body leaves it"
        ));
    }
    let is_held_away = support.is_rigid() && support.displacement != [0.0; 3];
    is_held_away.then(|| "a body in modes is held at zero, and this one at a displacement".to_owned())
}

/// Refuses bodies that require modal coordinates with another scheme, and schemes that a body does not support.
///
/// # Errors
/// - If a theory without unknowns is used with a scheme for unknowns.
/// - If a reduced body on pads is used with another scheme.
/// - If the explicit scheme is used with a plate theory or a reduced body.
pub(super) fn only(
    source: &Source,
    raw: &raw::Scene,
    (model, supports): (Model, &[Support]),
    time: &Time,
) -> Result<(), SceneError> {
    let name = raw.body.model.as_deref().unwrap_or_default();
    let pad = supports.iter().position(Support::may_lift_off);
    if let (false, Some(WordOrWhole::Whole(_)), Some(pad)) = (time.modal, &raw.body.reduction, pad) {
        let message = "on a basis, a body on pads moves in modal coordinates only".to_owned();
        let help = "`scheme = \"modal\"`, or `reduction = \"none\"`".to_owned();
        return Err(source.conflict("body.reduction", &format!("support.{pad}.kind"), message, help));
    }
    if !time.modal && matches!(model, Model::HalfSpace | Model::InfinitePlate) {
        let asked = [
            ("time.scheme", raw.time.scheme.is_some()),
            ("time.beta", raw.time.beta.is_some()),
            ("time.gamma", raw.time.gamma.is_some()),
        ];
        let key = asked.into_iter().find(|(_, given)| *given).map_or("solver.newton", |(key, _)| key);
        let message = format!("the theory \"{name}\" has no unknowns to step or to solve for");
        let help = "leave it out: a formula moves in modal coordinates".to_owned();
        return Err(source.conflict(key, "body.model", message, help));
    }
    let Some(scheme) = &raw.time.scheme else { return Ok(()) };
    if scheme == "central-difference" {
        let help = "another scheme, or `model = \"solid\"` with `reduction = \"none\"`".to_owned();
        if matches!(model, Model::Kirchhoff | Model::Mindlin | Model::Layerwise) {
            let message = format!("the theory \"{name}\" has no lumped mass, which the explicit scheme needs");
            return Err(source.conflict("time.scheme", "body.model", message, help));
        }
        if let (false, Some(WordOrWhole::Whole(_))) = (time.modal, &raw.body.reduction) {
            let message = "a reduced body has no lumped mass, which the explicit scheme needs".to_owned();
            return Err(source.conflict("time.scheme", "body.reduction", message, help));
        }
    }
    Ok(())
}
