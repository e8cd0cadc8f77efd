//! Shows the progress of a run or a sweep on rank 0: a bar on a terminal, a few lines elsewhere.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::impact::step::Step;

use super::note;
use super::terminal::has_bars;

/// Shows the progress of the steps of a run.
pub struct Progress {
    /// Start and end time of the steps, s.
    time: [f64; 2],
    left: Left,
    shown: Shown,
}

enum Shown {
    /// Bar on a terminal; its position runs from 0 to [`PARTS`].
    Bar(ProgressBar),
    /// Lines in a log, at growing intervals.
    Lines(Cadence),
}

/// Estimates the remaining time from the speed of the parts after the first one.
struct Left {
    first: Option<(Instant, f64)>,
    count: usize,
}

impl Left {
    /// Number of parts before there is an estimate. The first parts include set-up work and have other lengths than
    /// later ones.
    const PARTS_BEFORE_ESTIMATE: usize = 20;

    fn new() -> Self {
        Self { first: None, count: 0 }
    }

    /// Counts another part. `done` is the completed fraction, from 0 to 1.
    fn over(&mut self, done: f64) {
        self.count += 1;
        self.first.get_or_insert_with(|| (Instant::now(), done));
    }

    /// Remaining time in words, to be appended to a message; empty if there is no estimate yet.
    fn words(&self, done: f64) -> String {
        let Some((begin, at)) = self.first.filter(|(_, at)| self.count > Self::PARTS_BEFORE_ESTIMATE && done > *at)
        else {
            return String::new();
        };
        let seconds = begin.elapsed().as_secs_f64() * (1.0 - done).max(0.0) / (done - at);
        format!(", about {seconds:.0} s left")
    }
}

/// Intervals between lines: the first line comes soon, and each interval is twice as long as the previous one, up to a
/// maximum.
pub(super) struct Cadence {
    last: Instant,
    wait: Duration,
}

impl Cadence {
    const FIRST_WAIT: Duration = Duration::from_secs(1);
    const LONGEST_WAIT: Duration = Duration::from_secs(16);

    pub(super) fn new() -> Self {
        Self { last: Instant::now(), wait: Self::FIRST_WAIT }
    }

    pub(super) fn is_due(&self) -> bool {
        self.last.elapsed() >= self.wait
    }

    /// Starts the next interval after a line was written.
    pub(super) fn next(&mut self) {
        *self = Self { last: Instant::now(), wait: (2 * self.wait).min(Self::LONGEST_WAIT) };
    }
}

/// Number of positions of the bar.
const PARTS: u64 = 10_000;

impl Progress {
    /// Progress from the start time of the steps (later than 0 for a continued run) to the end, s, on standard error.
    pub fn new(time: [f64; 2]) -> Self {
        let shown = if has_bars() {
            let style = ProgressStyle::with_template("{bar:40} {percent} %, {msg}").expect("the template is valid");
            Shown::Bar(ProgressBar::new(PARTS).with_style(style))
        } else {
            Shown::Lines(Cadence::new())
        };
        Self { time, left: Left::new(), shown }
    }

    /// Counts an accepted step.
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

    /// Removes the bar.
    pub fn finish(&self) {
        if let Shown::Bar(bar) = &self.shown {
            bar.finish_and_clear();
        }
    }
}

/// Shows the progress of a number of items.
pub struct Items {
    what: &'static str,
    bar: Option<ProgressBar>,
    done: usize,
    all: usize,
    /// Time when the first items were done, and their number. The first item may include work shared by all.
    first: Option<(Instant, usize)>,
    cadence: Cadence,
}

impl Items {
    /// Progress towards `all` items on standard error. `what` names them in the plural.
    pub fn new(all: usize, what: &'static str) -> Self {
        let bar = has_bars().then(|| {
            let style = format!("{{bar:40}} {{pos}} of {{len}} {what}, {{eta}} left");
            ProgressBar::new(all as u64)
                .with_style(ProgressStyle::with_template(&style).expect("the template is valid"))
        });
        Self { what, bar, done: 0, all, first: None, cadence: Cadence::new() }
    }

    /// Counts `count` more items.
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

    /// Removes the bar.
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
        for part in 1..=Left::PARTS_BEFORE_ESTIMATE {
            left.over(1e-9 * part as f64);
            assert_eq!(left.words(1e-9 * part as f64), "");
        }
        left.over(0.5);
        assert_eq!(left.words(0.5), ", about 0 s left");
    }
}
