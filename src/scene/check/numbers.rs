//! Checks of single numbers and short lists of numbers.

use std::ops::{RangeBounds, RangeInclusive};

use super::super::{SceneError, Source, Vec3};

/// Formats a number as a person would write it.
pub(crate) fn show(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// Formats a number rounded to one digit.
pub fn one_digit(value: f64) -> String {
    show(format!("{value:.0e}").parse().unwrap_or(value))
}

impl Source {
    /// Checks that all values are finite.
    ///
    /// # Errors
    /// If a value is infinite or not a number.
    pub(super) fn finite(&self, path: &str, values: &[f64]) -> Result<(), SceneError> {
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.error(path, format!("{value} is not finite"), "a finite number")),
            None => Ok(()),
        }
    }

    /// Returns the value if it is finite and in `range`.
    pub(super) fn in_range(
        &self,
        path: &str,
        value: f64,
        range: impl RangeBounds<f64>,
        help: impl Into<String>,
    ) -> Result<f64, SceneError> {
        self.finite(path, &[value])?;
        if range.contains(&value) {
            return Ok(value);
        }
        Err(self.error(path, format!("{} is out of range", show(value)), help))
    }

    /// An error for a key that the scene needs together with others.
    pub(super) fn required(&self, path: &str, help: &str) -> SceneError {
        self.error(path, "this key is required", help)
    }

    /// Returns the value if it is finite and positive. `help` says its meaning and its unit.
    pub(super) fn positive(&self, path: &str, value: f64, help: &str) -> Result<f64, SceneError> {
        self.finite(path, &[value])?;
        if value > 0.0 {
            Ok(value)
        } else {
            let message = format!("must be positive, but is {}", show(value));
            Err(self.error(path, message, help))
        }
    }

    /// Returns the values if they are finite and not negative.
    pub(super) fn not_negative(&self, path: &str, values: Vec3, help: &str) -> Result<Vec3, SceneError> {
        self.finite(path, &values)?;
        match values.into_iter().find(|value| *value < 0.0) {
            Some(value) => {
                let message = format!("must not be negative, but is {}", show(value));
                Err(self.error(path, message, help))
            }
            None => Ok(values),
        }
    }

    /// Returns the whole number if it is in `range`.
    pub(super) fn whole(&self, path: &str, value: i64, range: RangeInclusive<usize>) -> Result<usize, SceneError> {
        usize::try_from(value).ok().filter(|value| range.contains(value)).ok_or_else(|| {
            let message = format!("{value} is out of range");
            let help = format!("a whole number from {} to {}", range.start(), range.end());
            self.error(path, message, help)
        })
    }

    /// The vector scaled to length one. A component below 1e-12 of the length is rounding, and set to zero.
    pub(super) fn unit(&self, path: &str, vector: Vec3) -> Result<Vec3, SceneError> {
        self.finite(path, &vector)?;
        // Scaled first, so that no square overflows or underflows.
        let largest = vector.into_iter().fold(0.0_f64, |l, v| l.max(v.abs()));
        if largest == 0.0 {
            let help = "three numbers [x, y, z], not all zero; the length does not matter";
            return Err(self.error(path, "a zero vector has no direction", help));
        }
        let scaled = vector.map(|v| v / largest);
        let length = scaled.iter().map(|v| v * v).sum::<f64>().sqrt();
        Ok(scaled.map(|v| if v.abs() > 1e-12 * length { v / length } else { 0.0 }))
    }
}

#[cfg(test)]
mod tests {
    use super::one_digit;

    #[test]
    fn one_digit_is_written_as_people_do() {
        assert_eq!([20.3, 1.04e-5, 0.0523, 3e5].map(one_digit), ["20", "1e-5", "0.05", "3e5"]);
    }
}
