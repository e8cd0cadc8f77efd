//! The paper's Newton step: body and impactor in one matrix, which contains the block âF′âᵀ.
//!
//! Unknowns are the stage's increments E = (E_u, E_q). The vector â is (−a, 1) restricted to the free unknowns:
//!
//! R(E) = Ŝ E − g + p + â F(δ_n + âᵀE),   R′ = Ŝ + p′ + â F′ âᵀ,   Ŝ = diag(K + c1 C + c2 M, c2 m0).
//!
//! The impactor's row is the last one and belongs to the last rank. R is the gradient of a strictly convex potential,
//! since Ŝ is positive definite and p and F do not decrease. Therefore Newton's direction always descends. A line
//! search that brackets the zero of the slope converges from any start, also across the kinks of contact and pads.

use mpi::traits::{Communicator, Root};
use petsc_wrap::{CallbackResult, Comm, Gather, Insert, Int, Matrix, MatrixView, Vector, VectorView};

use crate::body::Body;
use crate::error::{Error, Result};
use crate::scheme::Affine;
use crate::solve::Newton;

use super::implicit::{Problem, Solved};
use super::line_search::step_length;

/// Bound on the Newton iterations, for equations that do not converge. Contact takes three to six. A pad takes more if
/// many of its points open or close in a step: about a hundred if it is as stiff as the body and the step is large.
const MAX_ITERATIONS: usize = 1000;

/// Newton solver of a run; its matrix pattern and symbolic factorisation are used for all steps.
pub struct Full {
    comm: Comm,
    newton: Newton,
    /// Matrix Ŝ without the constrained unknowns.
    constant: Matrix,
    /// The vector â, and its nonzero entries, complete on every rank. `rows` is the range of the entries in this rank's
    /// rows.
    direction: Vector,
    entries: (Vec<Int>, Vec<f64>),
    rows: std::ops::Range<usize>,
    /// F′ that the Jacobian contains at present.
    tangent: f64,
    /// Increments and known part, with the impactor's row; `displacement` is work space without it.
    increment: Vector,
    known: Vector,
    displacement: Vector,
    /// Residual that counts as zero, N, except for rounding.
    tolerance: f64,
}

impl Full {
    /// Assembles Ŝ for a stage of a step (s), and the sparsity pattern of the Newton matrix. Collective.
    pub(super) fn new(comm: &Comm, body: &Body, stage: (Affine, f64), mass: f64, tolerance: f64) -> Result<Self> {
        let (all, _): (Vec<Int>, Vec<f64>) = body.contact_entries.iter().copied().unzip();
        let free = Gather::new(&body.clamps.free, &all)?.fetch(&body.clamps.free)?.to_vec();
        // Constrained unknowns take no force; their contribution to δ is constant and part of δ_n.
        let of_body = body.contact_entries.iter().zip(&free).filter(|(_, free)| **free != 0.0);
        let (indices, values): (Vec<Int>, Vec<f64>) =
            of_body.map(|((index, value), _)| (*index, -value)).chain([(body.unknowns() as Int, 1.0)]).unzip();
        let is_last = comm.rank() + 1 == comm.size();
        let local = {
            let range = body.terms.load.range();
            (range.end - range.start) as usize + usize::from(is_last)
        };
        let mut direction = Vector::new(comm, local)?;
        let range = direction.range();
        let rows = indices.partition_point(|i| *i < range.start)..indices.partition_point(|i| *i < range.end);
        direction.set_values(&indices[rows.clone()], &values[rows.clone()], Insert::Replace)?;
        direction.assemble()?;
        let constant = constant(comm, body, stage, mass, &indices[..indices.len() - 1])?;
        let mut jacobian = constant.duplicate()?;
        jacobian.declare_positive_definite()?;
        Ok(Self {
            newton: Newton::new(comm, jacobian, tolerance, MAX_ITERATIONS)?,
            comm: comm.clone(),
            constant,
            increment: direction.duplicate()?,
            known: direction.duplicate()?,
            displacement: body.terms.load.duplicate()?,
            direction,
            entries: (indices, values),
            rows,
            tangent: 0.0,
            tolerance,
        })
    }

