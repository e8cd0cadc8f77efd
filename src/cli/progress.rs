//! How far a run or a sweep is: a bar on a terminal, sparse lines elsewhere. On rank 0.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::impact::step::Step;

use super::note;
use super::terminal::has_bars;

/// Shows the progress of a run's steps.
pub struct Progress {
    /// Beginning and end of what is run, s.
    time: [f64; 2],
    left: Left,
    shown: Shown,
}

enum Shown {
    /// On a terminal; its position runs to [`PARTS`].
    Bar(ProgressBar),
    /// Into a log, not more often than lines are worth reading.
    Lines(Cadence),
}

/// About how long the rest takes, by how quickly the parts so far came after the first one.
struct Left {
    first: Option<(Instant, f64)>,
    count: usize,
}

impl Left {
    /// Parts that come before the estimate: the first ones have much to set up, and are of another length than later ones.
    const BEFORE: usize = 20;

    fn new() -> Self {
        Self { first: None, count: 0 }
    }

    /// Another part is over, up to `done` of 1.
    fn over(&mut self, done: f64) {
        self.count += 1;
        self.first.get_or_insert_with(|| (Instant::now(), done));
    }

    /// In words, behind what was done; nothing before there is something to go by.
    fn words(&self, done: f64) -> String {
        let Some((begin, at)) = self.first.filter(|(_, at)| self.count > Self::BEFORE && done > *at) else {
            return String::new();
        };
        let seconds = begin.elapsed().as_secs_f64() * (1.0 - done).max(0.0) / (done - at);
        format!(", about {seconds:.0} s left")
    }
}

/// When lines are due: the first soon, later ones twice as long after each other, up to a longest time.
pub(super) struct Cadence {
    last: Instant,
    wait: Duration,
}

impl Cadence {
    const FIRST: Duration = Duration::from_secs(1);
    const LONGEST: Duration = Duration::from_secs(16);

    pub(super) fn new() -> Self {
        Self { last: Instant::now(), wait: Self::FIRST }
    }

    pub(super) fn is_due(&self) -> bool {
        self.last.elapsed() >= self.wait
    }

    /// A line was written.
    pub(super) fn next(&mut self) {
        *self = Self { last: Instant::now(), wait: (2 * self.wait).min(Self::LONGEST) };
    }
}

/// Resolution of the bar.
const PARTS: u64 = 10_000;

impl Progress {
    /// Progress of a run from a time, where it goes on, to its end, s, on standard error.
    pub fn new(time: [f64; 2]) -> Self {
        let shown = if has_bars() {
            let style = ProgressStyle::with_template("{bar:40} {percent} %, {msg}").expect("the template is valid");
            Shown::Bar(ProgressBar::new(PARTS).with_style(style))
        } else {
            Shown::Lines(Cadence::new())
        };
        Self { time, left: Left::new(), shown }
    }

    /// A step was accepted.
    pub fn step(&mut self, step: &Step) {
        let [from, end] = self.time;
        let done = ((step.time - from) / (end - from)).min(1.0);
        self.left.over(done);
        let state = || {
            format!(
                "t = {:.3} of {:.3} ms, F = {:.1} N{}",
                1e3 * step.time,
                1e3 * end,
                step.contact.force,
                self.left.words(done)
            )
        };
        match &mut self.shown {
            Shown::Bar(bar) => {
                bar.set_position((PARTS as f64 * done) as u64);
                bar.set_message(state());
            }
            Shown::Lines(cadence) => {
                if cadence.is_due() && step.number > 0 {
                    cadence.next();
                    note(format_args!("step {}, {}", step.number, state()));
                }
            }
        }
    }

    /// The run is over.
    pub fn finish(self) {
        if let Shown::Bar(bar) = self.shown {
            bar.finish_and_clear();
        }
    }
}

/// Shows the progress of a number of things to do.
pub struct Items {
    what: &'static str,
    bar: Option<ProgressBar>,
    done: usize,
    all: usize,
    /// When the first was over, which may have borne what all share, and how many were then.
    first: Option<(Instant, usize)>,
    cadence: Cadence,
}

impl Items {
    /// Progress to `all` of what the plural `what` names, on standard error.
    pub fn new(all: usize, what: &'static str) -> Self {
        let bar = has_bars().then(|| {
            let style = format!("{{bar:40}} {{pos}} of {{len}} {what}, {{eta}} left");
            ProgressBar::new(all as u64)
                .with_style(ProgressStyle::with_template(&style).expect("the template is valid"))
        });
        Self { what, bar, done: 0, all, first: None, cadence: Cadence::new() }
    }

    /// So many more are over.
    pub fn over(&mut self, count: usize) {
        self.done += count;
        let (since, were) = *self.first.get_or_insert_with(|| (Instant::now(), self.done));
        if let Some(bar) = &self.bar {
            bar.inc(count as u64);
            if were == self.done {
                bar.reset_eta();
            }
        } else if self.cadence.is_due() {
            self.cadence.next();
            let left = match self.done - were {
                0 => String::new(),
                since_then => {
                    let seconds = since.elapsed().as_secs_f64() * (self.all - self.done) as f64 / since_then as f64;
                    format!(", about {seconds:.0} s left")
                }
            };
            note(format_args!("{} of {} {}{left}", self.done, self.all, self.what));
        }
    }

    /// No more will come.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Left;

    #[test]
    fn no_time_is_foreseen_from_the_first_parts() {
        let mut left = Left::new();
        for part in 1..=Left::BEFORE {
            left.over(1e-9 * part as f64);
            assert_eq!(left.words(1e-9 * part as f64), "");
        }
        left.over(0.5);
        assert_eq!(left.words(0.5), ", about 0 s left");
    }
}
