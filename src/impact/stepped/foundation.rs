//! The nonlinear equations of a step on pads, condensed to the unknowns that pads and contact push: small, dense, on one rank.
//!
//! With z = (e, δ) the increments of the pads' unknowns and the approach, φ = (p, F) the forces on them, and the compliance
//!
//! Ĝ = (G, −g; −gᵀ, s),   G = PᵀS⁻¹P,  g = Pᵀw,
//!
//! z = z* − Ĝφ has to meet φ = f(z). This is the zero of the gradient r = f(z) − φ of a strictly convex potential, whose Hessian
//! is Ĝ⁻¹ + D with the semi-smooth derivative D of f (L. Qi & J. Sun, A nonsmooth version of Newton's method, Math. Program. 58,
//! 1993). The forces are what is iterated, and z follows from them by a product with Ĝ: so r is free of Ĝ's condition number, and it
//! is the residual of the full equations.
//!
//! D changes in few points from one iteration to the next, as from step to step. So a factor of Ĝ⁻¹ + D is kept and
//! preconditions conjugate gradients. With M the matrix of the kept factor, M times the search direction follows from the
//! recurrence of that direction, and only the difference of the two D is ever multiplied.

use std::convert::Infallible;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::form::pressed_depth;
use crate::scheme::StageForce;

use super::line_search::step_length;

/// A bound for what cannot converge.
const MAX_ITERATIONS: usize = 1000;

/// The residual of Newton's linear equations, as a part of the one before.
const FORCING: f64 = 1e-4;

/// Roundings in z, in what D is multiplied by and in the sum over points.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Rank of Ĝ over the iterations of conjugate gradients from which a new factor is cheaper.
const RENEW: usize = 20;

/// The points of pads in the order of Ĝ.
pub struct Points {
    /// w, N/m, by point.
    pub weights: Vec<f64>,
    /// s ū, m, by point.
    pub offsets: Vec<f64>,
    /// How many unknowns each point has.
    pub counts: Vec<usize>,
    /// Columns of Ĝ, point by point; held unknowns have numbers behind those.
    pub columns: Vec<usize>,
    /// s φ_a, likewise.
    pub values: Vec<f64>,
}

/// What a step adds.
pub struct Step<'a> {
    /// F(δ).
    pub contact: &'a StageForce,
    /// s (u_n − ū) at the points, m.
    pub penetration: &'a [f64],
    /// Norm of r that counts as none, N.
    pub tolerance: f64,
}

/// How a solution ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Newton iterations.
    pub iterations: usize,
    /// |r|, N.
    pub residual: f64,
    /// Whether that is small enough, or what rounding leaves.
    pub converged: bool,
}

/// The condensed equations of one step size.
pub struct Reduced {
    points: Points,
    /// Ĝ, m/N; the contact's row is the last.
    compliance: DMatrix<f64>,
    /// Ĝ⁻¹, which serves for directions alone.
    stiffness: DMatrix<f64>,
    kept: Option<Kept>,
    /// φ, N: of the last step, until the next is solved.
    pub forces: DVector<f64>,
    /// D by point, and F′, N/m.
    tangents: Vec<f64>,
}

/// A factor of Ĝ⁻¹ + D, with its D.
struct Kept {
    factor: Cholesky<f64, Dyn>,
    tangents: Vec<f64>,
}

impl Reduced {
    /// From Ĝ; `None` where it is not positive definite to rounding.
    pub(super) fn new(points: Points, compliance: DMatrix<f64>) -> Option<Self> {
        let size = compliance.nrows();
        let mut raised = compliance.clone();
        // What rounding in the columns of Ĝ may have made negative.
        (0..size).for_each(|i| raised[(i, i)] *= 1.0 + 1e-12);
        let stiffness = raised.cholesky()?.inverse();
        Some(Self {
            tangents: vec![0.0; points.weights.len() + 1],
            points,
            compliance,
            stiffness,
            kept: None,
            forces: DVector::zeros(size),
        })
    }

