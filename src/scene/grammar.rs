//! Hints for lines that are not valid TOML.

/// Hint how to correct a line that is not valid TOML; `message` is the message of the parser.
pub(super) fn hint(line: &str, message: &str) -> &'static str {
    let line = line.trim();
    let value = line.split_once('=').map(|(_, value)| value.trim());
    let is_number = |text: &str| text.trim_start_matches(['-', '+']).starts_with(|c: char| c.is_ascii_digit());
    match value {
        Some(_) if message.contains("duplicate") => "a key may appear only once in a table: remove one",
        Some(value) if is_number(value) && value.contains(',') => {
            "a decimal has a point, as 0.23; several numbers stand in brackets, as [0.2, 0.2, 0.01]"
        }
        Some(value) if value.trim_start_matches(['-', '+']).starts_with('.') => {
            "a digit stands before the point, as in 0.5"
        }
        Some(value) if is_number(value) => "a number stands alone, without a unit or a formula, as 70e9",
        None if !line.starts_with('[') && line.contains(':') => "`=` stands between a key and its value, not `:`",
        _ if message.contains("array") && !line.starts_with("[[") => {
            "an array is `[a, b, c]`: is a bracket or a comma missing here, or in the line above?"
        }
        _ if message.contains("duplicate") && line.starts_with('[') => {
            "a table stands once; where there may be several, each has double brackets, as [[support]]"
        }
        _ => "a line is `key = value`, `[table]` or `[[array of tables]]`; text stands in \"quotes\"",
    }
}
