//! What the scene's format names and this version does not have: the one list of it. A feature that arrives takes
//! its entry out here, and puts its key into `raw` or its word into `check`.

use toml_edit::{Document, Item, Value};

use super::error::SceneError;
use super::source::{Mark, Source};

enum What {
    /// The key itself.
    Key,
    /// These words as its value.
    Words(&'static [&'static str]),
    /// A number as its value.
    Number,
}

use What::{Key, Number, Words};

/// Key, what of it is not available, and what is.
const UNAVAILABLE: &[(&str, What, &str)] = &[
    ("body.model", Words(&["auto", "half-space", "infinite-plate", "kirchhoff", "mindlin"]), "model = \"solid\""),
    ("body.reduction", Words(&["auto"]), "reduction = \"none\""),
    ("body.reduction", Number, "reduction = \"none\""),
    ("time.scheme", Words(&["modal"]), "\"newmark\", \"generalized-alpha\", \"energy\" and \"central-difference\""),
    ("output.fields", Key, "the series, with output.every"),
    ("output.probes", Key, "the series, with output.every"),
];

/// Refuses what this version does not have.
///
/// # Errors
/// The first such key or value.
pub(super) fn refuse(source: &Source) -> Result<(), SceneError> {
    // A text that does not parse is refused where it is decoded.
    let Ok(document) = Document::parse(source.text()) else {
        return Ok(());
    };
    for (path, what, instead) in UNAVAILABLE {
        let item = path.split('.').try_fold(document.as_item(), |item, key| item.get(key));
        let Some(item) = item else { continue };
        let (mark, message) = match what {
            Key => (Mark::Key, "this key is not available in this version".into()),
            Words(words) => match item.as_str() {
                Some(word) if words.contains(&word) => {
                    (Mark::Value, format!("\"{word}\" is not available in this version"))
                }
                _ => continue,
            },
            Number => match item {
                Item::Value(Value::Integer(_) | Value::Float(_)) => {
                    (Mark::Value, "a number is not available in this version".into())
                }
                _ => continue,
            },
        };
        let segments: Vec<&str> = path.split('.').collect();
        let help = format!("what it has: {instead}");
        return Err(source.error_at(&segments, mark, message, help));
    }
    Ok(())
}
