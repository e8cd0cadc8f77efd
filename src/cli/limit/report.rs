//! Reports the result of the search, as text or as JSON.

use std::path::Path;

use serde::Serialize;

use crate::scene::unit;
use crate::study::limit::{Found, Range};

use crate::record::stress::StrengthVerdict;

use super::super::{coordinate, say, short};
use super::table::{UNCERTAINTY, VALUE, significant, with_unit};
use super::trial::{Trial, Utilisation};

/// Position of the range relative to the strength.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Outcome {
    /// The strength is reached for the first time at the value.
    Reached,
    /// The strength is exceeded from the lower end up to the value.
    PassedUpToValue,
    /// The strength is exceeded in the whole range.
    PassedEverywhere,
    /// The strength is reached nowhere in the range.
    ReachedNowhere,
}

/// All facts, in SI units; unknown values are null.
#[derive(Debug, Serialize)]
pub(super) struct Report<'a> {
    key: &'a str,
    unit: &'static str,
    range: [f64; 2],
    outcome: Outcome,
    limit: Option<LimitFacts<'a>>,
    /// Verdict on the whole range: "not exceeded" needs an estimate in every run.
    verdict: &'static str,
    /// Run with the largest ratio of tension to strength.
    largest: &'a Trial,
    /// Run with the smallest ratio of tension to strength.
    smallest: &'a Trial,
    runs: usize,
    /// Number of runs added to the grid where a lower limit could be hidden.
    added: usize,
    /// Whether the curvature of the ratio excludes a lower limit in all intervals below.
    is_lowest_by_curvature: bool,
    /// All runs by ascending value.
    samples: Vec<&'a Trial>,
    /// Path of the result that is written.
    output: Option<&'a Path>,
    #[serde(skip)]
    warnings: &'a [String],
}

#[derive(Debug, Serialize)]
struct LimitFacts<'a> {
    #[serde(flatten)]
    run: &'a Trial,
    uncertainty: f64,
    is_jump: bool,
    is_converged: bool,
    /// On which side of the limit the strength is not exceeded: "below" or "above".
    safe_side: &'static str,
    /// Nearest computed value above the limit that contradicts this, because there is another limit.
    crossed_again_at: Option<f64>,
}

/// The lowest computed value above the limit at which the strength is exceeded, if it is not exceeded just above the limit,
/// or the other way round.
fn crossed_again(trials: &[Trial], limit: f64, is_rising: bool) -> Option<f64> {
    let is_contrary = |trial: &&Trial| trial.value > limit && (trial.utilisation.ratio >= 1.0) != is_rising;
    trials.iter().filter(is_contrary).map(|trial| trial.value).reduce(f64::min)
}

impl<'a> Report<'a> {
    /// Report on a search, with the path of the result to be written; `None` without a run.
    pub fn new(
        range: &'a Range,
        tolerance: f64,
        found: &Found,
        trials: &'a [Trial],
        output: Option<&'a Path>,
    ) -> Option<Self> {
        let at = found.root.and_then(|root| trials.iter().find(|trial| trial.value == root.at.value).zip(Some(root)));
        let limit = at.map(|(run, root)| {
            // Not smaller than the tolerance, even if the estimated error is.
            let error = run.utilisation.error_estimate;
            let error = if error.is_nan() { error } else { error.max(tolerance) };
            LimitFacts {
                run,
                uncertainty: (error + run.utilisation.ratio.ln().abs()) * root.sensitivity,
                is_jump: root.is_jump,
                is_converged: root.is_converged,
                safe_side: if root.is_rising { "below" } else { "above" },
                crossed_again_at: crossed_again(trials, run.value, root.is_rising),
            }
        });
        let mut samples: Vec<&Trial> = trials.iter().collect();
        samples.sort_by(|a, b| a.value.total_cmp(&b.value));
        let by_ratio = |a: &&&Trial, b: &&&Trial| a.utilisation.ratio.total_cmp(&b.utilisation.ratio);
        let outcome = match (found.root, samples.first()?) {
            (Some(root), _) if root.is_rising => Outcome::Reached,
            (Some(_), _) => Outcome::PassedUpToValue,
            (None, first) if first.utilisation.ratio >= 1.0 => Outcome::PassedEverywhere,
            (None, _) => Outcome::ReachedNowhere,
        };
        let verdicts: Vec<StrengthVerdict> = trials.iter().map(|trial| trial.utilisation.verdict()).collect();
        let first = [StrengthVerdict::Exceeded, StrengthVerdict::Undecided, StrengthVerdict::NotExceeded];
        let verdict = first.into_iter().find(|verdict| verdicts.contains(verdict)).map_or("", StrengthVerdict::name);
        // Without a limit, the warnings are those of the first run that leaves it open.
        let undecided = trials.iter().find(|trial| trial.utilisation.verdict() == StrengthVerdict::Undecided);
        let told = at.map(|(trial, _)| trial).or(undecided);
        Some(Self {
            key: &range.key,
            unit: unit(&range.key),
            range: [range.from, range.to],
            outcome,
            output: output.filter(|_| limit.is_some()),
            limit,
            verdict,
            largest: samples.iter().max_by(by_ratio)?,
            smallest: samples.iter().min_by(by_ratio)?,
            runs: trials.len(),
            added: found.added,
            is_lowest_by_curvature: found.is_complete,
            samples,
            warnings: told.map_or(&[], |trial| &trial.utilisation.warnings),
        })
    }

