//! What rules modal coordinates out, and what there is in them alone.

use super::super::values::WordOrWhole;
use super::super::{Geometry, Impactor, Model, Reduction, SceneError, Source, Support, SupportKind, Time, raw};

/// √(k/(ρ h)) of pads, times the contact time on a half-space, up to which a basis was seen to learn what a body does that lets go of them.
const STIFFEST: f64 = 300.0;

/// The stiffness of pads up to which a basis serves, N/m³.
pub(super) fn stiffest(geometry: &Geometry, density: f64, impactor: &Impactor) -> f64 {
    let Geometry::Box { size, .. } = geometry else { return f64::INFINITY };
    let thickness = size.iter().copied().fold(f64::INFINITY, f64::min);
    density * thickness * (STIFFEST / impactor.contact_time()).powi(2)
}

/// The first key that rules modal coordinates out, with the reason; `stiffest` is that of [`stiffest`].
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

/// The first support that leaves the body without modes, with the reason.
fn without_modes(supports: &[Support], stiffest: f64) -> Option<(String, String)> {
    supports
        .iter()
        .enumerate()
        .find_map(|(i, support)| against_modes(support, stiffest).map(|reason| (format!("support.{i}.kind"), reason)))
}

/// Refuses a basis for a body that has none.
///
/// # Errors
/// A number of vectors beside supports that leave the body without modes.
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

/// Why a support leaves the body without modes.
fn against_modes(support: &Support, stiffest: f64) -> Option<String> {
    match support.kind {
        SupportKind::Pad { stiffness, normal } if (0..3).any(|i| normal[i] != 0.0 && stiffness[i] > stiffest) => {
            Some(format!(
                "a pad stiffer than {stiffest:.1e} N/m3 is a wall for this impact, and no basis knows how a body leaves it"
            ))
        }
        SupportKind::Clamped { .. } if support.displacement != [0.0; 3] => {
            Some("a body in modes is held at zero, and this one at a displacement".to_owned())
        }
        _ => None,
    }
}

/// Refuses what only modal coordinates have with another scheme, and what they have not.
///
/// # Errors
/// A theory without unknowns under a scheme that steps unknowns; the same for the explicit scheme on any body but a mesh of solid elements.
pub(super) fn only(
    source: &Source,
    raw: &raw::Scene,
    (model, supports): (Model, &[Support]),
    time: &Time,
) -> Result<(), SceneError> {
    let name = raw.body.model.as_deref().unwrap_or_default();
    let pad = supports.iter().position(|support| matches!(support.kind, SupportKind::Pad { .. }));
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
