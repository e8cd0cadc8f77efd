//! Contact episodes: their start and end, peak force and impulse.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::impact::checkpoint::Visitor;
use crate::impact::step::Step;

/// Uninterrupted contact, from the first step with F > 0 until α falls to zero. Damping can reduce F to zero before that,
/// and to rounding errors of either sign.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Episode {
    /// Time at which α rises through zero, s: between the last step without force and the first step with force.
    pub start: f64,
    /// Time at which α falls through zero, s; the time of the last step while the contact lasts.
    pub end: f64,
    /// Largest F at a step, N.
    pub peak_force: f64,
    /// Time of the step with the largest F, s.
    pub peak_time: f64,
    /// Impulse ∫ F dt on the body, N s.
    pub impulse: f64,
}

impl Episode {
    /// The episode of a row of the table of contacts.
    pub(super) fn of_columns([start, end, peak_force, peak_time, impulse]: [f64; 5]) -> Self {
        Self { start, end, peak_force, peak_time, impulse }
    }
}

/// Contact episodes of a sequence of steps.
#[derive(Debug, Clone, Default)]
pub struct Episodes {
    all: Vec<Episode>,
    last: Option<Step>,
}

impl Episodes {
    /// Adds the next step. Steps must come in the order of time, without gaps.
    pub fn push(&mut self, step: &Step) {
        let last = self.last.replace(*step);
        let was_open = self.was_open(last.as_ref());
        let is_open = step.contact.force > 0.0 || was_open && step.contact.approach > 0.0;
        if is_open && !was_open {
            self.all.push(Episode {
                start: last.map_or(step.time, |last| crossing(&last, step)),
                end: step.time,
                peak_force: 0.0,
                peak_time: step.time,
                impulse: 0.0,
            });
        }
        if !(is_open || was_open) {
            return;
        }
        let Some(episode) = self.all.last_mut() else {
            return;
        };
        if let Some(last) = last {
            episode.impulse += step.contact.impulse - last.contact.impulse;
        }
        episode.end = match last {
            Some(last) if !is_open => crossing(&last, step),
            _ => step.time,
        };
        if step.contact.force > episode.peak_force {
            episode.peak_force = step.contact.force;
            episode.peak_time = step.time;
        }
    }

    /// Saves the episodes to a checkpoint or restores them from it.
    ///
    /// # Errors
    /// Same as [`Visitor`].
    pub fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        let mut count = self.all.len();
        visitor.count("episodes", &mut count)?;
        if visitor.is_restoring() {
            // Elements are added one by one, so that a wrong count does not exhaust the memory.
            self.all.clear();
        }
        for number in 0..count {
            let mut episode = self.all.get(number).copied().unwrap_or_default();
            visitor.within(&format!("episode.{number}"), |visitor| {
                let Episode { start, end, peak_force, peak_time, impulse } = &mut episode;
                let numbers = [
                    ("start", start),
                    ("end", end),
                    ("peak_force", peak_force),
                    ("peak_time", peak_time),
                    ("impulse", impulse),
                ];
                numbers.into_iter().try_for_each(|(name, value)| visitor.number(name, value))
            })?;
            if visitor.is_restoring() {
                self.all.push(episode);
            }
        }
        let mut last = self.last.unwrap_or_default();
        visitor.within("last", |visitor| last.visit(visitor))?;
        self.last = Some(last);
        Ok(())
    }

    /// All episodes so far, in the order of time. While [`Self::is_open`], the last one ends at the last step.
    pub fn all(&self) -> &[Episode] {
        &self.all
    }

    /// Last step added.
    pub fn last(&self) -> Option<&Step> {
        self.last.as_ref()
    }

    /// Whether the body and the impactor are in contact at the last step.
    pub fn is_open(&self) -> bool {
        self.was_open(self.last.as_ref())
    }

    /// Whether the contact lasts at the last step.
    fn was_open(&self, last: Option<&Step>) -> bool {
        // The last episode ends there as long as it lasts.
        let lasts = |last: &Step| last.contact.approach > 0.0 && self.all.last().is_some_and(|of| of.end == last.time);
        last.is_some_and(|last| last.contact.force > 0.0 || lasts(last))
    }
}

