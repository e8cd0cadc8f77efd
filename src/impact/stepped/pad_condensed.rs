//! Condensed step of a body on pads: the nonlinear equations are reduced to the unknowns on which the pads act.
//!
//! E = E* + w F − S⁻¹P p, where the columns of P select those unknowns. Rank 0 gathers PᵀE*, solves the small dense
//! equations ([`super::foundation`]) and broadcasts the result, so that all ranks have the same. One more solve with S
//! gives E. Then the pad forces are evaluated at this E. Pads that are much stiffer than the body amplify the rounding
//! of the solve and need a further pass.

use mpi::traits::{Communicator, Root};
use nalgebra::{DMatrix, DVector};
use petsc_wrap::{Comm, Gather, Insert, Int, Ksp, Vector};

use crate::agree::agree;
use crate::body::{PadPoints, Pads};
use crate::error::{Error, Result};

use super::foundation::{Points, Reduced, Step};
use super::implicit::{Problem, Solved};

/// Largest number of unknowns for which the dense matrices are small compared with a factor of S, and a product with
/// them is cheap compared with a solve.
pub(super) const MOST_UNKNOWNS: usize = 1200;

/// Number of passes after which only rounding can be left.
const PASSES: usize = 4;

/// Fraction of the tolerance to which the small equations are solved first. Their iterations cost little, while a
/// further pass costs a solve.
const FIRST_TOLERANCE_FACTOR: f64 = 0.01;

/// Part of the condensed step that treats the pads, for one step size.
pub struct PadStep {
    comm: Comm,
    /// Unknowns on which the pads act.
    pushed: Vec<Int>,
    /// Unknowns gathered on rank 0: `pushed`; one unused entry at the contact's place; the constrained unknowns of the
    /// pads.
    gather: Gather,
    /// Condensed equations, on rank 0 only.
    reduced: Option<Reduced>,
    /// Pad forces P p, N, and S⁻¹ of them, m.
    load: Vector,
    correction: Vector,
    /// Residual that counts as zero, N, except for rounding.
    tolerance: f64,
}

/// Linear response of body and impactor, common to all condensed steps.
pub struct Response<'a> {
    /// Solver with S.
    pub ksp: &'a mut Ksp,
    /// Response w of the body to a unit force, m/N.
    pub answer: &'a Vector,
    /// Compliance s of body and impactor, m/N.
    pub compliance: f64,
    /// Compliance of the impactor, 1/(c2 m0), m/N.
    pub of_impactor: f64,
}

/// Result of a pass, which rank 0 sends to the others.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    /// Contact force F, N.
    force: f64,
    /// Whether the pad forces p have changed.
    pushes: bool,
    converged: bool,
    iterations: usize,
    /// Norm of the residual, N.
    residual: f64,
}

impl PadStep {
    /// Solves for the columns of G, one for each unknown in `pushed`, which must not be empty. Collective.
    pub(super) fn new(comm: &Comm, pads: &Pads, pushed: Vec<Int>, response: Response, tolerance: f64) -> Result<Self> {
        let points = pads.points();
        let (mut load, mut correction) = (response.answer.duplicate()?, response.answer.duplicate()?);
        let unknowns = if comm.is_root() { in_columns(&pushed, &points) } else { Vec::new() };
        let mut gather = Gather::new(&load, &unknowns)?;
        let n = pushed.len();
        let mut compliance = if comm.is_root() { DMatrix::zeros(n + 1, n + 1) } else { DMatrix::zeros(0, 0) };
        for (j, unknown) in pushed.iter().enumerate() {
            load.fill(0.0)?;
            if comm.is_root() {
                load.set_values(&[*unknown], &[1.0], Insert::Replace)?;
            }
            load.assemble()?;
            response.ksp.solve(&load, &mut correction)?;
            let column = gather.fetch(&correction)?;
            if comm.is_root() {
                compliance.column_mut(j).copy_from_slice(&column[..=n]);
            }
        }
        if comm.is_root() {
            // Averages the matrix with its transpose: it is symmetric, but the columns have independent rounding.
            compliance = 0.5 * (&compliance + compliance.transpose());
            let of_contact = gather.fetch(response.answer)?;
            for i in 0..n {
                (compliance[(i, n)], compliance[(n, i)]) = (-of_contact[i], -of_contact[i]);
            }
            compliance[(n, n)] = response.compliance;
        } else {
            gather.fetch(response.answer)?;
        }
        let reduced = comm.is_root().then(|| {
            let fault = "the compliance of the pads' unknowns is not positive definite";
            Reduced::new(numbered(points, &unknowns, n), compliance).ok_or(fault.to_owned())
        });
        let reduced = agree(comm, reduced.transpose()).map_err(Error::Solve)?;
        Ok(Self { comm: comm.clone(), pushed, gather, reduced, load, correction, tolerance })
    }

