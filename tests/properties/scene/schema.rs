//! Tests that the JSON schema matches the program: the documented keys, and the words that are accepted.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::bad_scenes::{GOOD, SMALL};
use ricochet::scene::{Scene, schema};

/// The keys of a table and of its subtables, with their schemas.
fn keys<'a>(root: &'a Value, table: &'a Value, path: &str, into: &mut Vec<(String, &'a Value)>) {
    let resolved = |value: &'a Value| match value["$ref"].as_str() {
        Some(reference) => root.pointer(reference.trim_start_matches('#')).expect("the schema has what it refers to"),
        None => value,
    };
    for (name, value) in resolved(table)["properties"].as_object().expect("a table") {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        // A table, the tables of an array, or an optional table.
        let candidates = [&value["items"], &value["anyOf"][0]];
        let entry = candidates.into_iter().find(|entry| entry["$ref"].is_string()).unwrap_or(value);
        let of_name = &value["additionalProperties"];
        if of_name["$ref"].is_string() && resolved(of_name)["properties"].is_object() {
            keys(root, of_name, &format!("{path}.NAME"), into);
        } else if resolved(entry)["properties"].is_object() {
            keys(root, entry, &path, into);
            if !std::ptr::eq(entry, value) && path.contains('.') {
                into.push((path, value));
            }
        } else {
            into.push((path, value));
        }
    }
}

fn all_keys(schema: &Value) -> Vec<(String, &Value)> {
    let mut found = Vec::new();
    keys(schema, schema, "", &mut found);
    found
}

#[test]
fn the_schema_has_the_keys_of_the_documentation() {
    let schema = schema().to_value();
    let known: BTreeSet<String> = all_keys(&schema).into_iter().map(|(path, _)| path).collect();
    let text = include_str!("../../../docs/scene.md");
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `")?.split_once("` |"));
    let sections: BTreeSet<&str> =
        known.iter().filter_map(|path| path.split_once('.').map(|(table, _)| table)).collect();
    let is_key = |key: &str| key == "title" || key.split_once('.').is_some_and(|(table, _)| sections.contains(table));
    let documented: BTreeSet<String> = rows.map(|(key, _)| key.to_owned()).filter(|key| is_key(key)).collect();
    assert_eq!(known, documented);
}

#[test]
fn every_word_of_the_schema_is_accepted() {
    let schema = schema().to_value();
    let mut words = 0;
    for (path, of_key) in all_keys(&schema) {
        for word in of_key["enum"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            words += 1;
            let good = if path.starts_with("support") { GOOD } else { SMALL };
            let key = path.replacen("support.", "support.0.", 1);
            // A word may contradict another key, but must be known.
            if let Err(error) = Scene::parse("scene.toml", good, &[format!("{key}={word}")]) {
                assert!(!error.to_string().contains("is not one of its values"), "{key} = {word}: {error}");
            }
            let misspelt = Scene::parse("scene.toml", good, &[format!("{key}={word}x")]).map(drop);
            assert!(misspelt.is_err_and(|error| error.key() == key), "{key} = {word}x");
        }
    }
    assert!(words >= 20, "{words} words");
}

#[test]
fn required_keys_are_those_without_which_a_scene_is_refused() {
    let schema = schema().to_value();
    for (table, required) in [("Layer", vec!["thickness", "material"]), ("Time", vec!["end"])] {
        let listed = &schema["$defs"][table]["required"];
        assert_eq!(listed, &serde_json::json!(required));
    }
    // A body without layers requires these keys, which a laminate does not have, so they are not required in general.
    assert_eq!(schema["$defs"]["Body"]["required"], Value::Null);
    for required in [vec!["young", "poisson", "density"], vec!["end"]] {
        for key in required {
            let without: String = SMALL
                .lines()
                .filter(|line| !line.starts_with(&format!("{key} =")))
                .map(|line| format!("{line}\n"))
                .collect();
            assert!(Scene::parse("scene.toml", &without, &[]).is_err(), "{key}");
        }
    }
}
