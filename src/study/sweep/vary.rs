//! Parses `KEY=A..B:N` and `KEY=A,B,C`: one key of a scene and its values.

use std::collections::HashSet;

/// Error message for an argument without values.
const FORM: &str = "it has the form KEY=A..B:N or KEY=A,B,C";
/// Number of significant digits of values between two ends, counted from the first digit of the larger end. Rounding
/// gives round values for round steps between round ends.
const DIGITS: f64 = 15.0;
/// Largest number of values of a range, and of members of a sweep: a bound on memory.
pub(super) const MAX_VALUES: usize = 1_000_000;

/// One key and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    /// Dotted path of the key.
    pub key: String,
    /// Each value as given by the user.
    pub texts: Vec<String>,
    /// Each value as used in the scene: the same, except that the content of a file replaces its name.
    pub contents: Vec<String>,
    /// The values as numbers, if all of them are finite numbers.
    pub numbers: Option<Vec<f64>>,
    /// Whether the values belong on a logarithmic axis.
    pub is_log: bool,
}

impl Variation {
    /// Parses `KEY=A..B:N` (N numbers from A to B, including both) or `KEY=A,B,C` (each value as given). `log` spaces a
    /// range logarithmically, and marks a list of positive numbers as logarithmic.
    ///
    /// # Errors
    /// If the text does not have this form; the message quotes `given`.
    pub fn parse(given: &str, log: bool) -> Result<Self, String> {
        let wrong = |why: &str| format!("--vary {given}: {why}");
        let (key, values) = given.split_once('=').ok_or_else(|| wrong(FORM))?;
        let (key, values) = (key.trim(), values.trim());
        if key.is_empty() || values.is_empty() {
            return Err(wrong(FORM));
        }
        let texts = match as_range(values) {
            Some((from, to)) => range(from, to, log).map_err(|why| wrong(&why))?,
            None => match meant(values) {
                Some(range) => return Err(wrong(&format!("a range has two dots between its ends: {key}={range}"))),
                None => list(values).map_err(|why| wrong(&why))?,
            },
        };
        let numbers: Option<Vec<f64>> =
            texts.iter().map(|text| text.parse().ok().filter(|number: &f64| number.is_finite())).collect();
        let is_positive = numbers.as_ref().is_some_and(|numbers| numbers.iter().all(|number| *number > 0.0));
        Ok(Self { key: key.to_owned(), contents: texts.clone(), texts, numbers, is_log: log && is_positive })
    }
}

/// `A` and `B:N` of a range. A path such as `../plate.msh` is not a range.
fn as_range(values: &str) -> Option<(&str, &str)> {
    values.split_once("..").filter(|(from, to)| !from.trim().is_empty() && !values.contains(',') && !to.contains('/'))
}

/// Guesses the intended range from two numbers that are separated by something other than two dots, and a number of
/// values.
fn meant(values: &str) -> Option<String> {
    let (ends, count) = values.rsplit_once(':')?;
    let is_number = |text: &str| text.trim().parse().is_ok_and(|number: f64| number.is_finite());
    let between = |separator: &str| {
        let places = ends.match_indices(separator).map(|(at, _)| (&ends[..at], &ends[at + separator.len()..]));
        places.into_iter().find(|(from, to)| is_number(from) && is_number(to))
    };
    let (from, to) = ["...", "-", ":", "–", "…", "to"].into_iter().find_map(between)?;
    let count = count.trim().parse::<usize>().ok()?;
    Some(format!("{}..{}:{count}", from.trim(), to.trim()))
}

