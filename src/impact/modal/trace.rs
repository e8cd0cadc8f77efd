//! Contact force of a run as a function of time: one quadratic for each step.

use crate::impact::Errors;
use crate::scheme::modal::quadratic;

/// Fraction of the largest tension above which a tension is near the peak. Differences between two histories before
/// that do not change their peaks.
const NEAR_PEAK: f64 = 0.9;

/// Number of neighbouring values through which a cubic polynomial interpolates the deflection.
const INTERPOLATED: usize = 4;

/// Least length of a step, relative to the one before it, at whose end a deflection is added.
const LEAST_STEP_RATIO: f64 = 1e-6;

/// Least deflection that is compared, relative to the largest distance that the impactor moves.
const LEAST_DEFLECTION: f64 = 1e-7;

/// Largest stresses at the hit and elsewhere, divided by the larger one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PartsOfLargest {
    /// Stress opposite the impact point.
    hit: f64,
    /// Stress at the other watched places.
    elsewhere: f64,
}

impl PartsOfLargest {
    /// Errors of the largest stress due to relative errors of the stress opposite the impact point and of the stresses
    /// elsewhere: what an error exceeds the distance to the largest stress.
    fn effect(&self, of_hit: f64, elsewhere: f64) -> f64 {
        let effect = |error: f64, part: f64| (error * part - (1.0 - part)).max(0.0);
        effect(of_hit, self.hit).max(effect(elsewhere, self.elsewhere))
    }
}

/// Contact force F(t) on the modelled part, N, with the tension opposite the impact point.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct Trace {
    /// Beginning and size of each step, s, and the force at its beginning, middle and end, N.
    steps: Vec<(f64, f64, [f64; 3])>,
    /// Time (s) and tension on the face opposite the impact point (Pa), if it is read.
    tension: Vec<(f64, f64)>,
    /// Largest stress opposite the impact point and at each watched place, Pa: in the first contact, and in the whole run. Empty if
    /// they are not read.
    watched: [Vec<f64>; 2],
    /// Time (s) and displacement of the surface under the impactor (m) at the ends of the steps, if it is read.
    deflection: Vec<(f64, f64)>,
    /// Largest distance that the impactor has moved, m.
    travel: f64,
    /// Whether there has been a force, and the end of the first contact, s.
    has_touched: bool,
    end: Option<f64>,
}

impl Trace {
    /// Adds a step: beginning and size, s, and force at its beginning, middle and end, N.
    pub fn push(&mut self, begin: f64, step: f64, force: [f64; 3]) {
        self.steps.push((begin, step, force));
        self.has_touched |= force[1] > 0.0;
        if self.has_touched && self.end.is_none() && force[2] == 0.0 {
            self.end = Some(begin + step);
        }
    }

    /// Time up to which tensions are needed, s. Two traces are compared up to the later end of their first contacts. If
    /// these ends differ by a factor of two, the motions are different anyway.
    pub fn needs_tension_until(&self) -> f64 {
        2.0 * self.first_end()
    }

    /// Adds a tension (Pa) at a time (s).
    pub fn push_tension(&mut self, time: f64, tension: f64) {
        self.tension.push((time, tension));
    }

    /// Adds the stresses opposite the impact point and at watched places at a time (Pa).
    pub fn push_watched(&mut self, stresses: impl Iterator<Item = f64> + Clone, is_in_first_contact: bool) {
        for largest in &mut self.watched[if is_in_first_contact { 0 } else { 1 }..] {
            if largest.is_empty() {
                largest.extend(stresses.clone());
            } else {
                largest.iter_mut().zip(stresses.clone()).for_each(|(largest, stress)| *largest = largest.max(stress));
            }
        }
    }

    /// Adds the displacements of the surface under the impactor and of the impactor (m) at the end of a step (s). A step
    /// that is far shorter than the one before it replaces its end, since the interpolation divides by it.
    pub fn push_deflection(&mut self, time: f64, deflection: f64, impactor: f64) {
        self.travel = self.travel.max(impactor.abs());
        if let [.., (before, _), last] = &mut self.deflection[..]
            && time - last.0 < LEAST_STEP_RATIO * (last.0 - *before)
        {
            *last = (time, deflection);
        } else {
            self.deflection.push((time, deflection));
        }
    }

