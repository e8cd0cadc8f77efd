//! A linear or logarithmic axis with given limits, and the cells of values on it.

use super::axis::{Axis, exponential};

/// An axis with given limits.
pub(super) struct Scale {
    pub low: f64,
    pub high: f64,
    is_log: bool,
    /// Names of the values 0, 1, …; empty for an axis of numbers.
    names: Vec<String>,
}

/// Largest number of decades for which every power of ten has a label.
const LABELS: usize = 8;

/// Smallest number of labels that shows the scaling of an axis.
const LEAST_LABELS: usize = 3;

/// Candidates for the leading digits with labels in each decade, from the fewest digits to the most.
const LABELLED: [&[i32]; 4] = [&[1], &[1, 3], &[1, 2, 5], &[1, 2, 3, 5, 7]];

/// Ratio of the largest to the smallest positive value above which colours are on a logarithmic scale.
const LOG_FACTOR: f64 = 100.0;

impl Scale {
    /// Makes an axis with the limits `low` and `high`, which must be positive if the axis is logarithmic.
    pub fn new(low: f64, high: f64, is_log: bool) -> Self {
        Self { low, high, is_log, names: Vec::new() }
    }

    /// Makes a linear axis with rounded limits that enclose `low` and `high`.
    pub fn spanning(low: f64, high: f64) -> Self {
        let Axis { low, high, .. } = Axis::spanning(low, high);
        Self::new(low, high, false)
    }

    /// Makes an axis of the values 0, 1, … with names.
    pub fn named(names: &[String]) -> Self {
        Self { names: names.to_vec(), ..Self::new(-0.5, names.len() as f64 - 0.5, false) }
    }

    /// Makes the colour scale of non-negative values, from the smallest to the largest. It is logarithmic if the
    /// positive values span more than two decades. With `from_zero`, a linear scale begins at 0. Values that are not
    /// finite are ignored.
    pub fn of_colours(values: impl Iterator<Item = f64>, from_zero: bool) -> Self {
        let (mut low, mut least, mut high) = (f64::INFINITY, f64::INFINITY, 0.0_f64);
        for value in values.filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
            least = if value > 0.0 { least.min(value) } else { least };
        }
        if high > LOG_FACTOR * least {
            return Self::new(least, high, true);
        }
        let low = if from_zero { 0.0 } else { low };
        // If all values are equal, the scale is centred on them.
        if high > low { Self::new(low, high, false) } else { Self::new(0.0, 2.0 * high.max(1e-300), false) }
    }

    /// Relative position of a value: 0 at the lower limit, 1 at the upper limit.
    pub fn place(&self, value: f64) -> f64 {
        if self.is_log {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Whether a value is within the limits.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Relative position and label of each tick; minor ticks have no label.
    pub fn ticks(&self) -> Vec<(f64, Option<String>)> {
        let ticks = match (self.is_log, &self.names[..]) {
            (true, _) => self.log_ticks(),
            (false, []) => self.linear_ticks(),
            (false, names) => (0..).zip(names).map(|(n, name)| (f64::from(n), Some(name.clone()))).collect(),
        };
        ticks.into_iter().map(|(value, label)| (self.place(value), label)).filter(|tick| is_within(tick.0)).collect()
    }

    fn linear_ticks(&self) -> Vec<(f64, Option<String>)> {
        let ticks = Axis::spanning(self.low, self.high).ticks().into_iter();
        ticks.map(|(value, label)| (value, Some(label))).collect()
    }

    fn log_ticks(&self) -> Vec<(f64, Option<String>)> {
        let Some(labelled) = self.labelled_digits() else { return self.linear_ticks() };
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().ceil() as i32;
        let count = (last - first) as usize;
        let pace = count.div_ceil(LABELS) as i32;
        let digits = if count > 2 * LABELS { 1..=1 } else { 1..=9 };
        // For a few decades around 1, plain numbers are easier to read than powers of ten.
        let is_plain = count <= 4 && first >= -3 && last <= 4;
        let written = |digit: i32, power: i32| match (is_plain, digit) {
            (true, _) => format!("{:.*}", (-power).max(0) as usize, f64::from(digit) * 10f64.powi(power)),
            (false, 1) => exponential(power),
            (false, _) => format!("{digit}\u{b7}{}", exponential(power)),
        };
        let is_labelled = |digit: i32, power: i32| labelled.contains(&digit) && (digit > 1 || power % pace == 0);
        let tick = |digit: i32, power: i32| {
            let label = is_labelled(digit, power).then(|| written(digit, power));
            (f64::from(digit) * 10f64.powi(power), label)
        };
        (first..=last).flat_map(|power| digits.clone().map(move |digit| tick(digit, power))).collect()
    }

    /// Leading digits with labels in each decade of a logarithmic axis: the fewest that lead to at least
    /// [`LEAST_LABELS`] labels. `None` if the axis is too short for all candidates; the ticks of a linear axis are then
    /// used.
    fn labelled_digits(&self) -> Option<&'static [i32]> {
        let within = |digits: &[i32]| {
            let places = (self.low.log10().floor() as i32..=self.high.log10().ceil() as i32)
                .flat_map(|power| digits.iter().map(move |digit| f64::from(*digit) * 10f64.powi(power)));
            places.filter(|value| is_within(self.place(*value))).count()
        };
        LABELLED.into_iter().find(|digits| within(digits) >= LEAST_LABELS)
    }

    /// `unit` with the power of ten omitted from the labels.
    pub fn unit(&self, unit: &str) -> String {
        let has_plain_labels = self.is_log && self.labelled_digits().is_some();
        if has_plain_labels || !self.names.is_empty() {
            unit.to_owned()
        } else {
            Axis::spanning(self.low, self.high).unit(unit)
        }
    }
}