    /// Solves a step from a guess of E in `increment`, which is overwritten by the solution. Collective.
    pub(super) fn solve(&mut self, problem: Problem, increment: &mut Vector) -> petsc_wrap::Result<Solved> {
        let Problem { u, known, known_impactor, force, pads, guess, largest, .. } = problem;
        self.newton.set_absolute_tolerance(self.tolerance.max(largest))?;
        pack((known, known_impactor), &mut self.known)?;
        pack((&*increment, guess), &mut self.increment)?;
        let (direction, constant, known, entries) = (&self.direction, &self.constant, &self.known, &self.entries);
        let (displacement, current) = (std::cell::RefCell::new(&mut self.displacement), &mut self.tangent);
        let (rows, approach) = (self.rows.clone(), force.from);
        let pads = std::cell::RefCell::new(pads);
        // Pads use the displacement at the stage or, for a mean force, at the two ends of the step.
        let (from, scale) = if force.gradient { (Some(u), 1.0 / force.theta) } else { (None, 1.0) };
        let displaced = |d: &VectorView| -> petsc_wrap::Result<()> {
            let mut displacement = displacement.borrow_mut();
            unpack(d, &mut displacement)?;
            displacement.scale(scale)?;
            displacement.axpy(1.0, u)
        };
        let residual = |d: &VectorView, r: &mut VectorView| -> CallbackResult<()> {
            constant.mult(d, r)?;
            r.axpy(-1.0, known)?;
            if let Some(pads) = pads.borrow_mut().as_deref_mut() {
                displaced(d)?;
                pads.add_force(from, &displacement.borrow(), r)?;
            }
            r.axpy(force.at(approach + direction.dot(d)?).0, direction)?;
            Ok(())
        };
        let jacobian = |d: &VectorView, j: &mut MatrixView| -> CallbackResult<()> {
            let tangent = force.at(approach + direction.dot(d)?).1;
            let mut pads = pads.borrow_mut();
            if pads.is_none() && tangent == *current {
                return Ok(());
            }
            j.copy_from(constant)?;
            if let Some(pads) = pads.as_deref_mut() {
                displaced(d)?;
                pads.add_tangent(from, &displacement.borrow(), scale, j)?;
            }
            // Adds âF′âᵀ entry by entry, as in the paper; each rank sets its own rows.
            let (indices, values) = entries;
            let mine = &values[rows.clone()];
            let block: Vec<f64> = mine.iter().flat_map(|a| values.iter().map(move |b| tangent * a * b)).collect();
            j.set_values(&indices[rows.clone()], indices, &block, Insert::Add)?;
            j.assemble()?;
            *current = tangent;
            Ok(())
        };
        let iterations = self
            .newton
            .solve(&mut self.increment, residual, jacobian, |trial| Ok(step_length(|length| trial.slope(length))?))?;
        unpack(&self.increment, increment)?;
        let force = force.at(approach + self.direction.dot(&self.increment)?).0;
        Ok(Solved { increment: impactor(&self.comm, &self.increment)?, force, iterations })
    }

    /// Converts an error of the solver; divergence is reported with its residual.
    pub(super) fn describe(&self, error: petsc_wrap::Error) -> Error {
        match error {
            petsc_wrap::Error::Diverged(failure) => Error::Solve(format!(
                "Newton's method did not converge: {} after {} iterations, residual {:.3e} N (wanted: {:.3e} N). \
                 A smaller time.step helps in most cases; -snes_monitor shows the iterations",
                failure.reason,
                failure.iterations,
                failure.norm,
                self.newton.absolute_tolerance().unwrap_or_default()
            )),
            other => Error::from(other),
        }
    }
}

/// Assembles Ŝ with room for ââᵀ, which couples the impactor and all unknowns in `coupled` with one another.
fn constant(comm: &Comm, body: &Body, (stage, step): (Affine, f64), mass: f64, coupled: &[Int]) -> Result<Matrix> {
    let operator = body.operator_of_step(step, stage.c1, stage.c2)?;
    let rows = operator.row_range();
    let last = body.unknowns() as Int;
    let is_last = comm.rank() + 1 == comm.size();
    let owned = coupled.iter().filter(|row| rows.contains(row)).count();
    let (mut here, mut elsewhere) = (Vec::new(), Vec::new());
    let mut columns = Vec::new();
    for row in rows.clone() {
        columns.clear();
        columns.extend_from_slice(&operator.row(row)?.columns);
        if coupled.binary_search(&row).is_ok() {
            columns.extend_from_slice(coupled);
            columns.push(last);
            columns.sort_unstable();
            columns.dedup();
        }
        let own = columns.iter().filter(|c| rows.contains(c) || (is_last && **c == last)).count();
        here.push(own as Int);
        elsewhere.push((columns.len() - own) as Int);
    }
    if is_last {
        here.push(1 + owned as Int);
        elsewhere.push((coupled.len() - owned) as Int);
    }
    let local = (rows.end - rows.start) as usize + usize::from(is_last);
    let mut matrix = Matrix::aij(comm, (local, local), &here, &elsewhere)?;
    let zeros = vec![0.0; coupled.len() + 1];
    let with_impactor: Vec<Int> = coupled.iter().copied().chain([last]).collect();
    for row in rows {
        if coupled.binary_search(&row).is_ok() {
            matrix.set_values(&[row], &with_impactor, &zeros, Insert::Replace)?;
        }
        let entries = operator.row(row)?;
        matrix.set_values(&[row], &entries.columns, &entries.values, Insert::Replace)?;
    }
    if is_last {
        matrix.set_values(&[last], &with_impactor, &zeros, Insert::Replace)?;
        matrix.set_values(&[last], &[last], &[stage.c2 * mass], Insert::Replace)?;
    }
    matrix.assemble()?;
    operator.destroy()?;
    matrix.declare_positive_definite()?;
    Ok(matrix)
}

/// Writes the values of body and impactor into one vector, the impactor's value last.
fn pack((body, impactor): (&Vector, f64), out: &mut Vector) -> petsc_wrap::Result<()> {
    let body = body.read()?;
    let mut out = out.write()?;
    let n = body.len();
    out[..n].copy_from_slice(&body);
    if let Some(value) = out.get_mut(n) {
        *value = impactor;
    }
    Ok(())
}

/// Copies the body's values from a vector with the impactor's row.
fn unpack(from: &VectorView, body: &mut Vector) -> petsc_wrap::Result<()> {
    let from = from.read()?;
    let mut body = body.write()?;
    let n = body.len();
    body.copy_from_slice(&from[..n]);
    Ok(())
}

/// Returns the impactor's value of such a vector, on every rank. Collective.
fn impactor(comm: &Comm, from: &Vector) -> petsc_wrap::Result<f64> {
    let last = comm.size() - 1;
    let mut value = if comm.rank() == last { *from.read()?.last().expect("the impactor's row") } else { 0.0 };
    comm.mpi().process_at_rank(last as i32).broadcast_into(&mut value);
    Ok(value)
}
