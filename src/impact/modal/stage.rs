//! Contact force over one step: the quadratic in time that satisfies the contact law at the middle and the end of the
//! step.

use crate::contact::{Damped, Law};
use crate::scheme::modal::{SLOPES, quadratic, slopes};

use super::step_response::{NODES, SAMPLE_POINTS, StepResponse};

/// Largest number of Newton iterations. A few are enough; a step that needs more is too large.
const MAX_ITERATIONS: usize = 40;

/// Solution of a step.
#[derive(Debug, Clone, Copy)]
pub struct Stage {
    /// Contact force F at 0, h/2 and h, N.
    pub force: [f64; 3],
    /// Approach δ at [`SAMPLE_POINTS`], m.
    pub approach: [f64; 4],
    /// Largest difference between the contact law and the quadratic at h/4 and 3h/4, N.
    pub defect: f64,
    /// Number of Newton iterations.
    pub iterations: usize,
}

impl Stage {
    /// Largest difference between the quadratic and the straight line between its ends, N.
    pub fn bend(&self) -> f64 {
        let [first, middle, last] = self.force;
        (middle - 0.5 * (first + last)).abs()
    }
}

/// A step in contact without damping.
pub struct ContactStep<'a> {
    /// Contact law Φ.
    pub law: &'a Law,
    /// Response of body and impactor over the step.
    pub response: &'a StepResponse,
    /// Approach at [`SAMPLE_POINTS`] without a contact force, m.
    pub free: [f64; 4],
    /// Contact force at the beginning of the step, N.
    pub first: f64,
    /// Guess of the approach at h/2 and h, m.
    pub guess: [f64; 2],
    /// Whether the contact force at the end of the step is zero.
    pub held: bool,
}

impl ContactStep<'_> {
    /// Solves δ_i + Σ_j s_ij Φ(δ_j) = δ*_i at h/2 and h. Here δ* is the approach under the first value of the force alone,
    /// which is known. `None` if Newton's method does not converge.
    ///
    /// If the law's compliance is negative, it becomes part of s, and the unknowns are the indentations, in which the force
    /// is explicit. For a law that is much stiffer than the body this may not converge; the unknowns are then the
    /// approaches.
    pub fn solve(&self) -> Option<Stage> {
        let explicit = self.law.is_explicit_in_indentation().then(|| self.newton(true));
        explicit.flatten().or_else(|| self.newton(false))
    }

    /// Newton's method with the indentations (`is_explicit`) or the approaches as unknowns.
    fn newton(&self, is_explicit: bool) -> Option<Stage> {
        let Self { law, response, free, first, guess, held } = *self;
        let known = NODES.map(|k| free[k] - response.responses(k)[0] * first);
        let mut s = NODES.map(|k| [response.responses(k)[1], response.responses(k)[2]]);
        let mut x = guess;
        if is_explicit {
            (0..2).for_each(|i| s[i][i] -= law.compliance);
            x = guess.map(|approach| law.indentation(approach, first));
        }
        let law_at = |place: usize, x: f64| match held && place == 1 {
            true => (0.0, 0.0),
            false if is_explicit => (law.force_law.force(x), law.force_law.tangent(x)),
            false => law.force_and_tangent(x),
        };
        let law_near = |_, approach: f64, force: f64| match is_explicit {
            true => law.force_near(approach, force),
            false => law.force(approach),
        };
        let residual = |x: [f64; 2], f: [f64; 2]| [0, 1].map(|i| x[i] + s[i][0] * f[0] + s[i][1] * f[1] - known[i]);
        let size = |r: [f64; 2]| r[0].abs().max(r[1].abs());
        let mut at = [0, 1].map(|i| law_at(i, x[i]));
        let mut r = residual(x, at.map(|(f, _)| f));
        for iteration in 1..=MAX_ITERATIONS {
            let rounding = 4.0 * f64::EPSILON * (x[0].abs() + x[1].abs() + known[0].abs() + known[1].abs());
            let t = at.map(|(_, tangent)| tangent);
            let jacobian = [[1.0 + s[0][0] * t[0], s[0][1] * t[1]], [s[1][0] * t[0], 1.0 + s[1][1] * t[1]]];
            let change = solve_pair(jacobian, r)?;
            if size(r) <= rounding {
                // The last correction is applied to the forces. A stiff contact needs them to more digits than δ provides.
                let force = [0, 1].map(|i| (at[i].0 - t[i] * change[i]).max(0.0));
                return Some(finish(response, free, [first, force[0], force[1]], iteration, law_near));
            }
            let (old, mut part) = (size(r), 1.0);
            let start = x;
            loop {
                x = [0, 1].map(|i| start[i] - part * change[i]);
                at = [0, 1].map(|i| law_at(i, x[i]));
                r = residual(x, at.map(|(f, _)| f));
                // Rounding can end the decrease of the residual before the bound is reached.
                if size(r) < old || part < 1e-3 {
                    break;
                }
                part *= 0.5;
            }
            if part < 1e-3 {
                let finish = || finish(response, free, [first, at[0].0, at[1].0], iteration, law_near);
                return (old <= 1e3 * rounding).then(finish);
            }
        }
        None
    }
}

