//! Rational Krylov bases of a linear body.
//!
//! The impactor interacts with the body only through the contact force vector a: one force in, one displacement out.
//! The vectors
//!
//! q₁ = S⁻¹ a,  q_{j+1} = S⁻¹ M q_j,  S = K + s²M,
//!
//! made orthonormal in M, span the response to a unit force near the shift s and its derivatives with respect to s, up
//! to the number of vectors. Free motions and the dent under a static force are included (the shift-and-invert Lanczos
//! method of load-dependent Ritz vectors, E. L. Wilson, M.-W. Yuan & J. M. Dickens, Earthq. Eng. Struct. Dyn. 10, 1982).
//! With dampers the vectors are those of a second-order Krylov space ([`DampedPairs`]). Every vector is orthogonalised
//! against all others twice, and K itself is projected.
//!
//! For a viscoelastic body, S = K + G̃(s) D + sC + s²M contains the modulus at the shift s, and D is projected in
//! addition to K. Bodies that differ only in the Prony series therefore share the basis. The instantaneous response and
//! the relaxed response have different shapes. Some vectors are therefore made at lower shifts, with the modulus at the
//! respective shift: a rational Krylov space (A. Ruhe, Linear Algebra Appl. 58, 1984; multi-point moment matching, E.
//! Grimme, Ph.D. thesis, Univ. of Illinois, 1997). In this space, the transform of the motion is exact at each shift.
//!
//! If the contact is short compared with the slow motions of the body, the basis lacks these motions. For an
//! unsupported body, the first vector is therefore the translation, which K maps to zero.

use nalgebra::DVector;

use super::columns::Columns;
use super::damped_pairs::DampedPairs;
use super::direct::Precision;
use super::lanczos::{Growing, Lanczos};
use super::linear::{LinearBody, Operator, Properties};
use super::projected::Projected;
use super::shift::{Chain, Shift, Solver, Source, rates};
use super::{Projection, Start};
use crate::error::Result;
use crate::scene::Fault;

/// Ratio of the lengths after and before orthogonalisation below which a new vector is only rounding.
const EXHAUSTED: f64 = 1e-10;

/// The same ratio for vectors computed with a factor in single precision.
const EXHAUSTED_OF_SINGLE: f64 = 1e-5;

/// Number of vectors from which the lowest frequency is computed, for the shift of loads.
const VECTORS_FOR_LOWEST_FREQUENCY: usize = 20;

/// Ratio to the largest ω² of a basis below which an ω² is that of a free motion, with rounding.
const FREE_MOTION: f64 = 1e-12;

/// Least shift of the vectors that are made from sudden loads, over the shift of the impact. With a smaller one, S of an
/// unsupported body is almost singular.
const LEAST_OF_LOADS: f64 = 1e-4;

