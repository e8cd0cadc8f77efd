//! Measurements of an impact simulation: its energy balance, and its acceleration compared with a reference.

use crate::impact::step::Step;
use crate::record::episodes::Episodes;

/// Time history of the impactor's acceleration in a run, with the largest tension where it is known.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct History {
    time: Vec<f64>,
    acceleration: Vec<f64>,
    contacts: Vec<Contact>,
    /// Largest principal stress of the body at each time, Pa; empty if it is not known.
    tension: Vec<f64>,
}

/// One contact episode of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Start of the contact, s.
    pub start: f64,
    /// End of the contact, s; the last time of the history if the contact has not ended.
    pub end: f64,
    /// Impulse ∫ F dt, N s.
    pub impulse: f64,
}

/// Relative differences between a time history and another one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Difference {
    /// Largest difference of the acceleration up to the end of the other history's first contact, over the other's peak
    /// acceleration up to that time.
    pub first: f64,
    /// Largest difference of the acceleration over all compared times, over the other's peak acceleration.
    pub whole: f64,
    /// Relative difference of the largest tension up to the end of the other's first contact; NaN if a history has no
    /// tension.
    pub tension: f64,
}

impl History {
    /// History of an acceleration (m/s²) at ascending times (s), with its contacts.
    pub fn new(time: Vec<f64>, acceleration: Vec<f64>, contacts: Vec<Contact>) -> Self {
        Self { time, acceleration, contacts, tension: Vec::new() }
    }

    /// Adds the largest tension (Pa) at each time.
    pub fn with_tension(self, tension: Vec<f64>) -> Self {
        Self { tension, ..self }
    }

    /// History of an acceleration (m/s²) at ascending times (s), for an impactor's mass (kg). Contacts are the
    /// intervals of positive acceleration; their impulses are integrated by the trapezoidal rule.
    pub fn of_series(time: Vec<f64>, acceleration: Vec<f64>, mass: f64) -> Self {
        let mut contacts: Vec<Contact> = Vec::new();
        for n in 1..time.len() {
            let (before, now) = (acceleration[n - 1], acceleration[n]);
            if before <= 0.0 && now <= 0.0 {
                continue;
            }
            if before <= 0.0 || contacts.is_empty() {
                contacts.push(Contact { start: time[n - 1], end: time[n], impulse: 0.0 });
            }
            if let Some(contact) = contacts.last_mut() {
                contact.end = time[n];
                contact.impulse += 0.5 * mass * (before.max(0.0) + now.max(0.0)) * (time[n] - time[n - 1]);
            }
        }
        Self { time, acceleration, contacts, tension: Vec::new() }
    }

    /// Number of recorded times.
    pub fn rows(&self) -> usize {
        self.time.len()
    }

    /// The first contact; `None` if there is no contact.
    pub fn first(&self) -> Option<Contact> {
        self.contacts.first().copied()
    }

    /// Duration of the first contact, s; `None` if it has not ended.
    pub(super) fn contact(&self) -> Option<f64> {
        let is_over = self.contacts.len() > 1 || self.acceleration.last().is_some_and(|last| *last <= 0.0);
        self.first().filter(|_| is_over).map(|contact| contact.end - contact.start)
    }

    /// End of the first contact, s; the last time if there is no contact.
    fn first_end(&self) -> f64 {
        self.first().map_or(self.last(), |contact| contact.end)
    }

    fn last(&self) -> f64 {
        self.time.last().copied().unwrap_or_default()
    }

    /// Number of times up to `until` (s).
    fn within(&self, until: f64) -> usize {
        self.time.partition_point(|time| *time <= until * (1.0 + 1e-12))
    }

    /// Largest acceleration up to a time, m/s².
    fn peak_until(&self, until: f64) -> f64 {
        self.acceleration[..self.within(until)].iter().fold(0.0, |peak, a| a.max(peak))
    }

