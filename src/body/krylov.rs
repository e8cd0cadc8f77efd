//! Rational Krylov bases of a linear body.
//!
//! The impactor sees the body through a alone: one force in, one displacement out. The vectors
//!
//! q₁ = S⁻¹ a,  q_{j+1} = −S⁻¹ ((C + 2sM) q_j + M p_j),  S = K + sC + s²M,
//!
//! made orthonormal in M, span what a unit force does near the rate s, with its derivatives in s up to the number of vectors: free
//! motions, dampers and the dent under a static force included (Z. Bai & Y. Su, SOAR: A second-order Arnoldi method for the solution
//! of the quadratic eigenvalue problem, SIAM J. Matrix Anal. Appl. 26, 2005; without dampers the shift-and-invert Lanczos method of
//! load-dependent Ritz vectors, E. L. Wilson, M.-W. Yuan & J. M. Dickens, Earthq. Eng. Struct. Dyn. 10, 1982). Every vector is made
//! orthogonal to all others twice, and K itself is projected.
//!
//! Where a part of the body relaxes, S = K + G̃(s) D + sC + s²M has its modulus at the rate s, and D is projected beside K: a body that differs
//! in its chain alone is one on the same basis. What it does at once and after it has relaxed differs in shape. So vectors are made by turns
//! at a few rates, each with its own modulus: a rational Krylov space (A. Ruhe, Linear Algebra Appl. 58, 1984; multi-point moment matching,
//! E. Grimme, Ph.D. thesis, Univ. of Illinois, 1997), in which the transform of the motion is exact at each of the rates.
//!
//! A contact that is short beside the body's slow motions makes bases that lack these: of a body that nothing holds the first vector is the
//! translation, which K maps to nothing.

use super::columns::Columns;
use super::direct::Precision;
use super::lanczos::{Growing, Lanczos};
use super::linear::{LinearBody, Operator, Properties};
use super::projected::Projected;
use super::shift::{Chain, Shift, Solver, Source};
use super::{Projection, Start};
use crate::error::Result;
use crate::scene::Fault;

/// A new vector shorter than this part of what it was before it was made orthogonal adds nothing but rounding.
const EXHAUSTED: f64 = 1e-10;

/// The same of vectors by a factor in single precision.
const EXHAUSTED_OF_SINGLE: f64 = 1e-5;

/// A basis that grows, and the body on it.
pub struct Krylov {
    /// The rates at which vectors are made, each with its solver: the first is the body's own; of a body that relaxes there are more.
    shifts: Vec<Shift>,
    /// How vectors are made in blocks, where they are.
    lanczos: Option<Lanczos>,
    /// Orthonormal in M.
    basis: Columns,
    /// p, with dampers, for the first shift.
    auxiliary: Columns,
    projected: Projected,
    properties: Properties,
    /// All grow by turns.
    sources: Vec<Source>,
    /// Whose turn it is.
    turn: usize,
    /// Whose it was last of those that are not a.
    other: usize,
    /// Whether the first vector is the translation of a body that nothing holds.
    has_translation: bool,
    /// As of [`Start`].
    leaves_short_waves: bool,
}

/// Vectors from which on the first of the two passes that make a new vector orthogonal takes the last two vectors only, where the operator
/// is symmetric: its three-term recurrence ties the new vector to these two, and the second pass, to all, corrects what rounding leaves
/// (B. N. Parlett, The Symmetric Eigenvalue Problem, 1980, 13.7). Short bases keep all digits at no cost.
const LONG: usize = 256;

