//! What rules modal coordinates out, and what there is in them alone.

use super::super::values::WordOrWhole;
use super::super::{Model, Reduction, SceneError, Source, Support, SupportKind, Time, raw};

/// The first key that rules modal coordinates out, with the reason.
pub(super) fn against(
    raw: &raw::Scene,
    (model, reduction): (Model, Reduction),
    supports: &[Support],
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
    not_linear(supports)
}

/// The first support that leaves the body without modes, with the reason.
fn not_linear(supports: &[Support]) -> Option<(String, String)> {
    supports
        .iter()
        .enumerate()
        .find_map(|(i, support)| linear(support).map(|reason| (format!("support.{i}.kind"), reason)))
}

/// Refuses a basis for a body that has none.
///
/// # Errors
/// A number of vectors beside supports that are not linear.
pub(super) fn basis(source: &Source, reduction: Reduction, supports: &[Support]) -> Result<(), SceneError> {
    match (reduction, not_linear(supports)) {
        (Reduction::Vectors(_), Some((key, reason))) => {
            let help = "\"none\", or \"auto\", which is the same here".to_owned();
            Err(source.conflict("body.reduction", &key, reason, help))
        }
        _ => Ok(()),
    }
}

/// Why a support leaves the body without modes.
fn linear(support: &Support) -> Option<String> {
    match support.kind {
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
        if matches!(model, Model::Kirchhoff | Model::Mindlin) {
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
