//! What errors are measured by: the solid itself, refined until two references agree.

use crate::error::{Error, Result};
use crate::study::history::{Difference, History};

use super::{Bench, Ladder, Run, Timed};

/// Tolerances of the solid in modal coordinates.
const TOLERANCES: [f64; 6] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5];

/// Steps a contact on a half-space: of modal coordinates, whose own error is then below 1e-7, as is that of a straight line between two
/// of them.
const MODAL: f64 = 4000.0;

/// Those of a body without modes, refined by factors of two.
const STEPPED: [f64; 6] = [500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0];

/// Two references agree if they differ by less than this part of the smallest error.
const AGREEMENT: f64 = 0.1;

/// A finer reference may take so many times as long as the last one, before more is known.
const GROWTH: f64 = 5.0;

/// What errors are measured by.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// What was set.
    pub setting: String,
    /// Its acceleration; empty on ranks but the first.
    pub history: History,
    /// By how much the one before it differs; NaN where it was given.
    pub agreement: Difference,
}

impl Reference {
    /// Errors below this are not known, in the first contact and over all.
    pub fn floor(&self) -> Difference {
        let Difference { first, whole, tension } = self.agreement;
        Difference { first: first / AGREEMENT, whole: whole / AGREEMENT, tension: tension / AGREEMENT }
    }
}

/// Refines references until two agree to a tenth of the smallest error of the runs, or a finer one would take longer than `budget` (s) in
/// all. `decide` makes the first rank's answer every rank's. `None` where it was interrupted. Collective.
///
/// # Errors
/// That of a reference, where there are no two; those of `bench`.
pub fn refine(
    ladder: &Ladder,
    runs: &[Run],
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
            // Too fine for what it needs; or too coarse.
            Err(_) if best.is_some() => break,
            Err(why) => {
                reason = why;
                continue;
            }
        };
        let growth = found.as_ref().map_or(GROWTH, |(before, _)| (timed.spent / before.spent).max(1.5));
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

/// The settings of the references.
fn rungs(ladder: &Ladder) -> Vec<Vec<String>> {
    let solid = "body.model=solid".to_owned();
    if ladder.is_linear() {
        let rung = |tolerance| vec![solid.clone(), format!("accuracy.tolerance={tolerance:e}"), ladder.step(MODAL)];
        return TOLERANCES.map(rung).to_vec();
    }
    let rung = |a_contact| vec![solid.clone(), "time.scheme=energy".to_owned(), ladder.step(a_contact)];
    STEPPED.map(rung).to_vec()
}

/// The smallest errors of the runs.
fn smallest(runs: &[Run], reference: &History) -> Difference {
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