fn range(from: &str, to: &str, log: bool) -> Result<Vec<String>, String> {
    if to.starts_with('.') {
        return Err("a range has two dots between its ends: A..B:N".into());
    }
    let (to, count) = to.split_once(':').ok_or("a range says how many values it has: A..B:N")?;
    let end = |text: &str| {
        let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| format!("{:?} is no end of a range: a number is wanted", text.trim()))
    };
    let (from, to) = (end(from)?, end(to)?);
    let count: usize =
        count.trim().parse().ok().filter(|count| (2..=MAX_VALUES).contains(count)).ok_or_else(|| {
            format!("{:?} is no number of values: 2 to {MAX_VALUES}, both ends included", count.trim())
        })?;
    if from == to {
        return Err("both ends of the range are the same".into());
    }
    if let Some(low) = [from, to].into_iter().find(|end| log && *end <= 0.0) {
        return Err(format!("a logarithmic range (--log) has positive ends, and {low} is not"));
    }
    Ok((0..count).map(|n| written(at((from, to), n, count - 1, log))).collect())
}

/// Value `n` of 0 to `last` of a range; the ends are exact.
fn at((from, to): (f64, f64), n: usize, last: usize, log: bool) -> f64 {
    let part = |n: usize| n as f64 / last as f64;
    let between = |a: f64, b: f64| a * part(last - n) + b * part(n);
    match n {
        0 => from,
        _ if n == last => to,
        _ if log => {
            let value = 10f64.powf(between(from.log10(), to.log10()));
            rounded(value, value)
        }
        _ => rounded(between(from, to), from.abs().max(to.abs())),
    }
}

/// Rounds a value at the last decimal place that `size` has with [`DIGITS`] significant digits.
fn rounded(value: f64, size: f64) -> f64 {
    let power = |value: f64| value.abs().log10().floor();
    let digits = DIGITS - 1.0 - (power(size) - power(value));
    if digits < 0.0 { 0.0 } else { format!("{value:.*e}", digits as usize).parse().unwrap_or(value) }
}

/// Formats a number as TOML so that it reads back as the same number. Small whole numbers have no decimal point,
/// because some keys require integers.
pub fn written(value: f64) -> String {
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e6 {
        format!("{value:.0}")
    } else if (1e-3..1e6).contains(&size) {
        format!("{value:?}")
    } else {
        format!("{value:e}")
    }
}