impl Krylov {
    /// Factorises S. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(body: &dyn LinearBody, start: impl Into<Start>) -> Result<Self> {
        let Start { shift, end, leaves_short_waves, in_blocks } = start.into();
        let properties = body.properties()?;
        let Properties { layout, held, equilibrium: rest, pushed, load, support_load, .. } = &properties;
        let is_damped = body.has(Operator::Damping);
        let mut starts = layout.one(properties.force.clone());
        let mut loads = layout.one(load.clone());
        loads.add(1.0, &layout.one(support_load.clone()));
        // In equilibrium loads make no waves: the deflection that they have made is all that the basis needs of them.
        if rest.is_none() && loads.largest() > 0.0 {
            starts.append(loads);
        }
        // What lets go of a foundation, or meets it, is moved by its forces.
        pushed.iter().for_each(|pushed| starts.push(pushed));
        starts.zero_rows(held);
        let is_alone = starts.count() == 1;
        let may_recur = in_blocks && !is_damped && body.chains().is_empty() && is_alone && rest.is_none();
        // What single precision leaves of rounding is orthogonal to all vectors in the end, and small against a tolerance that allows blocks.
        let precision = if may_recur { Precision::Single } else { Precision::Double };
        let shifts = Shift::all(body, (shift, end), precision)?;
        let source = |number| Source::new(starts.range(number..number + 1), shifts.len());
        let sources: Vec<Source> = (0..starts.count()).map(source).collect();
        if sources[0].is_exhausted() {
            let message = "the body is held where it is hit, along the impact: it does not move there".to_owned();
            return Err(Fault::new("impactor.point", message, "`model = \"half-space\"`, or another point").into());
        }
        let (mut basis, mut auxiliary) = (layout.clone(), layout.clone());
        let translation = layout.one(properties.translation.clone());
        // (An antisymmetric class of motions has none.)
        let moves = translation.largest() > 0.0;
        let has_translation = moves && rest.is_none() && !is_damped && properties.is_free;
        let first = rest.as_ref().map(|rest| layout.one(rest.clone())).or(has_translation.then_some(translation));
        if let Some(mut first) = first {
            let length = body.apply(Operator::Mass, &first)?.dot(&first).sqrt();
            if length > 0.0 {
                first.scale(1.0 / length);
                basis.append(first);
                auxiliary.append(layout.zeros(usize::from(is_damped)));
            }
        }
        let is_recurrent = may_recur && matches!(shifts[0].solver, Solver::Direct(_));
        let recurrence = || Lanczos::new(body, &properties, &sources[0].start, &basis);
        Ok(Self {
            lanczos: is_recurrent.then(recurrence).transpose()?,
            projected: Projected::new(body),
            shifts,
            basis,
            auxiliary,
            properties,
            sources,
            turn: 0,
            other: 0,
            has_translation,
            // Other forces reach the modes through other vectors.
            leaves_short_waves: leaves_short_waves && is_alone,
        })
    }

    /// Vectors so far.
    pub fn vectors(&self) -> usize {
        self.basis.count()
    }

    /// The vectors, orthonormal in M.
    pub fn basis(&self) -> &Columns {
        &self.basis
    }

    /// Whether the basis holds all that the force can reach, to rounding.
    pub fn is_exhausted(&self) -> bool {
        self.lanczos.as_ref().map_or_else(|| self.sources.iter().all(Source::is_exhausted), Lanczos::is_exhausted)
    }

    /// Adds vectors up to a number. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn grow(&mut self, body: &dyn LinearBody, vectors: usize) -> Result<()> {
        if let Some(lanczos) = &mut self.lanczos {
            let solver = &mut self.shifts[0].solver;
            let exhausted = if solver.is_single() { EXHAUSTED_OF_SINGLE } else { EXHAUSTED };
            return lanczos.grow(&mut Growing { body, solver, exhausted }, &mut self.basis, vectors);
        }
        while self.vectors() < vectors && !self.is_exhausted() {
            self.add(body)?;
        }
        Ok(())
    }

    fn add(&mut self, body: &dyn LinearBody) -> Result<()> {
        let Self { shifts, basis, auxiliary, properties, sources, turn, other, has_translation, .. } = self;
        let is_damped = body.has(Operator::Damping);
        // A recurrence of three terms knows no other vectors.
        let is_alone = sources.len() == 1 && shifts.len() == 1 && properties.equilibrium.is_none() && !*has_translation;
        while sources[*turn].is_exhausted() {
            *turn = (*turn + 1) % sources.len();
        }
        let count = sources.len();
        let Source { start, chains, turn: own } = &mut sources[*turn];
        while chains[*own].exhausted {
            *own = (*own + 1) % chains.len();
        }
        let (first, Shift { rate, solver }) = (shifts[0].rate, &mut shifts[*own]);
        let (rate, Chain { last, exhausted }) = (*rate, &mut chains[*own]);
        let (mut next, mut companion) = match last {
            Some((number, momentum)) => {
                let (number, mut known) = (*number, momentum.clone());
                if is_damped {
                    // p of a vector at this shift is that at the first one and the difference of both times q.
                    known.scale(rate + first);
                    known.add(1.0, &body.apply(Operator::Damping, &basis.range(number..number + 1))?);
                    known.add(1.0, &body.apply(Operator::Mass, &auxiliary.range(number..number + 1))?);
                    known.scale(-1.0);
                }
                known.zero_rows(&properties.held);
                (known, is_damped.then(|| basis.range(number..number + 1)))
            }
            None => (start.clone(), is_damped.then(|| basis.zeros(1))),
        };
        solver.solve_in_place(next.get_mut(0))?;
        if let Some(companion) = companion.as_mut().filter(|_| rate != first) {
            companion.add(rate - first, &next);
        }
        let is_tied = !is_damped && is_alone && basis.count() >= LONG;
        // M-norms before and after, the latter by Pythagoras' theorem from that before the second, small correction.
        let (mut before, mut length, mut momentum) = (0.0_f64, 0.0, basis.zeros(0));
        for pass in 0..2 {
            let near = if is_tied && pass == 0 { basis.count() - 2 } else { 0 };
            let near = near..basis.count();
            momentum = body.apply(Operator::Mass, &next)?;
            let norm = next.dot(&momentum).max(0.0).sqrt();
            let shares = basis.products_of(near.clone(), &momentum);
            next.subtract_of(basis, near.clone(), &shares);
            if let Some(companion) = &mut companion {
                companion.subtract_of(auxiliary, near, &shares);
            }
            if pass == 0 {
                before = norm;
            }
            length = (norm * norm - shares.norm_squared()).max(0.0).sqrt();
        }
        if length <= EXHAUSTED * before {
            *exhausted = true;
            return Ok(());
        }
        next.scale(1.0 / length);
        if is_tied {
            // The recurrence wants the product with the vector itself.
            momentum = body.apply(Operator::Mass, &next)?;
        } else {
            // But for the second correction, which is within the basis.
            momentum.scale(1.0 / length);
        }
        *last = Some((basis.count(), momentum));
        // Every second vector is a's; the other chains share the rest.
        *own = (*own + 1) % chains.len();
        *turn = if *turn == 0 && count > 1 {
            *other = 1 + *other % (count - 1);
            *other
        } else {
            0
        };
        if let Some(mut companion) = companion {
            companion.scale(1.0 / length);
            auxiliary.append(companion);
        }
        basis.append(next);
        Ok(())
    }

    /// The body on the basis. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn projection(&mut self, body: &dyn LinearBody) -> Result<Projection> {
        self.projected.extend(body, &self.basis)?;
        if self.has_translation {
            self.projected.release_first();
        }
        let mut projection = self.projected.projection(body, &self.properties, &self.basis, self.shifts[0].rate)?;
        projection.infinite_plate = body.infinite_plate().filter(|_| self.leaves_short_waves).cloned();
        Ok(projection)
    }
}