    /// s (u − ū) at the points, m, of displacements in the order of the columns, the contact's idle.
    pub(super) fn penetration(&self, displacement: &[f64]) -> Vec<f64> {
        let at_point = |columns: &[usize], values: &[f64]| {
            columns.iter().zip(values).map(|(i, v)| v * displacement[*i]).sum::<f64>()
        };
        let entries = self.points.entries().zip(&self.points.offsets);
        entries.map(|((columns, values), offset)| at_point(columns, values) - offset).collect()
    }

    /// Solves for the forces, from a guess of them. `at` is z under forces `applied`.
    pub(super) fn solve(&mut self, step: &Step, at: &DVector<f64>, applied: &DVector<f64>) -> Convergence {
        // What rounding of the displacements is measured by.
        let largest = step.penetration.iter().chain(at.iter()).fold(0.0_f64, |max, value| max.max(value.abs()));
        let mut outcome = Convergence { iterations: 0, residual: f64::NAN, converged: false };
        loop {
            let z = at - &self.compliance * (&self.forces - applied);
            let r = self.push(step, &z) - &self.forces;
            let last = std::mem::replace(&mut outcome.residual, r.norm());
            let rounding = ROUNDING * largest * self.points.stiffest(self.tangents[self.points.weights.len()]);
            // Where rounding may be all that is left, iterations go on while they make it less.
            let idle = outcome.residual <= rounding && outcome.residual >= 0.5 * last;
            outcome.converged = outcome.residual <= step.tolerance || idle;
            if outcome.converged || !outcome.residual.is_finite() || outcome.iterations == MAX_ITERATIONS {
                return outcome;
            }
            let way = self.direction(-r, step.tolerance);
            let forces = -(&self.stiffness * &way);
            let (before, change) = (self.forces.dot(&way), forces.dot(&way));
            let slope = |length: f64| {
                let pushed = self.push(step, &(&z + length * &way)).dot(&way);
                Ok::<_, Infallible>(pushed - before - length * change)
            };
            let Ok(length) = step_length(slope);
            self.forces.axpy(length, &forces, 1.0);
            outcome.iterations += 1;
        }
    }

    /// f(z), N; leaves its tangents.
    fn push(&mut self, step: &Step, z: &DVector<f64>) -> DVector<f64> {
        let StageForce { gradient, theta, .. } = *step.contact;
        // Points see the displacement at the stage, or, for a mean force, at the two ends of the step.
        let scale = if gradient { 1.0 / theta } else { 1.0 };
        let mut forces = DVector::zeros(z.len());
        let last = z.len() - 1;
        for (q, (columns, values)) in self.points.entries().enumerate() {
            let (from, weight) = (step.penetration[q], self.points.weights[q]);
            let to = from + scale * moving(columns, values, last).map(|(i, value)| value * z[i]).sum::<f64>();
            let (depth, slope) = pressed_depth(gradient.then_some(from), to);
            self.tangents[q] = weight * scale * slope;
            if depth != 0.0 {
                moving(columns, values, last).for_each(|(i, value)| forces[i] += weight * depth * value);
            }
        }
        (forces[last], self.tangents[self.points.weights.len()]) = step.contact.at(z[last]);
        forces
    }

    /// x of (Ĝ⁻¹ + D) x = b to a part of |b|, or of a tolerance where that is more.
    fn direction(&mut self, b: DVector<f64>, tolerance: f64) -> DVector<f64> {
        let most = 4 + b.len() / RENEW;
        let wanted = (FORCING * b.norm()).max(0.1 * tolerance);
        if let Some(kept) = &self.kept {
            let difference: Vec<f64> = self.tangents.iter().zip(&kept.tangents).map(|(now, then)| now - then).collect();
            let found = conjugate_gradients(
                &kept.factor,
                |x, out| self.points.add_tangent(&difference, x, out),
                &b,
                wanted,
                most,
            );
            if let Some(x) = found {
                return x;
            }
        }
        let mut matrix = self.stiffness.clone();
        self.points.add_tangent_matrix(&self.tangents, &mut matrix);
        // Positive definite but for rounding, where a descent along −r is what is left.
        let Some(factor) = matrix.cholesky() else {
            self.kept = None;
            return b;
        };
        let x = factor.solve(&b);
        self.kept = Some(Kept { factor, tangents: self.tangents.clone() });
        x
    }
}

