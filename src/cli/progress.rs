//! How far a run is: a bar on a terminal, sparse lines elsewhere. On rank 0.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::impact::step::Step;

use super::tell;

/// Shows the progress of a run's steps.
pub enum Progress {
    /// On a terminal.
    Bar(ProgressBar),
    /// Into a log.
    Lines(Lines),
}

/// Lines of progress, not more often than they are worth reading.
pub struct Lines {
    steps: usize,
    begin: Instant,
    last: Instant,
}

/// Time between two lines.
const EVERY: Duration = Duration::from_secs(10);

impl Progress {
    /// Progress of so many steps, on standard error.
    pub fn new(steps: usize) -> Self {
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(steps as u64);
            let style = "{bar:40} {pos}/{len} steps, {eta} left, {msg}";
            bar.set_style(ProgressStyle::with_template(style).expect("the template is valid"));
            Self::Bar(bar)
        } else {
            let begin = Instant::now();
            Self::Lines(Lines { steps, begin, last: begin })
        }
    }

    /// A step was accepted.
    pub fn step(&mut self, step: &Step) {
        let state = || format!("t = {:.3} ms, F = {:.1} N", 1e3 * step.time, step.contact.force);
        match self {
            Self::Bar(bar) => {
                bar.set_position(step.number as u64);
                bar.set_message(state());
            }
            Self::Lines(Lines { steps, begin, last }) => {
                if last.elapsed() < EVERY || step.number == 0 {
                    return;
                }
                *last = Instant::now();
                let left = begin.elapsed().as_secs_f64() * (*steps - step.number) as f64 / step.number as f64;
                tell(format_args!("step {} of {steps}, {}, {left:.0} s left", step.number, state()));
            }
        }
    }

    /// The run is over.
    pub fn finish(self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
