//! Finds the tables of a scene in which a key is known, for a key in the wrong table.

use serde_json::Value;

use super::schema;

/// Placeholder for a name that the scene chooses, such as the name of a material.
const ANY_NAME: &str = "NAME";

/// A key of a scene.
pub(super) struct Key {
    /// Path of its table, empty for the scene itself. Numbers in arrays of tables are left out.
    pub table: String,
    pub name: String,
}

/// Returns all keys of a scene.
pub(super) fn keys() -> Vec<Key> {
    let schema = schema().to_value();
    let mut keys = Vec::new();
    add(&schema, &schema, "", &mut keys);
    keys
}

/// Adds the keys of all tables that a part of the schema describes; `table` is the path of this part.
fn add(schema: &Value, part: &Value, table: &str, keys: &mut Vec<Key>) {
    let below = |name: &str| if table.is_empty() { name.to_owned() } else { format!("{table}.{name}") };
    if let Some(definition) = part["$ref"].as_str().and_then(|path| schema.pointer(path.strip_prefix('#')?)) {
        add(schema, definition, table, keys);
    }
    for (name, value) in part["properties"].as_object().into_iter().flatten() {
        keys.push(Key { table: table.to_owned(), name: name.clone() });
        add(schema, value, &below(name), keys);
    }
    if part["additionalProperties"].is_object() {
        add(schema, &part["additionalProperties"], &below(ANY_NAME), keys);
    }
    if part["items"].is_object() {
        add(schema, &part["items"], table, keys);
    }
    for choice in ["anyOf", "oneOf"].into_iter().flat_map(|of| part[of].as_array().into_iter().flatten()) {
        add(schema, choice, table, keys);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_in_all_kinds_of_tables() {
        let keys = keys();
        let tables = |name: &str| -> Vec<&str> {
            keys.iter().filter(|key| key.name == name).map(|key| key.table.as_str()).collect()
        };
        assert_eq!(tables("thickness"), ["body.layer"]);
        assert_eq!(tables("support"), [""]);
        assert_eq!(tables("bulk"), ["material.NAME"]);
        assert_eq!(tables("wlf"), ["material.NAME"]);
        assert_eq!(tables("c1"), ["material.NAME.wlf"]);
        assert_eq!(tables("traction"), ["load"]);
    }
}
