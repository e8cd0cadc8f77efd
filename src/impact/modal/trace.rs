//! A force as a run gives it: quadratics in time, one a step.

use crate::impact::Errors;
use crate::scheme::modal::quadratic;

/// Part of the largest tension from which a tension is near it: what two histories differ by before they rise does not change their peaks.
const NEAR_PEAK: f64 = 0.9;

/// F(t), N.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Begin and size of each step, s, and its three values.
    steps: Vec<(f64, f64, [f64; 3])>,
    /// The tension under the hit on the other face, where it is read: s, Pa.
    tension: Vec<(f64, f64)>,
    /// Whether there was a force, and when the first contact ended, s.
    has_touched: bool,
    end: Option<f64>,
}

impl Trace {
    /// Adds a step.
    pub fn push(&mut self, begin: f64, step: f64, force: [f64; 3]) {
        self.steps.push((begin, step, force));
        self.has_touched |= force[1] > 0.0;
        if self.has_touched && self.end.is_none() && force[2] == 0.0 {
            self.end = Some(begin + step);
        }
    }

    /// Up to when tensions count, s: traces are compared up to the later one of their first contacts' ends, and ends that are twice as far
    /// apart are of other motions.
    pub fn needs_tension_until(&self) -> f64 {
        2.0 * self.first_end()
    }

    /// Adds a tension (Pa) at a time, s.
    pub fn push_tension(&mut self, time: f64, tension: f64) {
        self.tension.push((time, tension));
    }

    /// Largest of the values.
    pub fn peak(&self) -> f64 {
        self.steps.iter().flat_map(|(_, _, force)| *force).fold(0.0, f64::max)
    }

    /// F at a time.
    pub fn at(&self, time: f64) -> f64 {
        Cursor::default().force(self, time)
    }

    /// End of the first contact, s; infinite while it lasts.
    pub fn first_end(&self) -> f64 {
        self.end.unwrap_or(f64::INFINITY)
    }

    /// Largest difference to another trace in tension in the first contact, over the peak, at times at which one of them is near its own: at the
    /// peak of one it is at least as large as the two peaks differ. NaN where a trace has no tension.
    fn difference_of_tension(&self, other: &Self) -> f64 {
        let end = self.first_end().max(other.first_end());
        let within = |trace: &Self| trace.tension.iter().filter(|(time, _)| *time <= end).copied().collect::<Vec<_>>();
        let (own, others) = (within(self), within(other));
        if own.is_empty() || others.is_empty() {
            return f64::NAN;
        }
        let peak = |all: &[(f64, f64)]| all.iter().map(|(_, tension)| *tension).fold(f64::MIN_POSITIVE, f64::max);
        let (most, others_most) = (peak(&own), peak(&others));
        let is_near_peak = |one: f64, another: f64| one > NEAR_PEAK * most || another > NEAR_PEAK * others_most;
        let (mut in_other, mut in_own) = (Cursor::default(), Cursor::default());
        let of_own = own.iter().map(|(time, tension)| (*tension, in_other.tension(other, *time)));
        let of_own: Vec<(f64, f64)> = of_own.collect();
        let of_others = others.iter().map(|(time, tension)| (in_own.tension(self, *time), *tension));
        let near_peak = of_own.into_iter().chain(of_others).filter(|(one, another)| is_near_peak(*one, *another));
        near_peak.map(|(one, another)| (one - another).abs() / most).fold(0.0, f64::max)
    }

    /// Largest difference to another trace over the peak: that in force and, up to a step's length, in time.
    pub fn difference(&self, other: &Self) -> Errors {
        Errors {
            stress: self.difference_of_tension(other),
            ..self.off_at_steps_of(self, other).max(self.off_at_steps_of(other, self))
        }
    }

    /// The same to a trace in longer steps, in force at the middles and ends of these alone: there its law is met, and between them its
    /// quadratics are off by more.
    pub fn difference_at_steps(&self, longer: &Self) -> Errors {
        Errors { stress: self.difference_of_tension(longer), ..self.off_at_steps_of(longer, self) }
    }

