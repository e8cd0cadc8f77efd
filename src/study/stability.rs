//! Finds where each time integration scheme is stable and accurate on a scene: runs of schemes × time steps.
//!
//! Every pair is a run of the scene. Its energy is measured by the energy balance. Its acceleration is compared with a
//! reference that has the same mass matrix and finer steps: the energy-conserving scheme, or the central difference for
//! the lumped mass. The measured error is therefore the error of the time integration alone.

use std::ops::ControlFlow;
use std::time::Instant;

use mpi::traits::{Communicator, Root};

use crate::body::{Body, Lumped};
use crate::description::Description;
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{ImpactParameters, SteppedImpact, stable_step};
use crate::mesh::Mesh;
use crate::scene::{Newton, Scene, Scheme, Solver, Time};

use super::history::{History, Measure, Measured};
use super::plan::{Demand, Occasion, Plan};
use super::schemes::{compared, is_explicit, label};
use super::verdict::{Ending, Verdict};

/// Number of steps per contact at which average acceleration has a force error of 0.6% for an impact on a half-space
/// (2.2% at 10 steps). A body that vibrates during the contact needs more.
pub const STEPS_PER_CONTACT: f64 = 20.0;

/// Result of a stability study.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Duration of the reference's first contact episode, s; the contact time on a half-space if the episode did not
    /// end.
    pub contact: f64,
    /// End of the runs, s.
    pub end: f64,
    /// Tolerance on the energy error (over the initial energy) and on the acceleration error (over the peak
    /// acceleration).
    pub tolerance: f64,
    /// The reference with the consistent mass.
    pub reference: Reference,
    /// The reference with the lumped mass, and the effect of lumping: the difference of its acceleration from the
    /// consistent reference in the first contact episode, over the peak.
    pub explicit: Option<(Reference, f64)>,
    /// Results of each scheme.
    pub rows: Vec<Row>,
    /// Messages about what was left out, and why.
    pub notes: Vec<String>,
    /// Whether a signal interrupted the study.
    pub is_interrupted: bool,
}

impl Study {
    /// Number of planned runs that were not made.
    pub fn left_out(&self) -> usize {
        self.rows.iter().map(Row::left_out).sum()
    }

    /// Number of planned runs.
    pub fn planned(&self) -> usize {
        self.rows.iter().map(|row| row.runs.len()).sum()
    }
}

/// The run that other runs are compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// Time integration scheme.
    pub scheme: Scheme,
    /// Δt, s.
    pub step: f64,
    /// Measurements of the run. A reference with the consistent mass is itself compared with nothing, so its
    /// acceleration errors are zero.
    pub measured: Measured,
    /// Estimated error of the reference in the first contact episode, over the peak: half of the difference from the
    /// same scheme with steps twice as large. `None` if that run was not made.
    pub error: Option<f64>,
}

/// All runs of one scheme.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The scheme.
    pub scheme: Scheme,
    /// Theoretical stability limit of the time step, s: infinite if always stable, 0 if never.
    pub limit: f64,
    /// Runs in ascending order of step.
    pub runs: Vec<Trial>,
}

/// One run: a scheme at one time step.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Δt, s.
    pub step: f64,
    /// Measurements of the run.
    pub measured: Measured,
    /// Verdict drawn from the measurements.
    pub verdict: Verdict,
}

impl Row {
    /// Largest step up to which all completed runs are stable and accurate, s.
    pub fn holds(&self) -> Option<f64> {
        let made = self.runs.iter().filter(|run| run.verdict != Verdict::LeftOut);
        made.take_while(|run| run.verdict == Verdict::Holds).last().map(|run| run.step)
    }

    /// Number of planned runs that were not made. They are the finest, which take the longest.
    fn left_out(&self) -> usize {
        self.runs.iter().filter(|run| run.verdict == Verdict::LeftOut).count()
    }

    /// Smallest step at which a run gains energy, s.
    pub fn grows(&self) -> Option<f64> {
        let fails = |run: &&Trial| matches!(run.verdict, Verdict::Grows(_) | Verdict::Gains);
        self.runs.iter().find(fails).map(|run| run.step)
    }
}

/// One run of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Job {
    /// Index of the scheme.
    row: usize,
    /// Index of the step among the steps of the scheme.
    column: usize,
    /// Expected wall time, s.
    expected: f64,
}

/// Progress of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of completed runs.
    pub done: usize,
    /// Number of planned runs.
    pub planned: usize,
}

