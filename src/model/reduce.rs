//! Reduces a body to a basis as large as a scene needs, and estimates the error of the basis.

use crate::body::{
    DirectSum, LinearBody, ModalBody, Projection, SHIFT_OVER_CUTOFF, Start, rates, vectors_over_one_shift,
};
use crate::contact::ForceLaw;
use crate::error::{Error, Result};
use crate::impact::{ErrorRule, Errors, KnownForce, Steps, Trace};
use crate::scene::{Impactor, Measure, Reduction, Scene};

use super::context::ModelContext;
use super::error_factors::ErrorFactors;
use super::judgement::Rule;
use super::long_waves::{LongWaves, ORDER};
use super::trials::{Trial, Trials};
use super::watch::{Judged, Stage, Watch};

/// Number of vectors of the first basis that is tried.
const FIRST_VECTORS: usize = 10;

/// Largest number of vectors of an automatic basis, per symmetry class.
pub(super) const MAX_VECTORS_PER_CLASS: usize = 1500;

/// Least number of additional vectors of the larger basis. When a basis of 10 vectors was compared with one of 15, the
/// error was up to 6 times the difference.
const LEAST_MORE: usize = 9;

/// Share of the tolerance for the estimated error of the basis.
pub const BASIS_SHARE: f64 = 0.5;

/// Number of vectors of the basis of a body that loads move and that the impactor does not touch.
const VECTORS_WITHOUT_CONTACT: usize = 60;

/// Number of vectors of a long basis, which is costly to enlarge.
const LONG_BASIS: usize = 256;

/// Least growth factor of the number of vectors from one basis to the next.
const BASIS_GROWTH: f64 = 1.225;

/// Largest growth factor of bases of [`MANY_VECTORS`] up to [`LONG_BASIS`] vectors. Shorter bases grow by less, because
/// their error often falls faster than predicted.
const LARGEST_BASIS_GROWTH: f64 = 2.0;

/// Number of vectors from which a basis may grow by that factor.
const MANY_VECTORS: usize = 30;

/// Largest predicted growth factor of any basis.
const MOST_PREDICTED_GROWTH: f64 = 100.0;

/// Order of convergence in the number of vectors, if short waves are not treated separately.
const ORDER_OF_ALL_WAVES: f64 = 2.0;

/// Shift s of the basis, times the contact time on a half-space, for a tolerance of 1e-2. Bases from 5 to 50 are much
/// alike; the remaining error at small tolerances is at higher frequencies.
const SHIFT_TIMES_CONTACT: f64 = 15.0;

/// Ratio of the shift to [`rate`], if the basis must represent slow vibrations after a contact. Measured on a pane of
/// 20 mm over eighty contact times, with 100 vectors: the error of the deflection is 1.4% with ratios of 0.013 to 0.07,
/// and 160% with 1.
const LOW_SHIFT_OVER_RATE: f64 = 1.0 / 15.0;

/// Smallest tolerance for which long bases are orthogonalised in blocks. Below it the rounding errors of blocks matter:
/// for 1e-4 a pane took 363 vectors instead of 296.
const LEAST_TOLERANCE_OF_BLOCKS: f64 = 1e-3;

/// Least number of unknowns for which bases with all waves are orthogonalised in blocks. Smaller bodies need few
/// vectors, so that blocks save no time.
const LEAST_UNKNOWNS_OF_LANCZOS_BLOCKS: usize = 2000;

/// Number of vectors added to the basis of a small body between two checks for interruption, per symmetry class.
const VECTORS_PER_CHECK: usize = 32;