    /// Solves a step from E* in `increment`, which is replaced by E. Collective.
    pub(super) fn solve(&mut self, response: Response, problem: &Problem, increment: &mut Vector) -> Result<Solved> {
        let free_impactor = response.of_impactor * problem.known_impactor;
        let tolerance = self.tolerance.max(problem.largest);
        let displacement = self.gather.fetch(problem.u)?.to_vec();
        let penetration = self.reduced.as_ref().map_or_else(Vec::new, |reduced| reduced.penetration(&displacement));
        let mut step =
            Step { contact: problem.force, penetration: &penetration, tolerance: FIRST_TOLERANCE_FACTOR * tolerance };
        // Forces φ whose effect E contains already.
        let mut applied = DVector::zeros(self.pushed.len() + 1);
        let (mut force, mut iterations) = (0.0, 0);
        for _ in 0..PASSES {
            let impactor = free_impactor - response.of_impactor * force;
            let approach = problem.force.from + impactor - problem.direction.dot(increment)?;
            let told = self.pass(&step, increment, approach, &mut applied)?;
            iterations += told.iterations;
            if !told.converged {
                return Err(Error::Solve(format!(
                    "Newton's method on the pads did not converge: {iterations} iterations, residual {:.3e} N (wanted: \
                     {:.3e} N). A smaller time.step helps in most cases",
                    told.residual, step.tolerance
                )));
            }
            increment.axpy(told.force - force, response.answer)?;
            force = told.force;
            if !told.pushes {
                break;
            }
            response.ksp.solve(&self.load, &mut self.correction)?;
            increment.axpy(-1.0, &self.correction)?;
            step.tolerance = tolerance;
        }
        Ok(Solved { increment: free_impactor - response.of_impactor * force, force, iterations })
    }

    /// Finds the forces on rank 0 and stores the change of the pad forces in `load`. Collective.
    fn pass(&mut self, step: &Step, increment: &Vector, approach: f64, applied: &mut DVector<f64>) -> Result<Told> {
        let mut told = Told::default();
        let n = self.pushed.len();
        self.load.fill(0.0)?;
        let increments = self.gather.fetch(increment)?;
        if let Some(reduced) = &mut self.reduced {
            let mut at = DVector::from_column_slice(&increments[..=n]);
            at[n] = approach;
            let outcome = reduced.solve(step, &at, applied);
            let change = &reduced.forces - &*applied;
            let pads = &change.as_slice()[..n];
            told = Told {
                force: reduced.forces[n],
                pushes: pads.iter().any(|value| *value != 0.0),
                converged: outcome.converged,
                iterations: outcome.iterations,
                residual: outcome.residual,
            };
            self.load.set_values(&self.pushed, pads, Insert::Replace)?;
            applied.copy_from(&reduced.forces);
        }
        self.load.assemble()?;
        Ok(told.shared(&self.comm))
    }
}

impl Told {
    /// Returns the values of rank 0 on every rank. Collective.
    fn shared(self, comm: &Comm) -> Self {
        let flag = |yes: bool| f64::from(u8::from(yes));
        let mut values = [self.force, flag(self.pushes), flag(self.converged), self.iterations as f64, self.residual];
        comm.mpi().process_at_rank(0).broadcast_into(&mut values);
        let [force, pushes, converged, iterations, residual] = values;
        Self { force, pushes: pushes != 0.0, converged: converged != 0.0, iterations: iterations as usize, residual }
    }
}

/// Unknowns in the order of Ĝ's columns, followed by the constrained ones; the contact's place is filled with an
/// arbitrary unknown.
fn in_columns(pushed: &[Int], points: &PadPoints) -> Vec<Int> {
    let mut held: Vec<Int> =
        points.unknowns.iter().zip(&points.free).filter(|(_, free)| !**free).map(|(unknown, _)| *unknown).collect();
    held.sort_unstable();
    held.dedup();
    pushed.iter().chain(&pushed[..1]).chain(&held).copied().collect()
}

/// Returns the points with column numbers for their unknowns.
fn numbered(points: PadPoints, unknowns: &[Int], n: usize) -> Points {
    let (pushed, held) = (&unknowns[..n], &unknowns[n + 1..]);
    // Every unknown of a point is in one of the two sorted lists.
    let column = |(unknown, free): (&Int, &bool)| match free {
        true => pushed.partition_point(|other| other < unknown),
        false => n + 1 + held.partition_point(|other| other < unknown),
    };
    let PadPoints { weights, offsets, counts, values, .. } = points;
    let columns = points.unknowns.iter().zip(&points.free).map(column).collect();
    Points { weights, offsets, counts, columns, values }
}
