//! A force as a run gives it: quadratics in time, one a step.

use crate::impact::Errors;
use crate::scheme::modal::quadratic;

/// F(t), N.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    /// Begin and size of each step, s, and its three values.
    steps: Vec<(f64, f64, [f64; 3])>,
    /// The tension under the hit on the other face, where it is read: s, Pa.
    tension: Vec<(f64, f64)>,
}

impl Trace {
    /// Adds a step.
    pub fn push(&mut self, begin: f64, step: f64, force: [f64; 3]) {
        self.steps.push((begin, step, force));
    }

    /// Adds a tension (Pa) at a time, s.
    pub fn push_tension(&mut self, time: f64, tension: f64) {
        self.tension.push((time, tension));
    }

    /// The tension at a time, linear between those that are known; NaN where there is none.
    fn tension_at(&self, time: f64) -> f64 {
        let next = self.tension.partition_point(|(at, _)| *at < time).min(self.tension.len().saturating_sub(1));
        let (Some((b, after)), Some((a, before))) = (self.tension.get(next), self.tension.get(next.saturating_sub(1)))
        else {
            return f64::NAN;
        };
        if b > a { before + (after - before) * ((time - a) / (b - a)).clamp(0.0, 1.0) } else { *after }
    }

    /// Largest of the values.
    pub fn peak(&self) -> f64 {
        self.steps.iter().flat_map(|(_, _, force)| *force).fold(0.0, f64::max)
    }

    /// F at a time.
    pub fn at(&self, time: f64) -> f64 {
        let next = self.steps.partition_point(|(begin, _, _)| *begin <= time);
        let Some((begin, step, force)) = self.steps.get(next.saturating_sub(1)) else { return 0.0 };
        quadratic(*force, ((time - begin) / step).clamp(0.0, 1.0))
    }

    /// End of the first contact, s; infinite while it lasts.
    pub fn first_end(&self) -> f64 {
        let touched = self.steps.iter().position(|(_, _, force)| force[1] > 0.0).unwrap_or(self.steps.len());
        let end = self.steps[touched..].iter().find(|(_, _, force)| force[2] == 0.0);
        end.map_or(f64::INFINITY, |(begin, step, _)| begin + step)
    }

    /// Largest difference to another trace over the peak: that in force and, up to a step's length, in time.
    pub fn difference(&self, other: &Self) -> Errors {
        let peak = self.peak().max(f64::MIN_POSITIVE);
        let end = self.first_end().max(other.first_end());
        let times = |trace: &Self| {
            trace.steps.iter().flat_map(|(begin, step, _)| [begin + 0.5 * step, begin + step]).collect::<Vec<f64>>()
        };
        let mut largest = Errors::default();
        for time in times(self).into_iter().chain(times(other)) {
            let off = (self.at(time) - other.at(time)).abs() / peak;
            largest.history = largest.history.max(off);
            if time <= end {
                largest.first_contact = largest.first_contact.max(off);
            }
        }
        // Relative to the largest tension of the first contact.
        let within = |trace: &Self| trace.tension.iter().filter(|(time, _)| *time <= end).copied().collect::<Vec<_>>();
        let all = within(self);
        let most = all.iter().map(|(_, tension)| *tension).fold(0.0, f64::max);
        largest.stress = match all.is_empty() || other.tension.is_empty() {
            true => f64::NAN,
            false => {
                all.iter().map(|(time, tension)| (tension - other.tension_at(*time)).abs() / most).fold(0.0, f64::max)
            }
        };
        largest
    }
}
