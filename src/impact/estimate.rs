//! Estimated errors of the acceleration, the stresses and the deflection, by cause, and the rule that combines them.

use std::ops::{Add, Mul};

use serde::{Deserialize, Serialize};

use crate::contact::Patch;
use crate::scene::{Measure, Scene};

/// Cause of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The truncated basis.
    Basis,
    /// The size of the cells (discretisation error).
    Cells,
    /// The static stress field that is added near the impact point.
    LocalField,
    /// The theory of the body, compared with three-dimensional elasticity.
    Theory,
    /// The time steps.
    Steps,
    /// The contact patch that replaces the true contact area.
    Patch,
    /// Hertz's law of a half-space in a contact that is not small compared with the thickness.
    ContactLaw,
}

impl Cause {
    /// Name of the cause in messages and results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Basis => "basis",
            Self::Cells => "cells",
            Self::LocalField => "local field",
            Self::Theory => "theory",
            Self::Steps => "steps",
            Self::Patch => "patch",
            Self::ContactLaw => "contact law",
        }
    }
}

/// Exponent p with which errors of different causes are combined, (Σ errorᵖ)^(1/p). An exponent of 1 is the sum, an
/// upper bound; 2 is for independent errors of either sign. Measured on sixty impacts (docs/accuracy.md): with 1 the median estimate
/// was 3.5 times the error, and with 2 some estimates were too small.
const EXPONENT: f64 = 1.5;

/// Smallest ratio to the error of the largest cause at which another cause is named as well. An error of a fifth of the
/// largest increases the combined error by 6%.
const MAIN_CAUSE: f64 = 0.2;

/// Combines the estimated errors of two causes.
pub fn joined(one: f64, other: f64) -> f64 {
    // (A zero error leaves the other one unchanged to the last digit.)
    match (one == 0.0, other == 0.0) {
        (true, _) => other,
        (_, true) => one,
        _ => (one.powf(EXPONENT) + other.powf(EXPONENT)).powf(EXPONENT.recip()),
    }
}

/// Returns the error which, [`joined`] with `part`, makes `whole`. It is zero if the part is larger than the whole.
pub fn rest(whole: f64, part: f64) -> f64 {
    (whole.powf(EXPONENT) - part.powf(EXPONENT)).max(0.0).powf(EXPONENT.recip())
}

/// Estimated errors, each relative to the peak of its quantity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Errors {
    /// Error of the acceleration in the first contact.
    pub first_contact: f64,
    /// Error of the acceleration over the whole time history.
    pub history: f64,
    /// Error of the largest tension in the first contact, and in equilibrium before it; NaN if it is not estimated.
    pub stress: f64,
    /// Error of the largest tension in the whole run; NaN if it is not estimated.
    pub stress_history: f64,
    /// Error of the deflection under the impactor over the whole time history; NaN if it is not estimated.
    pub deflection: f64,
}

impl Errors {
    /// Returns errors that are all equal to `error`.
    pub fn throughout(error: f64) -> Self {
        Self { first_contact: error, history: error, stress: error, stress_history: error, deflection: error }
    }

    /// Error of the quantity that the tolerance applies to. For [`Measure::Deflection`] it is the larger error of the
    /// deflection and of the acceleration in the first contact. If the error of the quantity is not estimated, it is the
    /// error of the acceleration in the first contact.
    pub fn of(&self, measure: Measure) -> f64 {
        match self.own(measure) {
            unknown if unknown.is_nan() => self.first_contact,
            own if measure == Measure::Deflection => own.max(self.first_contact),
            own => own,
        }
    }

