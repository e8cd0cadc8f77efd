//! A basis as large as a scene needs, with its error.

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::body::{Body, DirectSum, LinearBody, ModalBody, OF_CUTOFF, Projection, Start};
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{Errors, ModalImpact, Reading, SteppedImpact, Steps, Trace, Until};
use crate::scene::{Reduction, Scene};

use super::long_waves::{LongWaves, ORDER};
use super::watch::{Judged, Stage, Watch};

/// Vectors of the first basis that is tried.
const FIRST: usize = 10;

/// Most vectors of a basis that grows by itself, for each class of motions.
pub(super) const MOST: usize = 1500;

/// Two bases, one of half as many vectors more, judge each other by the difference between them. Where errors fall with the square of the
/// number, that of the smaller one is (1 − 1.5⁻²)⁻¹ = 1.8 of it, and where they fall slower at times, more.
pub const OF_SMALLER: f64 = 2.2;

/// That of the larger one. Errors fall faster than with the square, which would give 0.8: of thirty plates and solids it was measured to be
/// 0.13 to 0.56; an estimate.
const OF_LARGER: f64 = 0.65;

/// The first vectors of the larger basis, over all of them, by which its error is estimated too where it grows by itself: such a nearer basis shows
/// how fast errors fall at last, which the first two do not tell. And that error over the difference: 0.1 to 1.1 was measured of sixty plates and solids.
const LAST: f64 = 0.8;
const OF_LAST: f64 = 1.5;

/// The same of a body that relaxes, whose creep is found more slowly: 0.2 to 1.15 was measured of laminates.
const OF_RELAXING: f64 = 1.5;

/// That of the smaller one of such a body: it is off by the difference and by what the larger one is off.
pub(super) const OF_SMALLER_RELAXING: f64 = 1.0 + OF_RELAXING;

/// Part of the tolerance that the estimate may take.
pub const OF_BASIS: f64 = 0.5;

/// Vectors of a long basis.
const LONG: usize = 256;

/// Vectors of a basis over those of the one before.
const GROWTH: f64 = 1.225;

/// The rate s at which a basis is made, times the contact time on a half-space, for a tolerance of 1e-2. From 5 to 50 bases are much alike;
/// what is left for small tolerances is of higher frequencies.
const RATE: f64 = 15.0;

/// Differences of histories over the peak from which on they are no measure of errors: a contact of one is none of the other.
const OTHER_CONTACTS: f64 = 0.3;

/// Vectors of a nearer basis by which the whole history is judged then, over those of the basis.
const NEARER: f64 = 0.875;

/// The tolerance from which on long bases are made in blocks. Below it the rounding that blocks leave counts: for 1e-4 a pane took 363 vectors
/// in the place of 296.
const IN_BLOCKS: f64 = 1e-3;

/// Vectors of a small body between two questions whether to go on, for each class of motions.
const AT_ONCE: usize = 32;

/// A body on a basis.
pub struct Reduced {
    /// The body.
    pub projection: Projection,
    /// The body on the other basis, by which the error was estimated.
    pub judge: Projection,
    /// The contact force on that basis, in the same steps.
    pub force_of_judge: Trace,
    /// Error over the difference of the two.
    pub of_difference: f64,
    /// That difference.
    pub difference: Errors,
    /// The vectors of the larger one.
    pub krylov: DirectSum,
    /// Its estimated error.
    pub error: Errors,
    /// The force on the basis, and its steps in modal coordinates.
    pub force: (Trace, Option<Steps>),
    /// The body in modal coordinates, where the force was last computed in them.
    pub modal: Option<ModalBody>,
    /// The same on the other basis, of a body that relaxes, whose modes take long.
    pub modal_of_judge: Option<ModalBody>,
}

/// A basis that was tried.
struct Tried {
    vectors: usize,
    force: Trace,
    /// As [`Reduced::modal_of_judge`].
    modal: Option<ModalBody>,
}

