//! Table of the runs, which shows the progress of the search.

use crate::scene::unit;
use crate::study::limit::Range;

use super::super::short;
use super::trial::{Trial, Utilisation};

/// Header line of the table of runs.
pub(super) fn header(range: &Range) -> String {
    let (key, width) = column(range);
    format!("{:>4}  {key:>width$}  {:>8}  {:>11}  {:<8}  {:>8}", "run", "ratio", "tension/MPa", "face", "time/ms")
}

/// Line of a run in the table.
pub(super) fn line(range: &Range, number: usize, Trial { value, utilisation }: &Trial) -> String {
    let Utilisation { ratio, tension, face, time, .. } = utilisation;
    let (width, value) = (column(range).1, significant(*value, VALUE));
    let [tension, time] = [1e-6 * tension, 1e3 * time].map(short);
    format!("{number:>4}  {value:>width$}  {ratio:>8.4}  {tension:>11}  {face:<8}  {time:>8}")
}

/// Header of the key's column, and its width in characters.
fn column(range: &Range) -> (String, usize) {
    let key = match unit(&range.key) {
        "1" => range.key.clone(),
        unit => format!("{}/({unit})", range.key),
    };
    let width = key.len().max(10);
    (key, width)
}

/// A value of a key with its unit.
pub(super) fn with_unit(value: &str, key: &str) -> String {
    match unit(key) {
        "1" => value.to_owned(),
        unit => format!("{value} {unit}"),
    }
}

/// Number of significant digits of values.
pub(super) const VALUE: usize = 5;
/// Number of significant digits of uncertainties.
pub(super) const UNCERTAINTY: usize = 2;

/// Formats a number with a given number of significant digits, without trailing zeros.
pub(super) fn significant(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn digits_that_mean_something() {
        let cases = [(0.058_612_34, "0.058612"), (0.1, "0.1"), (380_434_567.0, "3.8043e8"), (52.0, "52"), (0.0, "0")];
        assert!(cases.iter().all(|(value, text)| significant(*value, 5) == *text));
        assert_eq!(significant(0.000_314_15, 2), "0.00031");
    }
}
