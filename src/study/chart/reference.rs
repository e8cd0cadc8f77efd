//! Computes the reference of a chart: the solid, refined until two references agree.

use crate::error::{Error, Result};
use crate::study::history::{Difference, History};

use super::{Bench, Ladder, Timed, TimedRun};

/// Tolerances of the references of a solid in modal coordinates.
const TOLERANCES: [f64; 6] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5];

/// Number of steps per contact on a half-space for references in modal coordinates. Their error is then below 1e-7, and
/// so is the error of linear interpolation between two steps.
const MODAL: f64 = 4000.0;

/// Numbers of steps per contact for references of a body without modal coordinates.
const STEPPED: [f64; 6] = [500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0];

/// Largest difference of two references that agree, relative to the smallest error of the runs.
const AGREEMENT: f64 = 0.1;

/// Assumed factor in wall time from one reference to the next, before two have been timed.
const ASSUMED_TIME_FACTOR: f64 = 5.0;

/// The reference that errors are measured against.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// The settings, as text.
    pub setting: String,
    /// Time history of the acceleration; empty on all ranks except the first.
    pub history: History,
    /// Difference from the previous, coarser reference; NaN if the reference was given by the user.
    pub agreement: Difference,
}

impl Reference {
    /// Smallest errors that the reference resolves, in the first contact and over the whole history.
    pub fn floor(&self) -> Difference {
        let Difference { first, whole, tension } = self.agreement;
        Difference { first: first / AGREEMENT, whole: whole / AGREEMENT, tension: tension / AGREEMENT }
    }
}

/// Refines references until two agree to a tenth of the smallest error of the runs, or until a finer one would exceed
/// `budget` (s, for all references). `decide` returns the first rank's decision on all ranks. Returns `None` if
/// interrupted. Collective.
///
/// # Errors
/// The error of a reference, if fewer than two could be computed; or the same as `bench`.
pub fn refine(
    ladder: &Ladder,
    runs: &[TimedRun],
    budget: f64,
    bench: &mut Bench,
    decide: &dyn Fn(bool) -> bool,
) -> Result<Option<Reference>> {
    let mut found: Option<(Timed, String)> = None;
    let mut best: Option<Reference> = None;
    let (mut spent, mut expected, mut reason) = (0.0, 0.0, String::new());
    for settings in rungs(ladder) {
        if best.is_some() && spent + expected > budget {
            break;
        }
        let outcome = match bench("reference", &settings)? {
            None => return Ok(None),
            Some(outcome) => outcome,
        };
        let timed = match outcome {
            Ok(timed) => timed,
            // After two references a failure means that this setting is too fine. Before, it may be too coarse, and
            // finer ones are tried.
            Err(_) if best.is_some() => break,
            Err(why) => {
                reason = why;
                continue;
            }
        };
        let growth = found.as_ref().map_or(ASSUMED_TIME_FACTOR, |(before, _)| (timed.spent / before.spent).max(1.5));
        (spent, expected) = (spent + timed.spent, growth * timed.spent);
        let setting = settings.join(" ");
        if let Some((before, _)) = found.replace((timed.clone(), setting.clone())) {
            let agreement = before.history.difference(&timed.history);
            let smallest = smallest(runs, &timed.history);
            let agree = agreement.first <= AGREEMENT * smallest.first && agreement.whole <= AGREEMENT * smallest.whole;
            best = Some(Reference { setting, history: timed.history, agreement });
            if decide(agree) {
                break;
            }
        }
    }
    best.map(Some).ok_or_else(|| Error::Solve(format!("no two references to measure by: {reason}")))
}

/// Settings of the references, from coarse to fine.
fn rungs(ladder: &Ladder) -> Vec<Vec<String>> {
    let solid = "body.model=solid".to_owned();
    if ladder.is_linear() {
        let rung = |tolerance| vec![solid.clone(), format!("accuracy.tolerance={tolerance:e}"), ladder.step(MODAL)];
        return TOLERANCES.map(rung).to_vec();
    }
    let rung = |a_contact| vec![solid.clone(), "time.scheme=energy".to_owned(), ladder.step(a_contact)];
    STEPPED.map(rung).to_vec()
}

/// Smallest errors of the runs relative to a reference.
fn smallest(runs: &[TimedRun], reference: &History) -> Difference {
    let none = f64::INFINITY;
    let mut smallest = Difference { first: none, whole: none, tension: none };
    for run in runs {
        let Difference { first, whole, tension } = run.timed.history.difference(reference);
        smallest = Difference {
            first: smallest.first.min(first),
            whole: smallest.whole.min(whole),
            tension: smallest.tension.min(tension),
        };
    }
    smallest
}
