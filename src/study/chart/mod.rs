//! Charts speed against accuracy: the cost of a result of given accuracy on a scene, for every method that applies.
//!
//! Each method is run from coarse to fine. Each setting is timed, and its acceleration is compared with a reference.
//! The reference is refined until two references agree to a tenth of the smallest error in the chart.

mod foreign;
mod front;
mod methods;
mod reference;
mod table;
mod timing;

pub use foreign::{Foreign, check_same_impact, comparable, foreign, history};
pub use front::{LEVELS, best, front};
pub use methods::{Ladder, Method, cleared, settings_of};
pub use reference::{Reference, refine};
pub use table::{csv, summary};
pub use timing::{Recording, Timed, spent, time};

use crate::error::Result;
use crate::study::history::{Difference, History};

/// Result of a setting: numbers, or the reason why there are none.
pub type Attempt = std::result::Result<Timed, String>;

/// Computes a setting or returns a stored result; `None` if interrupted. The times are the same on all ranks.
/// Collective.
pub type Bench<'a> = dyn FnMut(&str, &[String]) -> Result<Option<Attempt>> + 'a;

/// A point of the chart: one run of this program or of a peer.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Name of the method.
    pub method: String,
    /// The settings, or a peer's description of them.
    pub setting: String,
    /// Tolerance given to the program, if it was to choose the numerical settings itself (`auto`).
    pub auto: Option<f64>,
    /// Whether the run is from another program.
    pub is_foreign: bool,
    /// Wall time before the first step and of the steps, s.
    pub seconds: [f64; 2],
    /// Theory, number of unknowns and number of basis vectors, as text; empty for a peer.
    pub body: String,
    /// Number of steps or of solves.
    pub solves: usize,
    /// The program's estimate of the error of the whole history, over the peak.
    pub estimate: Option<f64>,
    /// Errors relative to the reference.
    pub errors: Errors,
}

/// Errors of a run, each relative to the reference's value; NaN if not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Largest difference of the acceleration in the first contact and over the whole history, over its peak, and
    /// difference of the largest tension.
    pub history: Difference,
    /// Error of the largest acceleration.
    pub peak: f64,
    /// Error of the impulse of the first contact.
    pub impulse: f64,
    /// Error of the duration of the first contact.
    pub contact: f64,
}

impl Point {
    /// Total wall time, s.
    pub fn total(&self) -> f64 {
        self.seconds[0] + self.seconds[1]
    }
}

impl Errors {
    /// Errors of a history compared with the reference.
    pub fn of(history: &History, reference: &History) -> Self {
        let relative = |own: Option<f64>, other: Option<f64>| match (own, other) {
            (Some(own), Some(other)) => (own / other - 1.0).abs(),
            (None, None) => 0.0,
            _ => f64::NAN,
        };
        let [own, other] = [history, reference].map(History::first);
        Self {
            history: history.difference(reference),
            peak: relative(Some(history.peak()), Some(reference.peak())),
            impulse: relative(own.map(|c| c.impulse), other.map(|c| c.impulse)),
            contact: relative(own.map(|c| c.end - c.start), other.map(|c| c.end - c.start)),
        }
    }

    /// Errors if only those of the acceleration are known, in the first contact and over the whole history.
    pub fn known(first: f64, whole: f64) -> Self {
        let history = Difference { first, whole, tension: f64::NAN };
        Self { history, peak: f64::NAN, impulse: f64::NAN, contact: f64::NAN }
    }
}

/// A completed run.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedRun {
    /// Name of the method.
    pub method: String,
    /// Overrides `KEY=VALUE` of the run.
    pub settings: Vec<String>,
    /// Result and timing of the run.
    pub timed: Timed,
}

/// All runs of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Runs {
    /// Completed runs.
    pub done: Vec<TimedRun>,
    /// Messages about the runs that were left out, and why.
    pub left_out: Vec<String>,
    /// Whether a signal interrupted the work.
    pub is_interrupted: bool,
}

/// Assumed factor in wall time from one setting to the next finer one, before two settings have been timed.
const ASSUMED_TIME_FACTOR: f64 = 4.0;