/// A body reduced to a basis.
pub struct Reduced {
    /// The reduced body.
    pub projection: Projection,
    /// The body reduced to the other basis, for estimating the error.
    pub judge: Projection,
    /// Contact force on the other basis, in the same time steps.
    pub force_of_judge: Trace,
    /// Estimates the error from the difference of the forces on the two bases.
    pub rule: ErrorRule,
    /// Difference of the forces on the two bases.
    pub difference: Errors,
    /// Vectors of the larger of the two bases.
    pub krylov: DirectSum,
    /// Estimated error of the basis.
    pub error: Errors,
    /// Contact force on the basis, and its time steps in modal coordinates.
    pub force: (Trace, Option<Steps>),
    /// The reduced body in modal coordinates, if the last force was computed in them.
    pub modal: Option<ModalBody>,
    /// The same on the other basis. It is kept for viscoelastic bodies.
    pub modal_of_judge: Option<ModalBody>,
    /// Forces in the time steps that error control tried ([`ModalImpact::with_known`]).
    ///
    /// [`ModalImpact::with_known`]: crate::impact::ModalImpact::with_known
    pub known: Vec<KnownForce>,
}

/// A basis that was tried.
struct Tried {
    vectors: usize,
    /// The force; modal coordinates are kept for viscoelastic bodies only, whose modes are costly.
    trial: Trial,
}

impl Reduced {
    /// Numbers of vectors of the smaller and of the larger basis.
    pub fn counts(&self) -> [usize; 2] {
        let (one, other) = (self.projection.vectors(), self.judge.vectors());
        [one.min(other), one.max(other)]
    }

    /// The body reduced to the larger basis.
    pub fn larger(&self) -> &Projection {
        if self.judge.vectors() > self.projection.vectors() { &self.judge } else { &self.projection }
    }

    /// The body on the larger basis in modal coordinates, with the modes computed before if there are any.
    pub fn take_larger_modal(&mut self) -> ModalBody {
        let is_judge = self.judge.vectors() > self.projection.vectors();
        let known = if is_judge { self.modal_of_judge.take() } else { self.modal.take() };
        known.unwrap_or_else(|| ModalBody::of(self.larger()))
    }
}

/// Reduces a body to a basis that the scene's impact needs. A given number of vectors is compared with a larger basis.
/// Otherwise as many vectors are made as the tolerance needs, in comparison with smaller bases.
/// Collective.
///
/// # Errors
/// [`crate::Error::Solve`] if the impact cannot be solved on any basis; or if a PETSc call fails.
pub fn reduce(context: &ModelContext, body: &dyn LinearBody, scene: &Scene) -> Result<Reduced> {
    reduce_from(context, body, scene, None)
}