impl Reduced {
    /// Vectors of the smaller and of the larger basis.
    pub fn counts(&self) -> [usize; 2] {
        let (one, other) = (self.projection.vectors(), self.judge.vectors());
        [one.min(other), one.max(other)]
    }

    /// The body on the larger basis.
    pub fn larger(&self) -> &Projection {
        [&self.projection, &self.judge].into_iter().max_by_key(|projection| projection.vectors()).unwrap_or(&self.judge)
    }

    /// That one in modal coordinates, with the modes that were found, where it moved in these.
    pub fn take_larger_modal(&mut self) -> ModalBody {
        let is_judge = self.judge.vectors() > self.projection.vectors();
        let known = if is_judge { self.modal_of_judge.take() } else { self.modal.take() };
        known.unwrap_or_else(|| ModalBody::of(self.larger()))
    }
}

/// Reduces a body to what the scene's impact needs: a given number of vectors, judged by half as many more, or as many as the tolerance
/// asks for, judged by fewer. Collective.
///
/// # Errors
/// [`crate::Error::Solve`] where the impact is not solved on any basis; PETSc's.
pub fn reduce(comm: &Comm, body: &dyn LinearBody, scene: &Scene, watch: &dyn Watch) -> Result<Reduced> {
    reduce_from(comm, body, scene, None, watch)
}

