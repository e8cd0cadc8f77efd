//! A linear axis with rounded limits and rounded tick labels.

/// Approximate number of intervals between the ticks of an axis.
const TICKS: f64 = 7.0;

/// A metric prefix for a power of ten.
struct Prefix {
    exponent: i32,
    symbol: &'static str,
    /// Units with which engineers use the prefix. Other units, such as m/s², keep the power of ten.
    units: &'static [&'static str],
}

const PREFIXES: [Prefix; 5] = [
    Prefix { exponent: -6, symbol: "µ", units: &["m", "s"] },
    Prefix { exponent: -3, symbol: "m", units: &["m", "s", "N", "J"] },
    Prefix { exponent: 3, symbol: "k", units: &["Pa", "N", "J"] },
    Prefix { exponent: 6, symbol: "M", units: &["Pa", "N", "J"] },
    Prefix { exponent: 9, symbol: "G", units: &["Pa"] },
];

/// A linear axis whose limits are multiples of the tick spacing.
pub(super) struct Axis {
    pub low: f64,
    pub high: f64,
    step: f64,
    /// Labels are values divided by ten to this power.
    exponent: i32,
}

impl Axis {
    /// Makes an axis for finite values between `low` and `high`.
    pub fn spanning(low: f64, high: f64) -> Self {
        // An empty range gets an extent of one.
        let high = if high > low { high } else { low + 1.0 };
        let step = rounded_up((high - low) / TICKS);
        // A limit that equals a multiple of the spacing up to rounding is not moved to the next multiple.
        let low = (low / step + 1e-9).floor() * step;
        let high = (high / step - 1e-9).ceil() * step;
        let size = low.abs().max(high.abs());
        let exponent = match size.log10() {
            e if (-2.0..5.0).contains(&e) => 0,
            e => 3 * (e / 3.0).floor() as i32,
        };
        Self { low, high, step, exponent }
    }

    /// Value and label of each tick.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let unit = 10f64.powi(self.exponent);
        let step = self.step / unit;
        let whole = |digits: &usize| {
            let scaled = step * 10f64.powi(*digits as i32);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        };
        let digits = (0..9).find(whole).unwrap_or(9);
        let first = (self.low / self.step).round() as i64;
        let last = (self.high / self.step).round() as i64;
        (first..=last)
            .map(|n| {
                let label = format!("{:.*}", digits, n as f64 * step);
                (n as f64 * self.step, label.replace('-', "\u{2212}"))
            })
            .collect()
    }

    /// `unit` with the power of ten omitted from the labels, written as a prefix if one is in use for the unit.
    pub fn unit(&self, unit: &str) -> String {
        if self.exponent == 0 {
            return unit.to_owned();
        }
        match PREFIXES.iter().find(|prefix| prefix.exponent == self.exponent && prefix.units.contains(&unit)) {
            Some(prefix) => format!("{}{unit}", prefix.symbol),
            None => format!("{} {unit}", exponential(self.exponent)),
        }
    }
}

/// A power of ten in the form 10⁻⁶.
pub(crate) fn exponential(exponent: i32) -> String {
    let superscript = |c| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + digit as u32 - '0' as u32).unwrap_or(digit),
    };
    let power: String = exponent.to_string().chars().map(superscript).collect();
    format!("10{power}")
}

/// Rounds up to 1, 2, 2.5 or 5 times a power of ten.
fn rounded_up(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let factors = [1.0, 2.0, 2.5, 5.0];
    let fits = |factor: &&f64| **factor * power >= step * (1.0 - 1e-9);
    factors.iter().find(fits).unwrap_or(&10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> (Vec<String>, String) {
        let axis = Axis::spanning(low, high);
        let labels = axis.ticks().into_iter().map(|tick| tick.1).collect();
        (labels, axis.unit("m"))
    }

    #[test]
    fn limits_and_labels_are_rounded() {
        let of = |low, high| {
            let (labels, unit) = labels(low, high);
            format!("{} [{unit}]", labels.join(" "))
        };
        assert_eq!(of(0.0, 20.0), "0 5 10 15 20 [m]");
        assert_eq!(of(0.0, 2002.7), "0 500 1000 1500 2000 2500 [m]");
        assert_eq!(of(0.0, 0.0), "0.0 0.2 0.4 0.6 0.8 1.0 [m]");
        assert_eq!(of(-3.0, 3.0), "−3 −2 −1 0 1 2 3 [m]");
        assert_eq!(of(0.0, 1.5e6), "0.00 0.25 0.50 0.75 1.00 1.25 1.50 [10⁶ m]");
        assert_eq!(of(0.0, 4e-5), "0 10 20 30 40 [µm]");
        assert_eq!(["Pa", "m/s²"].map(|unit| Axis::spanning(0.0, 1.5e6).unit(unit)), ["MPa", "10⁶ m/s²"]);
    }

    #[test]
    fn limits_enclose_the_values_by_less_than_a_step() {
        for n in 0..2000 {
            let high = 1.013_f64.powi(n - 1000);
            let axis = Axis::spanning(0.0, high);
            assert!(axis.high >= high * (1.0 - 1e-8) && axis.high - high < axis.step);
            assert!((4..=9).contains(&axis.ticks().len()), "{high}");
        }
    }
}