/// [`reduce`] with an initial guess for an automatic basis: the numbers of vectors of the smaller and the larger basis
/// that were enough for a similar body. Collective.
///
/// # Errors
/// Same as [`reduce`].
pub fn reduce_from(
    context: &ModelContext,
    body: &dyn LinearBody,
    scene: &Scene,
    served: Option<[usize; 2]>,
) -> Result<Reduced> {
    let watch = context.watch;
    watch.at(Stage::Factor)?;
    let Plan { start, vectors: first } = Plan::new(context, body, scene);
    let mut krylov = DirectSum::new(body, start)?;
    let given = match scene.body.reduction {
        Reduction::Vectors(vectors) => Some(vectors),
        _ => None,
    };
    // After a number of vectors comes its larger basis, and then as many vectors as the error requires.
    let served = served.filter(|_| given.is_none());
    let first = served.map_or(first, |[smaller, _]| smaller);
    let second = served.map_or(larger(first), |[_, more]| more.max(larger(first)));
    let mut count = given.unwrap_or(first);
    let mut tried: Vec<Tried> = Vec::new();
    let mut trials = Trials::new(context, scene);
    let relaxes = !body.chains().is_empty();
    let factors = ErrorFactors::of(body, start);
    let is_smaller_used = !(start.leaves_short_waves || relaxes);
    let order = if start.leaves_short_waves { ORDER } else { ORDER_OF_ALL_WAVES };
    let mut last: Option<Judged> = None;
    // Number of vectors of the last smaller basis that was compared and not accurate enough, if the smaller one would
    // have been used.
    let mut failed: Option<usize> = None;
    loop {
        grow(&mut krylov, body, count, last, watch)?;
        tracing::debug!(count, "basis tried");
        let projection = krylov.projection(body)?;
        count = projection.vectors();
        let enough = count > MAX_VECTORS_PER_CLASS * body.classes().len() || (given.is_some() && !tried.is_empty());
        let is_exhausted = watch.decided(krylov.is_exhausted());
        let trial = trials.force(&projection);
        // Without a contact all bases have the same force, zero. It does not show how well they represent the motion
        // under the loads, so that there is nothing to compare.
        let is_untouched =
            trial.as_ref().is_ok_and(|trial| watch.decided(is_moved_by_loads(&projection, &trial.force)));
        if is_untouched && given.is_none() && count < VECTORS_WITHOUT_CONTACT && !is_exhausted {
            count = VECTORS_WITHOUT_CONTACT;
            continue;
        }
        match trial {
            // The basis spans all motions that the forces excite, up to rounding.
            Ok(mut trial) if is_untouched || is_exhausted && (given.is_none() || tried.is_empty()) => {
                trials.shorten_steps(&projection, &mut trial)?;
                let Trial { force, steps, modal, known } = trial;
                return Ok(Reduced {
                    judge: projection.clone(),
                    projection,
                    force_of_judge: force.clone(),
                    rule: ErrorRule::default(),
                    difference: Errors::default(),
                    krylov,
                    error: Errors::default(),
                    force: (force, steps),
                    modal,
                    modal_of_judge: None,
                    known,
                });
            }
            Ok(mut trial) => {
                let may_judge = |tried: &Tried| larger(tried.vectors) <= count;
                let judged = (0..tried.len()).filter(|at| may_judge(&tried[*at])).max_by_key(|at| tried[*at].vectors);
                // A basis that was not accurate enough is not compared again. One with as many vectors as its error
                // requires takes its place.
                let most = smaller_of(count);
                let wanted = failed.filter(|failed| *failed < most).map(|failed| {
                    let least = ((BASIS_GROWTH * failed as f64).ceil() as usize).min(most);
                    last.map_or(most, |last| vectors_needed(last, order).clamp(least, most))
                });
                let judged = match (judged, wanted) {
                    (Some(at), Some(wanted)) if wanted > tried[at].vectors => {
                        match trials.force(&projection.leading(wanted)) {
                            Ok(trial) => tried.push(Tried { vectors: wanted, trial }),
                            Err(error @ (Error::Alone(_) | Error::Interrupted)) => return Err(error),
                            Err(_) => {}
                        }
                        tried.iter().position(|tried| tried.vectors == wanted)
                    }
                    (judged, _) => judged,
                };
                if let Some(judge) = judged.or(tried.len().checked_sub(1).filter(|_| enough)) {
                    let Tried { vectors: smaller, trial: judge } = &mut tried[judge];
                    failed = is_smaller_used.then_some(*smaller);
                    let plate = projection.terms.infinite_plate.clone();
                    let plate = plate.as_ref();
                    let unknowns = body.unknowns();
                    let rule =
                        Rule { context, scene, start, unknowns, vectors: count, smaller: *smaller, factors, plate };
                    let judgement = match rule.judge_on(&projection, [judge, &mut trial], &mut trials, enough) {
                        Err(error @ (Error::Alone(_) | Error::Interrupted)) => return Err(error),
                        Err(error) if enough => return Err(error),
                        // In the larger basis' time steps the smaller basis may be too soft or too stiff for the
                        // contact law.
                        judgement => judgement.ok(),
                    };
                    last = judgement.as_ref().map(|judgement| judgement.judged).or(last);
                    if let Some(judgement) = judgement.filter(|judgement| enough || judgement.is_met) {
                        let mut error = rule.closer(judgement.error, &projection, &trial, &trials)?;
                        // Two bases that both lack the rotations of a free body agree and are wrong.
                        if !context.limits_deflection_error && may_lack_rotations(scene) {
                            error.deflection = f64::NAN;
                        }
                        tracing::info!(
                            vectors = count,
                            smaller = *smaller,
                            first = error.first_contact,
                            all = error.history,
                            "reduced"
                        );
                        let mut pair = [(projection.leading(*smaller), std::mem::take(judge)), (projection, trial)];
                        if !judgement.takes_smaller {
                            pair.reverse();
                        }
                        let [(projection, trial), (judge, of_judge)] = pair;
                        let Trial { force, steps, modal, known } = trial;
                        return Ok(Reduced {
                            projection,
                            judge,
                            force_of_judge: of_judge.force,
                            rule: judgement.rule,
                            difference: judgement.difference,
                            krylov,
                            error,
                            force: (force, steps),
                            modal,
                            modal_of_judge: of_judge.modal.filter(|_| relaxes),
                            known,
                        });
                    }
                }
                trial.modal = trial.modal.filter(|_| relaxes);
                tried.push(Tried { vectors: count, trial });
            }
            Err(error @ Error::Alone(_)) => return Err(error),
            Err(error) if enough || is_exhausted => return Err(error),
            // A basis that is too small may be too soft or too stiff for the contact law.
            Err(_) => {}
        }
        count = match last {
            _ if given.is_some() => larger(count),
            _ if tried.len() < 2 && count <= first => second,
            Some(judged) => next_count(judged, (count, is_smaller_used), order),
            None => (BASIS_GROWTH * count as f64).ceil() as usize,
        };
    }
}

