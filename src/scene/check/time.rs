//! Checks the end of the run, the time step and the scheme.

use std::ops::Bound;

use super::super::values::Number;
use super::super::{Initial, Load, SceneError, Scheme, Source, Support, Time, raw};
use super::numbers::show;
use super::word;

/// Largest number of steps. A smaller time step is a mistake.
const MOST_STEPS: f64 = 1e9;

/// Checks the table `time`. `against` is the key that excludes modal coordinates, with the reason.
pub(super) fn check(source: &Source, raw: &raw::Time, against: Option<(String, String)>) -> Result<Time, SceneError> {
    let end = source.positive("time.end", raw.end.0, "the end of the run in s")?;
    let step = raw.step.map(|Number(step)| step_within(source, step, end)).transpose()?;
    let asked = raw.scheme.as_deref() == Some("modal");
    if let (true, Some((key, reason))) = (asked, &against) {
        let help = "another scheme, as \"newmark\", or another value of that key".to_owned();
        return Err(source.conflict("time.scheme", key, reason.clone(), help));
    }
    // A parameter of a scheme selects that scheme.
    let parameters = raw.beta.is_some() || raw.gamma.is_some() || raw.rho_inf.is_some() || raw.allow_unstable.is_some();
    let modal = asked || (raw.scheme.is_none() && against.is_none() && !parameters);
    let initial = match word(source, "time.initial", &raw.initial, &raw::INITIALS)? {
        "rest" => Initial::Rest,
        _ => Initial::Equilibrium,
    };
    Ok(Time { end, step, initial, modal, scheme: scheme(source, raw)? })
}

/// Refuses an initial equilibrium if loads act along an axis along which no support acts.
///
/// # Errors
/// If there is such an axis. Loads on an unsupported part of a body are found later, when the body is built.
pub(super) fn equilibrium(source: &Source, time: &Time, load: &Load, supports: &[Support]) -> Result<(), SceneError> {
    if time.initial == Initial::Rest {
        return Ok(());
    }
    let holds = |support: &Support, axis: usize| support.stiffness_along(axis) > 0.0;
    let is_loaded = |axis: usize| load.acts_along(axis) || load.traction.iter().any(|entry| entry.value[axis] != 0.0);
    let unheld = |axis: &usize| is_loaded(*axis) && !supports.iter().any(|support| holds(support, *axis));
    let Some(axis) = (0..3).find(unheld) else { return Ok(()) };
    let message = format!("there is no equilibrium: loads act along {}, and no support does", ["x", "y", "z"][axis]);
    Err(source.error("time.initial", message, "supports that hold the loads, or `initial = \"rest\"`"))
}

fn step_within(source: &Source, step: f64, end: f64) -> Result<f64, SceneError> {
    source.positive("time.step", step, "the step in s")?;
    if step > end {
        let message = format!("the step of {} s is longer than the run of {} s", show(step), show(end));
        return Err(source.error("time.step", message, "at most time.end"));
    }
    if end / step > MOST_STEPS {
        let message = format!("the run has {:.1e} steps of {} s", end / step, show(step));
        return Err(source.error("time.step", message, "at most 1e9 steps: a longer step or an earlier end"));
    }
    Ok(step)
}

fn scheme(source: &Source, raw: &raw::Time) -> Result<Scheme, SceneError> {
    let name = word(source, "time.scheme", &raw.scheme, &raw::SCHEMES)?;
    let parameters = [
        ("beta", raw.beta.is_some(), "newmark"),
        ("gamma", raw.gamma.is_some(), "newmark"),
        ("rho_inf", raw.rho_inf.is_some(), "generalized-alpha"),
        ("allow_unstable", raw.allow_unstable.is_some(), "central-difference"),
    ];
    if let Some((key, _, owner)) = parameters.into_iter().find(|(_, given, owner)| *given && *owner != name) {
        let message = match &raw.scheme {
            Some(_) => format!("the scheme \"{name}\" has no `{key}`"),
            None => format!("`{key}` is of the scheme \"{owner}\", and no scheme is given"),
        };
        let help = match &raw.scheme {
            Some(_) => format!("take it out: it belongs to \"{owner}\""),
            None => format!("take it out, or add `scheme = \"{owner}\"`"),
        };
        return Err(source.conflict(&format!("time.{key}"), "time.scheme", message, help));
    }
    match name {
        "newmark" | "modal" => newmark(source, raw),
        "generalized-alpha" => {
            let Number(rho_inf) = raw.rho_inf.unwrap_or(Number(0.8));
            let help = "from 0 to 1: what is left of the highest frequencies after a step";
            source.in_range("time.rho_inf", rho_inf, 0.0..=1.0, help)?;
            Ok(Scheme::GeneralizedAlpha { rho_inf })
        }
        "energy" => Ok(Scheme::Energy),
        _ => Ok(Scheme::CentralDifference { allow_unstable: raw.allow_unstable.unwrap_or(false) }),
    }
}

fn newmark(source: &Source, raw: &raw::Time) -> Result<Scheme, SceneError> {
    let Number(beta) = raw.beta.unwrap_or(Number(0.25));
    let Number(gamma) = raw.gamma.unwrap_or(Number(0.5));
    let help = "above 0 and at most 1; 0.25 is the average acceleration";
    if beta == 0.0 {
        let message = "0 makes Newmark's method explicit: that is `scheme = \"central-difference\"`";
        return Err(source.error("time.beta", message, help));
    }
    source.in_range("time.beta", beta, (Bound::Excluded(0.0), Bound::Included(1.0)), help)?;
    let help = "from 0 to 1; below 0.5 the method is unstable, above it damps";
    source.in_range("time.gamma", gamma, 0.0..=1.0, help)?;
    Ok(Scheme::Newmark { beta, gamma })
}
