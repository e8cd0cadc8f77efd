//! Estimated errors of the acceleration, by what causes them, and how they add up.

use std::ops::{Add, Mul};

use serde::{Deserialize, Serialize};

use crate::contact::Patch;
use crate::scene::Measure;

/// What an error comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The vectors of a basis.
    Basis,
    /// The size of the cells.
    Cells,
    /// The theory of the body, compared with three-dimensional elasticity.
    Theory,
    /// The steps in time.
    Steps,
    /// The patch that stands for the contact.
    Patch,
}

impl Cause {
    /// Its name in messages and results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Basis => "basis",
            Self::Cells => "cells",
            Self::Theory => "theory",
            Self::Steps => "steps",
            Self::Patch => "patch",
        }
    }
}

/// How errors of different causes add up: between 1, the sum, a bound, and 2, which is for independent errors of either sign. With 1 the
/// estimates of sixty impacts were 3.5 times the errors in the median, and with 2 some were too small (docs/accuracy.md).
const EXPONENT: f64 = 1.5;

/// The part of the largest cause's error from which on another cause counts as well: an error of a fifth of it adds 6% to it.
const MAIN_CAUSE: f64 = 0.2;

/// Estimated errors of two causes together.
pub fn joined(one: f64, other: f64) -> f64 {
    // (What is without error changes nothing, to the last digit.)
    match (one == 0.0, other == 0.0) {
        (true, _) => other,
        (_, true) => one,
        _ => (one.powf(EXPONENT) + other.powf(EXPONENT)).powf(EXPONENT.recip()),
    }
}

/// What a part leaves of a whole: joined, both are the whole. None where the part is larger.
pub fn rest(whole: f64, part: f64) -> f64 {
    (whole.powf(EXPONENT) - part.powf(EXPONENT)).max(0.0).powf(EXPONENT.recip())
}

/// Estimated errors, each over the peak of its quantity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Errors {
    /// Of the acceleration in the first contact.
    pub first_contact: f64,
    /// Of the acceleration over the whole history.
    pub history: f64,
    /// Of the largest tension in the first contact; NaN where it is not estimated.
    pub stress: f64,
}

impl Errors {
    /// The same of all.
    pub fn throughout(error: f64) -> Self {
        Self { first_contact: error, history: error, stress: error }
    }

    /// That of what the tolerance is for; where the stress' is not estimated, the acceleration's.
    pub fn of(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Stress if !self.stress.is_nan() => self.stress,
            _ => self.first_contact,
        }
    }

    /// Both together.
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        Self {
            first_contact: joined(self.first_contact, other.first_contact),
            history: joined(self.history, other.history),
            stress: joined(self.stress, other.stress),
        }
    }

    /// The smaller of each; a stress that is not estimated stays so.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        let stress = if self.stress.is_nan() { self.stress } else { self.stress.min(other.stress) };
        Self {
            first_contact: self.first_contact.min(other.first_contact),
            history: self.history.min(other.history),
            stress,
        }
    }

    /// The larger of each.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            first_contact: self.first_contact.max(other.first_contact),
            history: self.history.max(other.history),
            stress: self.stress.max(other.stress),
        }
    }
}

/// Of causes that may well have the same sign.
impl Add for Errors {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            first_contact: self.first_contact + other.first_contact,
            history: self.history + other.history,
            stress: self.stress + other.stress,
        }
    }
}

impl Mul<Errors> for f64 {
    type Output = Errors;

    fn mul(self, errors: Errors) -> Errors {
        let Errors { first_contact, history, stress } = errors;
        Errors { first_contact: self * first_contact, history: self * history, stress: self * stress }
    }
}

/// Errors by their causes, which are [`joined`] to the estimate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorEstimate {
    parts: Vec<(Cause, Errors)>,
}

impl ErrorEstimate {
    /// With one more.
    #[must_use]
    pub fn with(mut self, cause: Cause, errors: Errors) -> Self {
        self.parts.push((cause, errors));
        self
    }

    /// With that of a patch, where there is one.
    #[must_use]
    pub fn with_patch(self, patch: Option<&Patch>) -> Self {
        match patch {
            Some(patch) => self.with(Cause::Patch, Errors::throughout(patch.error())),
            None => self,
        }
    }

    /// All but those of a cause.
    #[must_use]
    pub fn without(&self, cause: Cause) -> Self {
        Self { parts: self.parts.iter().copied().filter(|(of, _)| *of != cause).collect() }
    }

    /// Of all causes together; `None` where nothing is estimated.
    pub fn total(&self) -> Option<Errors> {
        self.parts.iter().map(|(_, errors)| *errors).reduce(Errors::joined)
    }

    /// The names of the causes whose error is at least a fifth of the largest one's.
    pub fn main_causes(&self, measure: Measure) -> Vec<&'static str> {
        // Where the stress of one cause has no estimate, all are compared by the acceleration, as the total is.
        let has_stress = self.total().is_some_and(|total| !total.stress.is_nan());
        let measure = if has_stress { measure } else { Measure::Acceleration };
        let part = |errors: &Errors| errors.of(measure);
        let largest = self.parts.iter().map(|(_, errors)| part(errors)).fold(0.0, f64::max);
        // (What is no number is not known to be small.)
        let is_small = |errors: &Errors| part(errors) < MAIN_CAUSE * largest;
        self.parts.iter().filter(|(_, errors)| !is_small(errors)).map(|(cause, _)| cause.name()).collect()
    }

    /// The names of the causes.
    pub fn causes(&self) -> Vec<&'static str> {
        self.parts.iter().map(|(cause, _)| cause.name()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What adds little is not among the main causes; where one cause has no estimate of the stress, all count by the acceleration.
    #[test]
    fn main_causes_are_those_that_count() {
        let errors = |first_contact: f64, stress: f64| Errors { first_contact, history: first_contact, stress };
        let estimate = |of_basis: Errors| {
            ErrorEstimate::default().with(Cause::Basis, of_basis).with(Cause::Theory, errors(1e-3, 0.5))
        };
        let known = estimate(errors(2e-2, 3e-2));
        assert_eq!(known.main_causes(Measure::Acceleration), ["basis"]);
        assert_eq!(known.main_causes(Measure::Stress), ["theory"]);
        assert_eq!(estimate(errors(2e-2, f64::NAN)).main_causes(Measure::Stress), ["basis"]);
        // What is no number is not known to be small.
        let unknown = estimate(errors(f64::NAN, 3e-2));
        assert_eq!(unknown.main_causes(Measure::Acceleration), ["basis", "theory"]);
        assert!(ErrorEstimate::default().main_causes(Measure::Acceleration).is_empty());
    }
}