    /// Error of a quantity; NaN if it is not estimated.
    pub fn own(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Acceleration => self.first_contact,
            Measure::Stress => self.stress,
            Measure::Deflection => self.deflection,
        }
    }

    /// Computes each error from those of both.
    fn each(self, other: Self, of_both: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            first_contact: of_both(self.first_contact, other.first_contact),
            history: of_both(self.history, other.history),
            stress: of_both(self.stress, other.stress),
            stress_history: of_both(self.stress_history, other.stress_history),
            deflection: of_both(self.deflection, other.deflection),
        }
    }

    /// Combines both, quantity by quantity (see [`joined`]).
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        self.each(other, joined)
    }

    /// Returns the smaller error of each quantity; an error that is not estimated remains NaN.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        let least = |one: f64, other: f64| if one.is_nan() { one } else { one.min(other) };
        Self {
            first_contact: self.first_contact.min(other.first_contact),
            history: self.history.min(other.history),
            ..self.each(other, least)
        }
    }

    /// Returns the larger error of each quantity.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.each(other, f64::max)
    }
}

/// Rule that estimates the error of a force from its difference from the force on another basis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorRule {
    /// Ratios of the errors to the differences; that of the whole history is for differences after the first contact.
    pub factors: Errors,
    /// Error that the difference does not show, for all quantities.
    pub least: f64,
}

impl ErrorRule {
    /// Returns a rule with the same factor for all quantities.
    pub fn with_factor(factor: f64) -> Self {
        Self { factors: Errors::throughout(factor), least: 0.0 }
    }

    /// Returns the errors for the given differences.
    pub fn errors(&self, difference: Errors) -> Errors {
        let Self { factors, least } = self;
        let first_contact = factors.first_contact * difference.first_contact;
        let is_largest_later = difference.history > difference.first_contact;
        let errors = Errors {
            first_contact,
            history: if is_largest_later { factors.history * difference.history } else { first_contact },
            stress: factors.stress * difference.stress,
            stress_history: factors.stress * difference.stress_history,
            deflection: factors.deflection * difference.deflection,
        };
        errors.joined(Errors::throughout(*least))
    }
}

/// Sums errors of causes that may have the same sign.
impl Add for Errors {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.each(other, f64::add)
    }
}

impl Mul<Errors> for f64 {
    type Output = Errors;

    fn mul(self, errors: Errors) -> Errors {
        Errors::throughout(self).each(errors, f64::mul)
    }
}

/// Formats a number beside a limit, with two digits or as many as are needed to show whether it is above the limit.
pub fn beside(number: f64, limit: f64) -> String {
    let text = |digits: usize| format!("{number:.digits$e}");
    let is_seen = |text: &String| text.parse::<f64>().is_ok_and(|shown| (shown > limit) == (number > limit));
    (1..4).map(text).find(is_seen).unwrap_or_else(|| text(4))
}

/// Error below which an estimate is only rounding.
const ROUNDING: f64 = 1e-9;

/// Formats an estimated error with two digits. If it is only rounding (below 1e-9), only that limit is printed.
pub fn estimated(error: f64) -> String {
    if error < ROUNDING { format!("below {ROUNDING:e}") } else { format!("{error:.1e}") }
}

/// Errors by their causes; the total estimate [`joined`] combines them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorEstimate {
    parts: Vec<(Cause, Errors)>,
}

impl ErrorEstimate {
    /// Adds or replaces the errors of a cause.
    #[must_use]
    pub fn with(mut self, cause: Cause, errors: Errors) -> Self {
        match self.parts.iter_mut().find(|(of, _)| *of == cause) {
            Some((_, known)) => *known = errors,
            None => self.parts.push((cause, errors)),
        }
        self
    }

    /// Adds or replaces the error of the contact law of a scene, if anything else is estimated.
    #[must_use]
    pub fn with_law(self, scene: &Scene) -> Self {
        let of_law = scene.impactor.error_of_law();
        let is_new = of_law > 0.0 && !self.parts.is_empty();
        let is_set = is_new || self.of(Cause::ContactLaw).is_some();
        if is_set { self.with(Cause::ContactLaw, Errors::throughout(of_law)) } else { self }
    }