    /// Whether there was a contact force at any time.
    pub fn has_contact(&self) -> bool {
        self.has_touched
    }

    /// Largest of the force values, N.
    pub fn peak(&self) -> f64 {
        self.steps.iter().flat_map(|(_, _, force)| *force).fold(0.0, f64::max)
    }

    /// Contact force F at a time (s), N.
    pub fn at(&self, time: f64) -> f64 {
        Cursor::default().force(self, time)
    }

    /// End of the first contact, s; infinite if it has not ended.
    pub fn first_end(&self) -> f64 {
        self.end.unwrap_or(f64::INFINITY)
    }

    /// Largest differences in stress to another trace, relative to the largest stress at the hit and the watched places: in
    /// the first contact, and in the whole run. NaN if a trace has no stresses.
    fn differences_of_stress(&self, other: &Self) -> [f64; 2] {
        let (of_hit, at_hit) = self.difference_of_tension(other);
        let mut largest = 0.0_f64;
        [0, 1].map(|span| {
            let (own, others) = (&self.watched[span], &other.watched[span]);
            let most = own.iter().copied().fold(at_hit, f64::max);
            // An error at a place changes the largest stress only by what it exceeds the distance to the largest stress.
            let off = own
                .iter()
                .zip(others)
                .map(|(one, another)| ((one - another).abs() - (most - one.max(*another)).max(0.0)) / most);
            // (A missing difference at the hit is NaN, and a maximum would drop it.)
            largest = if of_hit.is_nan() { f64::NAN } else { off.fold(largest.max(of_hit * at_hit / most), f64::max) };
            largest
        })
    }

    /// Parts of the largest stress, in the first contact and in the whole run: the stress opposite the impact point, and the
    /// largest one at watched places. 1 for the hit alone if no stresses are read.
    fn parts_of_largest_stress(&self) -> [PartsOfLargest; 2] {
        let end = self.first_end();
        let first = self.tension.iter().filter(|(time, _)| *time <= end);
        let in_first = first.map(|(_, tension)| *tension).fold(0.0, f64::max);
        self.watched.each_ref().map(|watched| {
            let at_hit = watched.first().copied().unwrap_or_default().max(in_first);
            let elsewhere = watched.iter().skip(1).copied().fold(0.0, f64::max);
            let most = at_hit.max(elsewhere);
            if most > 0.0 {
                PartsOfLargest { hit: at_hit / most, elsewhere: elsewhere / most }
            } else {
                PartsOfLargest { hit: 1.0, elsewhere: 0.0 }
            }
        })
    }

    /// Errors of the largest stress alone, in the first contact and in the whole run, due to relative errors of the stress
    /// opposite the impact point and of the stresses elsewhere.
    pub fn errors_of_largest_stress(&self, of_hit: f64, elsewhere: f64) -> Errors {
        let [stress, stress_history] = self.parts_of_largest_stress().map(|parts| parts.effect(of_hit, elsewhere));
        Errors { stress, stress_history, ..Errors::default() }
    }

    /// Largest difference in tension opposite the impact point to another trace in the first contact, relative to its
    /// peak; and the peak, Pa. Only times at which one of the two is near its own peak count. The difference is never less
    /// than that of the two peaks. NaN if a trace has no tension.
    fn difference_of_tension(&self, other: &Self) -> (f64, f64) {
        let end = self.first_end().max(other.first_end());
        let within = |trace: &Self| trace.tension.iter().filter(|(time, _)| *time <= end).copied().collect::<Vec<_>>();
        let (own, others) = (within(self), within(other));
        let is_unknown = |all: &[(f64, f64)]| all.is_empty() || all.iter().any(|(_, tension)| tension.is_nan());
        if is_unknown(&own) || is_unknown(&others) {
            return (f64::NAN, f64::NAN);
        }
        let peak = |all: &[(f64, f64)]| all.iter().map(|(_, tension)| *tension).fold(f64::MIN_POSITIVE, f64::max);
        let (most, others_most) = (peak(&own), peak(&others));
        let is_near_peak = |one: f64, another: f64| one > NEAR_PEAK * most || another > NEAR_PEAK * others_most;
        let (mut in_other, mut in_own) = (Cursor::default(), Cursor::default());
        let of_own = own.iter().map(|(time, tension)| (*tension, in_other.tension(other, *time)));
        let of_own: Vec<(f64, f64)> = of_own.collect();
        let of_others = others.iter().map(|(time, tension)| (in_own.tension(self, *time), *tension));
        let near_peak = of_own.into_iter().chain(of_others).filter(|(one, another)| is_near_peak(*one, *another));
        (near_peak.map(|(one, another)| (one - another).abs() / most).fold(0.0, f64::max), most)
    }

