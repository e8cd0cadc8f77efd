//! Nonlinear equations of a step on pads, condensed to the unknowns on which pads and contact act: a small dense system
//! on one rank.
//!
//! Let z = (e, δ) be the increments of the pads' unknowns and the approach, and φ = (p, F) the forces on them. With the
//! compliance
//!
//! Ĝ = (G, −g; −gᵀ, s),   G = PᵀS⁻¹P,  g = Pᵀw,
//!
//! z = z* − Ĝφ has to satisfy φ = f(z). The solution is the zero of the gradient r = f(z) − φ of a strictly convex
//! potential, whose Hessian is Ĝ⁻¹ + D with the semi-smooth derivative D of f (L. Qi & J. Sun, A nonsmooth version of
//! Newton's method, Math. Program. 58, 1993). The iteration updates the forces and computes z from them by a product
//! with Ĝ. Therefore r does not suffer from the condition number of Ĝ, and it is the residual of the full equations.
//!
//! D changes at few points from one iteration to the next and from step to step. Therefore a factor of Ĝ⁻¹ + D is kept
//! as the preconditioner of the conjugate gradient method. With M the matrix of the kept factor, M times the search
//! direction satisfies the same recurrence as the direction. Thus only the difference of the two D has to be
//! multiplied.

use std::convert::Infallible;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::form::pressed_depth;
use crate::scheme::StageForce;

use super::line_search::step_length;

/// Bound on the Newton iterations, for equations that do not converge.
const MAX_ITERATIONS: usize = 1000;

/// Residual to which Newton's linear equations are solved, relative to their right-hand side.
const FORCING: f64 = 1e-4;

/// Rounding of the residual in units of displacement times the largest D: in z, in the products with D, and in the sum
/// over points.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Size of the system divided by the number of conjugate gradient iterations at which a new factor is cheaper.
const RENEW: usize = 20;

/// Quadrature points of pads, numbered by the columns of Ĝ.
pub struct Points {
    /// Stiffness w of each point, N/m.
    pub weights: Vec<f64>,
    /// Offset s ū of each point, m.
    pub offsets: Vec<f64>,
    /// Number of unknowns of each point.
    pub counts: Vec<usize>,
    /// Columns of Ĝ for the unknowns, point after point; constrained unknowns have numbers beyond the last column.
    pub columns: Vec<usize>,
    /// Coefficients s φ_a of these unknowns, in the same order.
    pub values: Vec<f64>,
}

/// Data of one step.
pub struct Step<'a> {
    /// Contact force F(δ).
    pub contact: &'a StageForce,
    /// Penetration s (u_n − ū) at the points, m.
    pub penetration: &'a [f64],
    /// Norm of r that counts as zero, N.
    pub tolerance: f64,
}

/// Result of the Newton iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convergence {
    /// Number of Newton iterations.
    pub iterations: usize,
    /// Norm of the residual r, N.
    pub residual: f64,
    /// Whether the residual is below the tolerance or at the level of rounding.
    pub converged: bool,
}

/// The condensed equations of one step size.
pub struct Reduced {
    points: Points,
    /// Compliance Ĝ, m/N; the last row belongs to the contact.
    compliance: DMatrix<f64>,
    /// Inverse Ĝ⁻¹, used only for search directions.
    stiffness: DMatrix<f64>,
    kept: Option<KeptFactor>,
    /// Forces φ, N: the solution of the last step, which is the first guess for the next.
    pub forces: DVector<f64>,
    /// Tangent D of each point, and F′ as the last entry, N/m.
    tangents: Vec<f64>,
}

/// A factor of Ĝ⁻¹ + D, with the D it was computed from.
struct KeptFactor {
    factor: Cholesky<f64, Dyn>,
    tangents: Vec<f64>,
}