    /// Prints the report in a few lines.
    pub fn print(&self) {
        let [from, to] = self.range.map(|end| self.shown(end));
        let of = |run: &Trial| format!("{}, at {} = {}", short(run.utilisation.ratio), self.key, self.shown(run.value));
        match (&self.limit, self.outcome) {
            (Some(limit), _) => self.print_limit(limit),
            (None, Outcome::PassedEverywhere) => say(format_args!(
                "the strength is already exceeded at the lower end, and everywhere from {from} to {to}: the ratio of tension to strength is \
                 at most {}, and at least {}",
                of(self.largest),
                of(self.smallest)
            )),
            (None, _) => {
                let is_open = self.verdict == StrengthVerdict::Undecided.name();
                let open =
                    if is_open { "; with the errors of the tension, whether it is exceeded is undecided" } else { "" };
                say(format_args!(
                    "the strength is reached nowhere from {from} to {to}: the largest ratio of tension to strength is {}{open}",
                    of(self.largest)
                ));
            }
        }
        say(format_args!("{} runs", self.runs));
    }

    fn print_limit(&self, limit: &LimitFacts) {
        let Trial { value, utilisation } = limit.run;
        let Utilisation { ratio, strength, face, time, point, peak_force, .. } = utilisation;
        let (lower, value) = (self.samples.iter().filter(|run| run.value < *value).count(), significant(*value, VALUE));
        let value = match limit.uncertainty {
            none if none.is_nan() => {
                format!("{}, without an estimate of its uncertainty", with_unit(&value, self.key))
            }
            uncertainty => format!("{value} ± {}", with_unit(&significant(uncertainty, UNCERTAINTY), self.key)),
        };
        say(format_args!(
            "limit: {} = {value}, where the largest tension is {} of the strength; the strength is not exceeded {} it{}",
            self.key,
            short(*ratio),
            limit.safe_side,
            match (limit.crossed_again_at, limit.safe_side) {
                (None, _) => String::new(),
                (Some(value), "below") => format!(", nor at {}", self.shown(value)),
                (Some(value), _) => format!(", but it is exceeded at {}", self.shown(value)),
            }
        ));
        let [x, y, z] = point.map(coordinate);
        say(format_args!(
            "strength {} MPa reached on face {face:?} at {} ms, at [{x}, {y}, {z}] m; peak force {} N",
            short(1e-6 * strength),
            short(1e3 * time),
            short(*peak_force)
        ));
        let from = self.shown(self.range[0]);
        let below = match self.outcome {
            Outcome::PassedUpToValue => {
                format!("the strength is already exceeded at the lower end, {from}, and up to the limit")
            }
            _ => format!("no lower value from {from} on reaches the strength"),
        };
        let rest = match self.is_lowest_by_curvature {
            true => "the curvature of the tension between them allows no other limit",
            false => "another limit may lie between them",
        };
        let added = match self.added {
            0 => String::new(),
            added => format!("; added to check this: {added}"),
        };
        let computed = if lower == 1 { "1 value was".to_owned() } else { format!("{lower} values were") };
        say(format_args!("{below}: {computed} computed below the limit, and {rest}{added}"));
    }

    /// Warnings about the answer, for standard error.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = self.warnings.to_vec();
        if let Some(LimitFacts { is_jump, is_converged, crossed_again_at, .. }) = self.limit {
            if is_jump {
                remarks.push(format!(
                    "the tension jumps at the limit of {}: no value near it is just at the strength",
                    self.key
                ));
            }
            if !is_converged {
                remarks.push(format!(
                    "the search stopped after {} runs, before the limit of {} was accurate enough: search a smaller range",
                    self.runs, self.key
                ));
            }
            if let Some(value) = crossed_again_at {
                remarks.push(format!(
                    "between the limit and {} = {} there is another limit; search smaller ranges",
                    self.key,
                    self.shown(value)
                ));
            }
        }
        if !self.is_lowest_by_curvature {
            let message = "between the values that were computed the tension may reach the strength elsewhere: search a smaller range";
            remarks.push(message.to_owned());
        }
        if self.samples.len() > 1 && self.largest.utilisation.ratio == self.smallest.utilisation.ratio {
            remarks.push(format!("--vary {} has no effect on the tension", self.key));
        }
        remarks
    }

    fn shown(&self, value: f64) -> String {
        with_unit(&significant(value, VALUE), self.key)
    }
}
