//! Suggests the nearest of the known names for a misspelled one, or the table of a key in the wrong table.

use super::elsewhere::{Key, keys};

/// The known name nearest to a misspelled one, if at most a third of its letters are wrong.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(&name, candidate), *candidate))
        .filter(|(distance, candidate)| 3 * distance <= candidate.chars().count().max(3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// Help text for an unknown `name`: the nearest known name, and all known names, each in `quote` marks.
pub(super) fn help(name: &str, known: &[&str], quote: char) -> String {
    let all: Vec<String> = known.iter().map(|candidate| format!("{quote}{candidate}{quote}")).collect();
    let all = all.join(", ");
    match nearest(name, known) {
        Some(near) => format!("did you mean {quote}{near}{quote}? Known here: {all}"),
        None => format!("known here: {all}"),
    }
}

/// Help text for a key that is not known in its table, where the keys `known` are: the nearest of these, or the tables
/// that have such a key.
pub(super) fn help_with_key(name: &str, known: &[&str]) -> String {
    let all = help(name, known, '`');
    if nearest(name, known).is_some() {
        return all;
    }
    let keys = keys();
    let names: Vec<&str> = keys.iter().map(|key| key.name.as_str()).collect();
    let Some(near) = nearest(name, &names) else { return all };
    let table = |Key { table, .. }: &Key| match table.as_str() {
        "" => "the scene itself".to_owned(),
        table => format!("`{table}`"),
    };
    let tables: Vec<String> = keys.iter().filter(|key| key.name == near).map(table).collect();
    format!("`{near}` is a key of {}; {all}", tables.join(", "))
}