/// Whether loads move a body and the impactor does not touch it, so that the contact force says nothing of the motion.
pub(super) fn is_moved_by_loads(projection: &Projection, force: &Trace) -> bool {
    projection.is_loaded() && !force.has_contact()
}

/// Number of vectors with the wanted error, if the error falls with the number of vectors to the power `order`.
fn vectors_needed(Judged { vectors, error, wanted }: Judged, order: f64) -> usize {
    // The bound keeps the number finite.
    (vectors as f64 * (error / wanted).powf(1.0 / order).min(MOST_PREDICTED_GROWTH)).ceil() as usize
}

/// Number of vectors of the next basis after one of `count` vectors. If the smaller of two bases is used, it must be
/// accurate enough.
fn next_count(judged: Judged, (count, is_smaller_used): (usize, bool), order: f64) -> usize {
    let needed = vectors_needed(judged, order);
    let next = if is_smaller_used { larger(needed) } else { needed };
    let least = (BASIS_GROWTH * count as f64).ceil() as usize;
    let may_double = is_smaller_used && (MANY_VECTORS..LONG_BASIS).contains(&count);
    let most = if may_double { (LARGEST_BASIS_GROWTH * count as f64) as usize } else { larger(count) };
    next.clamp(least, most.max(least))
}

/// Initial settings of a basis.
pub(super) struct Plan {
    /// Shift, duration of the run and kind of the vectors.
    pub start: Start,
    /// Number of vectors of the first basis that is tried.
    pub(super) vectors: usize,
}

impl Plan {
    /// The plan for a scene's body: by the rule of thumb; or by the number of modes that take part, if a plate's
    /// contact excites many.
    pub(super) fn new(context: &ModelContext, body: &dyn LinearBody, scene: &Scene) -> Self {
        // A basis must not depend on the end time of a run that may be continued.
        let end = if scene.time.modal { scene.time.end } else { f64::INFINITY };
        let in_blocks = scene.tolerance >= LEAST_TOLERANCE_OF_BLOCKS;
        let may_be_long = body.unknowns() >= LEAST_UNKNOWNS_OF_LANCZOS_BLOCKS;
        let short = Self {
            start: Start {
                rate: rate(scene),
                end,
                in_blocks: in_blocks && may_be_long,
                ..Start::from(shift(scene, context.limits_deflection_error))
            },
            vectors: FIRST_VECTORS,
        };
        let plate = body.infinite_plate().filter(|_| !body.is_on_foundations());
        let most = MAX_VECTORS_PER_CLASS * body.classes().len();
        let Some(LongWaves { frequency, vectors }) = plate.and_then(|plate| LongWaves::of(scene, plate, most)) else {
            return short;
        };
        let shift = SHIFT_OVER_CUTOFF * frequency;
        let start = Start { end, leaves_short_waves: true, in_blocks, ..Start::from(shift) };
        let vectors = vectors_over_one_shift(rates(&body.chains(), start.shift, end).len()) * vectors as f64;
        // The first basis is the smaller one in the comparison with the second, if there are two.
        Self { start, vectors: (vectors / 1.5).ceil() as usize }
    }
}

