//! The rates at which the vectors of a Krylov basis are made.
//!
//! Of a body that does not relax there is one. A body that relaxes answers at once by other shapes than later, and those of one modulus hold
//! few of the others: it has some more, each with the moduli of its own.

use petsc_wrap::{Ksp, Vector};

use super::columns::Columns;
use super::direct::{Direct, Precision};
use super::linear::LinearBody;
use crate::error::Result;
use crate::material::Maxwell;

/// Rates over the first one at which more vectors of a body that relaxes are made. With the first alone, a laminate whose interlayer falls
/// from 400 to 0.3 MPa was off by 16% of the peak for any number of vectors up to 80; with these, by 0.2%.
const SLOWER: [f64; 2] = [0.3, SLOWEST];

/// The lowest of them.
pub(super) const SLOWEST: f64 = 0.1;

/// The part of a modulus below which it counts as another one.
const RELAXED: f64 = 0.9;

/// The part of a modulus that is left at the lowest rate from which on the first rate serves alone. With 0.76 to 1 a laminate of a chain as of PVB,
/// at 0 to 50 °C, takes 0.7 times the vectors at one rate that it takes at three. With 0.73 of a chain over twelve decades the error was
/// as small as it had to be, but 1.8 times its estimate.
const LITTLE_RELAXED: f64 = 0.75;

/// The part of it that must be left at the end of the run besides. That chain keeps 0.40 to 0.75. One that falls to a thousandth later than at the lowest
/// rate has shapes of its own then, which two bases of one modulus lack alike, so that their difference does not show it. (Terms that are slow beside the run are springs. Of thirteen laminates whose chains fall below
/// this after the end of the run, twelve were off at one rate, with two thirds of the vectors, by about as much as at three; one with an
/// interlayer of 1.5 mm by 3.3e-3 of the peak in the place of 1.5e-3.)
const LEFT_AT_LAST: f64 = 0.4;

/// A rate at which vectors are made.
pub(super) struct Shift {
    /// s, 1/s.
    pub rate: f64,
    /// Of S there.
    pub solver: Solver,
}

impl Shift {
    /// Those of a body, the given one (1/s) first, for a run of a length (s). Factorises S at each, that of a small body with so many digits. Collective.
    ///
    /// # Errors
    /// Those of [`LinearBody::solver`].
    pub fn all(body: &dyn LinearBody, (first, end): (f64, f64), precision: Precision) -> Result<Vec<Self>> {
        let at = |rate| Ok(Self { rate, solver: body.solver(rate, precision)? });
        rates(&body.chains(), first, end).into_iter().map(at).collect()
    }
}

/// Solves S x = b.
pub enum Solver {
    /// Of a body that one process has all of.
    Direct(Direct),
    /// Of one whose rows are spread over ranks, with vectors to solve in.
    Distributed(Box<(Ksp, [Vector; 2])>),
}

impl Solver {
    /// Whether its digits are those of single precision.
    pub fn is_single(&self) -> bool {
        matches!(self, Self::Direct(factor) if factor.is_single())
    }

    /// x ← S⁻¹ x, of this rank's rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn solve_in_place(&mut self, x: &mut [f64]) -> Result<()> {
        match self {
            Self::Direct(factor) => factor.solve_in_place(x),
            Self::Distributed(solver) => {
                let (solver, [b, found]) = &mut **solver;
                b.write()?.copy_from_slice(x);
                solver.solve(b, found)?;
                x.copy_from_slice(&found.read()?);
            }
        }
        Ok(())
    }
}

/// The rates at which the vectors of a body are made, 1/s: where its parts relax by much within a run of a length (s), lower ones beside the given one,
/// each of which has moduli of its own.
pub fn rates(chains: &[&Maxwell], shift: f64, end: f64) -> Vec<f64> {
    let mut rates = vec![shift];
    let relaxes_little = |chain: &&Maxwell| {
        let at_first = chain.transformed(shift);
        chain.transformed(SLOWEST * shift) >= LITTLE_RELAXED * at_first && chain.at(end) >= LEFT_AT_LAST * at_first
    };
    if chains.iter().all(relaxes_little) {
        return rates;
    }
    for rate in SLOWER.map(|part| part * shift) {
        let last = rates[rates.len() - 1];
        let has_relaxed = |chain: &&Maxwell| chain.transformed(rate) < RELAXED * chain.transformed(last);
        if chains.iter().any(has_relaxed) {
            rates.push(rate);
        }
    }
    rates
}

/// What vectors grow from.
pub(super) struct Source {
    /// What they begin with: a, or the loads.
    pub start: Columns,
    /// What grows from it, at each shift. All take turns.
    pub chains: Vec<Chain>,
    /// Whose turn it is.
    pub turn: usize,
}

/// What grows at one shift.
pub(super) struct Chain {
    /// Its last vector's number, where it has one, and M times that vector.
    pub last: Option<(usize, Columns)>,
    /// Whether nothing new comes of it.
    pub exhausted: bool,
}

impl Source {
    pub fn new(start: Columns, shifts: usize) -> Self {
        let exhausted = start.largest() == 0.0;
        let chains = (0..shifts).map(|_| Chain { last: None, exhausted }).collect();
        Self { start, chains, turn: 0 }
    }

    /// Whether nothing new comes of it at any shift.
    pub fn is_exhausted(&self) -> bool {
        self.chains.iter().all(|chain| chain.exhausted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Term;

    fn chain(equilibrium: f64, terms: &[(f64, f64)]) -> Maxwell {
        let terms = terms.iter().map(|(modulus, time)| Term { modulus: *modulus, time: *time }).collect();
        Maxwell { equilibrium, terms }
    }

    /// Vectors of a chain as of PVB are made at one rate; of one that falls to a thousandth later than at the lowest rate, at several, unless the run
    /// ends before.
    #[test]
    fn one_rate_serves_what_keeps_much() {
        let shift = 1e4;
        let pvb = chain(6.9e6, &[(6.9e6, 1e-5), (3.9e6, 1e-4), (2.3e6, 1e-3), (1.7e6, 1e-2)]);
        assert_eq!(rates(&[&pvb], shift, f64::INFINITY), [shift]);
        // At the lowest rate, 1e3/s, 0.8 of it are left.
        let late = chain(7.5e-4, &[(1.0, 4e-3)]);
        assert!(late.transformed(1e3) > LITTLE_RELAXED * late.transformed(shift));
        assert!(rates(&[&late], shift, 8e-3).len() > 1);
        assert_eq!(rates(&[&late], shift, 1e-3), [shift]);
    }
}