/// x of (M + Δ) x = b to a residual, with the factor of M as preconditioner; `None` where `most` iterations do not do.
fn conjugate_gradients(
    factor: &Cholesky<f64, Dyn>,
    add_difference: impl Fn(&DVector<f64>, &mut DVector<f64>),
    b: &DVector<f64>,
    wanted: f64,
    most: usize,
) -> Option<DVector<f64>> {
    let mut x = DVector::zeros(b.len());
    let mut residual = b.clone();
    let mut direction = factor.solve(&residual);
    let mut old = residual.dot(&direction);
    // M times the direction: it obeys the direction's recurrence.
    let mut product = residual.clone();
    for _ in 0..most {
        let mut image = product.clone();
        add_difference(&direction, &mut image);
        let length = old / direction.dot(&image);
        x.axpy(length, &direction, 1.0);
        residual.axpy(-length, &image, 1.0);
        if residual.norm() <= wanted {
            return Some(x);
        }
        let preconditioned = factor.solve(&residual);
        let new = residual.dot(&preconditioned);
        direction *= new / old;
        direction += preconditioned;
        product *= new / old;
        product += &residual;
        old = new;
    }
    None
}

impl Points {
    /// Columns and values, by point.
    fn entries(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        self.counts.iter().scan(0, |end, count| {
            let start = std::mem::replace(end, *end + count);
            Some((&self.columns[start..*end], &self.values[start..*end]))
        })
    }

    /// Adds D x to `out`, D of tangents by point, the contact's last.
    fn add_tangent(&self, tangents: &[f64], x: &DVector<f64>, out: &mut DVector<f64>) {
        let last = x.len() - 1;
        for ((columns, values), tangent) in self.entries().zip(tangents).filter(|(_, tangent)| **tangent != 0.0) {
            let at_point: f64 = moving(columns, values, last).map(|(i, value)| value * x[i]).sum();
            moving(columns, values, last).for_each(|(i, value)| out[i] += tangent * at_point * value);
        }
        out[last] += tangents[self.weights.len()] * x[last];
    }

    /// Norm of the largest D, all points pressed but the contact's F′ as it is: what rounding of displacements is seen through,
    /// since a point may be pressed by no more than that.
    fn stiffest(&self, contact: f64) -> f64 {
        let at_point = |((_, values), weight): ((&[usize], &[f64]), &f64)| {
            let sum: f64 = values.iter().map(|value| value.abs()).sum();
            (weight * sum * sum).powi(2)
        };
        let pads: f64 = self.entries().zip(&self.weights).map(at_point).sum();
        (pads + contact * contact).sqrt()
    }

    /// Adds D to a matrix.
    fn add_tangent_matrix(&self, tangents: &[f64], out: &mut DMatrix<f64>) {
        let last = out.nrows() - 1;
        for ((columns, values), tangent) in self.entries().zip(tangents).filter(|(_, tangent)| **tangent != 0.0) {
            for (j, b) in moving(columns, values, last) {
                moving(columns, values, last).for_each(|(i, a)| out[(i, j)] += tangent * a * b);
            }
        }
        out[(last, last)] += tangents[self.weights.len()];
    }
}