/// A growing basis, with the projection of the body onto it.
pub struct Krylov {
    /// Shifts at which vectors are made, each with a solver. The first is the main shift; a viscoelastic body may have
    /// more.
    shifts: Vec<Shift>,
    /// Block Lanczos recurrence, if the vectors are made in blocks.
    lanczos: Option<Lanczos>,
    /// Basis vectors, orthonormal in M.
    basis: Columns,
    /// Vectors with their companions, if the body has dampers.
    damped: Option<DampedPairs>,
    projected: Projected,
    /// Same as in [`Start`].
    rate: f64,
    /// Same as in [`Projection`].
    mode_acceleration: Option<f64>,
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
        let Start { shift, rate, end, leaves_short_waves, in_blocks } = start.into();
        let properties = body.properties()?;
        let Properties { layout, held, equilibrium: rest, pushed, .. } = &properties;
        let is_damped = body.has(Operator::Damping);
        let mut starts = layout.one(properties.terms.contact.force.clone());
        // Where a foundation loses or regains contact, its forces move the body.
        pushed.iter().for_each(|pushed| starts.push(pushed));
        // In equilibrium, the loads excite no waves. The basis then only needs the static deflection due to the loads.
        let loads = properties.sudden_loads();
        let of_impact = starts.count();
        loads.into_iter().for_each(|loads| starts.append(loads));
        starts.zero_rows(held);
        let is_alone = starts.count() == 1;
        let rates = rates(&body.chains(), shift, end);
        let is_plain = !is_damped && rates.len() == 1 && is_alone && rest.is_none();
        // Single precision cannot keep a volume.
        let may_recur = in_blocks && is_plain && !properties.is_nearly_incompressible;
        let accelerates = is_plain && properties.is_nearly_incompressible && body.chains().is_empty();
        // Single-precision vectors are orthogonalised in the end, and their rounding is small compared with a tolerance
        // that allows blocks.
        let precision = if may_recur { Precision::Single } else { Precision::Double };
        let shifts = Shift::all(body, &rates, precision)?;
        let source = |number| Source::new(starts.range(number..number + 1), 0..shifts.len());
        let sources: Vec<Source> = (0..starts.count()).map(source).collect();
        if sources[0].is_exhausted() {
            let message = "the body is held where it is hit, along the impact: it does not move there".to_owned();
            return Err(Fault::new("impactor.point", message, "`model = \"half-space\"`, or another point").into());
        }
        let mut basis = layout.clone();
        let translation = layout.one(properties.terms.translation.clone());
        // (An antisymmetric class of motions has no translation.)
        let moves = translation.largest() > 0.0;
        let has_translation = moves && rest.is_none() && !is_damped && properties.is_free;
        let first = rest.as_ref().map(|rest| layout.one(rest.clone())).or(has_translation.then_some(translation));
        if let Some(mut first) = first {
            let length = body.apply(Operator::Mass, &first)?.dot(&first).sqrt();
            if length > 0.0 {
                first.scale(1.0 / length);
                basis.append(first);
            }
        }
        let is_recurrent = may_recur && matches!(shifts[0].solver, Solver::Direct(_));
        let recurrence = || Lanczos::new(body, &properties, &sources[0].start, &basis);
        let of_loads = (starts.count() > of_impact).then(|| sources.len() - 1);
        let mut krylov = Self {
            lanczos: is_recurrent.then(recurrence).transpose()?,
            projected: Projected::new(body),
            rate,
            mode_acceleration: accelerates.then_some(shift),
            shifts,
            basis,
            damped: is_damped.then(|| DampedPairs::new(shift)),
            properties,
            sources,
            turn: 0,
            other: 0,
            has_translation,
            // Other forces excite the modes through other vectors.
            leaves_short_waves: leaves_short_waves && is_alone,
        };
        if let Some(of_loads) = of_loads {
            krylov.slow_down(body, of_loads, end)?;
        }
        Ok(krylov)
    }

    /// Gives the vectors that are made from sudden loads a shift of their own, at about the lowest frequency of the body:
    /// loads excite slow motions, which vectors at the shift of an impact represent poorly. The frequency is that of a few
    /// first vectors, which are then removed. Collective.
    fn slow_down(&mut self, body: &dyn LinearBody, of_loads: usize, end: f64) -> Result<()> {
        let (shift, first) = (self.shifts[0].rate, self.basis.count());
        self.grow(body, first + VECTORS_FOR_LOWEST_FREQUENCY)?;
        let squares = self.projection(body)?.stiffness_at_rate().symmetric_eigenvalues();
        let is_vibration = |square: &f64| *square > FREE_MOTION * squares.max();
        let lowest = squares.iter().copied().filter(is_vibration).min_by(f64::total_cmp).map_or(shift, f64::sqrt);
        let mut slow = [lowest.clamp(LEAST_OF_LOADS * shift, shift)];
        self.basis.agree(&mut slow);
        let at_impact = 0..self.shifts.len();
        self.shifts.extend(Shift::all(body, &rates(&body.chains(), slow[0], end), Precision::Double)?);
        let at_loads = at_impact.end..self.shifts.len();
        self.basis = self.basis.range(0..first);
        self.projected = Projected::new(body);
        self.damped = self.damped.as_ref().map(|_| DampedPairs::new(shift));
        (self.turn, self.other) = (0, 0);
        for (number, source) in self.sources.iter_mut().enumerate() {
            let shifts = if number == of_loads { &at_loads } else { &at_impact };
            *source = Source::new(source.start.clone(), shifts.clone());
        }
        Ok(())
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
        self.basis.check_room(vectors.saturating_sub(self.vectors()))?;
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
        let Self { shifts, basis, damped, properties, sources, turn, other, has_translation, .. } = self;
        // The three-term recurrence requires a single source, a single shift, and no other vectors in the basis.
        let is_alone = sources.len() == 1 && shifts.len() == 1 && properties.equilibrium.is_none() && !*has_translation;
        while sources[*turn].is_exhausted() {
            *turn = (*turn + 1) % sources.len();
        }
        let count = sources.len();
        let own = sources[*turn].next_chain();
        let Source { start, chains, shifts: of_source, .. } = &mut sources[*turn];
        let Shift { rate, solver } = &mut shifts[of_source.start + own];
        let Chain { last, exhausted } = &mut chains[own];
        let mut next = match (&last, &damped) {
            (None, _) => start.clone(),
            (Some((_, momentum)), None) => momentum.clone(),
            (Some((number, _)), Some(pairs)) => pairs.right_side(body, basis, *number, *rate)?,
        };
        if last.is_some() {
            next.zero_rows(&properties.held);
        }
        solver.solve_in_place(next.get_mut(0))?;
        let is_tied = damped.is_none() && is_alone && basis.count() >= LONG_BASIS;
        // M-norms before and after orthogonalisation. The latter follows by Pythagoras' theorem from the norm before
        // the second, small correction.
        let (mut before, mut length, mut momentum) = (0.0_f64, 0.0, basis.zeros(0));
        // Coefficients of the vector in the basis; with dampers only.
        let mut coefficients = DVector::zeros(basis.count() + 1);
        for pass in 0..2 {
            let near = if is_tied && pass == 0 { basis.count() - 2 } else { 0 };
            let near = near..basis.count();
            momentum = body.apply(Operator::Mass, &next)?;
            let norm = next.dot(&momentum).max(0.0).sqrt();
            let shares = basis.products_of(near.clone(), &momentum);
            next.subtract_of(basis, near.clone(), &shares);
            coefficients.rows_range_mut(near).axpy(1.0, &shares.column(0), 1.0);
            if pass == 0 {
                before = norm;
            }
            length = (norm * norm - shares.norm_squared()).max(0.0).sqrt();
        }
        let is_new = length > EXHAUSTED * before;
        if let Some(pairs) = damped {
            match is_new {
                true => coefficients[basis.count()] = length,
                false => coefficients = coefficients.remove_row(basis.count()),
            }
            let number = pairs.push(last.as_ref().map(|(number, _)| *number), *rate, coefficients);
            *exhausted = number.is_none();
            *last = number.map(|number| (number, basis.zeros(0)));
        } else {
            *exhausted = !is_new;
        }
        if !is_new {
            return Ok(());
        }
        next.scale(1.0 / length);
        if damped.is_none() {
            if is_tied {
                // The recurrence needs the product with the vector itself.
                momentum = body.apply(Operator::Mass, &next)?;
            } else {
                // This neglects the second correction, which lies within the basis.
                momentum.scale(1.0 / length);
            }
            *last = Some((basis.count(), momentum));
        }
        // Every second vector comes from the contact force vector a. The other sources share the rest.
        *turn = if *turn == 0 && count > 1 {
            *other = 1 + *other % (count - 1);
            *other
        } else {
            0
        };
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
        let mut projection = self.projected.projection(body, &self.properties, &self.basis, self.rate)?;
        let plate = body.infinite_plate().filter(|_| self.leaves_short_waves);
        projection.mode_acceleration = self.mode_acceleration;
        projection.terms.infinite_plate = plate.map(|plate| plate.clone().with_shifts(self.shifts.len()));
        Ok(projection)
    }
}
