//! What is measured of a run: its energy, and its acceleration against that of a reference.

use crate::impact::step::Step;
use crate::record::episodes::Episodes;

/// The acceleration of a run, to measure others by.
#[derive(Debug, Clone)]
pub(super) struct History {
    time: Vec<f64>,
    acceleration: Vec<f64>,
    episodes: Episodes,
}

/// What was measured of a run; of a run that was stopped, up to the step before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Steps taken.
    pub steps: usize,
    /// Time reached, s.
    pub time: f64,
    /// Largest |total + dissipated − external − initial| over the initial energy.
    pub energy_error: f64,
    /// Largest total + dissipated − external over the initial energy.
    pub growth: f64,
    /// Largest difference of the acceleration from the reference's, at the run's own times up to the end of the reference's
    /// first contact episode and at its peak, over that peak.
    pub first_error: f64,
    /// The same over the whole run, over the reference's peak.
    pub whole_error: f64,
}

impl History {
    pub(super) fn new() -> Self {
        // Times and forces are asked for, not impulses.
        Self { time: Vec::new(), acceleration: Vec::new(), episodes: Episodes::new(0.0) }
    }

    pub(super) fn push(&mut self, step: &Step) {
        self.time.push(step.time);
        self.acceleration.push(step.impactor.acceleration);
        self.episodes.push(step);
    }

    /// Duration of the first contact episode, s, if it is over.
    pub(super) fn contact(&self) -> Option<f64> {
        let is_over = self.episodes.all().len() > 1 || !self.episodes.is_open();
        self.episodes.all().first().filter(|_| is_over).map(|episode| episode.end - episode.start)
    }

    /// End of the first contact episode, s, or the last time where there is none.
    fn first_end(&self) -> f64 {
        let last = self.time.last().copied().unwrap_or_default();
        self.episodes.all().first().map_or(last, |episode| episode.end)
    }

    /// Time of the first contact's peak, s.
    fn first_peak(&self) -> f64 {
        self.episodes.all().first().map_or(f64::INFINITY, |episode| episode.peak_time)
    }

    /// Largest acceleration up to a time, m/s².
    fn peak(&self, until: f64) -> f64 {
        let within = self.time.partition_point(|time| *time <= until);
        self.acceleration[..within].iter().fold(0.0, |peak, a| a.max(peak))
    }

    /// The acceleration at a time within the history, linear between its steps.
    fn at(&self, time: f64) -> f64 {
        // A time that is met but for rounding is met.
        let after = self.time.partition_point(|known| *known < time * (1.0 - 1e-12));
        let (Some(&t1), Some(&a1)) = (self.time.get(after), self.acceleration.get(after)) else { return f64::NAN };
        if after == 0 || t1 <= time {
            return a1;
        }
        let (t0, a0) = (self.time[after - 1], self.acceleration[after - 1]);
        a0 + (a1 - a0) * (time - t0) / (t1 - t0)
    }
}

/// Measures a run step by step.
pub(super) struct Measure<'a> {
    reference: Option<&'a History>,
    first_end: f64,
    /// Time of the reference's first peak, s, and the last step's time and acceleration: a step that leaps over the peak has missed it.
    first_peak: f64,
    before: (f64, f64),
    last: f64,
    initial: f64,
    lowest: f64,
    highest: f64,
    first_difference: f64,
    whole_difference: f64,
    steps: usize,
    time: f64,
}

impl<'a> Measure<'a> {
    /// Without a reference, the errors of the acceleration are zero.
    pub(super) fn new(reference: Option<&'a History>) -> Self {
        Self {
            reference,
            first_end: reference.map_or(0.0, History::first_end),
            first_peak: reference.map_or(f64::INFINITY, History::first_peak),
            before: (0.0, 0.0),
            last: reference.and_then(|history| history.time.last().copied()).unwrap_or_default(),
            initial: 0.0,
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
            first_difference: 0.0,
            whole_difference: 0.0,
            steps: 0,
            time: 0.0,
        }
    }

