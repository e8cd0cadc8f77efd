//! Speed against accuracy: what an answer of a given accuracy costs on a scene, by every method that has one.
//!
//! Each method is run from coarse to fine, each setting timed and its acceleration measured against that of a reference, which is
//! itself refined until two of them agree to a tenth of the smallest error that is charted.

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

/// What came of a setting: numbers, or a reason why there are none.
pub type Attempt = std::result::Result<Timed, String>;

/// Computes a setting, or knows what it was; `None` where that was interrupted. The times of all ranks are the same. Collective.
pub type Bench<'a> = dyn FnMut(&str, &[String]) -> Result<Option<Attempt>> + 'a;

/// A run, or a peer's.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The method's name.
    pub method: String,
    /// What was set, or what a peer says of it.
    pub setting: String,
    /// The tolerance that the program itself was to find the means for.
    pub auto: Option<f64>,
    /// Whether another program made it.
    pub is_foreign: bool,
    /// Wall time before the first step, and of the steps, s.
    pub seconds: [f64; 2],
    /// What the body was made of.
    pub body: String,
    /// Steps, or solves.
    pub solves: usize,
    /// The program's own estimate of the error of the whole history.
    pub estimate: Option<f64>,
    /// What it is off by.
    pub errors: Errors,
}

/// What a run is off by, each over the reference's value; NaN where that is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Largest difference of the acceleration over its peak, in the first contact and over all, and that of the largest tension.
    pub history: Difference,
    /// Largest acceleration.
    pub peak: f64,
    /// Impulse of the first contact.
    pub impulse: f64,
    /// Duration of the first contact.
    pub contact: f64,
}

impl Point {
    /// Wall time, s.
    pub fn total(&self) -> f64 {
        self.seconds[0] + self.seconds[1]
    }
}

impl Errors {
    /// Of a history against the reference's.
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

    /// Of which the acceleration's alone are known.
    pub fn known(first: f64, whole: f64) -> Self {
        let history = Difference { first, whole, tension: f64::NAN };
        Self { history, peak: f64::NAN, impulse: f64::NAN, contact: f64::NAN }
    }
}

/// A run that was done.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The method's name.
    pub method: String,
    /// What was set.
    pub settings: Vec<String>,
    /// What came of it.
    pub timed: Timed,
}

/// All runs of a chart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Runs {
    /// Those that were done.
    pub done: Vec<Run>,
    /// What was not, and why.
    pub left_out: Vec<String>,
    /// Whether the work was interrupted.
    pub is_interrupted: bool,
}

/// A finer setting takes so many times as long as the one before it, before more is known.
const GROWTH: f64 = 4.0;

/// Runs all methods, each from coarse to fine: of their next settings always the one that is expected to take the shortest, until that
/// would pass `budget` (s, of all runs). `told` hears how many more settings are over. Collective.
///
/// # Errors
/// Those of `bench`.
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
                runs.done.push(Run { method: name.clone(), settings: settings.clone(), timed });
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

/// How a method's settings have grown.
#[derive(Debug, Clone, Default)]
struct Progress {
    /// What the last two have taken, s.
    last: [f64; 2],
    /// Settings that are left.
    left: usize,
    /// What the first may take, s.
    guess: f64,
}

impl Progress {
    fn push(&mut self, spent: f64) {
        self.last = [self.last[1], spent];
        self.left -= 1;
    }

    /// What the next setting may take, s.
    fn expected(&self) -> f64 {
        let [before, last] = self.last;
        if last == 0.0 {
            return self.guess;
        }
        last * if before > 0.0 { (last / before).max(1.0) } else { GROWTH }
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

    /// The quickest first; what is expected to take too long is left out; reasons are kept.
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
        // The expected times are 0 for all; then 0.4 s for cheap, 4 s for dear.
        assert_eq!(asked, ["cheap0", "dear0", "none0", "none1", "cheap1", "cheap2", "cheap3", "dear1"], "{found:?}");
        // 11.4 s spent and 100 s expected.
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
