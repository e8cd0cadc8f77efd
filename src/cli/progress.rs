//! How far a run or a sweep is: a bar on a terminal, sparse lines elsewhere. On rank 0.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::impact::step::Step;

use super::note;
use super::terminal::has_bars;

/// Shows the progress of a run's steps.
pub enum Progress {
    /// On a terminal.
    Bar {
        /// Its position runs to [`PARTS`].
        bar: ProgressBar,
        /// Beginning and end of what is run, s.
        time: [f64; 2],
    },
    /// Into a log.
    Lines(Lines),
}

/// Lines of progress, not more often than they are worth reading.
pub struct Lines {
    time: [f64; 2],
    begin: Instant,
    cadence: Cadence,
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
        if has_bars() {
            let bar = ProgressBar::new(PARTS);
            let style = "{bar:40} {percent} %, {eta} left, {msg}";
            bar.set_style(ProgressStyle::with_template(style).expect("the template is valid"));
            Self::Bar { bar, time }
        } else {
            Self::Lines(Lines { time, begin: Instant::now(), cadence: Cadence::new() })
        }
    }

    /// A step was accepted.
    pub fn step(&mut self, step: &Step) {
        let state = || format!("t = {:.3} ms, F = {:.1} N", 1e3 * step.time, step.contact.force);
        match self {
            Self::Bar { bar, time: [from, end] } => {
                bar.set_position((PARTS as f64 * ((step.time - *from) / (*end - *from)).min(1.0)) as u64);
                bar.set_message(state());
            }
            Self::Lines(Lines { time: [from, end], begin, cadence }) => {
                let done = step.time - *from;
                if !cadence.is_due() || done <= 0.0 {
                    return;
                }
                cadence.next();
                let left = begin.elapsed().as_secs_f64() * (*end - step.time).max(0.0) / done;
                note(format_args!("step {}, {} of {:.3} ms, {left:.0} s left", step.number, state(), 1e3 * *end));
            }
        }
    }

    /// The run is over.
    pub fn finish(self) {
        if let Self::Bar { bar, .. } = self {
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
    begin: Instant,
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
        Self { what, bar, done: 0, all, begin: Instant::now(), cadence: Cadence::new() }
    }

    /// So many more are over.
    pub fn over(&mut self, count: usize) {
        self.done += count;
        if let Some(bar) = &self.bar {
            bar.inc(count as u64);
        } else if self.cadence.is_due() {
            self.cadence.next();
            let left = self.begin.elapsed().as_secs_f64() * (self.all - self.done) as f64 / self.done as f64;
            note(format_args!("{} of {} {}, {left:.0} s left", self.done, self.all, self.what));
        }
    }

    /// No more will come.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