/// [`reduce`], where a basis that grows begins with numbers of vectors that served for a like body: of the smaller and the larger one.
/// Collective.
///
/// # Errors
/// As [`reduce`].
pub fn reduce_from(
    comm: &Comm,
    body: &dyn LinearBody,
    scene: &Scene,
    served: Option<[usize; 2]>,
    watch: &dyn Watch,
) -> Result<Reduced> {
    watch.at(Stage::Factor)?;
    let Plan { start, first } = Plan::new(body, scene);
    let mut krylov = DirectSum::new(body, start)?;
    let given = match scene.body.reduction {
        Reduction::Vectors(vectors) => Some(vectors),
        _ => None,
    };
    // A given number, then half as many more; else in steps of √1.5, each basis judged by the one before the last.
    let served = served.filter(|_| given.is_none());
    let first = served.map_or(first, |[smaller, _]| smaller);
    let second = served.map_or(larger(first), |[_, more]| more.max(larger(first)));
    let mut count = given.unwrap_or(first);
    // The bases so far, their force, and the steps that all are compared in.
    let mut tried: Vec<Tried> = Vec::new();
    let relaxes = !body.chains().is_empty();
    let mut steps = None;
    let mut last: Option<Judged> = None;
    loop {
        grow(&mut krylov, body, count, last, watch)?;
        let projection = krylov.projection(body)?;
        count = projection.vectors();
        let enough = count > MOST * body.classes().len() || (given.is_some() && !tried.is_empty());
        let is_exhausted = watch.decided(krylov.is_exhausted());
        match shared_force(comm, scene, &projection, &mut steps, watch) {
            // All that the forces reach, to rounding.
            Ok((trace, modal)) if is_exhausted && (given.is_none() || tried.is_empty()) => {
                let (judge, force_of_judge) = (projection.clone(), trace.clone());
                let (of_difference, error, force) = (0.0, Errors::default(), (trace, steps));
                return Ok(Reduced {
                    projection,
                    judge,
                    force_of_judge,
                    of_difference,
                    difference: Errors::default(),
                    krylov,
                    error,
                    force,
                    modal,
                    modal_of_judge: None,
                });
            }
            Ok((trace, modal)) => {
                let judged = tried.iter().rposition(|smaller| larger(smaller.vectors) <= count);
                if let Some(judge) = judged.or(tried.len().checked_sub(1).filter(|_| enough)) {
                    let Tried { vectors: smaller, force: before, modal: modal_of_smaller } = &mut tried[judge];
                    let difference = before.difference(&trace);
                    let wanted = OF_BASIS * scene.tolerance;
                    // A body that relaxes moves on the smaller one, at half the cost, where that serves.
                    let is_small_enough =
                        relaxes && watch.decided(OF_SMALLER_RELAXING * difference.of(scene.measure) <= wanted);
                    let takes_smaller = given.is_some() || is_small_enough;
                    let of_difference = match given {
                        _ if is_small_enough => OF_SMALLER_RELAXING,
                        Some(_) => OF_SMALLER,
                        _ if start.leaves_short_waves => of_larger(count, *smaller),
                        _ if relaxes => OF_RELAXING,
                        _ => OF_LARGER,
                    };
                    let mut error = of_difference * difference;
                    let over = watch.agreed(error.of(scene.measure) / wanted);
                    last = Some(Judged { vectors: count, error: over * wanted, wanted });
                    if enough || over <= 1.0 {
                        if start.leaves_short_waves && watch.decided(error.history > OTHER_CONTACTS * of_difference) {
                            let nearer = (NEARER * count as f64) as usize;
                            let (near, _) = shared_force(comm, scene, &projection.leading(nearer), &mut steps, watch)?;
                            error.history = of_larger(count, nearer) * near.difference(&trace).history;
                        }
                        if given.is_none() && !relaxes && !start.leaves_short_waves && scene.time.modal {
                            let nearer = projection.leading((LAST * count as f64) as usize);
                            match shared_force(comm, scene, &nearer, &mut steps, watch) {
                                Ok((near, _)) => error = error.min(OF_LAST * near.difference(&trace)),
                                Err(error @ (Error::Alone(_) | Error::Interrupted)) => return Err(error),
                                // It may be too soft, or too stiff, for the contact law: then it tells nothing.
                                Err(_) => {}
                            }
                        }
                        tracing::info!(
                            vectors = count,
                            smaller = *smaller,
                            first = error.first_contact,
                            all = error.history,
                            "reduced"
                        );
                        let smaller = (projection.leading(*smaller), before.clone(), modal_of_smaller.take());
                        let mut pair = [smaller, (projection, trace, modal)];
                        if !takes_smaller {
                            pair.reverse();
                        }
                        let [(projection, trace, modal), (judge, force_of_judge, modal_of_judge)] = pair;
                        let (force, modal_of_judge) = ((trace, steps), modal_of_judge.filter(|_| relaxes));
                        return Ok(Reduced {
                            projection,
                            judge,
                            force_of_judge,
                            of_difference,
                            difference,
                            krylov,
                            error,
                            force,
                            modal,
                            modal_of_judge,
                        });
                    }
                }
                tried.push(Tried { vectors: count, force: trace, modal: modal.filter(|_| relaxes) });
            }
            Err(error @ Error::Alone(_)) => return Err(error),
            Err(error) if enough || is_exhausted => return Err(error),
            // A basis that is too small may be too soft, or too stiff, for the contact law.
            Err(_) => {}
        }
        count = match last {
            _ if given.is_some() => larger(count),
            _ if tried.len() < 2 && count <= first => second,
            // A long basis is dear: it grows by as much as its error asks for, which falls with the square of the number.
            Some(Judged { error, wanted, .. }) if count >= LONG => {
                let order = if start.leaves_short_waves { ORDER } else { 2.0 };
                let needed = count as f64 * (error / wanted).powf(1.0 / order);
                (needed.ceil() as usize).clamp((GROWTH * count as f64).ceil() as usize, larger(count))
            }
            _ => (GROWTH * count as f64).ceil() as usize,
        };
    }
}

/// How a basis begins.
pub(super) struct Plan {
    /// Of its vectors.
    pub start: Start,
    /// How many the first one has that is tried.
    first: usize,
}

