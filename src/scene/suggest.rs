//! Suggests the nearest of the known names for a misspelled one.

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