    /// Largest acceleration, m/s².
    pub fn peak(&self) -> f64 {
        self.peak_until(f64::MAX)
    }

    /// Largest tension up to a time, Pa; NaN where it is not known.
    fn tension_until(&self, until: f64) -> f64 {
        let known = self.tension.iter().take(self.within(until));
        known.fold(f64::NAN, |largest, tension| largest.max(*tension))
    }

    /// Time of the largest acceleration in the first contact, s.
    fn first_peak(&self) -> f64 {
        let first = &self.acceleration[..self.within(self.first_end())];
        let peak = (0..first.len()).fold(0, |best, n| if first[n] > first[best] { n } else { best });
        self.time.get(peak).copied().unwrap_or(f64::INFINITY)
    }

    /// Acceleration at a time within the history, linear between its steps.
    fn at(&self, time: f64) -> f64 {
        // A time equal to a step's time up to rounding counts as that step's time.
        let after = self.time.partition_point(|known| *known < time * (1.0 - 1e-12));
        let (Some(&t1), Some(&a1)) = (self.time.get(after), self.acceleration.get(after)) else { return f64::NAN };
        if after == 0 || t1 <= time {
            return a1;
        }
        let (t0, a0) = (self.time[after - 1], self.acceleration[after - 1]);
        a0 + (a1 - a0) * (time - t0) / (t1 - t0)
    }

    /// Acceleration at a time within a contact, m/s²: the cubic through two steps on either side if all four are in
    /// contact, otherwise linear. Linear interpolation would add the error between exact steps.
    fn between(&self, time: f64) -> f64 {
        let after = self.time.partition_point(|known| *known < time * (1.0 - 1e-12));
        let around = after.wrapping_sub(2)..after + 2;
        let (Some(times), Some(values)) = (self.time.get(around.clone()), self.acceleration.get(around)) else {
            return self.at(time);
        };
        if values.iter().any(|a| *a <= 0.0) || times.windows(2).any(|pair| pair[0] >= pair[1]) {
            return self.at(time);
        }
        let weight = |n: usize| {
            let others = times.iter().enumerate().filter(|(other, _)| *other != n);
            others.map(|(_, t)| (time - t) / (times[n] - t)).product::<f64>()
        };
        values.iter().enumerate().map(|(n, a)| a * weight(n)).sum()
    }

    /// Relative differences from another history, at this history's times and at the other's first peak, where this
    /// history may have no step. Times beyond the other's last time are not compared.
    pub fn difference(&self, other: &Self) -> Difference {
        let (first_end, first_peak, last) = (other.first_end(), other.first_peak(), other.last());
        let mut difference = Difference::default();
        let mut count = |time: f64, off: f64| {
            difference.whole = difference.whole.max(off);
            if time <= first_end {
                difference.first = difference.first.max(off);
            }
        };
        let compared = self.within(last);
        for (time, acceleration) in self.time[..compared].iter().zip(&self.acceleration) {
            count(*time, (acceleration - other.at(time.min(last))).abs());
        }
        if self.last() >= first_peak {
            count(first_peak, (self.between(first_peak) - other.at(first_peak)).abs());
        }
        let over = |off: f64, peak: f64| if off > 0.0 { off / peak } else { 0.0 };
        Difference {
            first: over(difference.first, other.peak_until(first_end)),
            whole: over(difference.whole, other.peak()),
            tension: (self.tension_until(first_end) / other.tension_until(first_end) - 1.0).abs(),
        }
    }
}

/// Records a time history from the steps of a run.
#[derive(Debug, Clone, Default)]
pub struct Recorder {
    history: History,
    episodes: Episodes,
}

impl Recorder {
    /// Adds the next step.
    pub fn push(&mut self, step: &Step) {
        self.history.time.push(step.time);
        self.history.acceleration.push(step.impactor.acceleration);
        self.episodes.push(step);
    }

