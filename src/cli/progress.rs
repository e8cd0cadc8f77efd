//! How far a run or a sweep is: a bar on a terminal, sparse lines elsewhere. On rank 0.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::impact::step::Step;

use super::tell;

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
    last: Instant,
}

/// Resolution of the bar.
const PARTS: u64 = 10_000;

/// Time between two lines.
const EVERY: Duration = Duration::from_secs(10);

impl Progress {
    /// Progress of a run from a time, where it goes on, to its end, s, on standard error.
    pub fn new(time: [f64; 2]) -> Self {
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(PARTS);
            let style = "{bar:40} {percent} %, {eta} left, {msg}";
            bar.set_style(ProgressStyle::with_template(style).expect("the template is valid"));
            Self::Bar { bar, time }
        } else {
            let begin = Instant::now();
            Self::Lines(Lines { time, begin, last: begin })
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
            Self::Lines(Lines { time: [from, end], begin, last }) => {
                let done = step.time - *from;
                if last.elapsed() < EVERY || done < 0.01 * (*end - *from) {
                    return;
                }
                *last = Instant::now();
                let left = begin.elapsed().as_secs_f64() * (*end - step.time).max(0.0) / done;
                tell(format_args!("step {}, {} of {:.3} ms, {left:.0} s left", step.number, state(), 1e3 * *end));
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
    last: Instant,
}

impl Items {
    /// Progress to `all` of what the plural `what` names, on standard error.
    pub fn new(all: usize, what: &'static str) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = format!("{{bar:40}} {{pos}} of {{len}} {what}, {{eta}} left");
            ProgressBar::new(all as u64)
                .with_style(ProgressStyle::with_template(&style).expect("the template is valid"))
        });
        let begin = Instant::now();
        Self { what, bar, done: 0, all, begin, last: begin }
    }

    /// So many more are over.
    pub fn over(&mut self, count: usize) {
        self.done += count;
        if let Some(bar) = &self.bar {
            bar.inc(count as u64);
        } else if self.last.elapsed() >= EVERY {
            self.last = Instant::now();
            let left = self.begin.elapsed().as_secs_f64() * (self.all - self.done) as f64 / self.done as f64;
            tell(format_args!("{} of {} {}, {left:.0} s left", self.done, self.all, self.what));
        }
    }

    /// No more will come.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
