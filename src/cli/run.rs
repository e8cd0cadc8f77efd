//! `ricochet run`: a scene to a result.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Instant;

use petsc_wrap::Comm;

use crate::agree::agree;
use crate::error::{Error, Result};
use crate::impact::step::{Energy, Step};
use crate::model::{self, Model, Simulation};
use crate::record::episodes::Episodes;
use crate::record::fields;
use crate::record::provenance::Cost;
use crate::record::series::SeriesWriter;
use crate::record::target::check_writable;
use crate::scene::{Scene, Source};

use super::Run;
use super::interrupt::{INTERRUPTED, Interrupt};
use super::load::load;
use super::notes::{describe_model, listed, note_of_probes, notes};
use super::progress::Progress;
use super::provenance::provenance;
use super::recording::Recording;
use super::{say, short, tell, warn_of_unused_options};

/// Runs a scene; returns the exit status. Collective.
///
/// # Errors
/// All that [`Error`] names.
pub fn run(comm: &Comm, arguments: &Run) -> Result<i32> {
    let (scene, source) = load(comm, &arguments.scene, &arguments.overrides)?;
    let output = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.scene));
    // Before minutes of work whose result could not be written.
    let writable = || {
        check_writable(&output)?;
        if scene.output.fields.is_some() { fields::check_writable(&output) } else { Ok(()) }
    };
    let writable = if comm.is_root() { writable().map_err(|error| error.to_string()) } else { Ok(()) };
    agree(comm, writable).map_err(Error::Output)?;
    solve(comm, &scene, &source, &output).map_err(|error| error.in_scene(&source))
}

fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.with_extension("h5").file_name().unwrap_or("ricochet.h5".as_ref()))
}