/// Runs the scene with all schemes, in ascending order of expected wall time. The references are run first. After them,
/// a run is started only if it is expected to end within `budget` (s); the shortest run is always made. `interrupted`
/// returns whether to stop, the same on all ranks; `told` is called after each run. Returns `None` if interrupted
/// before the first run is done. Collective.
///
/// # Errors
/// Same as a run of the scene with the energy-conserving scheme in small steps, or if a PETSc call fails.
pub fn stability(
    mesh: &Mesh,
    scene: &Scene,
    budget: Option<f64>,
    interrupted: &mut dyn FnMut() -> bool,
    told: &mut dyn FnMut(Progress),
) -> Result<Option<Study>> {
    let body = Body::solid(scene, mesh)?;
    let unknowns = body.unknowns();
    let mut bench = Bench::new(mesh, scene, body, interrupted)?;
    let schemes = compared(scene.time.scheme);
    let mut demands = Vec::new();
    for scheme in &schemes {
        let limit = bench.limit(*scheme)?;
        demands.push(Demand { limit, is_explicit: is_explicit(*scheme) });
    }
    let impactor = &scene.impactor;
    let contact = impactor.contact_time();
    let plan = Plan::new(
        &Occasion { contact, touch: impactor.flight_time(), end: scene.time.end, step: scene.time.step, unknowns },
        &demands,
    );
    bench.scene.time.end = plan.end;

    let start = Instant::now();
    let Some((mut reference, history)) = bench.reference(Scheme::Energy, plan.reference, None)? else {
        return Ok(None);
    };
    // Wall time of an implicit and of an explicit step, s.
    let implicit = start.elapsed().as_secs_f64() / reference.measured.steps.max(1) as f64;
    let (mut explicit_step, mut explicit) = (implicit, None);
    if let Some(step) = plan.explicit_reference {
        let scheme = Scheme::CentralDifference { allow_unstable: true };
        let start = Instant::now();
        let Some((run, own)) = bench.reference(scheme, step, Some(&history))? else { return Ok(None) };
        explicit_step = start.elapsed().as_secs_f64() / run.measured.steps.max(1) as f64;
        explicit = Some((run, own));
    }
    let left_out = |step: f64| Trial { step, measured: Measured::NOTHING, verdict: Verdict::LeftOut };
    let row = |(scheme, (demand, steps)): (Scheme, (&Demand, &Vec<f64>))| {
        let runs = steps.iter().map(|step| left_out(*step)).collect();
        Row { scheme, limit: demand.limit, runs }
    };
    let mut study = Study {
        contact: history.contact().unwrap_or(contact),
        end: plan.end,
        tolerance: scene.tolerance,
        reference,
        explicit: None,
        rows: schemes.into_iter().zip(demands.iter().zip(&plan.steps)).map(row).collect(),
        notes: plan.notes,
        is_interrupted: false,
    };
    let mut jobs = Vec::new();
    for (row, (demand, steps)) in demands.iter().zip(&plan.steps).enumerate() {
        let a_step = if demand.is_explicit { explicit_step } else { implicit };
        jobs.extend(steps.iter().enumerate().map(|(column, step)| Job {
            row,
            column,
            expected: a_step * plan.end / step,
        }));
    }
    // All ranks use the clock of rank 0.
    let root = mesh.comm.mpi().process_at_rank(0);
    jobs.iter_mut().for_each(|job| root.broadcast_into(&mut job.expected));
    jobs.sort_by(|a, b| a.expected.total_cmp(&b.expected));
    let begin = Instant::now();
    for (done, job) in jobs.iter().enumerate() {
        let mut fits = budget.is_none_or(|budget| begin.elapsed().as_secs_f64() + job.expected <= budget);
        root.broadcast_into(&mut fits);
        if !fits && done > 0 {
            break;
        }
        let scheme = study.rows[job.row].scheme;
        let run = &mut study.rows[job.row].runs[job.column];
        let own = explicit.as_ref().filter(|_| is_explicit(scheme)).map(|(_, history)| history);
        let mut measure = Measure::new(Some(own.unwrap_or(&history)));
        let Some(ending) = bench.run(scheme, run.step, |step| measure.push(step))? else {
            study.is_interrupted = true;
            break;
        };
        run.measured = measure.finish().0;
        run.verdict = Verdict::new(ending, &run.measured, scene.tolerance);
        told(Progress { done: done + 1, planned: jobs.len() });
    }
    if study.left_out() == study.planned() {
        return Ok(None);
    }
    let why = match budget {
        Some(budget) if !study.is_interrupted => format!("to keep to the {budget} s of --budget"),
        _ => "interrupted".to_owned(),
    };
    for row in &study.rows {
        let which = match row.left_out() {
            0 => continue,
            all if all == row.runs.len() => "all steps".to_owned(),
            1 => "its finest step".to_owned(),
            some => format!("its {some} finest steps"),
        };
        study.notes.push(format!("{}: {which}, {why}", label(row.scheme)));
    }
    reference.estimate(&study.rows);
    study.reference = reference;
    study.explicit = explicit.map(|(mut run, _)| {
        run.estimate(&study.rows);
        (run, run.measured.first_error)
    });
    Ok(Some(study))
}

