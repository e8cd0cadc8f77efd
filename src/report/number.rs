//! Numbers with units, with the digits that an engineer reads.

use crate::figure::exponential;
use crate::scene::Vec3;

/// Between a number and its unit: a space where no line is broken.
const SPACE: char = '\u{a0}';

/// A unit and its value in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// As it is written.
    pub name: &'static str,
    /// How many of the SI unit it is.
    pub size: f64,
    /// The least value that it is taken for, in SI units.
    from: f64,
}

/// A physical quantity: its units, the smallest first.
pub type Units = &'static [Unit];

const fn unit(name: &'static str, size: f64, from: f64) -> Unit {
    Unit { name, size, from }
}

/// s.
pub const TIME: Units = &[unit("µs", 1e-6, 0.0), unit("ms", 1e-3, 1e-5), unit("s", 1.0, 0.1)];
/// m.
pub const LENGTH: Units = &[unit("µm", 1e-6, 0.0), unit("mm", 1e-3, 1e-5), unit("m", 1.0, 0.1)];
/// N.
pub const FORCE: Units = &[unit("N", 1.0, 0.0), unit("kN", 1e3, 1e3), unit("MN", 1e6, 1e6)];
/// Pa.
pub const STRESS: Units = &[unit("Pa", 1.0, 0.0), unit("kPa", 1e3, 1e3), unit("MPa", 1e6, 1e5)];
/// Pa, of materials.
pub const MODULUS: Units = &[unit("Pa", 1.0, 0.0), unit("MPa", 1e6, 1e5), unit("GPa", 1e9, 1e9)];
/// J.
pub const ENERGY: Units = &[unit("mJ", 1e-3, 0.0), unit("J", 1.0, 0.1)];
/// N s.
pub const IMPULSE: Units = &[unit("N s", 1.0, 0.0)];
/// m/s.
pub const SPEED: Units = &[unit("m/s", 1.0, 0.0)];
/// m/s².
pub const ACCELERATION: Units = &[unit("m/s²", 1.0, 0.0)];
/// kg.
pub const MASS: Units = &[unit("g", 1e-3, 0.0), unit("kg", 1.0, 0.1)];

/// The unit of a value.
pub fn unit_for(value: f64, units: Units) -> Unit {
    // But for rounding: 0.1 m is not 100 mm.
    let fitting = units.iter().rev().find(|unit| value.abs() >= unit.from * (1.0 - 1e-9));
    let of_nothing = || units.iter().find(|unit| unit.size == 1.0);
    let found = if value == 0.0 { of_nothing() } else { fitting };
    found.or(units.first()).copied().unwrap_or(unit("", 1.0, 0.0))
}

/// A computed value with its unit: four digits.
pub fn computed(value: f64, units: Units) -> String {
    let unit = unit_for(value, units);
    with_unit(digits(value / unit.size, 4), unit.name)
}

/// A value that the user has given, with its unit: all digits that it has.
pub fn given(value: f64, units: Units) -> String {
    let unit = unit_for(value, units);
    with_unit(plain(value / unit.size), unit.name)
}

/// A number and its unit.
pub fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() { number } else { format!("{number}{SPACE}{}", unit.replace(' ', "\u{a0}")) }
}

/// The smallest part of a whole that is told as a number.
pub const SMALLEST_PERCENT: f64 = 1e-5;

/// A part of a whole as per cent, with two digits.
pub fn percent(part: f64) -> String {
    if !part.is_finite() {
        return MISSING.to_owned();
    }
    if part.abs() < SMALLEST_PERCENT { format!("below 0.001{SPACE}%") } else { with_unit(digits(100.0 * part, 2), "%") }
}

/// In the place of what is no number.
const MISSING: &str = "–";

/// A number with so many significant digits; very large and small ones with a power of ten.
pub fn digits(value: f64, count: usize) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    // As it is written with these digits, so that 9.9996 has the power of 10.
    let written = format!("{value:.*e}", count.saturating_sub(1));
    let (mantissa, power) = written.split_once('e').unwrap_or((&written, "0"));
    let power: i32 = power.parse().unwrap_or_default();
    let text = if (-3..6).contains(&power) {
        format!("{value:.*}", (count as i32 - 1 - power).max(0) as usize)
    } else {
        format!("{mantissa}{SPACE}×{SPACE}{}", exponential(power))
    };
    signed(&text)
}