/// A point's entries in the columns before the contact's: the free ones.
fn moving<'a>(columns: &'a [usize], values: &'a [f64], last: usize) -> impl Iterator<Item = (usize, f64)> {
    columns.iter().copied().zip(values.iter().copied()).filter(move |(i, _)| *i < last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ForceLaw, Hertz, Law};

    /// A chain of ten unknowns under thirty points, and a contact: G = exp(−|i − j|/4) and the like, m/N times 1e-9.
    fn chain(stiffness: f64) -> Reduced {
        let n = 10;
        let kernel = |i: usize, j: usize| 1e-9 * (-0.25 * (i as f64 - j as f64).abs()).exp();
        let mut compliance = DMatrix::from_fn(n + 1, n + 1, kernel);
        for i in 0..n {
            let shown = 0.3 * kernel(i, 4);
            (compliance[(i, n)], compliance[(n, i)]) = (-shown, -shown);
        }
        let (mut columns, mut values) = (Vec::new(), Vec::new());
        for q in 0..30 {
            let i = (q / 3).min(n - 2);
            let part = 0.1 + 0.4 * (q % 3) as f64;
            // The last unknown's neighbour is held.
            columns.extend([i, if q < 27 { i + 1 } else { n + 1 }]);
            values.extend([1.0 - part, part]);
        }
        let weights = (0..30).map(|q| stiffness * (1.0 + 0.1 * q as f64)).collect();
        Reduced::new(Points { weights, offsets: vec![0.0; 30], counts: vec![2; 30], columns, values }, compliance)
            .unwrap()
    }

    /// Over decades of stiffness, from any guess, the forces are those of the displacements that they lead to.
    #[test]
    fn forces_and_displacements_agree_wherever_newton_starts() {
        for stiffness in [1e5, 1e9, 1e13, 1e17] {
            for gradient in [false, true] {
                let mut reduced = chain(stiffness);
                for trial in 0..20 {
                    // Displacements of all signs, which change with the trial: the forces of the last are a bad guess.
                    let wave = |i: usize| 1e-4 * (1.7 * i as f64 + 2.3 * f64::from(trial)).sin();
                    let force_law = ForceLaw::Hertz(Hertz { stiffness: 1e10 });
                    let law = Law { force_law, compliance: 0.0, damping: 0.0 };
                    let contact = StageForce {
                        law,
                        from: wave(20),
                        theta: if gradient { 0.5 } else { 1.0 },
                        gradient,
                        rate: [0.0; 2],
                    };
                    let before: Vec<f64> = (0..12).map(|i| wave(i + 30)).collect();
                    let penetration = reduced.penetration(&before);
                    let step = Step { contact: &contact, penetration: &penetration, tolerance: 1e-8 };
                    let at = DVector::from_fn(11, |i, _| wave(i));
                    let outcome = reduced.solve(&step, &at, &DVector::zeros(11));
                    assert!(outcome.converged && outcome.iterations < 40, "{stiffness:e}: {outcome:?}");
                    // From the definitions, not from the solver's own sums.
                    let z = &at - &reduced.compliance * &reduced.forces;
                    let scale = if gradient { 2.0 } else { 1.0 };
                    let mut expected = DVector::zeros(11);
                    expected[10] = contact.at(z[10]).0;
                    for (q, (columns, values)) in reduced.points.entries().enumerate() {
                        let free = |i: &&usize| **i < 10;
                        let moved: f64 =
                            columns.iter().zip(values).filter(|(i, _)| free(i)).map(|(i, v)| v * z[*i]).sum();
                        let (from, to) = (penetration[q], penetration[q] + scale * moved);
                        let square = |g: f64| 0.5 * g.max(0.0).powi(2);
                        let depth = if gradient { (square(to) - square(from)) / (to - from) } else { to.max(0.0) };
                        for (i, value) in columns.iter().zip(values).filter(|(i, _)| free(i)) {
                            expected[*i] += reduced.points.weights[q] * depth * value;
                        }
                    }
                    // The tolerance; thirty points up to four times as stiff show sixteen roundings of 1e-4 m.
                    let left = (&expected - &reduced.forces).norm();
                    assert!(left <= 2e-8 + 8e-18 * stiffness, "{stiffness:e}: {left:e} N");
                }
            }
        }
    }
}