fn solve(comm: &Comm, scene: &Scene, source: &Source, output: &Path) -> Result<i32> {
    let begin = Instant::now();
    let model = Model::new(comm, scene)?;
    let modelled = begin.elapsed().as_secs_f64();
    let patch = model.dynamics.patch();
    let (described, reason, of_probes) = (describe_model(&model), model.reason.clone(), note_of_probes(&model));
    let of_model = (model::name(model.theory), model.reduction(), model.unknowns);
    let mut provenance = provenance(comm, scene, source, of_model)?;
    let mut impact = Simulation::new(scene, model)?;
    provenance.planned_rows = impact.steps().map(|steps| steps / scene.output.every + 1);
    let assembled = begin.elapsed().as_secs_f64();
    tracing::info!(modelled, assembled, "ready");
    if comm.is_root() {
        tell(format_args!("{described}"));
        if let Some(reason) = reason {
            tell(format_args!("{reason}"));
        }
        for note in notes(scene, patch.as_ref(), impact.plan().as_ref()).into_iter().chain(of_probes) {
            tell(format_args!("note: {note}"));
        }
    }
    let names: Vec<String> = scene.output.probes.iter().map(|probe| probe.name.clone()).collect();
    let readings = impact.read()?;
    let mut desk = match comm.is_root() {
        true => Some(Desk {
            writer: SeriesWriter::with_probes(output, &provenance, &names)?.every(scene.output.every),
            recording: readings.map(|readings| Recording::new(readings, output, scene.output.fields, impact.steps())),
            progress: Progress::new(scene.time.end),
            summary: Summary::new(scene.impactor.mass),
        }),
        false => None,
    };
    let interrupt = Rc::new(Interrupt::on_signals());
    let (asked, ranks) = (interrupt.clone(), comm.clone());
    impact.set_interrupt(move || asked.is_raised(&ranks));
    let stepped = impact.run(|step| {
        if let Some(desk) = &mut desk {
            desk.step(step)?;
        }
        Ok(if interrupt.is_raised(comm) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    });
    let total = begin.elapsed().as_secs_f64();
    let (count, error, judged) = (impact.count(), impact.error(), impact.judged());
    let missed = error.is_some_and(|error| error > scene.tolerance);
    let cost = Cost {
        model: modelled,
        setup: assembled - modelled,
        steps: total - assembled,
        total,
        newton_iterations: count.iterations,
        solves: count.solves,
        error_estimate: error.unwrap_or(f64::NAN),
    };
    let flow = stepped.as_ref().ok().copied();
    if let Some(Desk { writer, recording, progress, summary }) = desk {
        progress.finish();
        // What was computed is kept, whatever ended the run.
        let recorded = recording.map_or(Ok(()), Recording::finish);
        let finished = writer.finish(&cost, flow == Some(ControlFlow::Continue(()))).and(recorded);
        // Where the run has failed already, that is what is told: a full disk fails the steps first and then the end.
        if let Some(flow) = flow {
            finished?;
            summary.print(&cost, &judged, output);
            if missed {
                tell(format_args!(
                    "note: the estimated error of the whole history is above accuracy.tolerance = {:e}, which is for the first contact: a smaller one \
                     tells what the history tends to",
                    scene.tolerance
                ));
            }
            if flow.is_break() {
                tell(format_args!("interrupted: {} holds the run up to t = {:.6e} s", output.display(), summary.end));
            }
            warn_of_unused_options(comm)?;
        }
    }
    // First of all: an error of rank 0 alone must not wait for the others in a collective call.
    let flow = stepped?;
    drop(impact);
    comm.collect_garbage()?;
    Ok(match flow {
        ControlFlow::Continue(()) => 0,
        ControlFlow::Break(()) => INTERRUPTED,
    })
}

/// What rank 0 keeps of a run.
struct Desk {
    writer: SeriesWriter,
    recording: Option<Recording>,
    progress: Progress,
    summary: Summary,
}

impl Desk {
    fn step(&mut self, step: &Step) -> Result<()> {
        let probes = match &mut self.recording {
            Some(recording) => recording.step(step, &self.writer)?,
            None => Vec::new(),
        };
        self.writer.push_read(step, probes)?;
        self.progress.step(step);
        self.summary.step(step);
        Ok(())
    }
}

/// The run in three lines.
struct Summary {
    episodes: Episodes,
    peak: (f64, f64),
    rebound: f64,
    end: f64,
    initial: f64,
    energy: Energy,
}

impl Summary {
    fn new(mass: f64) -> Self {
        let energy = Energy::default();
        Self { episodes: Episodes::new(mass), peak: (0.0, 0.0), rebound: 0.0, end: 0.0, initial: 0.0, energy }
    }

    fn step(&mut self, step: &Step) {
        self.episodes.push(step);
        if step.impactor.acceleration > self.peak.0 {
            self.peak = (step.impactor.acceleration, step.time);
        }
        self.rebound = step.impactor.velocity;
        self.end = step.time;
        if step.number == 0 {
            self.initial = step.energy.total;
        }
        self.energy = step.energy;
    }

    fn print(&self, cost: &Cost, judged: &[&str], output: &Path) {
        let contacts: Vec<String> = self
            .episodes
            .all()
            .iter()
            .map(|episode| format!("{}–{} ms", short(1e3 * episode.start), short(1e3 * episode.end)))
            .collect();
        let mut contacts = if contacts.is_empty() { "none".to_owned() } else { contacts.join(", ") };
        if self.episodes.is_open() {
            contacts += ", and still in contact";
        }
        say(format_args!(
            "peak acceleration {} m/s² at {} ms; impactor's velocity at the end {} m/s",
            short(self.peak.0),
            short(1e3 * self.peak.1),
            short(self.rebound)
        ));
        say(format_args!("contacts: {contacts}"));
        let energy = &self.energy;
        say(format_args!(
            "energy: {:+.1e} of the initial {} J made by the time integration{}",
            energy.numerical / self.initial,
            short(self.initial),
            if cost.error_estimate.is_nan() {
                String::new()
            } else {
                format!(
                    "; estimated error of the acceleration, by {}, {:.1e} of its peak",
                    listed(judged),
                    cost.error_estimate
                )
            }
        ));
        say(format_args!(
            "{}: {} s (model {}, setup {}, steps {}), {} solves and {} Newton iterations",
            output.display(),
            seconds(cost.total),
            seconds(cost.model),
            seconds(cost.setup),
            seconds(cost.steps),
            cost.solves,
            cost.newton_iterations
        ));
    }
}

/// Milliseconds below ten seconds, tenths of a second above.
fn seconds(value: f64) -> String {
    if value >= 10.0 { format!("{value:.1}") } else { format!("{value:.3}") }
}