/// A number with all its digits, up to ten; very large and small ones with a power of ten.
pub fn plain(value: f64) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    // Without the noise of a conversion of units.
    let value: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        return signed(&value.to_string());
    }
    let written = format!("{value:e}");
    let (mantissa, power) = written.split_once('e').unwrap_or((&written, "0"));
    let power = exponential(power.parse().unwrap_or_default());
    if mantissa == "1" { power } else { signed(&format!("{mantissa}{SPACE}×{SPACE}{power}")) }
}

/// With a minus sign in the place of a hyphen.
fn signed(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// A vector in a unit that the user has given it in.
pub fn vector(values: Vec3, unit: &str) -> String {
    with_unit(format!("({})", values.map(|value| plain(value + 0.0)).join(", ")), unit)
}

/// One number where all components are alike, otherwise all three.
pub fn by_component(values: Vec3, unit: &str) -> String {
    if values.iter().all(|value| *value == values[0]) {
        with_unit(plain(values[0]), unit)
    } else {
        vector(values, unit)
    }
}

/// A place that was found, in mm.
pub fn place(point: Vec3) -> String {
    // Rounded to micrometres, and no zero with a sign.
    vector(point.map(|x| (1e6 * x).round() * 1e-3), "mm")
}

/// The day and the time of a number of seconds since 1970, UTC.
pub fn date(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    // Days from 0000-03-01, so that a leap day is the last of its year (H. Hinnant, chrono-compatible low-level date algorithms).
    let shifted = days + 719_468;
    let (era, day) = (shifted / 146_097, shifted % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let of_year = day - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let (month, shift) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = era * 400 + year + shift;
    format!("{year:04}-{month:02}-{of_month:02} {:02}:{:02} UTC", rest / 3600, rest / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spaced(text: &str) -> String {
        text.replace(SPACE, " ")
    }

    #[test]
    fn values_have_a_fitting_unit_and_four_digits() {
        for (value, units, text) in [
            (26_368.4, FORCE, "26.37 kN"),
            (0.000_101_4, TIME, "0.1014 ms"),
            (1e-3, TIME, "1.000 ms"),
            (2.5e-6, TIME, "2.500 µs"),
            (1.112e8, STRESS, "111.2 MPa"),
            (4.13e-5, TIME, "0.04130 ms"),
            (-1.937_23, SPEED, "−1.937 m/s"),
            (99.996, SPEED, "100.0 m/s"),
            (0.0, LENGTH, "0 m"),
            (3.2e-9, LENGTH, "0.003200 µm"),
            (13_184.0, ACCELERATION, "13184 m/s²"),
            (4.5e7, STRESS, "45.00 MPa"),
            (f64::NAN, STRESS, "– Pa"),
            (1e12, FORCE, "1.000 × 10⁶ MN"),
            (0.5, LENGTH, "0.5000 m"),
        ] {
            assert_eq!(spaced(&computed(value, units)), text);
        }
    }

    #[test]
    fn given_values_keep_their_digits() {
        assert_eq!(spaced(&given(70e9, MODULUS)), "70 GPa");
        assert_eq!(spaced(&given(0.05, LENGTH)), "50 mm");
        assert_eq!(spaced(&given(7.672, SPEED)), "7.672 m/s");
        assert_eq!(spaced(&plain(1e9)), "10⁹");
        assert_eq!(spaced(&plain(1.669e10)), "1.669 × 10¹⁰");
        assert_eq!(spaced(&plain(0.1 + 0.2)), "0.3");
        assert_eq!(spaced(&by_component([0.0, 0.0, 2e9], "N/m³")), "(0, 0, 2 × 10⁹) N/m³");
        assert_eq!(spaced(&place([-0.0, 0.0123456, -1e-9])), "(0, 12.346, 0) mm");
    }

    #[test]
    fn parts_are_per_cent() {
        assert_eq!(spaced(&percent(0.0073)), "0.73 %");
        assert_eq!(spaced(&percent(0.96)), "96 %");
        assert_eq!(spaced(&percent(1.234)), "123 %");
        assert_eq!(spaced(&percent(1e-12)), "below 0.001 %");
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date(0), "1970-01-01 00:00 UTC");
        assert_eq!(date(951_782_400), "2000-02-29 00:00 UTC");
        assert_eq!(date(1_795_368_659), "2026-11-22 17:30 UTC");
        assert_eq!(date(4_107_542_399), "2100-02-28 23:59 UTC");
    }
}
