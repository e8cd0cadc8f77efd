//! Shows the progress of a run or a sweep on rank 0: a bar on a terminal, a few lines elsewhere.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::impact::step::Step;

use super::note;
use super::terminal::has_bars;

/// A bar on a terminal, or lines in a log at growing intervals.
pub(super) enum Shown {
    Bar(ProgressBar),
    Lines(Cadence),
}

impl Shown {
    /// A bar of this length by a template of indicatif, or lines.
    pub(super) fn new(length: u64, template: &str) -> Self {
        if has_bars() {
            let style = ProgressStyle::with_template(template).expect("the template is valid");
            Self::Bar(ProgressBar::new(length).with_style(style))
        } else {
            Self::Lines(Cadence::new())
        }
    }

    /// Moves the bar to a position, with a message; or writes a line if one is due.
    pub(super) fn show(&mut self, position: u64, message: impl Fn() -> String, line: impl Fn() -> String) {
        match self {
            Self::Bar(bar) => {
                bar.set_position(position);
                bar.set_message(message());
            }
            Self::Lines(cadence) if cadence.is_due() => {
                cadence.next();
                note(format_args!("{}", line()));
            }
            Self::Lines(_) => {}
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Estimates the remaining time from the speed of the parts after the first one.
struct Left {
    first: Option<(Instant, f64)>,
    count: usize,
    /// Number of parts before there is an estimate. The first parts may include set-up work and have other lengths than
    /// later ones.
    uncounted: usize,
}

impl Left {
    fn new(uncounted: usize) -> Self {
        Self { first: None, count: 0, uncounted }
    }

    /// Counts another part. `done` is the completed fraction, from 0 to 1.
    fn over(&mut self, done: f64) {
        self.count += 1;
        self.first.get_or_insert_with(|| (Instant::now(), done));
    }

    /// Remaining time in words, to be appended to a message; empty if there is no estimate yet.
    fn words(&self, done: f64) -> String {
        let Some((begin, at)) = self.first.filter(|(_, at)| self.count > self.uncounted && done > *at) else {
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

    fn new() -> Self {
        Self { last: Instant::now(), wait: Self::FIRST_WAIT }
    }

    fn is_due(&self) -> bool {
        self.last.elapsed() >= self.wait
    }

    /// Starts the next interval after a line was written.
    fn next(&mut self) {
        *self = Self { last: Instant::now(), wait: (2 * self.wait).min(Self::LONGEST_WAIT) };
    }
}

/// Shows the progress of the steps of a run.
pub struct Progress {
    /// Start and end time of the steps, s.
    time: [f64; 2],
    left: Left,
    shown: Shown,
}

impl Progress {
    /// Number of positions of the bar.
    const PARTS: u64 = 10_000;
    /// Number of steps before the remaining time is estimated.
    const PARTS_BEFORE_ESTIMATE: usize = 20;

    /// Progress from the start time of the steps (later than 0 for a continued run) to the end, s, on standard error.
    pub fn new(time: [f64; 2]) -> Self {
        Self {
            time,
            left: Left::new(Self::PARTS_BEFORE_ESTIMATE),
            shown: Shown::new(Self::PARTS, "{bar:40} {percent} %, {msg}"),
        }
    }

    /// Counts an accepted step.
    pub fn step(&mut self, step: &Step) {
        let [from, end] = self.time;
        let done = ((step.time - from) / (end - from)).min(1.0);
        self.left.over(done);
        let (time, force) = (1e3 * step.time, step.contact.force);
        let state = || format!("t = {time:.3} of {:.3} ms, F = {force:.1} N{}", 1e3 * end, self.left.words(done));
        if step.number == 0 {
            return;
        }
        self.shown.show((Self::PARTS as f64 * done) as u64, state, || format!("step {}, {}", step.number, state()));
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.shown.finish();
    }
}

/// Shows the progress of a number of items.
pub struct Items {
    what: &'static str,
    done: usize,
    all: usize,
    left: Left,
    shown: Shown,
}

impl Items {
    /// Progress towards `all` items on standard error. `what` names them in the plural.
    pub fn new(all: usize, what: &'static str) -> Self {
        // The first item may include work shared by all.
        Self { what, done: 0, all, left: Left::new(1), shown: Shown::new(all as u64, "{bar:40} {msg}") }
    }

    /// Counts `count` more items.
    pub fn over(&mut self, count: usize) {
        self.done += count;
        let (part, what) = (self.done as f64 / self.all as f64, self.what);
        self.left.over(part);
        let state = || format!("{} of {} {what}{}", self.done, self.all, self.left.words(part));
        self.shown.show(self.done as u64, state, state);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.shown.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::Left;

    #[test]
    fn no_time_is_foreseen_from_the_first_parts() {
        let mut left = Left::new(20);
        for part in 1..=20 {
            left.over(1e-9 * part as f64);
            assert_eq!(left.words(1e-9 * part as f64), "");
        }
        left.over(0.5);
        assert_eq!(left.words(0.5), ", about 0 s left");
    }
}
