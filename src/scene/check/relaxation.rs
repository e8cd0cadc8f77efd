//! Checks that the theory and the scheme can treat a viscoelastic body.

use super::super::{SceneError, Source, raw};

/// Key of the first viscoelastic material.
pub(super) fn key(raw: &raw::Scene) -> Option<String> {
    let relaxes = raw.material.iter().find(|(_, material)| material.prony.is_some());
    relaxes.map(|(name, _)| format!("material.{name}.prony"))
}

/// Refuses theories and schemes that do not treat relaxation.
///
/// # Errors
/// If a material is viscoelastic and the scene names such a theory or the explicit scheme.
pub(super) fn check(source: &Source, raw: &raw::Scene, key: Option<&str>) -> Result<(), SceneError> {
    let Some(key) = key else { return Ok(()) };
    let theory = raw.body.model.as_deref().unwrap_or("auto");
    if !["auto", "layerwise", "solid"].contains(&theory) {
        let message = format!("the theory \"{theory}\" does not follow the relaxation of a material");
        return Err(source.conflict("body.model", key, message, "\"layerwise\", \"solid\", or \"auto\"".to_owned()));
    }
    if raw.time.scheme.as_deref() == Some("central-difference") {
        let message = "the explicit scheme does not follow the relaxation of a material".to_owned();
        let help = "\"modal\", \"newmark\", \"generalized-alpha\" or \"energy\"".to_owned();
        return Err(source.conflict("time.scheme", key, message, help));
    }
    Ok(())
}
