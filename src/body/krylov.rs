//! Rational Krylov bases of a linear body.
//!
//! The impactor interacts with the body only through the contact force vector a: one force in, one displacement out.
//! The vectors
//!
//! q₁ = S⁻¹ a,  q_{j+1} = −S⁻¹ ((C + 2sM) q_j + M p_j),  S = K + sC + s²M,
//!
//! made orthonormal in M, span the response to a unit force near the shift s and its derivatives with respect to s, up
//! to the number of vectors. Free motions, dampers and the dent under a static force are included (Z. Bai & Y. Su,
//! SOAR: A second-order Arnoldi method for the solution of the quadratic eigenvalue problem, SIAM J. Matrix Anal. Appl.
//! 26, 2005; without dampers the shift-and-invert Lanczos method of load-dependent Ritz vectors, E. L. Wilson, M.-W.
//! Yuan & J. M. Dickens, Earthq. Eng. Struct. Dyn. 10, 1982). Every vector is orthogonalised against all others twice,
//! and K itself is projected.
//!
//! For a viscoelastic body, S = K + G̃(s) D + sC + s²M contains the modulus at the shift s, and D is projected in
//! addition to K. Bodies that differ only in the Prony series therefore share the basis. The instantaneous response and
//! the relaxed response have different shapes. Some vectors are therefore made at lower shifts, with the modulus at the
//! respective shift: a rational Krylov space (A. Ruhe, Linear Algebra Appl. 58, 1984; multi-point moment matching, E.
//! Grimme, Ph.D. thesis, Univ. of Illinois, 1997). In this space, the transform of the motion is exact at each shift.
//!
//! If the contact is short compared with the slow motions of the body, the basis lacks these motions. For an
//! unsupported body, the first vector is therefore the translation, which K maps to zero.

use super::columns::Columns;
use super::direct::Precision;
use super::lanczos::{Growing, Lanczos};
use super::linear::{LinearBody, Operator, Properties};
use super::projected::Projected;
use super::shift::{Chain, Shift, Solver, Source, rates as shift_rates};
use super::{Projection, Start};
use crate::error::Result;
use crate::scene::Fault;

/// Ratio of the lengths after and before orthogonalisation below which a new vector is only rounding.
const EXHAUSTED: f64 = 1e-10;

/// The same ratio for vectors computed with a factor in single precision.
const EXHAUSTED_OF_SINGLE: f64 = 1e-5;

/// A growing basis, with the projection of the body onto it.
pub struct Krylov {
    /// Shifts at which vectors are made, each with a solver. The first is the main shift; a viscoelastic body may have
    /// more.
    shifts: Vec<Shift>,
    /// Block Lanczos recurrence, if the vectors are made in blocks.
    lanczos: Option<Lanczos>,
    /// Basis vectors, orthonormal in M.
    basis: Columns,
    /// Vectors p at the first shift; only with dampers.
    auxiliary: Columns,
    projected: Projected,
    properties: Properties,
    /// Sources of vectors, used in turn.
    sources: Vec<Source>,
    /// Number of the source of the next vector.
    turn: usize,
    /// Last used source other than the contact force vector a.
    other: usize,
    /// Whether the first vector is the translation of an unsupported body.
    has_translation: bool,
    /// Same as in [`Start`]; false if there are several sources.
    leaves_short_waves: bool,
}

/// Number of basis vectors from which on the first of the two orthogonalisation passes uses the last two vectors only,
/// if the operator is symmetric. The three-term recurrence couples the new vector to these two. The second pass,
/// against all vectors, corrects the rounding (B. N. Parlett, The Symmetric Eigenvalue Problem, 1980, 13.7). Short
/// bases keep full accuracy at no cost.
const LONG_BASIS: usize = 256;