    /// Adds the error of a contact patch, if there is one and its error is known.
    #[must_use]
    pub fn with_patch(self, patch: Option<&Patch>) -> Self {
        match patch.and_then(Patch::error) {
            // The radius of the patch changes the peak of the force. Its effect on the deflection is not known.
            Some(error) => self.with(Cause::Patch, Errors { deflection: f64::NAN, ..Errors::throughout(error) }),
            None => self,
        }
    }

    /// Errors of a cause; `None` if they are not estimated.
    pub fn of(&self, cause: Cause) -> Option<Errors> {
        self.parts.iter().find(|(of, _)| *of == cause).map(|(_, errors)| *errors)
    }

    /// Combined errors of all causes; `None` if nothing is estimated.
    pub fn total(&self) -> Option<Errors> {
        self.parts.iter().map(|(_, errors)| *errors).reduce(Errors::joined)
    }

    /// Errors of the largest tension; NaN unless the error of the cells is among the causes. Without it, the others are no
    /// estimate: under the impact point the tension depends mostly on the cells.
    pub fn of_tension(&self) -> Errors {
        let has_cells = self.parts.iter().any(|(cause, _)| *cause == Cause::Cells);
        let unknown = Errors { stress: f64::NAN, stress_history: f64::NAN, ..Errors::default() };
        self.total().filter(|_| has_cells).unwrap_or(unknown)
    }

    /// Error of the deflection under the impactor; NaN unless the error of the basis is among the causes.
    pub fn of_deflection(&self) -> f64 {
        let has_basis = self.parts.iter().any(|(cause, _)| *cause == Cause::Basis);
        self.total().filter(|_| has_basis).map_or(f64::NAN, |errors| errors.deflection)
    }

    /// Causes to be mended if the total is above the tolerance: those whose error is at least a fifth of the largest one, or,
    /// if the error of the theory, the local field or the contact law alone is above the tolerance, those whose error is above
    /// the tolerance and at least half of it. Finer cells do not help against these three.
    pub fn causes_to_mend(&self, measure: Measure, tolerance: f64) -> Vec<Cause> {
        let measure = self.known(measure);
        let is_fixed = |cause: Cause| matches!(cause, Cause::Theory | Cause::LocalField | Cause::ContactLaw);
        let fixed = self.parts.iter().filter(|(cause, _)| is_fixed(*cause));
        let largest = fixed.map(|(_, errors)| errors.of(measure)).fold(0.0, f64::max);
        if largest <= tolerance {
            return self.main_causes(measure);
        }
        let is_large = |errors: &Errors| errors.of(measure) > tolerance && errors.of(measure) >= 0.5 * largest;
        self.parts.iter().filter(|(_, errors)| is_large(errors)).map(|(cause, _)| *cause).collect()
    }

    /// The quantity by which causes are compared: if its error is unknown for one cause, the acceleration, as in the total.
    fn known(&self, measure: Measure) -> Measure {
        let is_known = self.total().is_some_and(|total| !total.own(measure).is_nan());
        if is_known { measure } else { Measure::Acceleration }
    }

    /// Causes whose error is at least a fifth of the largest one.
    pub fn main_causes(&self, measure: Measure) -> Vec<Cause> {
        let measure = self.known(measure);
        self.main_causes_by(|errors| errors.of(measure))
    }

    /// Causes whose error of the acceleration over the whole history is at least a fifth of the largest one.
    pub fn main_causes_of_history(&self) -> Vec<Cause> {
        self.main_causes_by(|errors| errors.history)
    }

    fn main_causes_by(&self, part: impl Fn(&Errors) -> f64) -> Vec<Cause> {
        let largest = self.parts.iter().map(|(_, errors)| part(errors)).fold(0.0, f64::max);
        // (A NaN error is not known to be small.)
        let is_small = |errors: &Errors| part(errors) < MAIN_CAUSE * largest;
        self.parts.iter().filter(|(_, errors)| !is_small(errors)).map(|(cause, _)| *cause).collect()
    }