impl Reduced {
    /// Builds the equations from Ĝ; `None` if Ĝ is not positive definite to rounding.
    pub(super) fn new(points: Points, compliance: DMatrix<f64>) -> Option<Self> {
        let size = compliance.nrows();
        let mut raised = compliance.clone();
        // A slightly larger diagonal compensates the rounding in the columns of Ĝ, which can make eigenvalues negative.
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

    /// Penetration s (u − ū) at the points, m. The displacements are in the order of the columns of Ĝ; the entry of the
    /// contact is not used.
    pub(super) fn penetration(&self, displacement: &[f64]) -> Vec<f64> {
        let at_point = |columns: &[usize], values: &[f64]| {
            columns.iter().zip(values).map(|(i, v)| v * displacement[*i]).sum::<f64>()
        };
        let entries = self.points.entries().zip(&self.points.offsets);
        entries.map(|((columns, values), offset)| at_point(columns, values) - offset).collect()
    }

    /// Solves for the forces, starting from the forces of the last step. `at` is z under the forces `applied`.
    pub(super) fn solve(&mut self, step: &Step, at: &DVector<f64>, applied: &DVector<f64>) -> Convergence {
        // Scale of the rounding of the displacements.
        let largest = step.penetration.iter().chain(at.iter()).fold(0.0_f64, |max, value| max.max(value.abs()));
        let mut outcome = Convergence { iterations: 0, residual: f64::NAN, converged: false };
        loop {
            let z = at - &self.compliance * (&self.forces - applied);
            let r = self.push(step, &z) - &self.forces;
            let last = std::mem::replace(&mut outcome.residual, r.norm());
            let rounding = ROUNDING * largest * self.points.stiffest(self.tangents[self.points.weights.len()]);
            // If only rounding may be left, iterations go on while they reduce the residual.
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

    /// Computes f(z), N, and stores its tangents.
    fn push(&mut self, step: &Step, z: &DVector<f64>) -> DVector<f64> {
        let StageForce { gradient, theta, .. } = *step.contact;
        // Points use the displacement at the stage or, for a mean force, at the two ends of the step.
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

    /// Solves (Ĝ⁻¹ + D) x = b to a residual relative to |b|, or to a fraction of the tolerance if this is larger.
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
        // The matrix is positive definite except for rounding; if the factorisation fails, the direction is −r.
        let Some(factor) = matrix.cholesky() else {
            self.kept = None;
            return b;
        };
        let x = factor.solve(&b);
        self.kept = Some(KeptFactor { factor, tangents: self.tangents.clone() });
        x
    }
}

/// Solves (M + Δ) x = b to a residual `wanted`, with the factor of M as preconditioner; `None` if `most` iterations are
/// not enough.
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
    // The product of M with the direction satisfies the recurrence of the direction.
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
    /// Columns and values of each point.
    fn entries(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        self.counts.iter().scan(0, |end, count| {
            let start = std::mem::replace(end, *end + count);
            Some((&self.columns[start..*end], &self.values[start..*end]))
        })
    }

    /// Adds D x to `out`; `tangents` has D of each point and then of the contact.
    fn add_tangent(&self, tangents: &[f64], x: &DVector<f64>, out: &mut DVector<f64>) {
        let last = x.len() - 1;
        for ((columns, values), tangent) in self.entries().zip(tangents).filter(|(_, tangent)| **tangent != 0.0) {
            let at_point: f64 = moving(columns, values, last).map(|(i, value)| value * x[i]).sum();
            moving(columns, values, last).for_each(|(i, value)| out[i] += tangent * at_point * value);
        }
        out[last] += tangents[self.weights.len()] * x[last];
    }

    /// Norm of the largest possible D, with all points pressed and the contact's F′ as given. It bounds how rounding of
    /// displacements appears in the forces, because any of the points may be pressed.
    fn stiffest(&self, contact: f64) -> f64 {
        let at_point = |((_, values), weight): ((&[usize], &[f64]), &f64)| {
            let sum: f64 = values.iter().map(|value| value.abs()).sum();
            (weight * sum * sum).powi(2)
        };
        let pads: f64 = self.entries().zip(&self.weights).map(at_point).sum();
        (pads + contact * contact).sqrt()
    }

    /// Adds D to a matrix; `tangents` is as in [`Self::add_tangent`].
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

/// Entries of a point for its free unknowns, which have columns before the contact's.
fn moving<'a>(columns: &'a [usize], values: &'a [f64], last: usize) -> impl Iterator<Item = (usize, f64)> {
    columns.iter().copied().zip(values.iter().copied()).filter(move |(i, _)| *i < last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ForceLaw, Hertz, Law};

    /// Test system of ten unknowns under thirty points, and a contact: G = exp(−|i − j|/4) times 1e-9 m/N.
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
            // The neighbour of the last unknown is constrained.
            columns.extend([i, if q < 27 { i + 1 } else { n + 1 }]);
            values.extend([1.0 - part, part]);
        }
        let weights = (0..30).map(|q| stiffness * (1.0 + 0.1 * q as f64)).collect();
        Reduced::new(Points { weights, offsets: vec![0.0; 30], counts: vec![2; 30], columns, values }, compliance)
            .unwrap()
    }

    /// For stiffnesses over many decades and from any guess, the forces agree with the displacements that they cause.
    #[test]
    fn forces_and_displacements_agree_wherever_newton_starts() {
        for stiffness in [1e5, 1e9, 1e13, 1e17] {
            for gradient in [false, true] {
                let mut reduced = chain(stiffness);
                for trial in 0..20 {
                    // Displacements of both signs that change with the trial, so that the last forces are a bad guess.
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
                    // From the definitions, independently of the sums in the solver.
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
                    // The tolerance, plus sixteen roundings of 1e-4 m at thirty points up to four times as stiff.
                    let left = (&expected - &reduced.forces).norm();
                    assert!(left <= 2e-8 + 8e-18 * stiffness, "{stiffness:e}: {left:e} N");
                }
            }
        }
    }
}
