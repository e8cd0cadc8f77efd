//! Shifts of a Krylov basis: the rates at which its vectors are made.
//!
//! An elastic body has one shift. The instantaneous and the later responses of a viscoelastic body have different
//! shapes, and vectors with one modulus represent the other shapes poorly. Such a body has a few more shifts, each with
//! the moduli at that shift.

use std::ops::Range;

use petsc_wrap::{Ksp, Vector};

use super::columns::Columns;
use super::direct::{Direct, Precision};
use super::linear::LinearBody;
use crate::error::Result;
use crate::material::Maxwell;

/// Ratios of additional shifts of a viscoelastic body to the first shift. With the first shift alone, a laminate with
/// an interlayer that relaxes from 400 to 0.3 MPa had an error of 16% of the peak, for any number of vectors up to 80,
/// if modes that were left out became springs that do not relax. With these shifts, the error was 0.2%.
const SLOWER_SHIFTS: [f64; 2] = [0.3, SLOWEST];

/// Ratio of the lowest shift to the first.
pub(super) const SLOWEST: f64 = 0.1;

/// Number of consecutive vectors at the first shift before each vector at a lower one. The lower shifts contribute the
/// shapes of slow motions, of which a few suffice; the first one contributes the vibrations. On a laminate of 0.8 x 0.4
/// m with 200 to 400 vectors, the error was 0.6 to 0.8 times that of a basis with as many vectors at each shift. With four
/// instead of three, the errors on four small, strongly relaxing laminates were mostly larger.
const VECTORS_AT_FIRST: usize = 3;

/// Ratio of the moduli at a lower and at the previous shift below which the lower shift is used.
const RELAXED: f64 = 0.9;

/// Ratio of the moduli at the lowest and at the first shift from which on the first shift is sufficient. With ratios of
/// 0.76 to 1, a laminate with a Prony series typical of PVB, at 0 to 50 °C, takes 0.7 times as many vectors at one
/// shift as with equal numbers at three. With a ratio of 0.73, for a series over twelve decades, the error was as small
/// as required, but 1.8 times its estimate.
const LITTLE_RELAXED: f64 = 0.75;

/// Least ratio of the modulus at the end of the run to the modulus at the first shift for which the first shift is
/// sufficient, in addition to [`LITTLE_RELAXED`]. The PVB series keeps 0.40 to 0.75. A series that decreases to a
/// thousandth later than at the lowest shift has different shapes then. Two bases with one modulus both lack them, so
/// that their difference does not show this error. (Terms that are slow compared with the run act as springs. In a
/// test, the series of thirteen laminates decreased below this ratio after the end of the run. For twelve of them, one
/// shift, with two thirds of the vectors, had about the same error as equal numbers at three shifts. For one with an
/// interlayer of 1.5 mm, the error was 3.3e-3 of the peak instead of 1.5e-3.)
const LEFT_AT_LAST: f64 = 0.4;

/// A shift at which basis vectors are made.
pub(super) struct Shift {
    /// Shift s, 1/s.
    pub rate: f64,
    /// Solver with S at this shift.
    pub solver: Solver,
}

impl Shift {
    /// Returns the shifts of a body at the given rates (1/s, from [`rates`]). Factorises S at each shift, with the given
    /// precision if the body is small. Collective.
    ///
    /// # Errors
    /// Same as [`LinearBody::solver`].
    pub fn all(body: &dyn LinearBody, rates: &[f64], precision: Precision) -> Result<Vec<Self>> {
        rates.iter().map(|&rate| Ok(Self { rate, solver: body.solver(rate, precision)? })).collect()
    }
}

/// Solver of S x = b.
pub enum Solver {
    /// For a body that one process stores completely.
    Direct(Direct),
    /// For a body whose rows are distributed over ranks, with work vectors.
    Distributed(Box<(Ksp, [Vector; 2])>),
}

impl Solver {
    /// Whether the factor is in single precision.
    pub fn is_single(&self) -> bool {
        matches!(self, Self::Direct(factor) if factor.is_single())
    }