    /// Largest difference in deflection from another trace, relative to the largest deflection of this one. NaN if a
    /// trace has too few deflections, if there is no contact, or if the deflection is negligible compared with the
    /// distance that the impactor moves.
    fn difference_of_deflection(&self, other: &Self) -> f64 {
        let largest = self.deflection.iter().fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
        let is_short = self.deflection.len().min(other.deflection.len()) < INTERPOLATED;
        if is_short || !(self.has_touched || other.has_touched) || largest <= LEAST_DEFLECTION * self.travel {
            return f64::NAN;
        }
        let off = |one: &Self, another: &Self| {
            let mut there = Cursor::default();
            let off = one.deflection.iter().map(|(time, value)| (value - there.deflection(another, *time)).abs());
            off.fold(0.0, f64::max)
        };
        off(self, other).max(off(other, self)) / largest
    }

    /// Largest difference to another trace, relative to the peak of this one, at the middles and ends of the steps of
    /// both.
    pub fn difference(&self, other: &Self) -> Errors {
        let [stress, stress_history] = self.differences_of_stress(other);
        Errors {
            stress,
            stress_history,
            deflection: self.difference_of_deflection(other),
            ..self.off_at_steps_of(self, other).max(self.off_at_steps_of(other, self))
        }
    }

    /// Same as [`Self::difference`] to a trace in longer steps, but with the force compared only at the middles and
    /// ends of the longer steps. There the longer steps satisfy the contact law; between these points their quadratics
    /// have larger errors.
    pub fn difference_at_steps(&self, longer: &Self) -> Errors {
        let [stress, stress_history] = self.differences_of_stress(longer);
        Errors {
            stress,
            stress_history,
            deflection: self.difference_of_deflection(longer),
            ..self.off_at_steps_of(longer, self)
        }
    }

    /// Largest difference in force between two traces, relative to the peak of `self`, at the middles and ends of the
    /// steps of `one`.
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

/// Reading position in a trace. It is fast for times in sequence, because the position then usually remains or advances
/// by one.
#[derive(Default)]
struct Cursor {
    /// Number of steps that begin, or of tensions, before the last time asked for.
    passed: usize,
}

impl Cursor {
    /// Returns the number of sorted entries before a time.
    fn pass<T>(&mut self, entries: &[T], is_before: impl Fn(&T) -> bool) -> usize {
        while entries.get(self.passed).is_some_and(&is_before) {
            self.passed += 1;
        }
        while self.passed > 0 && !is_before(&entries[self.passed - 1]) {
            self.passed -= 1;
        }
        self.passed
    }

    /// Contact force F at a time (s), N.
    fn force(&mut self, trace: &Trace, time: f64) -> f64 {
        let next = self.pass(&trace.steps, |(begin, _, _)| *begin <= time);
        let Some((begin, step, force)) = trace.steps.get(next.saturating_sub(1)) else { return 0.0 };
        quadratic(*force, ((time - begin) / step).clamp(0.0, 1.0))
    }

    /// Deflection at a time (s), m, by the polynomial through the four nearest ends of steps. The trace must have at least four.
    fn deflection(&mut self, trace: &Trace, time: f64) -> f64 {
        let known = &trace.deflection;
        let next = self.pass(known, |(at, _)| *at < time);
        let first = next.saturating_sub(INTERPOLATED / 2).min(known.len() - INTERPOLATED);
        cubic(std::array::from_fn(|i| known[first + i]), time)
    }

