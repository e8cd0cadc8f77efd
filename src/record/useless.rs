//! Numbers of a result whose estimated error makes them useless.

/// Estimated error over the peak above which a number is of no use.
pub const USELESS: f64 = 0.5;

/// Numbers of a result that are printed, by their estimated errors (NaN without an estimate), and times.
#[derive(Debug, Clone, Copy)]
pub struct Printed {
    /// End of the first contact, s; `None` without a contact.
    pub first_end: Option<f64>,
    /// Time of the largest force, s.
    pub peak_time: f64,
    /// Error of the acceleration in the first contact, before the steps.
    pub first_contact_error: f64,
    /// Error of the acceleration over the whole history.
    pub history_error: f64,
    /// Error of the deflection under the impactor.
    pub deflection_error: f64,
    /// Error of the largest stress.
    pub stress_error: f64,
}

impl Printed {
    /// Names and estimated errors of the numbers that are of no use.
    pub fn useless(&self) -> Vec<(&'static str, f64)> {
        let Some(first_end) = self.first_end else { return Vec::new() };
        let is_first = self.peak_time <= first_end && !self.first_contact_error.is_nan();
        let of_peak = if is_first { self.first_contact_error } else { self.history_error };
        let all = [
            ("peak force and acceleration", of_peak),
            ("largest deflection under the impactor", self.deflection_error),
            ("largest tension", self.stress_error),
        ];
        all.into_iter().filter(|(_, error)| *error > USELESS).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each number is held against the error that applies at its time; a number without an estimate is not judged.
    #[test]
    fn numbers_are_judged_by_their_own_errors() {
        let good = Printed {
            first_end: Some(1.0),
            peak_time: 0.5,
            first_contact_error: 1e-3,
            history_error: 0.9,
            deflection_error: f64::NAN,
            stress_error: f64::NAN,
        };
        assert!(good.useless().is_empty());
        let named = |printed: Printed| printed.useless().iter().map(|(name, _)| name.len()).collect::<Vec<_>>();
        assert_eq!(Printed { peak_time: 3.0, ..good }.useless(), [("peak force and acceleration", 0.9)]);
        assert_eq!(Printed { first_contact_error: f64::NAN, ..good }.useless().len(), 1);
        assert_eq!(named(Printed { deflection_error: 0.51, stress_error: 0.8, ..good }).len(), 2);
        assert!(Printed { first_end: None, peak_time: 3.0, deflection_error: 0.6, ..good }.useless().is_empty());
    }
}
