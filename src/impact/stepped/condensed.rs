//! Condensed Newton step: body and impactor respond linearly to a force, so that only one scalar equation remains.
//!
//! While S = K + c1 C + c2 M is constant, the stage's increment of the body is E = E* + w F with E* = S⁻¹g and
//! w = S⁻¹a, and the increment of the impactor is E*_q − F/(c2 m0). The approach is then δ = δ* − s F with
//! s = aᵀw + 1/(c2 m0), and F follows from δ + s F(δ) = δ*. The left side increases with δ. Therefore Newton's method
//! with a bracket always converges, across the kink at δ = 0 and for any step size. By the formula of Sherman and
//! Morrison the result is the solution of the full Newton system with its block âF′âᵀ. Pads add unknowns to this
//! equation ([`super::pad_condensed`]).

use petsc_wrap::{Comm, Int, Ksp, Vector};

use crate::body::Body;
use crate::error::Result;
use crate::scheme::{Affine, StageForce};
use crate::solve::linear::is_direct;

use super::implicit::{Problem, Solved};
use super::pad_condensed::{PadStep, Response};

/// Factorised S for one step size, and the response to a unit force.
pub struct Condensed {
    ksp: Ksp,
    /// Response w, m/N, of the free unknowns.
    answer: Vector,
    /// Compliance s of body and impactor, m/N.
    compliance: f64,
    /// Compliance of the impactor, 1/(c2 m0), m/N.
    of_impactor: f64,
    /// Part that treats the pads, if there are any.
    pads: Option<PadStep>,
    /// Whether the linear solves use a direct solver.
    pub is_direct: bool,
}

impl Condensed {
    /// Assembles and factorises S for a stage of a step (s). `pushed` are the unknowns on which pads act
    /// ([`crate::body::Pads::pushed`]); residuals of their equations below `tolerance` (N) count as zero. Collective.
    pub(super) fn new(
        comm: &Comm,
        body: &Body,
        (stage, step): (Affine, f64),
        mass: f64,
        (pushed, tolerance): (Vec<Int>, f64),
    ) -> Result<Self> {
        let mut ksp = body.step_solver(step, stage.c1, stage.c2)?;
        let mut force = body.terms.load.duplicate()?;
        force.copy_from(&body.terms.contact.force)?;
        body.clamps.zero(&mut force)?;
        let mut answer = body.terms.load.duplicate()?;
        ksp.solve(&force, &mut answer)?;
        let of_impactor = 1.0 / (stage.c2 * mass);
        let compliance = force.dot(&answer)? + of_impactor;
        let response = Response { ksp: &mut ksp, answer: &answer, compliance, of_impactor };
        let pads = match &body.pads {
            Some(pads) if !pushed.is_empty() => Some(PadStep::new(comm, pads, pushed, response, tolerance)?),
            _ => None,
        };
        let is_direct = is_direct(&ksp)?;
        Ok(Self { ksp, answer, compliance, of_impactor, pads, is_direct })
    }

    /// Solves a step; an iterative solver starts from the guess of E in `increment`, which is overwritten by the
    /// solution. Collective.
    pub(super) fn solve(&mut self, problem: &Problem, increment: &mut Vector) -> Result<Solved> {
        let Self { ksp, answer, compliance, of_impactor, pads, is_direct } = self;
        let (a, of_impactor, compliance) = (problem.direction, *of_impactor, *compliance);
        // E* is the increment without the contact force; the guess contains the force, so its effect is subtracted.
        if !*is_direct {
            increment.axpy(-problem.force.at(problem.force.from).0, answer)?;
        }
        ksp.solve(problem.known, increment)?;
        if let Some(pads) = pads {
            return pads.solve(Response { ksp, answer, compliance, of_impactor }, problem, increment);
        }
        let free_impactor = of_impactor * problem.known_impactor;
        let free = problem.force.from + free_impactor - a.dot(increment)?;
        let (force, iterations) = solve_scalar(problem.force, free, compliance);
        increment.axpy(force, answer)?;
        Ok(Solved { increment: free_impactor - of_impactor * force, force, iterations })
    }
}

/// Returns F of δ + s F(δ) = δ* and the number of iterations. A NaN argument gives a NaN result.
fn solve_scalar(law: &StageForce, free: f64, compliance: f64) -> (f64, usize) {
    /// Bound on the iterations: enough bisections from 1e308 down to rounding.
    const MAX_ITERATIONS: usize = 200;
    let (mut high, most) = (free, law.at(free).0);
    let mut low = free - compliance * most;
    if most == 0.0 || !low.is_finite() {
        return (most + 0.0 * low, 0);
    }
    let mut approach = law.from.clamp(low, high);
    let mut force = 0.0;
    for iteration in 1..=MAX_ITERATIONS {
        let (value, tangent) = law.at(approach);
        let left = approach + compliance * value - free;
        let change = left / (1.0 + compliance * tangent);
        // The last correction is applied to the force. A stiff contact needs it to more digits than δ provides.
        force = value - tangent * change;
        if left.abs() <= 2.0 * f64::EPSILON * (approach.abs() + free.abs()) || !left.is_finite() {
            return (force, iteration);
        }
        if left > 0.0 {
            high = approach;
        } else {
            low = approach;
        }
        let newton = approach - change;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == approach {
            return (force, iteration);
        }
        approach = next;
    }
    (force, MAX_ITERATIONS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ForceLaw, Hertz, Law};

    /// For stiffness, compliance and approach over many decades the equation is solved to rounding in few iterations.
    #[test]
    fn the_scalar_equation_is_solved_wherever_it_starts() {
        for stiffness in [1e3, 1e10, 1e20] {
            for compliance in [1e-12, 1e-8, 1e-3] {
                for (free, from) in
                    [(1e-9, -1e-3), (1e-4, -1.0), (1e-4, 1e-9), (10.0, 0.0), (1e-6, 2e-6), (-1e-6, 1e-6)]
                {
                    for gradient in [false, true] {
                        let force_law = ForceLaw::Hertz(Hertz { stiffness });
                        let law = Law { force_law, compliance: 0.0, damping: 0.0 };
                        let theta = if gradient { 0.5 } else { 1.0 };
                        let stage = StageForce { law, from, theta, gradient, rate: [0.0; 2] };
                        let (force, iterations) = solve_scalar(&stage, free, compliance);
                        let approach = free - compliance * force;
                        let (again, tangent) = stage.at(approach);
                        // Rounding of δ multiplied by the slope of the force.
                        let rounding = 1e-15 * (tangent + 1.0 / compliance) * (free.abs() + from.abs());
                        assert!(
                            (again - force).abs() <= 1e-12 * force + 8.0 * rounding,
                            "{stage:?} {free}: {force} {again}"
                        );
                        assert!(iterations < 200, "{iterations}");
                    }
                }
            }
        }
    }
}