/// Solves a step as [`ContactStep::solve`] does, for a force that also depends on δ̇. The rate is the derivative of the quartic through δ at the
/// beginning of the step and at [`SAMPLE_POINTS`].
///
/// Newton's method is applied to the forces at h/2 and h: F_i = Φ(δ_i, δ̇_i), where δ and δ̇ are linear in the forces.
pub fn solve_damped(
    law: &Law,
    response: &StepResponse,
    (begin, free): (f64, [f64; 4]),
    first: f64,
    guess: [f64; 2],
    held: bool,
) -> Option<Stage> {
    let approaches = |f: [f64; 2]| {
        let sample = |k: usize| {
            let a = response.responses(k);
            free[k] - a[0] * first - a[1] * f[0] - a[2] * f[1]
        };
        [begin, sample(0), sample(1), sample(2), sample(3)]
    };
    // Changes of δ and of δ̇ at the five points of the step for a force of 1 N at h/2 or at h.
    let moved =
        [1, 2].map(|j| [0, 1, 2, 3, 4].map(|k: usize| if k == 0 { 0.0 } else { -response.responses(k - 1)[j] }));
    let turned = moved.map(|values| slopes(values, response.step));
    let at = |f: [f64; 2]| {
        let all = approaches(f);
        let rates = slopes(all, response.step);
        // The five points begin with the start of the step, so a node's index among them is its index in SAMPLE_POINTS plus
        // one.
        NODES.map(|sample| (all[sample + 1], law.damped(all[sample + 1], rates[sample + 1])))
    };
    let residual =
        |f: [f64; 2], at: &[(f64, Damped); 2]| [f[0] - at[0].1.force, if held { f[1] } else { f[1] - at[1].1.force }];
    let size = |r: [f64; 2]| r[0].abs().max(r[1].abs());
    let mut f = [law.force(guess[0]), if held { 0.0 } else { law.force(guess[1]) }];
    let mut now = at(f);
    let mut r = residual(f, &now);
    for iteration in 1..=MAX_ITERATIONS {
        let largest = |part: fn(&Damped) -> f64| part(&now[0].1).max(part(&now[1].1));
        let extent = begin.abs() + now[0].0.abs() + now[1].0.abs();
        // The derivative of the quartic amplifies the rounding of its values.
        let steepest = largest(|at| at.stiffness) + SLOPES[4][3].abs() / response.step * largest(|at| at.viscosity);
        let rounding = 8.0 * f64::EPSILON * (size(f) + first + steepest * extent);
        let finished = |f: [f64; 2]| {
            let rates = slopes(approaches(f), response.step);
            finish(response, free, [first, f[0], f[1]], iteration, |sample, at, _| {
                law.damped(at, rates[sample + 1]).force
            })
        };
        if size(r) <= rounding {
            return Some(finished(f));
        }
        let slope = |i: usize, j: usize| {
            let (place, at) = (NODES[i] + 1, &now[i].1);
            at.stiffness * moved[j][place] + at.viscosity * turned[j][place]
        };
        let last = if held { [0.0, 1.0] } else { [-slope(1, 0), 1.0 - slope(1, 1)] };
        let jacobian = [[1.0 - slope(0, 0), -slope(0, 1)], last];
        let change = solve_pair(jacobian, r)?;
        let (old, start, mut part) = (size(r), f, 1.0);
        loop {
            f = [0, 1].map(|i| start[i] - part * change[i]);
            now = at(f);
            r = residual(f, &now);
            if size(r) < old || part < 1e-3 {
                break;
            }
            part *= 0.5;
        }
        if part < 1e-3 {
            return (old <= 1e3 * rounding).then(|| finished(start));
        }
    }
    None
}

/// Solution x of the two equations A x = r by Cramer's rule; `None` if it is not finite.
fn solve_pair(a: [[f64; 2]; 2], r: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    let x = [(a[1][1] * r[0] - a[0][1] * r[1]) / determinant, (a[0][0] * r[1] - a[1][0] * r[0]) / determinant];
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// Returns the stage of given forces; `force_at` is the contact law's force at a point of [`SAMPLE_POINTS`], its δ and the
/// force of the quadratic.
fn finish(
    response: &StepResponse,
    free: [f64; 4],
    force: [f64; 3],
    iterations: usize,
    force_at: impl Fn(usize, f64, f64) -> f64,
) -> Stage {
    let approach = [0, 1, 2, 3].map(|k| {
        let a = response.responses(k);
        free[k] - a[0] * force[0] - a[1] * force[1] - a[2] * force[2]
    });
    let off = |k: usize| {
        let near = quadratic(force, SAMPLE_POINTS[k]);
        (force_at(k, approach[k], near) - near).abs()
    };
    Stage { force, approach, defect: off(0).max(off(2)), iterations }
}
