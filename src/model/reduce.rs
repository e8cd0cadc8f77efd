//! A basis as large as a scene needs, with its error.

use petsc_wrap::Comm;

use crate::body::{DirectSum, LinearBody, ModalBody, OF_CUTOFF, Projection, Start};
use crate::error::{Error, Result};
use crate::impact::{Errors, Steps, Trace};
use crate::scene::{Reduction, Scene};

use super::long_waves::{LongWaves, ORDER};
use super::trials::{Trial, Trials};
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
    /// With its modal coordinates where the body relaxes alone: their modes take long.
    trial: Trial,
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
    let mut tried: Vec<Tried> = Vec::new();
    let mut trials = Trials::new(comm, scene, watch);
    let relaxes = !body.chains().is_empty();
    let mut last: Option<Judged> = None;
    loop {
        grow(&mut krylov, body, count, last, watch)?;
        let projection = krylov.projection(body)?;
        count = projection.vectors();
        let enough = count > MOST * body.classes().len() || (given.is_some() && !tried.is_empty());
        let is_exhausted = watch.decided(krylov.is_exhausted());
        match trials.force(&projection) {
            // All that the forces reach, to rounding.
            Ok(trial) if is_exhausted && (given.is_none() || tried.is_empty()) => {
                let Trial { force, steps, modal } = trials.in_shorter_steps(&projection)?.unwrap_or(trial);
                return Ok(Reduced {
                    judge: projection.clone(),
                    projection,
                    force_of_judge: force.clone(),
                    of_difference: 0.0,
                    difference: Errors::default(),
                    krylov,
                    error: Errors::default(),
                    force: (force, steps),
                    modal,
                    modal_of_judge: None,
                });
            }
            Ok(mut trial) => {
                let judged = tried.iter().rposition(|smaller| larger(smaller.vectors) <= count);
                if let Some(judge) = judged.or(tried.len().checked_sub(1).filter(|_| enough)) {
                    let Tried { vectors: smaller, trial: judge } = &mut tried[judge];
                    let rule = Rule { scene, watch, start, vectors: count, smaller: *smaller, relaxes };
                    let judgement = match rule.judge_on(&projection, [judge, &mut trial], &mut trials, enough) {
                        Err(error @ (Error::Alone(_) | Error::Interrupted)) => return Err(error),
                        Err(error) if enough => return Err(error),
                        // The smaller one may be too soft, or too stiff, for the contact law in the larger one's steps.
                        judgement => judgement.ok(),
                    };
                    last = judgement.as_ref().map(|judgement| judgement.judged).or(last);
                    if let Some(judgement) = judgement.filter(|judgement| enough || judgement.is_met) {
                        let error = rule.closer(judgement.error, &projection, &trial, &trials)?;
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
                        let [(projection, Trial { force, steps, modal }), (judge, of_judge)] = pair;
                        return Ok(Reduced {
                            projection,
                            judge,
                            force_of_judge: of_judge.force,
                            of_difference: judgement.of_difference,
                            difference: judgement.difference,
                            krylov,
                            error,
                            force: (force, steps),
                            modal,
                            modal_of_judge: of_judge.modal.filter(|_| relaxes),
                        });
                    }
                }
                trial.modal = trial.modal.filter(|_| relaxes);
                tried.push(Tried { vectors: count, trial });
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

/// By what a basis is judged.
struct Rule<'a> {
    scene: &'a Scene,
    watch: &'a dyn Watch,
    start: Start,
    /// Of the basis, and of a smaller one.
    vectors: usize,
    smaller: usize,
    relaxes: bool,
}

/// What is found of a basis.
struct Judgement {
    /// Of the forces on the two.
    difference: Errors,
    /// Error over the difference.
    of_difference: f64,
    error: Errors,
    /// Whether the error is within its part of the tolerance.
    is_met: bool,
    /// Whether the smaller one is the one that serves.
    takes_smaller: bool,
    judged: Judged,
}

impl Rule<'_> {
    /// From the forces on the smaller basis and on the larger one, a projection. Where the larger one would serve, or is the last, both are those in its steps, and
    /// in shorter ones if it needs them. Collective.
    ///
    /// # Errors
    /// Those of [`Trials::force`].
    fn judge_on(
        &self,
        projection: &Projection,
        [judge, trial]: [&mut Trial; 2],
        trials: &mut Trials,
        is_last: bool,
    ) -> Result<Judgement> {
        let judgement = self.judge(judge.force.difference(&trial.force));
        if !(is_last || judgement.is_met) {
            return Ok(judgement);
        }
        if let Some(own) = trials.in_shorter_steps(projection)? {
            *trial = own;
        }
        if !self.watch.decided(judge.steps != trial.steps) {
            return Ok(judgement);
        }
        *judge = trials.force_in(trial.steps, &projection.leading(self.smaller))?;
        Ok(self.judge(judge.force.difference(&trial.force)))
    }

    /// From the difference of the forces on the two. Collective.
    fn judge(&self, difference: Errors) -> Judgement {
        let Self { scene, watch, start, vectors, smaller, relaxes } = *self;
        let wanted = OF_BASIS * scene.tolerance;
        let is_given = matches!(scene.body.reduction, Reduction::Vectors(_));
        // A body that relaxes moves on the smaller one, at half the cost, where that serves.
        let is_small_enough = relaxes && watch.decided(OF_SMALLER_RELAXING * difference.of(scene.measure) <= wanted);
        let of_difference = match is_given {
            _ if is_small_enough => OF_SMALLER_RELAXING,
            true => OF_SMALLER,
            _ if start.leaves_short_waves => of_larger(vectors, smaller),
            _ if relaxes => OF_RELAXING,
            _ => OF_LARGER,
        };
        let error = of_difference * difference;
        let over = watch.agreed(error.of(scene.measure) / wanted);
        let judged = Judged { vectors, error: over * wanted, wanted };
        let takes_smaller = is_given || is_small_enough;
        Judgement { difference, of_difference, error, is_met: over <= 1.0, takes_smaller, judged }
    }

    /// The error of the larger basis by a nearer one, where that tells more than the smaller one. Collective.
    ///
    /// # Errors
    /// PETSc's.
    fn closer(&self, mut error: Errors, projection: &Projection, trial: &Trial, trials: &Trials) -> Result<Errors> {
        let Self { scene, watch, start, vectors, smaller, relaxes } = *self;
        let leading = |part: f64| projection.leading((part * vectors as f64) as usize);
        if start.leaves_short_waves {
            if watch.decided(error.history > OTHER_CONTACTS * of_larger(vectors, smaller)) {
                let near = leading(NEARER);
                let force = trials.force_in(trial.steps, &near)?.force;
                error.history = of_larger(vectors, near.vectors()) * force.difference(&trial.force).history;
            }
        } else if scene.body.reduction == Reduction::Auto && !relaxes && scene.time.modal {
            match trials.force_in(trial.steps, &leading(LAST)) {
                Ok(near) => error = error.min(OF_LAST * near.force.difference(&trial.force)),
                Err(error @ (Error::Alone(_) | Error::Interrupted)) => return Err(error),
                // It may be too soft, or too stiff, for the contact law: then it tells nothing.
                Err(_) => {}
            }
        }
        Ok(error)
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

/// The rate at which the scene's impact excites a body, 1/s.
pub fn rate(scene: &Scene) -> f64 {
    let impactor = &scene.impactor;
    RATE * (1e-2 / scene.tolerance).cbrt() / impactor.contact_time()
}
