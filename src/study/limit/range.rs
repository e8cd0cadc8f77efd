//! Parses `KEY=A..B`: one key and the ends of the range that is searched.

/// Error message for an argument without a range.
const FORM: &str =
    "it has the form KEY=A..B, the key of a number and the ends of its range, for example impactor.speed=0.1..10";
/// Ratio of the ends from which a range is searched on a logarithmic axis.
const WIDE: f64 = 4.0;
/// Number of grid intervals: per decade on a logarithmic axis, and in any case at least [`MIN_INTERVALS`] and at most
/// [`MAX_INTERVALS`].
const INTERVALS_PER_DECADE: f64 = 3.0;
const MIN_INTERVALS: f64 = 6.0;
const MAX_INTERVALS: f64 = 12.0;
/// Absolute value, relative to the range, below which a value counts as zero when its accuracy is judged.
const NEAR_ZERO: f64 = 1e-3;
/// Number of significant digits of computed values, few enough for a message to repeat them exactly.
const DIGITS: usize = 10;

/// One key and the range that is searched.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// Dotted path of the key.
    pub key: String,
    /// Lower end, in the key's unit.
    pub from: f64,
    /// Upper end, in the key's unit.
    pub to: f64,
}

impl Range {
    /// Parses `KEY=A..B`.
    ///
    /// # Errors
    /// If the text does not have this form or the range is empty; the message quotes `given`.
    pub fn parse(given: &str) -> Result<Self, String> {
        let wrong = |why: String| format!("--vary {given}: {why}");
        let (key, values) = given.split_once('=').ok_or_else(|| wrong(FORM.into()))?;
        let (key, values) = (key.trim(), values.trim());
        if key.is_empty() || values.is_empty() {
            return Err(wrong(FORM.into()));
        }
        if values.contains(',') {
            return Err(wrong("a list has no values between its own: a limit is searched in a range, KEY=A..B".into()));
        }
        let (from, to) = values.split_once("..").ok_or_else(|| wrong(FORM.into()))?;
        if to.contains(':') {
            return Err(wrong("a limit chooses the values itself: leave out their number, KEY=A..B".into()));
        }
        let end = |text: &str| {
            let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
            number
                .ok_or_else(|| wrong(format!("{:?} is not a number, so it cannot be an end of the range", text.trim())))
        };
        let (from, to) = (end(from)?, end(to)?);
        if from == to {
            return Err(wrong("both ends of the range are the same".into()));
        }
        if from > to {
            return Err(wrong("the first end of the range must be the lower one".into()));
        }
        Ok(Self { key: key.to_owned(), from, to })
    }

    /// Whether the search axis is logarithmic.
    fn is_log(&self) -> bool {
        self.from > 0.0 && self.to >= WIDE * self.from
    }

    /// Value at a place of the search axis. A place is a natural logarithm of the value, or a part (0 to 1) of the
    /// range.
    pub(super) fn value(&self, place: f64) -> f64 {
        let [first, last] = self.ends();
        if place <= first {
            return self.from;
        }
        if place >= last {
            return self.to;
        }
        let value = if self.is_log() { place.exp() } else { self.from + place * (self.to - self.from) };
        let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
        rounded.clamp(self.from, self.to)
    }

    /// Change of the place that corresponds to a relative change of the value. Near zero, the change is relative to a
    /// small part of the range, so that a bracket around zero becomes narrow too.
    pub(super) fn width(&self, relative: f64, place: f64) -> f64 {
        if self.is_log() {
            relative
        } else {
            relative * (self.value(place).abs() / (self.to - self.from)).max(NEAR_ZERO)
        }
    }

    fn ends(&self) -> [f64; 2] {
        if self.is_log() { [self.from.ln(), self.to.ln()] } else { [0.0, 1.0] }
    }

    /// Places of the coarse grid, ascending, including both ends.
    pub(super) fn grid(&self) -> Vec<f64> {
        let [first, last] = self.ends();
        let wanted = if self.is_log() { INTERVALS_PER_DECADE * (self.to / self.from).log10() } else { MIN_INTERVALS };
        let intervals = wanted.ceil().clamp(MIN_INTERVALS, MAX_INTERVALS);
        let place = |n: usize| first + (last - first) * n as f64 / intervals;
        (0..=intervals as usize).map(place).collect()
    }

    /// Values of the coarse grid, ascending, including both ends.
    pub fn values(&self) -> Vec<f64> {
        self.grid().into_iter().map(|place| self.value(place)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Range;

    #[test]
    fn ends_are_exact_and_wide_ranges_logarithmic() {
        let values = Range::parse("impactor.speed=0.1..10").unwrap().values();
        assert_eq!((values[0], values[3], values[6], values.len()), (0.1, 1.0, 10.0, 7));
        let values = Range::parse("a = -1..2").unwrap().values();
        assert_eq!(values, [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(Range::parse("k=1e-300..1e300").unwrap().values().len(), 13);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (given, part) in [
            ("speed", "KEY=A..B"),
            ("=1..2", "KEY=A..B"),
            ("speed=", "KEY=A..B"),
            ("speed=3", "KEY=A..B"),
            ("speed=1,2,3", "a list"),
            ("speed=1..2:5", "leave out their number"),
            ("speed=slow..2", "\"slow\" is not a number"),
            ("speed=1..inf", "\"inf\" is not a number"),
            ("speed=1..", "\"\" is not a number"),
            ("speed=2..2", "the same"),
            ("speed=2..1", "lower one"),
        ] {
            let message = Range::parse(given).unwrap_err();
            assert!(message.starts_with(&format!("--vary {given}: ")) && message.contains(part), "{message}");
        }
    }
}