impl Reference {
    /// Estimates the reference's error from the runs.
    fn estimate(&mut self, rows: &[Row]) {
        let row = rows.iter().find(|row| row.scheme == self.scheme);
        let is_whole = |run: &Trial| run.verdict.reason().is_none() && run.verdict != Verdict::LeftOut;
        let twice = |run: &&Trial| (run.step / self.step / 2.0 - 1.0).abs() < 1e-9 && is_whole(run);
        let run = row.and_then(|row| row.runs.iter().find(twice));
        self.error = run.map(|run| 0.5 * run.measured.first_error);
    }
}

/// One body that is reused for many runs.
struct Bench<'a> {
    mesh: &'a Mesh,
    scene: Scene,
    /// `None` only while a run owns the body, or after an error.
    body: Option<Body>,
    /// The lumped mass while the body uses the consistent mass.
    lumped: Option<Lumped>,
    interrupted: &'a mut dyn FnMut() -> bool,
}

impl<'a> Bench<'a> {
    /// Prepares the scene's body for many runs. The energy gate is switched off. Steps are solved by the condensed
    /// Newton method, which has the same results as the full one but is faster.
    fn new(mesh: &'a Mesh, scene: &Scene, body: Body, interrupted: &'a mut dyn FnMut() -> bool) -> Result<Self> {
        let lumped = if body.lumped.is_none() { Some(Lumped::new(&Description::new(scene), mesh)?) } else { None };
        let solver = Solver { newton: Newton::Condensed, energy_gate: None };
        Ok(Self { mesh, scene: Scene { solver, ..scene.clone() }, body: Some(body), lumped, interrupted })
    }

    /// Returns the body with the mass matrix of a scheme.
    fn body(&mut self, scheme: Scheme) -> &mut Body {
        let body = self.body.as_mut().expect("every run that did not end the study has handed it back");
        if is_explicit(scheme) != body.lumped.is_some() {
            std::mem::swap(&mut body.lumped, &mut self.lumped);
        }
        body
    }

    /// Theoretical stability limit of a scheme's time step, s. Collective.
    fn limit(&mut self, scheme: Scheme) -> Result<f64> {
        let mesh = self.mesh;
        let impactor = self.scene.impactor.clone();
        let body = self.body(scheme);
        let setting = ImpactParameters::new(&impactor, body);
        let limit = stable_step(body, &setting, scheme);
        mesh.comm.collect_garbage()?;
        limit
    }

    /// Makes a reference run, for which instability is an error. Returns it with its history, compared with `other` if
    /// given; `None` if interrupted. Collective.
    fn reference(
        &mut self,
        scheme: Scheme,
        step: f64,
        other: Option<&History>,
    ) -> Result<Option<(Reference, History)>> {
        let mut measure = Measure::new(other);
        let ending = self.run(scheme, step, |step| measure.push(step))?;
        match ending {
            None => Ok(None),
            Some(Ending::Whole) => {
                let (measured, history) = measure.finish();
                Ok(Some((Reference { scheme, step, measured, error: None }, history)))
            }
            Some(Ending::Unstable(reason)) => Err(Error::Unstable(reason)),
            Some(Ending::Unsolved(reason)) => Err(Error::Solve(reason)),
        }
    }

    /// Makes a run and returns how it ended; `None` if interrupted. Collective.
    fn run(&mut self, scheme: Scheme, step: f64, mut observe: impl FnMut(&Step)) -> Result<Option<Ending>> {
        self.body(scheme);
        self.scene.time = Time { step: Some(step), scheme, ..self.scene.time };
        let body = self.body.take().expect("it has just been made ready");
        let mut impact = SteppedImpact::new(&self.scene, body)?;
        let ended = impact.run(|step| {
            observe(step);
            Ok(if (self.interrupted)() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        });
        // An error on one rank alone is returned at once: the other ranks do not join the collective calls below.
        if let Err(error) = &ended
            && !error.is_everywhere()
        {
            return ended.map(|_| None);
        }
        self.body = Some(impact.into_body());
        self.mesh.comm.collect_garbage()?;
        match ended {
            Ok(ControlFlow::Continue(())) => Ok(Some(Ending::Whole)),
            Ok(ControlFlow::Break(())) => Ok(None),
            Err(Error::Unstable(reason)) => Ok(Some(Ending::Unstable(reason))),
            Err(Error::Solve(reason)) => Ok(Some(Ending::Unsolved(reason))),
            Err(other) => Err(other),
        }
    }
}