    /// Tension at a time (s), Pa, by linear interpolation; NaN if the trace has no tension.
    fn tension(&mut self, trace: &Trace, time: f64) -> f64 {
        let known = &trace.tension;
        let next = self.pass(known, |(at, _)| *at < time).min(known.len().saturating_sub(1));
        let (Some((b, after)), Some((a, before))) = (known.get(next), known.get(next.saturating_sub(1))) else {
            return f64::NAN;
        };
        if b > a { before + (after - before) * ((time - a) / (b - a)).clamp(0.0, 1.0) } else { *after }
    }
}

/// Value at a time of the cubic polynomial through four points (time and value), by Lagrange's formula.
fn cubic(points: [(f64, f64); INTERPOLATED], time: f64) -> f64 {
    let [(a, _), (b, _), (c, _), (d, _)] = points;
    let [to_a, to_b, to_c, to_d] = [a, b, c, d].map(|at| time - at);
    let [ab, ac, ad, bc, bd, cd] = [a - b, a - c, a - d, b - c, b - d, c - d];
    let weights = [
        to_b * to_c * to_d / (ab * ac * ad),
        -(to_a * to_c * to_d) / (ab * bc * bd),
        to_a * to_b * to_d / (ac * bc * cd),
        -(to_a * to_b * to_c) / (ad * bd * cd),
    ];
    points.iter().zip(weights).map(|((_, value), weight)| weight * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Longer steps that are exact where they satisfy the law have no error, whatever the error of their quadratics in
    /// between.
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
        // Interpolation error of a sine by a quadratic: at most h³/(72 √3), with h = 0.4, and 0.4³/384·3 at a quarter.
        let everywhere = shorter.difference(&longer).history;
        assert!(everywhere > 1e-4 && everywhere < 0.4_f64.powi(3) / 72.0, "{everywhere}");
    }

    /// Two traces of one deflection in different steps differ by the interpolation only. A third one, larger by one part
    /// in a hundred, differs by that. Traces with too few steps are not compared.
    #[test]
    fn deflections_are_compared_between_steps() {
        let sampled = |step: f64, factor: f64| {
            let mut trace = Trace { has_touched: true, ..Trace::default() };
            (0..=(3.0 / step).round() as i32).map(|i| step * f64::from(i)).for_each(|time| {
                trace.push_deflection(time, factor * time.sin(), 1.0);
            });
            trace
        };
        let (one, other, larger) = (sampled(0.1, 1.0), sampled(0.15, 1.0), sampled(0.15, 1.01));
        let [same, off] = [&other, &larger].map(|trace| one.difference(trace).deflection);
        // A cubic through four points at distances h has an error of at most h⁴/24.
        let rounded = 0.15_f64.powi(4) / 24.0;
        assert!(same > 0.0 && same < rounded, "{same:e}");
        assert!((off - 0.01).abs() < 2.0 * rounded, "{off:e}");
        assert!(one.difference(&sampled(1.5, 1.0)).deflection.is_nan());
        // Nor are deflections that are rounding errors of the distance.
        assert!(sampled(0.1, 1e-12).difference(&other).deflection.is_nan());
    }

    /// A second contact has the largest stress opposite the impact point. Its error is that of the whole run, and not that of
    /// the first contact.
    #[test]
    fn a_later_stress_at_the_hit_has_its_own_error() {
        let hit_again = |later: f64| {
            let mut trace = Trace::default();
            trace.push(0.0, 1.0, [0.0, 1.0, 0.0]);
            for (time, at_hit) in [(0.5, 1.0), (1.0, 0.0)] {
                trace.push_tension(time, at_hit);
                trace.push_watched([at_hit, 0.2].into_iter(), true);
            }
            trace.push_watched([later, 0.1].into_iter(), false);
            trace
        };
        let (one, other) = (hit_again(2.0), hit_again(2.1));
        let Errors { stress, stress_history, .. } = one.difference(&other);
        assert!(stress == 0.0 && (stress_history - 0.05).abs() < 1e-15, "{stress} {stress_history}");
        let Errors { stress, stress_history, .. } = one.errors_of_largest_stress(0.1, 0.0);
        assert_eq!((stress, stress_history), (0.1, 0.1));
    }

    /// A cursor gives the same values as a search in the whole trace, for times in any order.
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
            // Linear interpolation of a cosine has an error of at most h²/8; beyond the ends the value is constant.
            let exact = f64::clamp(time, 0.1, 4.0).cos();
            assert!((tension.tension(&trace, time) - exact).abs() < 0.1 * 0.1 / 8.0 + 1e-15, "{time}");
        }
        assert!(Cursor::default().tension(&Trace::default(), 0.0).is_nan());
    }
}
