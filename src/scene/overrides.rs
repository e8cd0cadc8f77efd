//! Overrides `KEY=VALUE` of single keys, written into the text of a scene.

use serde::{Deserialize, Serialize};
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// Number of segments of the longest path, `load.traction.0.value.0`. The limit prevents a path from exhausting the
/// stack.
const DEEPEST: usize = 5;

/// One override, as given and split.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Override {
    /// The text `KEY=VALUE`.
    pub given: String,
    /// Segments of the key's path.
    pub segments: Vec<String>,
}

impl Override {
    /// Splits `KEY=VALUE`. A value that is not valid TOML is taken as a string; an empty value removes the key.
    ///
    /// # Errors
    /// If there is no `=` or no key; the text says which.
    pub fn new(given: &str) -> Result<Self, String> {
        let (key, _) = given.split_once('=').ok_or("an override has the form KEY=VALUE, and this one has no `=`")?;
        let segments: Vec<String> = key.split('.').map(|part| part.trim().to_owned()).collect();
        if segments.iter().any(String::is_empty) {
            return Err("its KEY is not a path of names and numbers joined by single dots".into());
        }
        if segments.len() > DEEPEST {
            return Err(format!("its KEY has {} parts, and no key of a scene has more than {DEEPEST}", segments.len()));
        }
        Ok(Self { given: given.to_owned(), segments })
    }

    /// The value after the `=`; `None` removes the key.
    fn value(&self) -> Option<Value> {
        let (_, value) = self.given.split_once('=')?;
        let value = value.trim();
        let read = |value: &str| value.parse().unwrap_or_else(|_| Value::from(value));
        (!value.is_empty()).then(|| read(value))
    }

    /// Writes the value into the document. Missing tables on the path are created.
    ///
    /// # Errors
    /// If the path leads through a value that is not a table, or past the end of an array; the text says which.
    pub fn apply(&self, document: &mut DocumentMut) -> Result<(), String> {
        let segments: Vec<&str> = self.segments.iter().map(String::as_str).collect();
        in_table(document.as_table_mut(), false, &segments, self.value().as_ref())
    }
}

fn in_table(table: &mut dyn TableLike, inline: bool, segments: &[&str], value: Option<&Value>) -> Result<(), String> {
    let [segment, rest @ ..] = segments else {
        return Err("a whole entry cannot be replaced: name one of its keys".into());
    };
    if let [next, ..] = rest {
        if table.get(segment).is_none() && next.parse::<usize>().is_ok() {
            return Err(format!("`{segment}` is not given, so it has no entry {next}"));
        }
        let item = table
            .entry(segment)
            .or_insert_with(|| if inline { Item::Value(InlineTable::new().into()) } else { Item::Table(Table::new()) });
        return in_item(item, segment, rest, value);
    }
    match (table.get_mut(segment), value) {
        (Some(Item::Value(old)), Some(value)) => replace(old, value),
        (_, Some(value)) => {
            table.insert(segment, Item::Value(value.clone()));
        }
        (_, None) => {
            table.remove(segment);
        }
    }
    Ok(())
}

fn in_item(item: &mut Item, name: &str, rest: &[&str], value: Option<&Value>) -> Result<(), String> {
    match item {
        Item::Table(table) => in_table(table, false, rest, value),
        Item::Value(Value::InlineTable(table)) => in_table(table, true, rest, value),
        Item::Value(Value::Array(array)) => in_array(array, name, rest, value),
        Item::ArrayOfTables(tables) => {
            let index = index(name, rest[0], tables.len())?;
            tables
                .get_mut(index)
                .map_or_else(|| Err(past_the_end(name, index, 0)), |table| in_table(table, false, &rest[1..], value))
        }
        Item::Value(_) | Item::None => Err(not_a_table(name, rest[0])),
    }
}

fn in_array(array: &mut Array, name: &str, rest: &[&str], value: Option<&Value>) -> Result<(), String> {
    let length = array.len();
    let index = index(name, rest[0], length)?;
    let Some(entry) = array.get_mut(index) else {
        return Err(past_the_end(name, index, length));
    };
    match (&rest[1..], entry) {
        ([], entry) => {
            replace(entry, value.ok_or("an entry of an array cannot be taken out: set the whole array")?);
            Ok(())
        }
        (rest, Value::InlineTable(table)) => in_table(table, true, rest, value),
        (deeper, Value::Array(inner)) => in_array(inner, rest[0], deeper, value),
        (deeper, _) => Err(not_a_table(rest[0], deeper[0])),
    }
}

fn index(name: &str, segment: &str, length: usize) -> Result<usize, String> {
    let index = segment
        .parse()
        .map_err(|_| format!("`{name}` is an array: `{segment}` should be the number of an entry, from 0"))?;
    if index < length { Ok(index) } else { Err(past_the_end(name, index, length)) }
}

fn past_the_end(name: &str, index: usize, length: usize) -> String {
    match length {
        0 => format!("`{name}` has no entries, so there is no number {index}"),
        1 => format!("`{name}` has one entry, {name}.0, and no {name}.{index}: entries are added in the scene's file"),
        _ => format!("`{name}` has {length} entries, numbers 0 to {}, so there is no number {index}", length - 1),
    }
}

fn not_a_table(name: &str, segment: &str) -> String {
    format!("`{name}` holds a single value, so there is no `{segment}` in it")
}

/// Replaces a value but keeps the white space and the comment around it.
fn replace(old: &mut Value, new: &Value) {
    let decor = old.decor().clone();
    *old = new.clone();
    *old.decor_mut() = decor;
}
