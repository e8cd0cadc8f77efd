//! The paper's Newton step: body and impactor in one matrix, which holds the block âF′âᵀ.
//!
//! Unknowns are the increments D = (ΔU, Δq) over a step; â = (−a, 1) restricted to the unknowns that are free:
//!
//! R(D) = Ŝ D − g + p(u_n + ΔU) + â F(δ_n + âᵀD),   R′ = Ŝ + p′ + â F′ âᵀ,   Ŝ = diag(K + c1 C + c2 M, c2 m0).
//!
//! The impactor's row is the last one, owned by the last rank. R is the gradient of a strictly convex potential, since Ŝ
//! is positive definite and p and F do not decrease; so Newton's direction always descends, and a line search that brackets the
//! zero of the slope converges from anywhere, across the kinks of contact and pads.

use mpi::traits::{Communicator, Root};
use petsc_wrap::{Comm, Gather, Insert, Int, Matrix, Snes, Trial, Vector};

use crate::body::{Pads, Solid};
use crate::contact::Hertz;
use crate::error::Result;
use crate::scheme::Update;

/// What closures return to SNES.
type Outcome = std::result::Result<(), Box<dyn std::error::Error>>;

/// A bound for what cannot converge. Contact takes three to six; a pad takes more the more of its points change sides in
/// a step, some hundred when it is as stiff as the body and the step is large.
const MAX_ITERATIONS: usize = 1000;

/// The Newton solver of a run: its matrix pattern and symbolic factorisation serve all steps.
pub struct Newton {
    comm: Comm,
    snes: Snes,
    /// Ŝ, with held unknowns taken out.
    constant: Matrix,
    /// â as a vector, and as its entries on rank 0.
    direction: Vector,
    entries: (Vec<Int>, Vec<f64>),
    /// F′ in the Jacobian as it stands.
    tangent: f64,
    /// Increments and their known part, laid out with the impactor's row.
    increment: Vector,
    known: Vector,
    displacement: Vector,
}

/// What a step's equations are made of.
pub struct Step<'a> {
    /// u_n.
    pub u: &'a Vector,
    /// g, of the body and of the impactor.
    pub known: (&'a Vector, f64),
    /// δ_n.
    pub approach: f64,
    /// F.
    pub law: Hertz,
    /// p.
    pub pads: Option<&'a mut Pads>,
}

impl Newton {
    /// Assembles Ŝ and the pattern of the Newton matrix. Collective.
    pub(super) fn new(comm: &Comm, body: &Solid, update: Update, mass: f64, tolerance: f64) -> Result<Self> {
        // One rank adds the block.
        let entries = if comm.is_root() { &body.localization.entries[..] } else { &[] };
        let (all, _): (Vec<Int>, Vec<f64>) = entries.iter().copied().unzip();
        let free = Gather::new(&body.clamps.free, &all)?.fetch(&body.clamps.free)?.to_vec();
        // A held unknown takes no force; what it adds to δ is constant and part of δ_n.
        let of_body = entries.iter().zip(&free).filter(|(_, free)| **free != 0.0);
        let of_impactor = (!all.is_empty()).then_some((body.unknowns() as Int, 1.0));
        let (indices, values): (Vec<Int>, Vec<f64>) =
            of_body.map(|((index, value), _)| (*index, -value)).chain(of_impactor).unzip();
        let is_last = comm.rank() + 1 == comm.size();
        let local = {
            let range = body.load.range();
            (range.end - range.start) as usize + usize::from(is_last)
        };
        let mut direction = Vector::new(comm, local)?;
        direction.set_values(&indices, &values, Insert::Replace)?;
        direction.assemble()?;
        let constant = constant(comm, body, update, mass, &direction)?;
        let mut jacobian = constant.duplicate()?;
        jacobian.declare_positive_definite()?;
        Ok(Self {
            snes: Snes::new(comm, jacobian, tolerance, MAX_ITERATIONS)?,
            comm: comm.clone(),
            constant,
            increment: direction.duplicate()?,
            known: direction.duplicate()?,
            displacement: body.load.duplicate()?,
            direction,
            entries: (indices, values),
            tangent: 0.0,
        })
    }