    pub(super) fn push(&mut self, step: &Step) {
        let energy = &step.energy;
        let balance = energy.total + energy.dissipated - energy.external;
        if step.number == 0 {
            self.initial = balance;
        }
        (self.lowest, self.highest) = (self.lowest.min(balance), self.highest.max(balance));
        (self.steps, self.time) = (step.number, step.time);
        let (from, now) = (self.before, (step.time, step.impactor.acceleration));
        self.before = now;
        if let Some(reference) = self.reference
            && from.0 < self.first_peak
            && self.first_peak <= now.0
        {
            let part = (self.first_peak - from.0) / (now.0 - from.0);
            let difference = (from.1 + part * (now.1 - from.1) - reference.at(self.first_peak)).abs();
            self.first_difference = self.first_difference.max(difference);
            self.whole_difference = self.whole_difference.max(difference);
        }
        let Some(reference) = self.reference.filter(|_| step.time <= self.last * (1.0 + 1e-12)) else { return };
        let difference = (step.impactor.acceleration - reference.at(step.time.min(self.last))).abs();
        self.whole_difference = self.whole_difference.max(difference);
        if step.time <= self.first_end {
            self.first_difference = self.first_difference.max(difference);
        }
    }

    pub(super) fn finish(self) -> Measured {
        let Self { initial, lowest, highest, first_end, last, .. } = self;
        let of_peak = |difference: f64, until: f64| match self.reference {
            Some(reference) if difference > 0.0 => difference / reference.peak(until),
            _ => 0.0,
        };
        Measured {
            steps: self.steps,
            time: self.time,
            energy_error: (highest - initial).max(initial - lowest) / initial.abs(),
            growth: highest / initial,
            first_error: of_peak(self.first_difference, first_end),
            whole_error: of_peak(self.whole_difference, last),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::step::{Contact, Energy, Motion};

    /// A step with an acceleration, a force that has its sign, and a total energy.
    fn step(number: usize, time: f64, acceleration: f64, total: f64) -> Step {
        Step {
            number,
            time,
            impactor: Motion { position: 0.0, velocity: 0.0, acceleration: acceleration.max(0.0) },
            contact: Contact {
                force: acceleration.max(0.0),
                indentation: acceleration,
                surface_displacement: 0.0,
                approach: acceleration,
                rate: 0.0,
            },
            energy: Energy {
                kinetic: 0.0,
                elastic: 0.0,
                support: 0.0,
                impactor: total,
                contact: 0.0,
                dissipated: 0.5,
                external: 0.25,
                numerical: 0.0,
                total,
            },
        }
    }

    /// ⟨sin t⟩ up to t = 9: episodes 0 to π and 2π to 9.
    fn reference() -> History {
        let mut history = History::new();
        (0..=9000).for_each(|n| history.push(&step(n, 1e-3 * n as f64, (1e-3 * n as f64).sin(), 1.0)));
        history
    }

    #[test]
    fn errors_are_split_at_the_end_of_the_first_episode() {
        let reference = reference();
        // The rate is left out of the steps, which makes the end of the contact good to a step.
        assert!((reference.contact().unwrap() - std::f64::consts::PI).abs() < 1e-3);
        let mut measure = Measure::new(Some(&reference));
        // Off by 1% before π, by 3% after; beyond the reference's end nothing is compared.
        for n in 0..20 {
            let t = 0.5 * n as f64;
            measure.push(&step(n, t, if t < 3.2 { 1.01 } else { 1.03 } * t.sin(), 1.0 + 1e-3 * t));
        }
        let measured = measure.finish();
        // At t = 1.5 and 8; the reference's peak is 1 to (1e-3)²/8 of rounding its maximum to a step.
        assert!((measured.first_error - 0.01 * 1.5_f64.sin()).abs() < 1e-6, "{measured:?}");
        assert!((measured.whole_error - 0.03 * 8_f64.sin()).abs() < 1e-6, "{measured:?}");
        // The balance is total + 0.25; it rises from 1.25 by 9.5e-3.
        assert!((measured.energy_error - 9.5e-3 / 1.25).abs() < 1e-12);
        assert!((measured.growth - 1.0 - 9.5e-3 / 1.25).abs() < 1e-12);
        assert_eq!((measured.steps, measured.time), (19, 9.5));
    }

    #[test]
    fn a_history_is_linear_between_its_steps() {
        let reference = reference();
        assert_eq!(reference.at(1.5), (1.5_f64).sin());
        let between = 0.5 * (1.5_f64.sin() + 1.501_f64.sin());
        assert!((reference.at(1.5005) - between).abs() < 1e-12);
        assert!(Measure::new(None).finish().first_error == 0.0);
    }
}