/// Grows a basis to a number of vectors; the watch may interrupt it. Collective.
pub(super) fn grow(
    krylov: &mut DirectSum,
    body: &dyn LinearBody,
    vectors: usize,
    judged: Option<Judged>,
    watch: &dyn Watch,
) -> Result<()> {
    // For a mesh each vector takes long; for a small body vectors are made in blocks.
    let at_once = if body.is_meshed() { 1 } else { VECTORS_PER_CHECK * body.classes().len() };
    while watch.decided(krylov.vectors() < vectors && !krylov.is_exhausted()) {
        watch.at(Stage::Basis { vectors: krylov.vectors(), judged })?;
        krylov.grow(body, vectors.min(krylov.vectors() + at_once))?;
    }
    watch.at(Stage::Trial)
}

/// Largest number of vectors of a basis that may be compared with one of `vectors`.
fn smaller_of(vectors: usize) -> usize {
    (2 * vectors / 3).min(vectors.saturating_sub(LEAST_MORE))
}

/// Number of vectors of the basis with which one of n `vectors` is compared: the larger of 1.5 n and n + 9.
pub(super) fn larger(vectors: usize) -> usize {
    vectors + vectors.div_ceil(2).max(LEAST_MORE)
}

/// Rate of the scene's impact, 1/s: 15 over the contact time on a half-space, at a tolerance of 1e-2. It is the shift of a
/// basis for the contact force.
pub fn rate(scene: &Scene) -> f64 {
    SHIFT_TIMES_CONTACT * (1e-2 / scene.tolerance).cbrt() / contact_time(&scene.impactor)
}

/// Duration of the contact with a fixed half-space (s), halved as often as the contact with a stack of layers requires. (On a
/// thin coat it may be a fifth.)
fn contact_time(impactor: &Impactor) -> f64 {
    let time = impactor.contact_time();
    let of_law = |law: &ForceLaw| law.contact_time(impactor.timing_mass, impactor.contact_speed());
    let of_layers = impactor.layered_contact().map_or(time, |layered| of_law(&layered.force_law));
    time * (of_layers / time).log2().floor().clamp(-10.0, 0.0).exp2()
}

/// Shift s of the basis for the scene's impact, 1/s, if short waves are not treated separately. It is low, for slow vibrations
/// after a contact, if the error of the deflection is limited.
pub fn shift(scene: &Scene, limits_deflection_error: bool) -> f64 {
    let is_low = limits_deflection_error || scene.measure == Measure::Deflection;
    if is_low { LOW_SHIFT_OVER_RATE * rate(scene) } else { rate(scene) }
}

/// Whether the basis may lack rotations of the body, so that the error of the deflection is unknown. The impact makes
/// the body rotate, nothing holds it, and the basis is made for the acceleration or the stresses alone.
pub fn may_lack_rotations(scene: &Scene) -> bool {
    let is_central = scene
        .struck_axis()
        .is_some_and(|struck| (0..3).filter(|axis| *axis != struck).all(|axis| scene.impactor.point[axis] == 0.0));
    scene.supports.is_empty() && !is_central && scene.measure != Measure::Deflection
}
