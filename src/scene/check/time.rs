//! The end of the run, the step and the scheme.

use super::super::values::Number;
use super::super::{Impactor, SceneError, Scheme, Source, Time, raw};
use super::numbers::show;
use super::word;
use crate::contact::hertz;

/// More steps than anyone waits for: a step that small is a slip.
const MOST_STEPS: f64 = 1e9;

pub(super) fn check(source: &Source, raw: &raw::Time, impactor: &Impactor) -> Result<Time, SceneError> {
    let end = source.positive("time.end", raw.end.0, "the end of the run in s")?;
    let step = match raw.step {
        Some(Number(step)) => source.positive("time.step", step, "the step in s")?,
        None => default_step(impactor, end),
    };
    if step > end {
        let message = format!("the step of {} s is longer than the run of {} s", show(step), show(end));
        return Err(source.error("time.step", message, "at most time.end"));
    }
    // A default step that underflowed to zero fails here too.
    if end / step > MOST_STEPS {
        let key = if raw.step.is_some() { "time.step" } else { "time.end" };
        let message = format!("the run has {:.1e} steps of {} s", end / step, show(step));
        return Err(source.error(key, message, "at most 1e9 steps: a longer step or an earlier end"));
    }
    let scheme = scheme(source, raw)?;
    Ok(Time { end, step, scheme })
}

fn scheme(source: &Source, raw: &raw::Time) -> Result<Scheme, SceneError> {
    word(source, "time.scheme", &raw.scheme, &["newmark"])?;
    let Number(beta) = raw.beta.unwrap_or(Number(0.25));
    let Number(gamma) = raw.gamma.unwrap_or(Number(0.5));
    source.finite("time.beta", &[beta])?;
    source.finite("time.gamma", &[gamma])?;
    if beta == 0.0 {
        let help = "above 0 and at most 1; 0.25 is the average acceleration";
        let message = "0 makes Newmark's method the explicit central difference, which this implicit step cannot take";
        return Err(source.error("time.beta", message, help));
    }
    if !(beta > 0.0 && beta <= 1.0) {
        let help = "above 0 and at most 1; 0.25 is the average acceleration";
        return Err(source.error("time.beta", format!("{beta} is out of range"), help));
    }
    if !(0.0..=1.0).contains(&gamma) {
        let help = "from 0 to 1; below 0.5 the method is unstable, above it damps";
        return Err(source.error("time.gamma", format!("{gamma} is out of range"), help));
    }
    Ok(Scheme::Newmark { beta, gamma })
}

/// A hundredth of the contact time on a half-space, and of the run where that is shorter, rounded down.
fn default_step(impactor: &Impactor, end: f64) -> f64 {
    let contact = hertz::contact_time(impactor.stiffness, impactor.mass, impactor.speed);
    round_down(contact.min(end) / 100.0)
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `value`; 0 when `value` is too small for one.
fn round_down(value: f64) -> f64 {
    let exponent = value.log10().floor() as i32;
    // The logarithm may be off in its last digit, hence the neighbours. Read as decimal text, so that the step is the
    // number that a person would type.
    [-1, 0, 1]
        .iter()
        .flat_map(|shift| [1, 2, 5].map(|digit| (digit, exponent.saturating_add(*shift))))
        .filter_map(|(digit, exponent)| format!("{digit}e{exponent}").parse::<f64>().ok())
        .filter(|candidate| *candidate <= value)
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::round_down;

    #[test]
    fn steps_are_rounded_down_to_one_two_five() {
        for (value, expected) in [
            (1.0, 1.0),
            (1.999, 1.0),
            (2e-5, 2e-5),
            (4.99e-5, 2e-5),
            (5e-6, 5e-6),
            (9.999_999e-7, 5e-7),
            (1e-6, 1e-6),
            (1e3, 1e3),
            (0.0, 0.0),
        ] {
            assert_eq!(round_down(value), expected, "{value}");
        }
    }
}
