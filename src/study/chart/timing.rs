//! One setting's time, and what came of it.

use std::rc::Rc;
use std::time::Instant;

use mpi::traits::Communicator;
use mpi::traits::{CommunicatorCollectives, Root};
use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{self, Reading};
use crate::model::watch::Until;
use crate::model::{self, Model, Simulation};
use crate::scene::Scene;
use crate::space::evaluate::FaceTension;
use crate::study::history::{History, Recorder};

/// Repetitions that will do where they take so long, s, and the time after which there are no more, s.
const WILL_DO: (usize, f64) = (5, 0.3);
const ENOUGH: f64 = 3.0;

/// What came of a setting.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Timed {
    /// Median wall time of what comes before the first step, s.
    pub build: f64,
    /// Median wall time of the steps, s.
    pub run: f64,
    /// What all repetitions took, s.
    pub spent: f64,
    /// The theory that was taken.
    pub model: String,
    /// What was made of it.
    pub reduction: String,
    /// Unknowns of the theory, the impactor's included.
    pub unknowns: usize,
    /// Steps taken, or solves.
    pub solves: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Estimated error of the whole history; NaN where there is none.
    pub estimate: f64,
    /// The acceleration; empty on ranks but the first where it was read from a file.
    pub history: History,
}

/// The steps of a run, with what was read at them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Names of the faces whose largest tension is read; on rank 0.
    pub faces: Vec<String>,
    /// The steps.
    pub steps: Vec<Step>,
    /// The reading of each.
    pub readings: Vec<Reading>,
}

impl Recording {
    /// The history of an impactor's mass (kg).
    fn history(&self, mass: f64) -> History {
        let mut recorder = Recorder::new(mass);
        self.steps.iter().for_each(|step| recorder.push(step));
        let largest = |faces: &[FaceTension]| faces.iter().fold(f64::NAN, |largest, face| largest.max(face.largest));
        let has_tension = self.readings.iter().any(|reading| !reading.faces.is_empty());
        let tension = self.readings.iter().filter(|_| has_tension).map(|reading| largest(&reading.faces)).collect();
        recorder.finish().with_tension(tension)
    }
}

/// Runs a scene, a few times where it is `repeated`, without writing anything; the last time is recorded. `None` where it was interrupted.
/// Collective.
///
/// # Errors
/// Those of the run.
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
        let model = match Model::watched(comm, scene, &Until(comm, &**interrupted)) {
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
            // (Without the maps, which all steps together would have no room for.)
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
            timed.history = recording.history(scene.impactor.mass);
            return Ok(Some((timed, recording)));
        }
    }
}

/// Whether so many repetitions that have taken so long, s, are enough: an odd number, of which there is a median.
fn is_enough(count: usize, spent: f64) -> bool {
    count % 2 == 1 && (count >= WILL_DO.0 && spent > WILL_DO.1 || spent > ENOUGH)
}

/// What all repetitions of a run of so many seconds take, s.
pub fn spent(seconds: f64) -> f64 {
    // (A clock may tell nothing of the shortest.)
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
