//! What a viscoelastic body cannot do yet.

use super::super::values::WordOrWhole;
use super::super::{SceneError, Source, raw};

/// Why a relaxing body has no modes.
const NO_MODES: &str =
    "a body with a relaxing material is stepped in all its unknowns: modes and bases do not follow relaxation";

/// The key of the first material that relaxes.
pub(super) fn key(raw: &raw::Scene) -> Option<String> {
    let relaxes = raw.material.iter().find(|(_, material)| material.prony.is_some());
    relaxes.map(|(name, _)| format!("material.{name}.prony"))
}

/// What rules modal coordinates out, as of [`super::modal::against`].
pub(super) fn against_modes(key: Option<&str>) -> Option<(String, String)> {
    key.map(|key| (key.to_owned(), NO_MODES.to_owned()))
}

/// Refuses theories, bases and schemes that do not follow relaxation.
///
/// # Errors
/// Those.
pub(super) fn check(source: &Source, raw: &raw::Scene, key: Option<&str>) -> Result<(), SceneError> {
    let Some(key) = key else { return Ok(()) };
    let theory = raw.body.model.as_deref().unwrap_or("auto");
    if !["auto", "layerwise", "solid"].contains(&theory) {
        let message = format!("the theory \"{theory}\" does not follow the relaxation of a material");
        return Err(source.conflict("body.model", key, message, "\"layerwise\", \"solid\", or \"auto\"".to_owned()));
    }
    if let Some(WordOrWhole::Whole(_)) = raw.body.reduction {
        let help = "\"none\", or \"auto\", which is the same here".to_owned();
        return Err(source.conflict("body.reduction", key, NO_MODES.to_owned(), help));
    }
    if raw.time.scheme.as_deref() == Some("central-difference") {
        let message = "the explicit scheme does not follow the relaxation of a material".to_owned();
        let help = "\"newmark\", \"generalized-alpha\" or \"energy\"".to_owned();
        return Err(source.conflict("time.scheme", key, message, help));
    }
    Ok(())
}
