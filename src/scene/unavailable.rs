//! What the scene's format names and this version does not have: the one list of it. A feature that arrives takes
//! its entry out here, and puts its key into `raw` or its word into `check`.

use toml_edit::Document;

use super::error::SceneError;
use super::source::{Mark, Source};

/// Key, and what is available.
const UNAVAILABLE: &[(&str, &str)] =
    &[("output.fields", "the series, with output.every"), ("output.probes", "the series, with output.every")];

/// Refuses what this version does not have.
///
/// # Errors
/// The first such key or value.
pub(super) fn refuse(source: &Source) -> Result<(), SceneError> {
    // A text that does not parse is refused where it is decoded.
    let Ok(document) = Document::parse(source.text()) else {
        return Ok(());
    };
    for (path, instead) in UNAVAILABLE {
        if path.split('.').try_fold(document.as_item(), |item, key| item.get(key)).is_none() {
            continue;
        }
        let segments: Vec<&str> = path.split('.').collect();
        let help = format!("what it has: {instead}");
        let message = "this key is not available in this version".to_owned();
        return Err(source.error_at(&segments, Mark::Key, message, help));
    }
    Ok(())
}
