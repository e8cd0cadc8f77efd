//! The contact's force over one step: the quadratic in time that satisfies the contact law at the middle and the end.

use crate::contact::Law;
use crate::scheme::modal::quadratic;

use super::answer::{Answer, LOOKS, NODES};

/// Newton iterations at most: a few serve, and steps that need more are too large.
const MOST: usize = 40;

/// A step's solution.
#[derive(Debug, Clone, Copy)]
pub struct Stage {
    /// F at 0, h/2 and h, N.
    pub force: [f64; 3],
    /// δ at the looks, m.
    pub approach: [f64; 4],
    /// Largest difference of law and quadratic at h/4 and 3h/4, N.
    pub defect: f64,
    /// Newton iterations.
    pub iterations: usize,
}

/// Solves δ_i + Σ_j s_ij Φ(δ_j) = δ*_i at h/2 and h from a guess of both (m), δ* the approach under the first value of the force alone;
/// `held` takes the last force for zero. `None` where Newton's method does not converge.
pub fn solve(law: &Law, answer: &Answer, free: [f64; 4], first: f64, guess: [f64; 2], held: bool) -> Option<Stage> {
    let known = NODES.map(|k| free[k] - answer.answers(k)[0] * first);
    let s = NODES.map(|k| [answer.answers(k)[1], answer.answers(k)[2]]);
    let law_at = |place: usize, approach: f64| match held && place == 1 {
        true => (0.0, 0.0),
        false => (law.force(approach), law.tangent(approach)),
    };
    let residual = |x: [f64; 2], f: [f64; 2]| [0, 1].map(|i| x[i] + s[i][0] * f[0] + s[i][1] * f[1] - known[i]);
    let size = |r: [f64; 2]| r[0].abs().max(r[1].abs());
    let mut x = guess;
    let mut at = [0, 1].map(|i| law_at(i, x[i]));
    let mut r = residual(x, at.map(|(f, _)| f));
    for iteration in 1..=MOST {
        let rounding = 4.0 * f64::EPSILON * (x[0].abs() + x[1].abs() + known[0].abs() + known[1].abs());
        let t = at.map(|(_, tangent)| tangent);
        let jacobian = [[1.0 + s[0][0] * t[0], s[0][1] * t[1]], [s[1][0] * t[0], 1.0 + s[1][1] * t[1]]];
        let determinant = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
        let change = [
            (jacobian[1][1] * r[0] - jacobian[0][1] * r[1]) / determinant,
            (jacobian[0][0] * r[1] - jacobian[1][0] * r[0]) / determinant,
        ];
        if !change[0].is_finite() || !change[1].is_finite() {
            return None;
        }
        if size(r) <= rounding {
            // The last correction goes to the forces, which a stiff contact needs to more digits than δ has.
            let force = [0, 1].map(|i| (at[i].0 - t[i] * change[i]).max(0.0));
            return Some(finish(law, answer, free, [first, force[0], force[1]], iteration));
        }
        let (old, mut part) = (size(r), 1.0);
        let start = x;
        loop {
            x = [0, 1].map(|i| start[i] - part * change[i]);
            at = [0, 1].map(|i| law_at(i, x[i]));
            r = residual(x, at.map(|(f, _)| f));
            // Rounding may stop the descent before the residual does.
            if size(r) < old || part < 1e-3 {
                break;
            }
            part *= 0.5;
        }
        if part < 1e-3 {
            return (old <= 1e3 * rounding).then(|| finish(law, answer, free, [first, at[0].0, at[1].0], iteration));
        }
    }
    None
}

fn finish(law: &Law, answer: &Answer, free: [f64; 4], force: [f64; 3], iterations: usize) -> Stage {
    let approach = [0, 1, 2, 3].map(|k| {
        let a = answer.answers(k);
        free[k] - a[0] * force[0] - a[1] * force[1] - a[2] * force[2]
    });
    let off = |k: usize| (law.force(approach[k]) - quadratic(force, LOOKS[k])).abs();
    Stage { force, approach, defect: off(0).max(off(2)), iterations }
}
