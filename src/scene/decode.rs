//! Reads the text of a scene into typed values, and translates the error messages of serde.

use serde::Deserialize;
use serde_path_to_error::{Path, Segment, Track};
use toml_edit::de;

use super::error::SceneError;
use super::source::{Mark, Source};
use super::{raw, suggest};

/// Reads the keys of a scene with their types.
///
/// # Errors
/// If a key is unknown or missing, or if a value has another type.
pub(super) fn decode(source: &Source) -> Result<raw::Scene, SceneError> {
    let deserializer = de::Deserializer::parse(source.text()).map_err(|error| source.error("", error.message(), ""))?;
    let mut track = Track::new();
    let tracked = serde_path_to_error::Deserializer::new(deserializer, &mut track);
    match raw::Scene::deserialize(tracked) {
        Ok(scene) => Ok(scene),
        Err(error) => Err(refuse(source, &segments(&track.path()), error.message())),
    }
}

fn segments(path: &Path) -> Vec<String> {
    path.iter()
        .map_while(|segment| match segment {
            Segment::Seq { index } => Some(index.to_string()),
            Segment::Map { key } | Segment::Enum { variant: key } => Some(key.clone()),
            Segment::Unknown => None,
        })
        .collect()
}

/// Translates an error message of serde. The texts are fixed by the documentation of `unknown_field`, `missing_field`,
/// `invalid_type` and `invalid_length` in serde. They are the only way to know the kind of error.
fn refuse(source: &Source, path: &[String], text: &str) -> SceneError {
    let mut path: Vec<&str> = path.iter().map(String::as_str).collect();
    if let Some((name, known)) = text.strip_prefix("unknown field `").and_then(|rest| rest.rsplit_once("`, expected "))
    {
        let known: Vec<&str> = known.split('`').skip(1).step_by(2).collect();
        if path.last() != Some(&name) {
            path.push(name);
        }
        let help = suggest::help_with_key(name, &known);
        return source.error_at(&path, Mark::Key, "unknown key".into(), help);
    }
    if let Some(name) = text.strip_prefix("missing field `") {
        let name = name.trim_end_matches('`');
        let table = path.join(".");
        path.push(name);
        let help = match table.as_str() {
            "" => format!("add a table [{name}]; see docs/scene.md for its keys"),
            _ => format!("add `{name} = …` to the table `{table}`; docs/scene.md has all keys"),
        };
        return source.error_at(&path, Mark::Key, "this key is required".into(), help);
    }
    let (found, expected) = text.rsplit_once(", expected ").unwrap_or((text, ""));
    let found = match found.split_once(": ") {
        Some(("invalid type", what)) => format!("this is the wrong type: {what}"),
        Some(("invalid value", what)) => format!("this value will not do: {what}"),
        _ => found.replacen("invalid length", "wrong number of entries:", 1),
    };
    // serde's names of types, replaced by the words that a reader of the scene would use.
    let plain = [
        ("type: map", "type: a table"),
        ("type: sequence", "type: an array"),
        ("type: string", "type: the text"),
        ("type: floating point", "type: the number"),
        ("type: integer", "type: the number"),
        ("type: boolean", "type: the value"),
    ];
    let found = plain.into_iter().fold(found, |found, (theirs, ours)| found.replace(theirs, ours));
    let expected = match expected {
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        other => other,
    };
    source.error_at(&path, Mark::Value, found, format!("expected {expected}"))
}