/// Whether a relative position is on the axis, with a tolerance for rounding.
fn is_within(place: f64) -> bool {
    (-1e-9..=1.0 + 1e-9).contains(&place)
}

/// Lower and upper end of the cell of each of the ascending `values`: half way to the neighbours. The outer cells are
/// symmetric about their value. With `is_log`, half way refers to a logarithmic axis.
pub(super) fn cells(values: &[f64], is_log: bool) -> Vec<(f64, f64)> {
    let back = |x: f64| if is_log { x.exp() } else { x };
    let at: Vec<f64> = values.iter().map(|value| if is_log { value.ln() } else { *value }).collect();
    let middles: Vec<f64> = at.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let alone = if is_log { 0.5 } else { 0.5 * at.first().map_or(1.0, |x| x.abs().max(1e-300)) };
    let cell = |n: usize| {
        let (before, after) = (n.checked_sub(1).and_then(|n| middles.get(n)), middles.get(n));
        let low = before.copied().unwrap_or_else(|| after.map_or(at[n] - alone, |after| 2.0 * at[n] - after));
        let high = after.copied().unwrap_or_else(|| before.map_or(at[n] + alone, |before| 2.0 * at[n] - before));
        (back(low), back(high))
    };
    (0..at.len()).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> String {
        scale.ticks().into_iter().filter_map(|tick| tick.1).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn ticks_are_round_and_within_the_limits() {
        assert_eq!(labels(&Scale::new(0.4, 2.1, false)), "0.50 0.75 1.00 1.25 1.50 1.75 2.00");
        assert_eq!(
            labels(&Scale::new(5e5, 2e12, true)),
            "10\u{2076} 10\u{2077} 10\u{2078} 10\u{2079} 10\u{b9}\u{2070} 10\u{b9}\u{b9} 10\u{b9}\u{b2}"
        );
        assert_eq!(labels(&Scale::new(0.09, 7.0, true)), "0.1 0.3 1 3");
        assert_eq!(labels(&Scale::new(0.4, 2.1, true)), "0.5 1 2");
        let tens = |digit: &str| format!("{digit}10\u{2077}");
        assert_eq!(labels(&Scale::new(0.9e7, 6e7, true)), [tens(""), tens("2\u{b7}"), tens("5\u{b7}")].join(" "));
        let names = ["upper", "lower"].map(str::to_owned);
        let places: Vec<f64> = Scale::named(&names).ticks().into_iter().map(|tick| tick.0).collect();
        assert_eq!((labels(&Scale::named(&names)).as_str(), &places[..]), ("upper lower", &[0.25, 0.75][..]));
        assert!(labels(&Scale::new(1e-30, 1e30, true)).split(' ').count() <= 9);
        let places: Vec<f64> = Scale::new(1.0, 100.0, true).ticks().into_iter().map(|tick| tick.0).collect();
        assert!(places.iter().all(|place| (-1e-9..=1.0 + 1e-9).contains(place)));
        // Ticks at 1 … 9, 10 … 90 and 100.
        assert_eq!(places.len(), 19);
        assert!((Scale::new(1.0, 100.0, true).place(10.0) - 0.5).abs() < 1e-15);
    }

    /// Holds for any length and start of the axis.
    #[test]
    fn every_axis_has_three_labels_and_not_too_many() {
        for n in 0..400 {
            let low = 1e-7 * 1.07_f64.powi(n);
            for factor in [1.001, 1.3, 2.0, 3.0, 7.0, 9.99, 30.0, 99.0, 101.0, 1e3, 1e9] {
                for is_log in [true, false] {
                    let scale = Scale::new(low, factor * low, is_log);
                    let labels = labels(&scale);
                    let count = labels.split(' ').count();
                    assert!((3..=9).contains(&count), "{low} {factor} {is_log}: {labels}");
                }
            }
        }
        let short = Scale::new(1.1e9, 1.4e9, true);
        assert_eq!((labels(&short).as_str(), short.unit("Pa").as_str()), ("1.10 1.15 1.20 1.25 1.30 1.35 1.40", "GPa"));
    }

    #[test]
    fn colours_of_more_than_two_decades_are_logarithmic() {
        let of = |values: &[f64], from_zero| Scale::of_colours(values.iter().copied(), from_zero);
        assert!((of(&[1.0, 1e4, f64::NAN], false).place(100.0) - 0.5).abs() < 1e-12);
        assert!((of(&[0.0, 1.0, 1e4], true).place(100.0) - 0.5).abs() < 1e-12);
        assert_eq!(of(&[1.0, 99.0], false).place(50.0), 0.5);
        assert_eq!(of(&[50.0, 100.0], true).place(50.0), 0.5);
        assert_eq!(of(&[3.0, 3.0], false).place(3.0), 0.5);
    }

    #[test]
    fn cells_meet_half_way() {
        assert_eq!(cells(&[1.0, 2.0, 4.0], false), [(0.5, 1.5), (1.5, 3.0), (3.0, 5.0)]);
        let log = cells(&[1.0, 100.0], true);
        assert!((log[0].0 - 0.1).abs() < 1e-12 && (log[0].1 - 10.0).abs() < 1e-12 && (log[1].1 - 1000.0).abs() < 1e-9);
        assert_eq!(cells(&[2.0], false), [(1.0, 3.0)]);
        assert_eq!(cells(&[0.0], false).len(), 1);
        assert!(cells(&[], true).is_empty());
    }
}