/// Splits a list into its values; commas within brackets belong to a value.
fn list(values: &str) -> Result<Vec<String>, String> {
    let mut depth = 0_i32;
    let parts = values.split(|letter| {
        depth += i32::from(letter == '[') - i32::from(letter == ']');
        letter == ',' && depth == 0
    });
    let parts: Vec<String> = parts.map(|part| part.trim().to_owned()).collect();
    if parts.iter().any(String::is_empty) {
        return Err("a value of the list is empty".into());
    }
    // The same number may be written in different ways.
    let value = |text: &String| text.parse::<f64>().map_or_else(|_| text.clone(), written);
    let mut seen = HashSet::new();
    match parts.iter().find(|part| !seen.insert(value(part))) {
        Some(part) => Err(format!("the list has the value {part} twice")),
        None => Ok(parts),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn numbers(given: &str, log: bool) -> Vec<f64> {
        Variation::parse(given, log).unwrap().numbers.unwrap()
    }

    #[test]
    fn ranges_and_lists() {
        assert_eq!(numbers("time.step=0.1..0.5:5", false), [0.1, 0.2, 0.3, 0.4, 0.5]);
        assert_eq!(numbers("a=-1..1:3", false), [-1.0, 0.0, 1.0]);
        assert_eq!(numbers("a=3..1:3", false), [3.0, 2.0, 1.0]);
        let decades = numbers("support.0.stiffness=1e6..1e12:7", true);
        assert_eq!(decades, [1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12]);
        let cells = Variation::parse("body.cells.0 = 2..8:3", false).unwrap();
        assert_eq!((cells.key.as_str(), cells.texts), ("body.cells.0", vec!["2".into(), "5".into(), "8".into()]));
        let schemes = Variation::parse("time.scheme=newmark, energy", false).unwrap();
        assert_eq!((schemes.texts, schemes.numbers), (vec!["newmark".into(), "energy".into()], None));
        let points = Variation::parse("impactor.point=[0,0,0.05],[0.1, 0,0.05]", false).unwrap();
        assert_eq!(points.texts, ["[0,0,0.05]", "[0.1, 0,0.05]"]);
        let meshes = Variation::parse("body.mesh=../a.msh", false).unwrap();
        assert_eq!(meshes.texts, ["../a.msh"]);
        // Values keep the text that was given.
        assert_eq!(Variation::parse("a=1e-05,2e30", false).unwrap().texts, ["1e-05", "2e30"]);
        assert_eq!(Variation::parse("a=1e20..2e20:2", false).unwrap().texts, ["1e20", "2e20"]);
        assert!(Variation::parse("a=1,10", true).unwrap().is_log && !Variation::parse("a=0,1", true).unwrap().is_log);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (given, log, part) in [
            ("speed", false, "KEY=A..B:N or KEY=A,B,C"),
            ("=1,2", false, "KEY=A..B:N or KEY=A,B,C"),
            ("speed=", false, "KEY=A..B:N or KEY=A,B,C"),
            ("speed=1..2", false, "how many values"),
            ("speed=1..2:", false, "\"\" is no number of values"),
            ("speed=1..2:1", false, "\"1\" is no number of values: 2 to"),
            ("speed=1..2:2.5", false, "\"2.5\" is no number"),
            ("speed=1..2:-3", false, "\"-3\" is no number"),
            ("speed=1..2:10000000", false, "is no number of values"),
            ("speed=one..2:3", false, "\"one\" is no end"),
            ("speed=1..inf:3", false, "\"inf\" is no end"),
            ("speed=1..nan:3", false, "\"nan\" is no end"),
            ("speed=1..:3", false, "\"\" is no end"),
            ("speed=1e6...1e9:3", false, "two dots"),
            ("speed=1..1:3", false, "both ends"),
            ("speed=0..1:3", true, "positive ends, and 0 is not"),
            ("speed=1..-2:3", true, "positive ends, and -2 is not"),
            ("speed=1,,2", false, "a value of the list is empty"),
            ("speed=1,2,", false, "a value of the list is empty"),
        ] {
            let message = Variation::parse(given, log).unwrap_err();
            assert!(message.starts_with(&format!("--vary {given}: ")) && message.contains(part), "{message}");
        }
    }

    proptest! {
        /// Integer steps between integer ends, scaled by a power of ten, are exact to the last bit.
        #[test]
        fn round_ranges_have_round_values(from in -1000_i64..1000, step in 1_i64..1000, count in 2_usize..50, power in -9_i32..9) {
            let to = from + step * (count as i64 - 1);
            let found = numbers(&format!("key={from}e{power}..{to}e{power}:{count}"), false);
            for (n, value) in found.iter().enumerate() {
                let exact: f64 = format!("{}e{power}", from + step * n as i64).parse().unwrap();
                prop_assert_eq!(*value, exact);
            }
        }

        /// The ends are exact; the ratio of neighbours is constant up to rounding.
        #[test]
        fn logarithmic_ranges_have_exact_ends_and_equal_ratios(a in -30.0..30.0_f64, b in -30.0..30.0_f64, count in 3_usize..40) {
            let (from, to) = (10f64.powf(a), 10f64.powf(b));
            prop_assume!(from != to);
            let found = numbers(&format!("key={from:?}..{to:?}:{count}"), true);
            prop_assert_eq!((found[0], found[count - 1], found.len()), (from, to, count));
            let ratio = (to / from).powf(1.0 / (count - 1) as f64);
            // The rounding error of the logarithm, 4e-15 over 30 decades, is amplified by ln 10.
            prop_assert!(found.windows(2).all(|pair| (pair[1] / pair[0] / ratio - 1.0).abs() < 1e-13));
        }

        /// Any text is parsed or refused with a message, and a parsed variation has as many numbers as texts.
        #[test]
        fn no_text_is_too_strange(given in "[a-z.]{0,6}=?[-0-9.,:e\\[\\]x]{0,12}", log: bool) {
            if let Ok(found) = Variation::parse(&given, log) {
                prop_assert!(!found.texts.is_empty());
                if let Some(numbers) = found.numbers {
                    prop_assert_eq!(numbers.len(), found.texts.len());
                }
            }
        }
    }
}