    /// Returns the recorded history.
    pub fn finish(mut self) -> History {
        let contacts = self.episodes.all().iter();
        self.history.contacts = contacts.map(|e| Contact { start: e.start, end: e.end, impulse: e.impulse }).collect();
        self.history
    }
}

/// Measurements of a run; for a run that was stopped, up to the last completed step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Steps taken.
    pub steps: usize,
    /// Time reached, s.
    pub time: f64,
    /// Largest |total + dissipated − external − initial energy| over the initial energy and the largest work of the loads.
    pub energy_error: f64,
    /// Largest (total + dissipated − external) energy over the initial one, both with the largest work of the loads added.
    pub growth: f64,
    /// Largest difference of the acceleration from the reference, over the reference's peak. Compared at the run's
    /// times up to the end of the reference's first contact episode, and at its peak.
    pub first_error: f64,
    /// Largest difference of the acceleration over the whole run, over the reference's peak.
    pub whole_error: f64,
}

impl Measured {
    /// Values for a run that was not made.
    pub(super) const NOTHING: Self = Self {
        steps: 0,
        time: f64::NAN,
        energy_error: f64::NAN,
        growth: f64::NAN,
        first_error: f64::NAN,
        whole_error: f64::NAN,
    };
}

/// Measures a run step by step.
pub(super) struct Measure<'a> {
    reference: Option<&'a History>,
    own: Recorder,
    initial: f64,
    lowest: f64,
    highest: f64,
    /// Largest work of the loads and of the weight, J.
    work: f64,
    steps: usize,
    time: f64,
}

