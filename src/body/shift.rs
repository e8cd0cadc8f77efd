//! The rates at which the vectors of a Krylov basis are made.
//!
//! Of a body that does not relax there is one. A body that relaxes answers at once by other shapes than later, and those of one modulus hold
//! few of the others: it has some more, each with the moduli of its own.

use petsc_wrap::{Ksp, Vector};

use super::direct::{Direct, Precision};
use super::{Body, Relaxation};
use crate::error::Result;
use crate::solve::Method;

/// Rates over the first one at which more vectors of a body that relaxes are made. With the first alone, a laminate whose interlayer falls
/// from 400 to 0.3 MPa was off by 16% of the peak for any number of vectors up to 80; with these, by 0.2%.
const SLOWER: [f64; 2] = [0.3, SLOWEST];

/// The lowest of them.
pub(super) const SLOWEST: f64 = 0.1;

/// The part of a modulus below which it counts as another one.
const RELAXED: f64 = 0.9;

/// A rate at which vectors are made.
pub(super) struct Shift {
    /// s, 1/s.
    pub rate: f64,
    /// Of S there.
    pub solver: Solver,
}

impl Shift {
    /// Those of a body, the given one (1/s) first. Factorises S at each, that of a small body with so many digits. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn all(body: &Body, first: f64, precision: Precision) -> Result<Vec<Self>> {
        let at = |rate| Ok(Self { rate, solver: Solver::new(body, rate, precision)? });
        rates(body, first).into_iter().map(at).collect()
    }
}

/// Solves S x = b.
pub(super) enum Solver {
    Small(Direct),
    Distributed(Ksp),
}

impl Solver {
    fn new(body: &Body, shift: f64, precision: Precision) -> Result<Self> {
        // Every rank has all of a body of numbers.
        Ok(match (body.method, &body.nodes) {
            (Method::Cholesky, None) => Self::Small(Direct::new(body, shift, precision)?),
            _ => Self::Distributed(body.solver(&body.operator_at_rate(shift)?)?),
        })
    }

    pub fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        match self {
            Self::Small(factor) => factor.solve(b, x),
            Self::Distributed(solver) => Ok(solver.solve(b, x)?),
        }
    }
}

/// The rates at which the vectors of a body are made, 1/s: where its parts relax, lower ones beside the given one, each of which has moduli of its own.
fn rates(body: &Body, shift: f64) -> Vec<f64> {
    let mut rates = vec![shift];
    for rate in SLOWER.map(|part| part * shift) {
        let last = rates[rates.len() - 1];
        let has_relaxed = |part: &Relaxation| part.chain.transformed(rate) < RELAXED * part.chain.transformed(last);
        if body.relaxations.iter().any(has_relaxed) {
            rates.push(rate);
        }
    }
    rates
}

/// What vectors grow from.
pub(super) struct Source {
    /// What they begin with: a, or the loads.
    pub start: Vector,
    /// What grows from it, at each shift. All take turns.
    pub chains: Vec<Chain>,
    /// Whose turn it is.
    pub turn: usize,
}

/// What grows at one shift.
pub(super) struct Chain {
    /// Its last vector's number, where it has one.
    pub last: Option<usize>,
    /// M times that vector.
    pub image: Vector,
    /// Whether nothing new comes of it.
    pub exhausted: bool,
}

impl Source {
    pub fn new(start: Vector, shifts: usize) -> Result<Self> {
        let exhausted = start.norm_max()? == 0.0;
        let chain = |_| Ok::<_, crate::Error>(Chain { image: start.duplicate()?, last: None, exhausted });
        let chains = (0..shifts).map(chain).collect::<Result<_>>()?;
        Ok(Self { start, chains, turn: 0 })
    }

    /// Whether nothing new comes of it at any shift.
    pub fn is_exhausted(&self) -> bool {
        self.chains.iter().all(|chain| chain.exhausted)
    }
}
