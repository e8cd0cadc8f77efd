//! Formats numbers with units, with the number of digits that engineers use.

use crate::figure::exponential;
use crate::scene::Vec3;

/// The character between a number and its unit: a no-break space.
const SPACE: char = '\u{a0}';

/// A unit of a physical quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Symbol of the unit.
    pub name: &'static str,
    /// Value of one unit in SI units.
    pub size: f64,
    /// Smallest magnitude for which the unit is used, in SI units.
    from: f64,
}

/// Units of a physical quantity, in ascending order of size.
pub type Units = &'static [Unit];

const fn unit(name: &'static str, size: f64, from: f64) -> Unit {
    Unit { name, size, from }
}

/// Units of time.
pub const TIME: Units = &[unit("µs", 1e-6, 0.0), unit("ms", 1e-3, 1e-5), unit("s", 1.0, 0.1)];
/// Units of length.
pub const LENGTH: Units = &[unit("µm", 1e-6, 0.0), unit("mm", 1e-3, 1e-5), unit("m", 1.0, 0.1)];
/// Units of force.
pub const FORCE: Units = &[unit("N", 1.0, 0.0), unit("kN", 1e3, 1e3), unit("MN", 1e6, 1e6)];
/// Units of stress.
pub const STRESS: Units = &[unit("Pa", 1.0, 0.0), unit("kPa", 1e3, 1e3), unit("MPa", 1e6, 1e5)];
/// Units of the elastic moduli of materials.
pub const MODULUS: Units = &[unit("Pa", 1.0, 0.0), unit("MPa", 1e6, 1e5), unit("GPa", 1e9, 1e9)];
/// Units of energy.
pub const ENERGY: Units = &[unit("mJ", 1e-3, 0.0), unit("J", 1.0, 0.1)];
/// Units of impulse.
pub const IMPULSE: Units = &[unit("N s", 1.0, 0.0)];
/// Units of velocity.
pub const SPEED: Units = &[unit("m/s", 1.0, 0.0)];
/// Units of acceleration.
pub const ACCELERATION: Units = &[unit("m/s²", 1.0, 0.0)];
/// Units of mass.
pub const MASS: Units = &[unit("g", 1e-3, 0.0), unit("kg", 1.0, 0.1)];

/// Chooses the unit for a value in SI units.
pub fn unit_for(value: f64, units: Units) -> Unit {
    // The tolerance allows for rounding: 0.1 m is written as 0.1 m, not as 100 mm.
    let fitting = units.iter().rev().find(|unit| value.abs() >= unit.from * (1.0 - 1e-9));
    let of_nothing = || units.iter().find(|unit| unit.size == 1.0);
    let found = if value == 0.0 { of_nothing() } else { fitting };
    found.or(units.first()).copied().unwrap_or(unit("", 1.0, 0.0))
}

/// Formats a computed value (SI units) with its unit and four significant digits.
pub fn computed(value: f64, units: Units) -> String {
    let unit = unit_for(value, units);
    with_unit(digits(value / unit.size, 4), unit.name)
}

/// Formats a value given by the user (SI units) with its unit and all its digits.
pub fn given(value: f64, units: Units) -> String {
    let unit = unit_for(value, units);
    with_unit(plain(value / unit.size), unit.name)
}

/// Joins a number and its unit, without allowing a line break.
pub fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() { number } else { format!("{number}{SPACE}{}", unit.replace(' ', "\u{a0}")) }
}

/// Smallest fraction that [`percent`] writes as a number.
pub const SMALLEST_PERCENT: f64 = 1e-5;

/// Formats a fraction in per cent with two significant digits.
pub fn percent(part: f64) -> String {
    if !part.is_finite() {
        return MISSING.to_owned();
    }
    if part.abs() < SMALLEST_PERCENT { format!("below 0.001{SPACE}%") } else { with_unit(digits(100.0 * part, 2), "%") }
}

/// Text for values that are not finite.
const MISSING: &str = "–";

/// Formats a number with `count` significant digits. Very large and very small numbers have a power of ten.
pub fn digits(value: f64, count: usize) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    // The power is taken from the rounded number, so that 9.9996 with four digits becomes 10.00.
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

/// Formats a number with all its digits, at most ten. Very large and very small numbers have a power of ten.
pub fn plain(value: f64) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    // Removes rounding errors from the conversion of units.
    let value: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        return signed(&value.to_string());
    }
    let written = format!("{value:e}");
    let (mantissa, power) = written.split_once('e').unwrap_or((&written, "0"));
    let power = exponential(power.parse().unwrap_or_default());
    if mantissa == "1" { power } else { signed(&format!("{mantissa}{SPACE}×{SPACE}{power}")) }
}

/// Replaces hyphens by minus signs.
fn signed(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// Formats a vector in the unit of the user's input.
pub fn vector(values: Vec3, unit: &str) -> String {
    with_unit(format!("({})", values.map(|value| plain(value + 0.0)).join(", ")), unit)
}

/// Formats a vector as one number if all components are equal, otherwise as three numbers.
pub fn by_component(values: Vec3, unit: &str) -> String {
    if values.iter().all(|value| *value == values[0]) {
        with_unit(plain(values[0]), unit)
    } else {
        vector(values, unit)
    }
}

/// Formats a computed position in mm.
pub fn place(point: Vec3) -> String {
    // Rounded to micrometres. This may result in −0, from which `vector` removes the sign.
    vector(point.map(|x| (1e6 * x).round() * 1e-3), "mm")
}

/// Formats seconds since 1970 as date and time, UTC.
pub fn date(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    // Days since 0000-03-01, so that a leap day is the last day of its year (H. Hinnant, chrono-compatible low-level
    // date algorithms).
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