    /// Computes x ← S⁻¹ x for this rank's rows. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
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

/// Returns the shifts of a body, 1/s: the given one, and lower ones if parts relax considerably within a run of length
/// `end` (s). The moduli differ between the shifts.
pub fn rates(chains: &[&Maxwell], shift: f64, end: f64) -> Vec<f64> {
    let mut rates = vec![shift];
    let relaxes_little = |chain: &&Maxwell| {
        let at_first = chain.transformed(shift);
        chain.transformed(SLOWEST * shift) >= LITTLE_RELAXED * at_first && chain.at(end) >= LEFT_AT_LAST * at_first
    };
    if chains.iter().all(relaxes_little) {
        return rates;
    }
    for rate in SLOWER_SHIFTS.map(|part| part * shift) {
        let last = rates[rates.len() - 1];
        let has_relaxed = |chain: &&Maxwell| chain.transformed(rate) < RELAXED * chain.transformed(last);
        if chains.iter().any(has_relaxed) {
            rates.push(rate);
        }
    }
    rates
}

/// Returns the ratio of all basis vectors to those made at the first shift, for a number of shifts.
pub fn vectors_over_one_shift(shifts: usize) -> f64 {
    if shifts > 1 { (VECTORS_AT_FIRST + 1) as f64 / VECTORS_AT_FIRST as f64 } else { 1.0 }
}

/// A start vector, with the chains of vectors made from it.
pub(super) struct Source {
    /// Start vector: the contact force vector a, the loads, or the load vector of a foundation.
    pub start: Columns,
    /// Numbers of the shifts at which vectors are made from the start vector.
    pub shifts: Range<usize>,
    /// One chain of vectors for each of these shifts.
    pub chains: Vec<Chain>,
    /// Position in the sequence of chains, including exhausted ones that were skipped.
    turn: usize,
}

/// Chain of vectors at one shift.
pub(super) struct Chain {
    /// Number of its last vector and M times this vector; with dampers the number of its last pair alone. `None` before the
    /// first vector.
    pub last: Option<(usize, Columns)>,
    /// Whether the chain gives no new directions.
    pub exhausted: bool,
}

impl Source {
    pub fn new(start: Columns, shifts: Range<usize>) -> Self {
        let exhausted = start.largest() == 0.0;
        let chains = shifts.clone().map(|_| Chain { last: None, exhausted }).collect();
        Self { start, shifts, chains, turn: 0 }
    }

    /// Whether no chain gives new directions.
    pub fn is_exhausted(&self) -> bool {
        self.chains.iter().all(|chain| chain.exhausted)
    }

    /// Chooses the chain of the next vector: [`VECTORS_AT_FIRST`] times the first chain, then one of the others, in turn.
    /// Exhausted chains are skipped; at least one must not be exhausted.
    pub fn next_chain(&mut self) -> usize {
        loop {
            let (round, place) = (self.turn / (VECTORS_AT_FIRST + 1), self.turn % (VECTORS_AT_FIRST + 1));
            let others = self.chains.len() - 1;
            let chain = if place < VECTORS_AT_FIRST || others == 0 { 0 } else { 1 + round % others };
            self.turn += 1;
            if !self.chains[chain].exhausted {
                return chain;
            }
        }
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

    /// Three vectors at the first shift come before each vector at a lower one; these take turns. Exhausted chains are
    /// skipped.
    #[test]
    fn most_vectors_are_made_at_the_first_shift() {
        let mut basis = Columns::new(1, None);
        basis.push(&[1.0]);
        let mut source = Source::new(basis, 0..3);
        let mut next = |count: usize| (0..count).map(|_| source.next_chain()).collect::<Vec<_>>();
        assert_eq!(next(9), [0, 0, 0, 1, 0, 0, 0, 2, 0]);
        source.chains[0].exhausted = true;
        assert_eq!([source.next_chain(), source.next_chain()], [1, 2]);
        source.chains[1].exhausted = true;
        assert_eq!(source.next_chain(), 2);
    }

    /// A PVB-like series needs one shift. A series that decreases to a thousandth later than at the lowest shift needs
    /// several, unless the run ends before.
    #[test]
    fn one_rate_serves_what_keeps_much() {
        let shift = 1e4;
        let pvb = chain(6.9e6, &[(6.9e6, 1e-5), (3.9e6, 1e-4), (2.3e6, 1e-3), (1.7e6, 1e-2)]);
        assert_eq!(rates(&[&pvb], shift, f64::INFINITY), [shift]);
        // At the lowest shift, 1e3/s, 0.8 of the modulus is left.
        let late = chain(7.5e-4, &[(1.0, 4e-3)]);
        assert!(late.transformed(1e3) > LITTLE_RELAXED * late.transformed(shift));
        assert!(rates(&[&late], shift, 8e-3).len() > 1);
        assert_eq!(rates(&[&late], shift, 1e-3), [shift]);
    }
}