    /// Sets [`Newton::tolerance`], unless the user has.
    pub(super) fn set_tolerance(&mut self, tolerance: f64) -> petsc_wrap::Result<()> {
        self.snes.set_absolute_tolerance(tolerance)
    }

    /// Converged when the Euclidean norm of R is below, N.
    pub(super) fn tolerance(&self) -> petsc_wrap::Result<f64> {
        self.snes.absolute_tolerance()
    }

    /// Solves for the increments from a guess, which it replaces; returns the impactor's and the iterations. Collective.
    pub(super) fn solve(&mut self, step: Step, start: (&mut Vector, f64)) -> petsc_wrap::Result<(f64, usize)> {
        let Step { u, known, approach, law, pads } = step;
        pack(known, &mut self.known)?;
        pack((&*start.0, start.1), &mut self.increment)?;
        let (direction, constant, known, entries) = (&self.direction, &self.constant, &self.known, &self.entries);
        let (displacement, current) = (std::cell::RefCell::new(&mut self.displacement), &mut self.tangent);
        let pads = std::cell::RefCell::new(pads);
        let displaced = |d: &Vector| -> petsc_wrap::Result<()> {
            let mut displacement = displacement.borrow_mut();
            unpack(d, &mut displacement)?;
            displacement.axpy(1.0, u)
        };
        let residual = |d: &Vector, r: &mut Vector| -> Outcome {
            constant.mult(d, r)?;
            r.axpy(-1.0, known)?;
            if let Some(pads) = pads.borrow_mut().as_deref_mut() {
                displaced(d)?;
                pads.add_force(&displacement.borrow(), r)?;
            }
            r.axpy(law.force(approach + direction.dot(d)?), direction)?;
            Ok(())
        };
        let jacobian = |d: &Vector, j: &mut Matrix| -> Outcome {
            let tangent = law.tangent(approach + direction.dot(d)?);
            let mut pads = pads.borrow_mut();
            if pads.is_none() && tangent == *current {
                return Ok(());
            }
            j.copy_from(constant)?;
            if let Some(pads) = pads.as_deref_mut() {
                displaced(d)?;
                pads.add_tangent(&displacement.borrow(), j)?;
            }
            // âF′âᵀ, entry by entry as in the paper, whole from rank 0.
            let (indices, values) = entries;
            let block: Vec<f64> = values.iter().flat_map(|a| values.iter().map(move |b| tangent * a * b)).collect();
            j.set_values(indices, indices, &block, Insert::Add)?;
            j.assemble()?;
            *current = tangent;
            Ok(())
        };
        let iterations = self.snes.solve(&mut self.increment, residual, jacobian, |trial| Ok(step_length(trial)?))?;
        unpack(&self.increment, start.0)?;
        Ok((impactor(&self.comm, &self.increment)?, iterations))
    }
}

/// The full step, unless it overshoots: then the zero of the slope, bracketed, by the Illinois rule (Dowell & Jarratt, A
/// modified regula falsi method, BIT 11, 1971).
fn step_length(trial: &mut Trial) -> petsc_wrap::Result<f64> {
    /// The slope left over that a next Newton direction will remove anyway.
    const ENOUGH: f64 = 0.5;
    let before = trial.slope(0.0)?;
    let full = trial.slope(1.0)?;
    // NaN is passed on, for SNES to report.
    if before >= 0.0 || full.is_nan() || full <= ENOUGH * -before {
        return Ok(1.0);
    }
    let ((mut low, mut slope_low), (mut high, mut slope_high)) = ((0.0, before), (1.0, full));
    for _ in 0..30 {
        let length = (low * slope_high - high * slope_low) / (slope_high - slope_low);
        let slope = trial.slope(length)?;
        if slope.abs() <= ENOUGH * -before {
            return Ok(length);
        }
        if slope < 0.0 {
            (low, slope_low) = (length, slope);
            slope_high /= 2.0;
        } else {
            (high, slope_high) = (length, slope);
            slope_low /= 2.0;
        }
    }
    Ok(low)
}