impl Krylov {
    /// Prepares the basis and factorises S at each shift. Collective.
    ///
    /// # Errors
    /// If the impact point is constrained along the impact direction, if S has no factor, or if a PETSc call fails.
    pub fn new(body: &dyn LinearBody, start: impl Into<Start>) -> Result<Self> {
        let Start { shift, loads_shift, end, leaves_short_waves, in_blocks } = start.into();
        let properties = body.properties()?;
        let Properties { layout, held, equilibrium: rest, pushed, .. } = &properties;
        let is_damped = body.has(Operator::Damping);
        let mut starts = layout.one(properties.force.clone());
        // Where a foundation loses or regains contact, its forces move the body.
        pushed.iter().for_each(|pushed| starts.push(pushed));
        // In equilibrium, the loads excite no waves. The basis then only needs the static deflection due to the loads.
        let loads = properties.sudden_loads();
        let of_impact = starts.count();
        loads.into_iter().for_each(|loads| starts.append(loads));
        starts.zero_rows(held);
        let is_alone = starts.count() == 1;
        let mut rates = shift_rates(&body.chains(), shift, end);
        let at_impact = 0..rates.len();
        let at_loads = match loads_shift.filter(|_| starts.count() > of_impact) {
            Some(slow) => {
                rates.extend(shift_rates(&body.chains(), slow, end));
                at_impact.end..rates.len()
            }
            None => at_impact.clone(),
        };
        let may_recur = in_blocks && !is_damped && rates.len() == 1 && is_alone && rest.is_none();
        // Single-precision vectors are orthogonalised in the end, and their rounding is small compared with a tolerance
        // that allows blocks.
        let precision = if may_recur { Precision::Single } else { Precision::Double };
        let shifts = Shift::all(body, &rates, precision)?;
        let source = |number| {
            let shifts = if number < of_impact { &at_impact } else { &at_loads };
            Source::new(starts.range(number..number + 1), shifts.clone())
        };
        let sources: Vec<Source> = (0..starts.count()).map(source).collect();
        if sources[0].is_exhausted() {
            let message = "the body is held where it is hit, along the impact: it does not move there".to_owned();
            return Err(Fault::new("impactor.point", message, "`model = \"half-space\"`, or another point").into());
        }
        let (mut basis, mut auxiliary) = (layout.clone(), layout.clone());
        let translation = layout.one(properties.translation.clone());
        // (An antisymmetric class of motions has no translation.)
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
            // Other forces excite the modes through other vectors.
            leaves_short_waves: leaves_short_waves && is_alone,
        })
    }

    /// Number of vectors so far.
    pub fn vectors(&self) -> usize {
        self.basis.count()
    }

    /// The basis vectors, orthonormal in M.
    pub fn basis(&self) -> &Columns {
        &self.basis
    }

    /// Whether the basis spans all motions that the force can excite, to rounding.
    pub fn is_exhausted(&self) -> bool {
        self.lanczos.as_ref().map_or_else(|| self.sources.iter().all(Source::is_exhausted), Lanczos::is_exhausted)
    }

    /// Extends the basis up to `vectors` vectors. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
        // The three-term recurrence requires a single source, a single shift, and no other vectors in the basis.
        let is_alone = sources.len() == 1 && shifts.len() == 1 && properties.equilibrium.is_none() && !*has_translation;
        while sources[*turn].is_exhausted() {
            *turn = (*turn + 1) % sources.len();
        }
        let count = sources.len();
        let own = sources[*turn].next_chain();
        let Source { start, chains, shifts: of_source, .. } = &mut sources[*turn];
        let (first, Shift { rate, solver }) = (shifts[0].rate, &mut shifts[of_source.start + own]);
        let (rate, Chain { last, exhausted }) = (*rate, &mut chains[own]);
        let (mut next, mut companion) = match last {
            Some((number, momentum)) => {
                let (number, mut known) = (*number, momentum.clone());
                if is_damped {
                    // p of a vector at this shift is p at the first shift plus the difference of the shifts times q.
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
        let is_tied = !is_damped && is_alone && basis.count() >= LONG_BASIS;
        // M-norms before and after orthogonalisation. The latter follows by Pythagoras' theorem from the norm before
        // the second, small correction.
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
            // The recurrence needs the product with the vector itself.
            momentum = body.apply(Operator::Mass, &next)?;
        } else {
            // This neglects the second correction, which lies within the basis.
            momentum.scale(1.0 / length);
        }
        *last = Some((basis.count(), momentum));
        // Every second vector comes from the contact force vector a. The other sources share the rest.
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

    /// Returns the body projected onto the basis. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn projection(&mut self, body: &dyn LinearBody) -> Result<Projection> {
        self.projected.extend(body, &self.basis)?;
        if self.has_translation {
            self.projected.release_first();
        }
        let mut projection = self.projected.projection(body, &self.properties, &self.basis, self.shifts[0].rate)?;
        let plate = body.infinite_plate().filter(|_| self.leaves_short_waves);
        projection.infinite_plate = plate.map(|plate| plate.clone().with_shifts(self.shifts.len()));
        Ok(projection)
    }
}