/// Runs all methods, each from coarse to fine. The next run is always the setting with the shortest expected time,
/// until it would exceed `budget` (s, for all runs). `told` is called with the number of settings that are now finished
/// or left out. Collective.
///
/// # Errors
/// Same as `bench`.
pub fn runs(methods: &[Method], budget: f64, bench: &mut Bench, told: &mut dyn FnMut(usize)) -> Result<Runs> {
    let mut runs = Runs::default();
    let begin = |method: &Method| Progress { left: method.rungs.len(), guess: method.guess, ..Progress::default() };
    let mut all: Vec<Progress> = methods.iter().map(begin).collect();
    let mut spent = 0.0;
    loop {
        let open = (0..all.len()).filter(|n| all[*n].left > 0);
        let Some(next) = open.min_by(|a, b| all[*a].expected().total_cmp(&all[*b].expected())) else { break };
        if spent + all[next].expected() > budget {
            break;
        }
        let Method { name, rungs, .. } = &methods[next];
        let settings = &rungs[rungs.len() - all[next].left];
        let Some(outcome) = bench(name, settings)? else {
            runs.is_interrupted = true;
            return Ok(runs);
        };
        match outcome {
            Ok(timed) => {
                spent += timed.spent;
                all[next].push(timed.spent);
                runs.done.push(TimedRun { method: name.clone(), settings: settings.clone(), timed });
            }
            Err(reason) => {
                all[next].left -= 1;
                runs.left_out.push(format!("{name} with {}: {reason}", settings.join(" ")));
            }
        }
        told(1);
    }
    for (method, progress) in methods.iter().zip(&all).filter(|(_, progress)| progress.left > 0) {
        let which = if progress.left == method.rungs.len() {
            "all".to_owned()
        } else {
            format!("its {} finest", progress.left)
        };
        runs.left_out.push(format!("{}: {which}, for the time that they take", method.name));
        told(progress.left);
    }
    Ok(runs)
}

/// Growth of the wall times of a method's settings.
#[derive(Debug, Clone, Default)]
struct Progress {
    /// Wall times of the last two settings, s.
    last: [f64; 2],
    /// Number of settings left.
    left: usize,
    /// Assumed time of the first setting, s.
    guess: f64,
}

impl Progress {
    fn push(&mut self, spent: f64) {
        self.last = [self.last[1], spent];
        self.left -= 1;
    }

    /// Expected time of the next setting, s.
    fn expected(&self) -> f64 {
        let [before, last] = self.last;
        if last == 0.0 {
            return self.guess;
        }
        last * if before > 0.0 { (last / before).max(1.0) } else { ASSUMED_TIME_FACTOR }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(name: &str, rungs: usize) -> Method {
        Method { name: name.into(), rungs: (0..rungs).map(|n| vec![format!("n={n}")]).collect(), guess: 0.0 }
    }

    fn timed(spent: f64) -> Timed {
        Timed { spent, ..Timed::default() }
    }

    /// The fastest settings are run first; those expected to take too long are left out; reasons are kept.
    #[test]
    fn the_budget_cuts_the_finest() {
        let methods = [method("cheap", 4), method("dear", 4), method("none", 2)];
        let mut asked = Vec::new();
        let mut bench = |name: &str, settings: &[String]| {
            let rung: i32 = settings[0][2..].parse().unwrap();
            asked.push(format!("{name}{rung}"));
            Ok(Some(match name {
                "cheap" => Ok(timed(0.1)),
                "dear" => Ok(timed(10f64.powi(rung))),
                _ => Err("refused".to_owned()),
            }))
        };
        let found = runs(&methods, 40.0, &mut bench, &mut |_| {}).unwrap();
        // The expected times are 0 for all at first; then 0.4 s for cheap and 4 s for dear.
        assert_eq!(asked, ["cheap0", "dear0", "none0", "none1", "cheap1", "cheap2", "cheap3", "dear1"], "{found:?}");
        // 11.4 s are spent and the next setting is expected to take 100 s.
        assert!(found.left_out.iter().any(|line| line.contains("dear: its 2 finest")), "{found:?}");
        assert_eq!(found.left_out.iter().filter(|line| line.contains("refused")).count(), 2);
        assert!(!found.is_interrupted);
    }

    #[test]
    fn an_interruption_ends_it() {
        let mut left = 2;
        let mut bench = |_: &str, _: &[String]| {
            left -= 1;
            Ok(if left < 0 { None } else { Some(Ok(timed(1.0))) })
        };
        let found = runs(&[method("a", 4)], 1e9, &mut bench, &mut |_| {}).unwrap();
        assert!(found.is_interrupted && found.done.len() == 2);
    }
}
