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

use nalgebra::{DMatrix, DVector};
use petsc_wrap::{Matrix, Vector};

use super::direct::Precision;
use super::gram::{forms, forms_on};
use super::lanczos::{self, Lanczos};
use super::shift::{Shift, Solver, Source};
use super::{Body, ProjectedRelaxation, Projection, Start};
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
    /// The same vectors as dense matrices, where Lanczos' recurrence makes them.
    lanczos: Option<Lanczos>,
    basis: Vec<Vector>,
    /// p, with dampers, for the first shift.
    auxiliary: Vec<Vector>,
    /// The projected operators, of the first vectors: K of the body, K of the supports, C.
    projected: [DMatrix<f64>; 3],
    /// D of each relaxation, likewise.
    distortions: Vec<DMatrix<f64>>,
    work: [Vector; 2],
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
    pub fn new(body: &Body, start: impl Into<Start>) -> Result<Self> {
        let Start { shift, leaves_short_waves, in_blocks } = start.into();
        let mut loads = body.load.duplicate()?;
        loads.copy_from(&body.load)?;
        loads.axpy(1.0, &body.support_load)?;
        let mut force = body.load.duplicate()?;
        force.copy_from(&body.localization.vector)?;
        let mut starts = vec![force];
        // In equilibrium loads make no waves: the deflection that they have made is all that the basis needs of them.
        let rest = body.equilibrium.as_ref();
        if rest.is_none() && loads.norm_max()? > 0.0 {
            starts.push(loads);
        }
        // What lets go of a foundation, or meets it, is moved by its forces.
        for pushed in body.unilateral.iter().flat_map(|foundation| &foundation.loads) {
            let mut start = body.load.duplicate()?;
            start.copy_from(pushed)?;
            starts.push(start);
        }
        let is_alone = starts.len() == 1;
        let is_undamped = body.damping.is_none() && body.relaxations.is_empty();
        let may_recur = in_blocks && is_undamped && is_alone && rest.is_none();
        // What single precision leaves of rounding is orthogonal to all vectors in the end, and small against a tolerance that allows blocks.
        let precision = if may_recur { Precision::Single } else { Precision::Double };
        let shifts = Shift::all(body, shift, precision)?;
        let mut sources = Vec::new();
        for mut start in starts {
            body.clamps.zero(&mut start)?;
            sources.push(Source::new(start, shifts.len())?);
        }
        if sources[0].is_exhausted() {
            let message = "the body is held where it is hit, along the impact: it does not move there".to_owned();
            return Err(Fault::new("impactor.point", message, "`model = \"half-space\"`, or another point").into());
        }
        let (mut basis, mut auxiliary) = (Vec::new(), Vec::new());
        // (An antisymmetric class of motions has none.)
        let moves = body.translation.norm_max()? > 0.0;
        let has_translation = moves && rest.is_none() && body.damping.is_none() && body.is_free()?;
        let first = if has_translation { Some(&body.translation) } else { rest };
        if let Some(rest) = first {
            let (mut first, mut product) = (rest.duplicate()?, rest.duplicate()?);
            first.copy_from(rest)?;
            body.apply_mass(&first, &mut product)?;
            let length = first.dot(&product)?.sqrt();
            if length > 0.0 {
                first.scale(1.0 / length)?;
                if body.damping.is_some() {
                    auxiliary.push(body.load.duplicate()?);
                }
                basis.push(first);
            }
        }
        let is_recurrent = may_recur && matches!(shifts[0].solver, Solver::Small(_));
        let recurrence = || Lanczos::new(body, &sources[0].start, basis.first());
        let lanczos = is_recurrent.then(recurrence).transpose()?;
        Ok(Self {
            shifts,
            lanczos,
            basis,
            auxiliary,
            projected: std::array::from_fn(|_| DMatrix::zeros(0, 0)),
            distortions: vec![DMatrix::zeros(0, 0); body.relaxations.len()],
            work: [body.load.duplicate()?, body.load.duplicate()?],
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
        self.basis.len()
    }

    /// The vectors, orthonormal in M.
    pub fn basis(&self) -> &[Vector] {
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
    pub fn grow(&mut self, body: &Body, vectors: usize) -> Result<()> {
        if let (Some(lanczos), Solver::Small(factor)) = (&mut self.lanczos, &self.shifts[0].solver) {
            let exhausted = if factor.is_single() { EXHAUSTED_OF_SINGLE } else { EXHAUSTED };
            lanczos.grow(&lanczos::Solver { factor, exhausted }, vectors);
            for number in self.basis.len()..lanczos.vectors().count() {
                let mut vector = body.load.duplicate()?;
                vector.write()?.copy_from_slice(lanczos.vectors().get(number));
                self.basis.push(vector);
            }
            return Ok(());
        }
        while self.basis.len() < vectors && !self.is_exhausted() {
            self.add(body)?;
        }
        Ok(())
    }

    fn add(&mut self, body: &Body) -> Result<()> {
        let Self { shifts, basis, auxiliary, work: [known, product], sources, turn, other, has_translation, .. } = self;
        // A recurrence of three terms knows no other vectors.
        let is_alone = sources.len() == 1 && shifts.len() == 1 && body.equilibrium.is_none() && !*has_translation;
        while sources[*turn].is_exhausted() {
            *turn = (*turn + 1) % sources.len();
        }
        let count = sources.len();
        let Source { start, chains, turn: own } = &mut sources[*turn];
        while chains[*own].exhausted {
            *own = (*own + 1) % chains.len();
        }
        let (first, Shift { rate, solver }) = (shifts[0].rate, &mut shifts[*own]);
        let rate = *rate;
        let chain = &mut chains[*own];
        let is_first = chain.last.is_none();
        let mut next = body.load.duplicate()?;
        let mut companion = body.damping.is_some().then(|| body.load.duplicate()).transpose()?;
        if let Some(number) = chain.last {
            let last = &basis[number];
            known.copy_from(&chain.image)?;
            if let Some(damping) = &body.damping {
                // p of a vector at this shift is that at the first one and the difference of both times q.
                known.scale(rate + first)?;
                damping.mult(last, product)?;
                known.axpy(1.0, product)?;
                body.apply_mass(&auxiliary[number], product)?;
                known.axpy(1.0, product)?;
                known.scale(-1.0)?;
            }
            body.clamps.zero(known)?;
            solver.solve(known, &mut next)?;
            if let Some(companion) = &mut companion {
                companion.copy_from(last)?;
            }
        }
        if is_first {
            solver.solve(start, &mut next)?;
            if let Some(companion) = &mut companion {
                companion.fill(0.0)?;
            }
        }
        if let Some(companion) = companion.as_mut().filter(|_| rate != first) {
            companion.axpy(rate - first, &next)?;
        }
        let is_tied = body.damping.is_none() && is_alone && basis.len() >= LONG;
        // M-norms before and after, the latter by Pythagoras' theorem from that before the second, small correction.
        let (mut before, mut length) = (0.0_f64, 0.0);
        for pass in 0..2 {
            let near = if is_tied && pass == 0 { basis.len() - 2 } else { 0 };
            body.apply_mass(&next, product)?;
            let norm = next.dot(product)?.max(0.0).sqrt();
            let shares: Vec<f64> = product.dots(&basis[near..])?.iter().map(|share| -share).collect();
            next.add_combination(&shares, &basis[near..])?;
            if let Some(companion) = &mut companion {
                companion.add_combination(&shares, &auxiliary[near..])?;
            }
            if pass == 0 {
                before = norm;
            }
            length = (norm * norm - shares.iter().map(|share| share * share).sum::<f64>()).max(0.0).sqrt();
        }
        if length <= EXHAUSTED * before {
            chain.exhausted = true;
            return Ok(());
        }
        next.scale(1.0 / length)?;
        if is_tied {
            // The recurrence wants the product with the vector itself.
            body.apply_mass(&next, &mut chain.image)?;
        } else {
            // But for the second correction, which is within the basis.
            chain.image.copy_from(product)?;
            chain.image.scale(1.0 / length)?;
        }
        chain.last = Some(basis.len());
        // Every second vector is a's; the other chains share the rest.
        *own = (*own + 1) % chains.len();
        *turn = if *turn == 0 && count > 1 {
            *other = 1 + *other % (count - 1);
            *other
        } else {
            0
        };
        if let Some(mut companion) = companion {
            companion.scale(1.0 / length)?;
            auxiliary.push(companion);
        }
        basis.push(next);
        Ok(())
    }

    /// Projects the operators onto the vectors that are new since the last time.
    fn project(&mut self, body: &Body) -> Result<()> {
        enum Operator<'a> {
            Elastic,
            Of(&'a Matrix),
        }
        let Self { shifts, basis, projected, distortions, has_translation, lanczos, .. } = self;
        if let Some(lanczos) = lanczos {
            *projected = lanczos.project(projected);
            let [elastic, ..] = projected;
            if *has_translation {
                free_of_rounding(elastic);
            }
            return Ok(());
        }
        let count = basis.len();
        let matrices =
            [Some(Operator::Elastic), body.support.as_ref().map(Operator::Of), body.damping.as_ref().map(Operator::Of)];
        let relaxing = body.relaxations.iter().map(|relaxation| Some(Operator::Of(&relaxation.distortion)));
        let all = projected.iter_mut().zip(matrices).chain(distortions.iter_mut().zip(relaxing));
        for (known, operator) in all {
            let first = known.nrows();
            *known = std::mem::replace(known, DMatrix::zeros(0, 0)).resize(count, count, 0.0);
            let Some(operator) = operator else { continue };
            let at_once = match (&operator, &shifts[0].solver) {
                (Operator::Elastic, Solver::Small(factor)) => factor.elastic_forms(basis, first)?,
                _ => None,
            };
            let apply = |vector: &Vector, image: &mut Vector| match operator {
                Operator::Of(matrix) => Ok(matrix.mult(vector, image)?),
                Operator::Elastic => body.apply_elastic(vector, image),
            };
            let columns = at_once.map_or_else(|| forms(body.comm(), basis, first, apply), Ok)?;
            for (j, column) in (first..count).zip(columns.column_iter()) {
                // The lower triangle is that of the later vectors.
                for i in 0..=j {
                    known[(i, j)] = column[i];
                    known[(j, i)] = column[i];
                }
            }
            if *has_translation && count > 0 {
                free_of_rounding(known);
            }
        }
        Ok(())
    }

    /// The body on the basis. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn projection(&mut self, body: &Body) -> Result<Projection> {
        self.project(body)?;
        let along = |v: &Vector| match &self.lanczos {
            Some(lanczos) => Ok::<_, crate::Error>(lanczos.vectors().along(&v.read()?).column(0).into_owned()),
            None => Ok(DVector::from_vec(v.dots(&self.basis)?)),
        };
        let mut momentum = body.translation.duplicate()?;
        // Of a body that is held the basis has no translation, which K would map to nothing.
        if body.is_free()? {
            body.apply_mass(&body.translation, &mut momentum)?;
        }
        let [elastic, support, damping] = &self.projected;
        let relaxing = body.relaxations.iter().zip(&self.distortions);
        let relaxing = relaxing.map(|(relaxation, distortion)| ProjectedRelaxation {
            distortion: distortion.clone(),
            chain: relaxation.chain.clone(),
        });
        let mut projection = Projection {
            translation: along(&momentum)?,
            hit_stress: forms_on(&body.hit_stress, &self.basis)?,
            hit_local: body.hit_local,
            elastic: elastic.clone(),
            relaxations: relaxing.collect(),
            rate: self.shifts[0].rate,
            support: support.clone(),
            damping: body.damping.is_some().then(|| damping.clone()),
            force: along(&body.localization.vector)?,
            load: along(&body.load)?,
            support_load: along(&body.support_load)?,
            support_offset: body.support_offset,
            compliance: body.localization.compliance,
            copies: body.copies,
            patch: body.localization.patch,
            foundation: body.unilateral.as_ref().map(|foundation| foundation.on(&self.basis)).transpose()?,
            infinite_plate: body.infinite_plate.clone().filter(|_| self.leaves_short_waves),
        };
        // Sums over ranks may differ in their last digits, and with them the decisions that follow from them.
        projection.numbers().for_each(|numbers| body.comm().broadcast_from_root(numbers));
        Ok(projection)
    }
}

/// K maps the first vector, the translation, to nothing, but for rounding that a large body would oscillate by.
fn free_of_rounding(stiffness: &mut DMatrix<f64>) {
    stiffness.row_mut(0).fill(0.0);
    stiffness.column_mut(0).fill(0.0);
}