    /// Names of the causes of the estimated error of a quantity. The local field affects stresses only.
    pub fn causes(&self, measure: Measure) -> Vec<&'static str> {
        let is_of_stress = self.known(measure) == Measure::Stress;
        let counts = |cause: Cause| cause != Cause::LocalField || is_of_stress;
        self.parts.iter().filter(|(cause, _)| counts(*cause)).map(|(cause, _)| cause.name()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_rounding_is_not_printed() {
        let shown = [1.1e-16, 0.0, 2.04e-3, 0.5].map(estimated);
        assert_eq!(shown, ["below 1e-9", "below 1e-9", "2.0e-3", "5.0e-1"]);
    }

    /// Small errors are not among the main causes. If one cause has no estimate of the stress, all causes are compared
    /// by the acceleration.
    #[test]
    fn main_causes_are_those_that_count() {
        let errors = |first_contact: f64, stress: f64| Errors {
            first_contact,
            history: first_contact,
            stress,
            stress_history: stress,
            deflection: f64::NAN,
        };
        let estimate = |of_basis: Errors| {
            ErrorEstimate::default().with(Cause::Basis, of_basis).with(Cause::Theory, errors(1e-3, 0.5))
        };
        let known = estimate(errors(2e-2, 3e-2));
        assert_eq!(known.main_causes(Measure::Acceleration), [Cause::Basis]);
        assert_eq!(known.main_causes(Measure::Stress), [Cause::Theory]);
        assert_eq!(estimate(errors(2e-2, f64::NAN)).main_causes(Measure::Stress), [Cause::Basis]);
        // A NaN error is not known to be small.
        let unknown = estimate(errors(f64::NAN, 3e-2));
        assert_eq!(unknown.main_causes(Measure::Acceleration), [Cause::Basis, Cause::Theory]);
        assert!(ErrorEstimate::default().main_causes(Measure::Acceleration).is_empty());
    }

    #[test]
    fn a_theory_above_the_tolerance_is_mended_first() {
        let estimate = ErrorEstimate::default()
            .with(Cause::Basis, Errors::throughout(9e-3))
            .with(Cause::Theory, Errors::throughout(1.1e-2));
        assert_eq!(estimate.causes_to_mend(Measure::Acceleration, 1e-2), [Cause::Theory]);
        assert_eq!(estimate.causes_to_mend(Measure::Acceleration, 8e-3), [Cause::Basis, Cause::Theory]);
        assert_eq!(estimate.causes_to_mend(Measure::Acceleration, 2e-2), [Cause::Basis, Cause::Theory]);
    }

    /// Finer cells do not help if the local field alone is above the tolerance. It has no error of the acceleration.
    #[test]
    fn a_local_field_above_the_tolerance_is_mended_first() {
        let of_stress = |stress: f64| Errors { stress, ..Errors::throughout(8e-3) };
        let local_field = Errors { stress: 1.2e-2, ..Errors::default() };
        let estimate =
            ErrorEstimate::default().with(Cause::Cells, of_stress(6e-3)).with(Cause::LocalField, local_field);
        assert_eq!(estimate.causes_to_mend(Measure::Stress, 1e-2), [Cause::LocalField]);
        assert_eq!(estimate.causes_to_mend(Measure::Stress, 1.3e-2), [Cause::Cells, Cause::LocalField]);
        assert_eq!(estimate.causes_to_mend(Measure::Acceleration, 1e-2), [Cause::Cells]);
        assert_eq!(estimate.causes(Measure::Stress), ["cells", "local field"]);
        assert_eq!(estimate.causes(Measure::Acceleration), ["cells"]);
        // Without an estimate of the tension the error is that of the acceleration.
        let unknown = estimate.with(Cause::Basis, of_stress(f64::NAN));
        assert_eq!(unknown.causes(Measure::Stress), ["cells", "basis"]);
    }
}