/// Ŝ with room for ââᵀ and a unit-like diagonal for held unknowns.
fn constant(comm: &Comm, body: &Solid, update: Update, mass: f64, direction: &Vector) -> Result<Matrix> {
    let combination = body.combination(update.c1, update.c2)?;
    let range = direction.range();
    let rows = combination.row_range();
    let last = body.unknowns() as Int;
    let is_last = comm.rank() + 1 == comm.size();
    // â's entries couple the impactor with unknowns of one facet, whose own couplings are in the body's pattern already.
    let coupled: Vec<Int> = {
        let values = direction.read()?;
        rows.clone().filter(|row| values[(row - range.start) as usize] != 0.0).collect()
    };
    let all = gather_all(comm, &coupled);
    let (mut here, mut elsewhere) = (Vec::new(), Vec::new());
    for row in rows.clone() {
        let entries = combination.row(row)?;
        let own = entries.columns().iter().filter(|column| rows.contains(column)).count();
        let impactor = usize::from(coupled.contains(&row));
        here.push((own + if is_last { impactor } else { 0 }) as Int);
        elsewhere.push((entries.columns().len() - own + if is_last { 0 } else { impactor }) as Int);
    }
    if is_last {
        here.push(1 + coupled.len() as Int);
        elsewhere.push((all.len() - coupled.len()) as Int);
    }
    let local = (range.end - range.start) as usize;
    let mut matrix = Matrix::aij(comm, (local, local), &here, &elsewhere)?;
    for row in rows {
        let entries = combination.row(row)?;
        matrix.set_values(&[row], entries.columns(), entries.values(), Insert::Replace)?;
    }
    for row in coupled {
        matrix.set_values(&[row], &[last], &[0.0], Insert::Replace)?;
    }
    if is_last {
        matrix.set_values(&[last], &all, &vec![0.0; all.len()], Insert::Replace)?;
        matrix.set_values(&[last], &[last], &[update.c2 * mass], Insert::Replace)?;
    }
    matrix.assemble()?;
    let typical = combination.trace()? / body.unknowns() as f64;
    combination.destroy()?;
    matrix.zero_rows_columns(&body.clamps.rows, typical)?;
    matrix.declare_positive_definite()?;
    Ok(matrix)
}

/// The lists of all ranks, one after the other. Collective.
fn gather_all(comm: &Comm, mine: &[Int]) -> Vec<Int> {
    let mut all = Vec::new();
    for root in 0..comm.size() {
        let process = comm.mpi().process_at_rank(root as i32);
        let mut length = mine.len();
        process.broadcast_into(&mut length);
        let mut list = if root == comm.rank() { mine.to_vec() } else { vec![0; length] };
        process.broadcast_into(&mut list[..]);
        all.extend(list);
    }
    all
}

/// Body's and impactor's values in one vector, the impactor's last.
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

/// The body's values of a vector with the impactor's row.
fn unpack(from: &Vector, body: &mut Vector) -> petsc_wrap::Result<()> {
    let from = from.read()?;
    let mut body = body.write()?;
    let n = body.len();
    body.copy_from_slice(&from[..n]);
    Ok(())
}

/// The impactor's value of such a vector, on every rank. Collective.
fn impactor(comm: &Comm, from: &Vector) -> petsc_wrap::Result<f64> {
    let last = comm.size() - 1;
    let mut value = if comm.rank() == last { *from.read()?.last().expect("the impactor's row") } else { 0.0 };
    comm.mpi().process_at_rank(last as i32).broadcast_into(&mut value);
    Ok(value)
}
