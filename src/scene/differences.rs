//! Compares two scenes key by key.

use std::collections::BTreeMap;

use toml_edit::{Document, Item, TableLike, Value};

/// Keys (for example `support.0.stiffness`) whose values differ between two texts, or that only one of them has.
pub fn differences(one: &str, other: &str) -> Vec<String> {
    let [one, other] = [one, other].map(|text| {
        let mut all = BTreeMap::new();
        // A text that is not TOML has no keys.
        if let Ok(document) = Document::parse(text) {
            in_table(document.as_table(), "", &mut all);
        }
        all
    });
    let in_one = one.iter().filter(|(key, value)| other.get(*key) != Some(*value));
    let in_other = other.iter().filter(|(key, _)| !one.contains_key(*key));
    in_one.chain(in_other).map(|(key, _)| key.clone()).collect()
}

fn in_table(table: &dyn TableLike, above: &str, all: &mut BTreeMap<String, String>) {
    for (key, item) in table.iter() {
        let key = if above.is_empty() { key.to_owned() } else { format!("{above}.{key}") };
        match item {
            Item::Table(table) => in_table(table, &key, all),
            Item::ArrayOfTables(tables) => {
                tables.iter().enumerate().for_each(|(n, table)| in_table(table, &format!("{key}.{n}"), all));
            }
            Item::Value(value) => in_value(value, &key, all),
            Item::None => {}
        }
    }
}

fn in_value(value: &Value, key: &str, all: &mut BTreeMap<String, String>) {
    let text = match value {
        Value::InlineTable(table) => return in_table(table, key, all),
        Value::Array(array) if array.iter().any(Value::is_inline_table) => {
            return array.iter().enumerate().for_each(|(n, value)| in_value(value, &format!("{key}.{n}"), all));
        }
        Value::Array(array) => {
            let numbers: Vec<String> = array.iter().map(plain).collect();
            numbers.join(", ")
        }
        value => plain(value),
    };
    all.insert(key.to_owned(), text);
}

/// Text of a value without its notation: 1e-3 becomes 0.001.
fn plain(value: &Value) -> String {
    let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
    let text = || value.as_str().map_or_else(|| value.to_string().trim().to_owned(), str::to_owned);
    number.map_or_else(text, |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::differences;

    #[test]
    fn keys_are_told_by_what_they_say() {
        let one = "a = 1e-3 # here\n[b]\nc = [1, 2.0]\n[[d]]\ne = 'x'\n[[d]]\ne = 'y'\nf = { g = 1 }\n";
        assert!(
            differences(one, "b = { c = [1.0, 2] }\na = 0.001\nd = [{ e = \"x\" }, { e = \"y\", f.g = 1 }]\n")
                .is_empty()
        );
        let other = "a = 0.002\n[b]\nc = [1, 3]\n[[d]]\ne = 'z'\n[h]\ni = 1\n";
        assert_eq!(differences(one, other), ["a", "b.c", "d.0.e", "d.1.e", "d.1.f.g", "h.i"]);
    }
}