impl Plan {
    /// That of a scene's body: by the rule of thumb, or, where a plate's contact has many modes, by the number of these.
    pub(super) fn new(body: &dyn LinearBody, scene: &Scene) -> Self {
        // (Another end of a run that goes on must not ask for another basis.)
        let end = if scene.time.modal { scene.time.end } else { f64::INFINITY };
        let short = Self { start: Start { end, ..Start::from(rate(scene)) }, first: FIRST };
        // (What relaxes knows no waves that go off either.)
        let is_bound = body.is_on_foundations() || !body.chains().is_empty();
        let plate = body.infinite_plate().filter(|_| !is_bound);
        let most = MOST * body.classes().len();
        let Some(LongWaves { frequency, vectors }) = plate.and_then(|plate| LongWaves::of(scene, plate, most)) else {
            return short;
        };
        // The first one judges the second.
        let in_blocks = scene.tolerance >= IN_BLOCKS;
        let start = Start { shift: OF_CUTOFF * frequency, end, leaves_short_waves: true, in_blocks };
        Self { start, first: (vectors as f64 / 1.5).ceil() as usize }
    }
}

/// Grows a basis to a number of vectors before somebody who may break it off. Collective.
pub(super) fn grow(
    krylov: &mut DirectSum,
    body: &dyn LinearBody,
    vectors: usize,
    judged: Option<Judged>,
    watch: &dyn Watch,
) -> Result<()> {
    // Vectors of a mesh take long each, those of a small body come in blocks.
    let at_once = if body.is_meshed() { 1 } else { AT_ONCE * body.classes().len() };
    while watch.decided(krylov.vectors() < vectors && !krylov.is_exhausted()) {
        watch.at(Stage::Basis { vectors: krylov.vectors(), judged })?;
        krylov.grow(body, vectors.min(krylov.vectors() + at_once))?;
    }
    watch.at(Stage::Trial)
}

/// Error of the larger of two bases over their difference, where short waves are kept apart.
fn of_larger(vectors: usize, smaller: usize) -> f64 {
    ((vectors as f64 / smaller as f64).powf(ORDER) - 1.0).recip()
}

/// Half as many vectors more.
pub(super) fn larger(vectors: usize) -> usize {
    vectors + vectors.div_ceil(2)
}

/// The force on a basis, by the scene's own scheme, whose steps pass the body's vibrations differently; in modal coordinates by the same
/// steps on each basis, with the body in these.
fn force(
    comm: &Comm,
    scene: &Scene,
    projection: &Projection,
    steps: &mut Option<Steps>,
    watch: &dyn Watch,
) -> Result<(Trace, Option<ModalBody>)> {
    let take = |_: &Step, _: &Reading| {};
    if scene.time.modal {
        let body = ModalBody::of(projection);
        let mut impact = ModalImpact::new(scene, &body).without_energies();
        let (trace, taken) =
            impact.trace_watched(*steps, &mut Until { interrupted: &|| watch.is_raised_here(), take })?;
        *steps = Some(taken);
        drop(impact);
        return Ok((trace, Some(body)));
    }
    let mut trace = Trace::default();
    let mut last: Option<(f64, f64)> = None;
    let reduced = Body::of(&comm.session().alone(), &projection.system())?;
    let _ = SteppedImpact::new(scene, reduced)?.run(|step| {
        let (time, force) = (step.time, step.contact.force);
        if let Some((before, was)) = last.replace((time, force)) {
            trace.push(before, time - before, [was, 0.5 * (was + force), force]);
        }
        Ok(if watch.is_raised_here() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok((trace, None))
}

/// [`force`] as the first rank has it, with this rank's body, before somebody who may break it off. Collective.
pub(super) fn shared_force(
    comm: &Comm,
    scene: &Scene,
    projection: &Projection,
    steps: &mut Option<Steps>,
    watch: &dyn Watch,
) -> Result<(Trace, Option<ModalBody>)> {
    let mut modal = None;
    let trace = force(comm, scene, projection, steps, watch).map(|(trace, body)| {
        modal = body;
        trace
    });
    let trace = watch.shared(trace);
    // A rank that has broken off has a part of the force: all of them end here.
    watch.at(Stage::Trial)?;
    Ok((trace?, modal))
}

/// The rate at which the scene's impact excites a body, 1/s.
pub fn rate(scene: &Scene) -> f64 {
    let impactor = &scene.impactor;
    RATE * (1e-2 / scene.tolerance).cbrt() / impactor.contact_time()
}