    /// Largest difference in force between two traces over this one's peak, at the middles and ends of the first one's steps.
    fn off_at_steps_of(&self, one: &Self, another: &Self) -> Errors {
        let peak = self.peak().max(f64::MIN_POSITIVE);
        let end = one.first_end().max(another.first_end());
        let (mut largest, mut there) = (Errors::default(), Cursor::default());
        for (begin, step, [_, middle, last]) in &one.steps {
            for (time, force) in [(begin + 0.5 * step, *middle), (begin + step, *last)] {
                let off = (force - there.force(another, time)).abs() / peak;
                largest.history = largest.history.max(off);
                if time <= end {
                    largest.first_contact = largest.first_contact.max(off);
                }
            }
        }
        largest
    }
}

/// A place in a trace that is read at times one after the other: mostly it stays or goes on by one.
#[derive(Default)]
struct Cursor {
    /// How many steps begin, or tensions lie, before the last time asked for.
    passed: usize,
}

impl Cursor {
    /// Counts the sorted entries before a time.
    fn pass<T>(&mut self, entries: &[T], is_before: impl Fn(&T) -> bool) -> usize {
        while entries.get(self.passed).is_some_and(&is_before) {
            self.passed += 1;
        }
        while self.passed > 0 && !is_before(&entries[self.passed - 1]) {
            self.passed -= 1;
        }
        self.passed
    }

    /// F at a time.
    fn force(&mut self, trace: &Trace, time: f64) -> f64 {
        let next = self.pass(&trace.steps, |(begin, _, _)| *begin <= time);
        let Some((begin, step, force)) = trace.steps.get(next.saturating_sub(1)) else { return 0.0 };
        quadratic(*force, ((time - begin) / step).clamp(0.0, 1.0))
    }

    /// The tension at a time, linear between those that are known; NaN where there is none.
    fn tension(&mut self, trace: &Trace, time: f64) -> f64 {
        let known = &trace.tension;
        let next = self.pass(known, |(at, _)| *at < time).min(known.len().saturating_sub(1));
        let (Some((b, after)), Some((a, before))) = (known.get(next), known.get(next.saturating_sub(1))) else {
            return f64::NAN;
        };
        if b > a { before + (after - before) * ((time - a) / (b - a)).clamp(0.0, 1.0) } else { *after }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Longer steps that are right where their law is met have no error, however far their quadratics are off between.
    #[test]
    fn longer_steps_are_judged_where_they_meet_the_law() {
        let sampled = |step: f64| {
            let mut trace = Trace::default();
            for i in 0..(2.0 / step).round() as i32 {
                let begin = step * f64::from(i);
                trace.push(begin, step, [0.0, 0.5, 1.0].map(|part| (begin + part * step).sin()));
            }
            trace
        };
        let (shorter, longer) = (sampled(0.2), sampled(0.4));
        let at_steps = shorter.difference_at_steps(&longer);
        assert!(at_steps.history < 1e-15 && at_steps.first_contact < 1e-15, "{at_steps:?}");
        // The cubic term of a sine that a quadratic lacks: h³/(72 √3) at most, with h = 0.4, and 0.4³/384·3 at a quarter.
        let everywhere = shorter.difference(&longer).history;
        assert!(everywhere > 1e-4 && everywhere < 0.4_f64.powi(3) / 72.0, "{everywhere}");
    }

    /// A cursor finds what a search in the whole trace finds, at times in any order.
    #[test]
    fn cursors_read_as_searches_do() {
        let mut trace = Trace::default();
        for i in 0..40 {
            let begin = 0.1 * f64::from(i);
            let values = [0.0, 0.05, 0.1].map(|more| (begin + more).sin());
            trace.push(begin, 0.1, values);
            trace.push_tension(begin + 0.1, (begin + 0.1).cos());
        }
        let (mut force, mut tension) = (Cursor::default(), Cursor::default());
        for time in [-1.0, 0.0, 0.03, 0.1, 0.17, 2.9, 2.95, 1.0, 0.4, 3.99, 4.5, 0.05] {
            assert_eq!(force.force(&trace, time), Cursor::default().force(&trace, time));
            // The linear interpolant of a cosine, off by h²/8 at most, and what is beyond the ends as there.
            let exact = f64::clamp(time, 0.1, 4.0).cos();
            assert!((tension.tension(&trace, time) - exact).abs() < 0.1 * 0.1 / 8.0 + 1e-15, "{time}");
        }
        assert!(Cursor::default().tension(&Trace::default(), 0.0).is_nan());
    }
}