impl<'a> Measure<'a> {
    /// Starts a measurement. Without a reference, the errors of the acceleration are zero.
    pub(super) fn new(reference: Option<&'a History>) -> Self {
        Self {
            reference,
            own: Recorder::default(),
            initial: 0.0,
            lowest: f64::INFINITY,
            highest: f64::NEG_INFINITY,
            work: 0.0,
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
        self.work = self.work.max(energy.external.abs());
        (self.steps, self.time) = (step.number, step.time);
        self.own.push(step);
    }

    /// Returns the measurements and the run's history.
    pub(super) fn finish(self) -> (Measured, History) {
        let Self { initial, lowest, highest, work, .. } = self;
        let own = self.own.finish();
        let difference = self.reference.map(|reference| own.difference(reference)).unwrap_or_default();
        let measured = Measured {
            steps: self.steps,
            time: self.time,
            energy_error: (highest - initial).max(initial - lowest) / (initial.abs() + work),
            growth: (highest + work) / (initial + work),
            first_error: difference.first,
            whole_error: difference.whole,
        };
        (measured, own)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::impact::step::{Contact, Energy, Motion};

    /// A step with a given acceleration, a contact force equal to its positive part, and a total energy.
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
                impulse: 0.0,
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

    /// Reference ⟨sin t⟩ up to t = 9, with contact episodes 0 to π and 2π to 9.
    fn reference() -> History {
        let mut recorder = Recorder::default();
        (0..=9000).for_each(|n| recorder.push(&step(n, 1e-3 * n as f64, (1e-3 * n as f64).sin(), 1.0)));
        recorder.finish()
    }

    #[test]
    fn the_largest_tension_is_compared_in_the_first_contact() {
        let sine = |tension: f64| {
            let time: Vec<f64> = (0..=6).map(f64::from).collect();
            let acceleration = time.iter().map(|t| t.sin()).collect();
            // Tension after the first contact must not count.
            let all = time.iter().map(|t| if *t < 4.5 { tension * t.sin() } else { 1e3 }).collect();
            History::of_series(time, acceleration, 1.0).with_tension(all)
        };
        assert!((sine(1.03).difference(&sine(1.0)).tension - 0.03).abs() < 1e-12);
        assert!(reference().difference(&sine(1.0)).tension.is_nan());
    }

    #[test]
    fn errors_are_split_at_the_end_of_the_first_episode() {
        let reference = reference();
        // The steps have no approach rate, so the end of the contact is accurate to one step only.
        assert!((reference.contact().unwrap() - std::f64::consts::PI).abs() < 1e-3);
        let mut measure = Measure::new(Some(&reference));
        // Errors of 1% before π and 3% after; nothing is compared beyond the reference's end.
        for n in 0..20 {
            let t = 0.5 * n as f64;
            measure.push(&step(n, t, if t < 3.2 { 1.01 } else { 1.03 } * t.sin(), 1.0 + 1e-3 * t));
        }
        let measured = measure.finish().0;
        // The largest errors are at t = 1.5 and 8. The reference's peak is 1 up to (1e-3)²/8, because its maximum is
        // taken at a step.
        assert!((measured.first_error - 0.01 * 1.5_f64.sin()).abs() < 1e-6, "{measured:?}");
        assert!((measured.whole_error - 0.03 * 8_f64.sin()).abs() < 1e-6, "{measured:?}");
        // The energy balance is total + 0.25; it rises from 1.25 by 9.5e-3. The loads have done a work of 0.25.
        assert!((measured.energy_error - 9.5e-3 / 1.5).abs() < 1e-12);
        assert!((measured.growth - 1.0 - 9.5e-3 / 1.5).abs() < 1e-12);
        assert_eq!((measured.steps, measured.time), (19, 9.5));
    }

    #[test]
    fn a_history_is_linear_between_its_steps() {
        let reference = reference();
        assert_eq!(reference.at(1.5), (1.5_f64).sin());
        let between = 0.5 * (1.5_f64.sin() + 1.501_f64.sin());
        assert!((reference.at(1.5005) - between).abs() < 1e-12);
        assert!(Measure::new(None).finish().0.first_error == 0.0);
    }

    /// With exact steps only the interpolation error of the cubic remains: 9/16 step⁴/24 for sin t at the midpoint.
    #[test]
    fn the_peak_between_exact_steps_is_as_they_tell() {
        let reference = reference();
        for step in [0.4, 0.2, 0.1] {
            // The peak is halfway between two steps.
            let time: Vec<f64> = (-3..=3).map(|n| FRAC_PI_2 + step * (f64::from(n) + 0.5)).collect();
            let acceleration = time.iter().map(|t| t.sin()).collect();
            let found = History::of_series(time, acceleration, 1.0).difference(&reference).first;
            let of_cubic = 9.0 / 16.0 * step.powi(4) / 24.0;
            // The reference's steps of 1e-3 add an error of 1e-7.
            assert!((found - of_cubic).abs() < 0.05 * of_cubic + 3e-7, "{step}: {found:e}, {of_cubic:e}");
        }
        // A single step in a contact has no neighbours for the cubic: linear interpolation is used.
        let coarse = History::of_series(vec![0.0, 1.0, 4.0], vec![0.0, 1.0, 0.0], 1.0);
        assert_eq!(coarse.between(2.5), 0.5);
    }

    /// Contacts found from times and accelerations alone.
    #[test]
    fn contacts_are_where_the_acceleration_is_positive() {
        let known = reference();
        let foreign = History::of_series(known.time.clone(), known.acceleration.clone(), 2.0);
        assert_eq!(foreign.contacts.len(), 2);
        for (found, is) in foreign.contacts.iter().zip(&known.contacts) {
            assert!((found.start - is.start).abs() < 1e-3 && (found.end - is.end).abs() < 1e-3, "{found:?}, {is:?}");
        }
        // The exact impulse is 2 ∫ sin over half a period; the relative error of the trapezoidal rule is (1e-3)²/12.
        assert!((foreign.contacts[0].impulse - 4.0).abs() < 1e-6);
        let Difference { first, whole, .. } = foreign.difference(&known);
        assert_eq!([first, whole], [0.0; 2]);
        assert_eq!(known.peak(), foreign.peak());
    }
}