/// Time between two steps at which δ (and with it α) is zero. It is a root of the cubic Hermite interpolant of values
/// and rates, found by bisection. If δ does not change its sign, it is the time of the step with the smaller |δ|.
fn crossing(last: &Step, step: &Step) -> f64 {
    let length = step.time - last.time;
    let (from, to) = (last.contact.approach, step.contact.approach);
    if (from > 0.0) == (to > 0.0) {
        return if from.abs() < to.abs() { last.time } else { step.time };
    }
    let (rate_from, rate_to) = (length * last.contact.rate, length * step.contact.rate);
    let cubic = |x: f64| {
        let (y, hermite) = (1.0 - x, x * x * (3.0 - 2.0 * x));
        from * (1.0 - hermite) + to * hermite + x * y * (rate_from * y - rate_to * x)
    };
    let (mut low, mut high) = (0.0, 1.0);
    // 53 bisections resolve 2⁻⁵³ of the step.
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        if (cubic(middle) > 0.0) == (from > 0.0) { low = middle } else { high = middle }
    }
    last.time + low * length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::step::Contact;
    use std::f64::consts::PI;

    fn step(number: usize, time: f64, (indentation, rate): (f64, f64), force: f64) -> Step {
        let contact = Contact { force, indentation, approach: indentation, rate, ..Contact::default() };
        Step { number, time, contact, ..Step::default() }
    }

    /// Episodes of F = k ⟨α⟩ at the times n Δt, n = 0 … steps. `alpha` returns α and its rate at a time.
    fn of(alpha: impl Fn(f64) -> (f64, f64), dt: f64, steps: usize) -> Episodes {
        let mut episodes = Episodes::default();
        for n in 0..=steps {
            let (t, a) = (n as f64 * dt, alpha(n as f64 * dt));
            episodes.push(&step(n, t, a, 1e3 * a.0.max(0.0)));
        }
        episodes
    }

    #[test]
    fn linear_indentation_is_located_exactly() {
        // α = 1 − |t − 2|/0.7 is linear around its zeros 1.3 and 2.7, which lie between steps.
        let episodes = of(|t| (1.0 - (t - 2.0).abs() / 0.7, (2.0 - t).signum() / 0.7), 0.25, 16);
        let [e] = episodes.all() else { panic!("{:?}", episodes.all()) };
        // Only rounding errors.
        assert!((e.start - 1.3).abs() < 1e-14 && (e.end - 2.7).abs() < 1e-14);
        assert_eq!((e.peak_force, e.peak_time), (1e3, 2.0));
        assert!(!episodes.is_open());
    }

    #[test]
    fn errors_on_a_sine_keep_within_the_bound_of_the_cubic() {
        // α = sin t + 0.3: in contact from t = 0 to π + z, and from 2π − z to 3π + z, z = asin 0.3.
        let z = 0.3_f64.asin();
        for steps in [64, 256, 1024] {
            let h = 11.0 / steps as f64;
            let episodes = of(|t| (t.sin() + 0.3, t.cos()), h, steps);
            let [a, b] = *episodes.all() else { panic!("{:?}", episodes.all()) };
            assert_eq!(a.start, 0.0);
            // The error of the cubic is at most h⁴/384 max|α⁗|, divided by the slope |α′| = cos z at the zero. The
            // factor 0.9 allows for the change of the slope within a step. At the largest number of steps only rounding
            // errors remain.
            let bound = h.powi(4) / 384.0 / (0.9 * z.cos()) + 1e-14;
            for (time, exact) in [(a.end, PI + z), (b.start, 2.0 * PI - z), (b.end, 3.0 * PI + z)] {
                assert!((time - exact).abs() < bound, "{time} {exact} {bound}");
            }
        }
    }

    /// The force of a damped contact vanishes to rounding long before α does: there is one contact, which ends with α.
    #[test]
    fn a_contact_lasts_as_long_as_the_indentation() {
        let mut episodes = Episodes::default();
        for (n, force) in [0.0, 3.0, 1e-13, 0.0, 2e-13, 0.0, 0.0, 0.0].into_iter().enumerate() {
            let indentation = if n == 0 { 0.0 } else { 5.5 - n as f64 };
            episodes.push(&step(n, n as f64, (indentation, -1.0), force));
        }
        let [Episode { start, end, .. }] = *episodes.all() else { panic!("{:?}", episodes.all()) };
        // α is linear between the last steps: its zero is found to rounding.
        assert!(start < 1.0 && (end - 5.5).abs() < 1e-14 && !episodes.is_open());
    }

    #[test]
    fn impulses_are_those_of_each_episode() {
        let forces = [0.0, 2.0, 0.0, 3.0, 5.0, 0.0, 0.0, 1.0];
        let mut episodes = Episodes::default();
        let (mut impulse, mut last) = (0.0, 0.0);
        for (n, f) in forces.into_iter().enumerate() {
            // Impulse by Newmark's method with γ = 1/2.
            impulse += 0.5 * (last + f) * 0.5;
            last = f;
            let mut step = step(n, n as f64 * 0.5, (if f > 0.0 { f } else { -1.0 }, 0.0), f);
            step.contact.impulse = impulse;
            episodes.push(&step);
        }
        let impulses: Vec<f64> = episodes.all().iter().map(|e| e.impulse).collect();
        assert_eq!(impulses, [1.0, 4.0, 0.25]);
        assert!(episodes.is_open());
        assert_eq!(episodes.all()[2].end, 3.5);
    }
}
