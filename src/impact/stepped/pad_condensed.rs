//! The condensed step of a body on pads: what is not linear stays on the unknowns that the pads push.
//!
//! E = E* + w F − S⁻¹P p with P the columns of those unknowns. Rank 0 gathers PᵀE*, solves the small dense equations
//! ([`super::foundation`]) and sends what it found, so that all ranks have the same; one more solve with S gives E. Then the
//! pads are asked at that E: pads far stiffer than the body see the rounding of a solve, and take another pass.

use mpi::traits::{Communicator, Root};
use nalgebra::{DMatrix, DVector};
use petsc_wrap::{Comm, Gather, Insert, Int, Ksp, Vector};

use crate::agree::agree;
use crate::body::{PadPoints, Pads};
use crate::error::{Error, Result};

use super::foundation::{Points, Reduced, Step};
use super::implicit::{Problem, Solved};

/// Unknowns up to which the dense matrices are small beside a factor of S, and a product with them beside a solve.
pub(super) const MOST_UNKNOWNS: usize = 1200;

/// Passes after which rounding is all that can be left.
const PASSES: usize = 4;

/// Part of the tolerance to which the small equations are solved: iterations cost little there, a further pass a solve.
const FIRST: f64 = 0.01;

/// The pads' part of the condensed step of one step size.
pub struct PadStep {
    comm: Comm,
    /// The unknowns that the pads push.
    pushed: Vec<Int>,
    /// Of rank 0: those; one for the contact's place, of no meaning; held unknowns of the pads.
    gather: Gather,
    /// On rank 0.
    reduced: Option<Reduced>,
    /// P p, N, and S⁻¹ of it, m.
    load: Vector,
    correction: Vector,
    /// Residual that counts as none, N, but for rounding.
    tolerance: f64,
}

/// The linear response that all condensed steps have.
pub struct Response<'a> {
    /// S.
    pub ksp: &'a mut Ksp,
    /// w, m/N.
    pub answer: &'a Vector,
    /// s, m/N.
    pub compliance: f64,
    /// 1/(c2 m0), m/N.
    pub of_impactor: f64,
}

/// What rank 0 tells the others of a pass.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    /// F, N.
    force: f64,
    /// Whether p has changed.
    pushes: bool,
    converged: bool,
    iterations: usize,
    /// N.
    residual: f64,
}

impl PadStep {
    /// Solves for the columns of G, one for each of the `pushed` unknowns, of which there must be one. Collective.
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
            // Each column has its own rounding; the matrix is symmetric.
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

    /// Solves a step, from E* in `increment`, which becomes E. Collective.
    pub(super) fn solve(&mut self, response: Response, problem: &Problem, increment: &mut Vector) -> Result<Solved> {
        let free_impactor = response.of_impactor * problem.known_impactor;
        let tolerance = self.tolerance.max(problem.largest);
        let displacement = self.gather.fetch(problem.u)?.to_vec();
        let penetration = self.reduced.as_ref().map_or_else(Vec::new, |reduced| reduced.penetration(&displacement));
        let mut step = Step { contact: problem.force, penetration: &penetration, tolerance: FIRST * tolerance };
        // φ that E has already.
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

    /// Finds the forces on rank 0 and leaves their change on the pads in `load`. Collective.
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
    /// What rank 0 has, on every rank. Collective.
    fn shared(self, comm: &Comm) -> Self {
        let flag = |yes: bool| f64::from(u8::from(yes));
        let mut values = [self.force, flag(self.pushes), flag(self.converged), self.iterations as f64, self.residual];
        comm.mpi().process_at_rank(0).broadcast_into(&mut values);
        let [force, pushes, converged, iterations, residual] = values;
        Self { force, pushes: pushes != 0.0, converged: converged != 0.0, iterations: iterations as usize, residual }
    }
}

/// The unknowns in the order of Ĝ's columns, held ones behind; the contact's place is filled with one of them.
fn in_columns(pushed: &[Int], points: &PadPoints) -> Vec<Int> {
    let mut held: Vec<Int> =
        points.unknowns.iter().zip(&points.free).filter(|(_, free)| !**free).map(|(unknown, _)| *unknown).collect();
    held.sort_unstable();
    held.dedup();
    pushed.iter().chain(&pushed[..1]).chain(&held).copied().collect()
}

/// The points with columns for their unknowns.
fn numbered(points: PadPoints, unknowns: &[Int], n: usize) -> Points {
    let (pushed, held) = (&unknowns[..n], &unknowns[n + 1..]);
    // Every unknown of a point is in one of the two lists, which are sorted.
    let column = |(unknown, free): (&Int, &bool)| match free {
        true => pushed.partition_point(|other| other < unknown),
        false => n + 1 + held.partition_point(|other| other < unknown),
    };
    let PadPoints { weights, offsets, counts, values, .. } = points;
    let columns = points.unknowns.iter().zip(&points.free).map(column).collect();
    Points { weights, offsets, counts, columns, values }
}
