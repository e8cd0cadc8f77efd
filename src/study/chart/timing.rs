//! Times one setting and records its result.

use std::rc::Rc;
use std::time::Instant;

use mpi::traits::Communicator;
use mpi::traits::{CommunicatorCollectives, Root};
use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{self, Reading};
use crate::model::watch::Until;
use crate::model::{self, Model, ModelContext, Simulation};
use crate::scene::Scene;
use crate::space::evaluate::FaceTension;
use crate::study::history::{History, Recorder};

/// Number of repetitions that are enough if they have taken longer than [`ENOUGH_SECONDS`] in all.
const ENOUGH_REPETITIONS: usize = 5;

/// Total time of [`ENOUGH_REPETITIONS`] that is long enough to time them, s.
const ENOUGH_SECONDS: f64 = 0.3;

/// Total time after which no further repetition is made, s.
const MOST_SECONDS: f64 = 3.0;

/// Timing and result of a setting.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Timed {
    /// Median wall time before the first step, s.
    pub build: f64,
    /// Median wall time of the steps, s.
    pub run: f64,
    /// Wall time of all repetitions, s.
    pub spent: f64,
    /// Name of the theory that was used.
    pub model: String,
    /// Description of the reduction: number of Krylov vectors, or none.
    pub reduction: String,
    /// Number of unknowns of the theory, including the impactor's.
    pub unknowns: usize,
    /// Number of steps or of solves.
    pub solves: usize,
    /// Number of Newton iterations.
    pub iterations: usize,
    /// Estimated error of the whole history, over the peak; NaN if there is no estimate.
    pub estimate: f64,
    /// Time history of the acceleration. If it was read from a file, it is empty on all ranks except the first.
    #[serde(skip)]
    pub history: History,
}

/// The steps of a run, with the readings at each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Names of the faces whose largest tension is read; only on rank 0.
    pub faces: Vec<String>,
    /// Steps in ascending order of time.
    pub steps: Vec<Step>,
    /// Readings at each step.
    pub readings: Vec<Reading>,
}

impl Recording {
    /// The time history.
    fn history(&self) -> History {
        let mut recorder = Recorder::default();
        self.steps.iter().for_each(|step| recorder.push(step));
        let largest = |faces: &[FaceTension]| faces.iter().fold(f64::NAN, |largest, face| largest.max(face.largest));
        let has_tension = self.readings.iter().any(|reading| !reading.faces.is_empty());
        let tension = self.readings.iter().filter(|_| has_tension).map(|reading| largest(&reading.faces)).collect();
        recorder.finish().with_tension(tension)
    }
}

/// Runs a scene without writing files, several times if `repeated`; the last repetition is recorded. Returns `None` if
/// interrupted. Collective.
///
/// # Errors
/// Same as a run.
pub fn time(
    comm: &Comm,
    scene: &Scene,
    repeated: bool,
    interrupted: &Rc<dyn Fn() -> bool>,
) -> Result<Option<(Timed, Recording)>> {
    let (mut builds, mut runs) = (Vec::new(), Vec::new());
    let begin = Instant::now();
    loop {
        comm.mpi().barrier();
        let start = Instant::now();
        let model = match Model::made(&ModelContext::new(comm, &Until(comm, &**interrupted)), scene) {
            Err(Error::Interrupted) => return Ok(None),
            model => model?,
        };
        let mut timed = Timed {
            model: model::name(model.theory).to_owned(),
            reduction: model.reduction(),
            unknowns: model.unknowns + 1,
            ..Timed::default()
        };
        let mut simulation = Simulation::new(scene, model)?;
        let built = start.elapsed().as_secs_f64();
        let mut recording = Recording { faces: simulation.faces().to_vec(), ..Recording::default() };
        let take = |step: &Step, reading: &Reading| {
            recording.steps.push(*step);
            // Stress maps are left out: those of all steps together would not fit in memory.
            let Reading { probes, faces, .. } = reading;
            recording.readings.push(Reading { probes: probes.clone(), faces: faces.clone(), ..Reading::default() });
        };
        let flow = simulation.run_watched(&mut impact::Until { interrupted: &**interrupted, take })?;
        runs.push(start.elapsed().as_secs_f64() - built);
        builds.push(built);
        timed.solves = simulation.count().solves;
        timed.iterations = simulation.count().iterations;
        timed.estimate = simulation.error().total().map_or(f64::NAN, |errors| errors.history);
        drop(simulation);
        comm.collect_garbage()?;
        if flow.is_break() {
            return Ok(None);
        }
        let spent = begin.elapsed().as_secs_f64();
        let mut is_enough = !repeated || is_enough(builds.len(), spent);
        comm.mpi().process_at_rank(0).broadcast_into(&mut is_enough);
        if is_enough {
            let mut numbers = [median(builds), median(runs), spent];
            comm.mpi().process_at_rank(0).broadcast_into(&mut numbers);
            [timed.build, timed.run, timed.spent] = numbers;
            timed.history = recording.history();
            return Ok(Some((timed, recording)));
        }
    }
}

/// Whether `count` repetitions that took `spent` seconds in all are enough. The count must be odd, to have a median.
fn is_enough(count: usize, spent: f64) -> bool {
    count % 2 == 1 && (count >= ENOUGH_REPETITIONS && spent > ENOUGH_SECONDS || spent > MOST_SECONDS)
}

/// Expected wall time of all repetitions of a run of `seconds`, s.
pub fn spent(seconds: f64) -> f64 {
    // The clock may not resolve the shortest runs.
    let all = |count: usize| count as f64 * seconds.max(1e-6);
    (1..)
        .map(|count| (count, all(count)))
        .find(|(count, spent)| is_enough(*count, *spent))
        .map_or(seconds, |(_, spent)| spent)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
