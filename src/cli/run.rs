//! `ricochet run`: a scene to a result.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::Instant;

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::agree::{agree, decided, of_root};
use crate::error::{Error, INTERRUPTED, Result};
use crate::impact::checkpoint::Checkpoint;
use crate::impact::step::Step;
use crate::impact::{Observer, Reading};
use crate::model::watch::{Stage, Watch as _};
use crate::model::{self, Linearity, Model, Simulation};
use crate::record::checkpoint;
use crate::record::extremes::extremes;
use crate::record::fields;
use crate::record::lock::Lock;
use crate::record::provenance::Cost;
use crate::record::read;
use crate::record::series::{Points, SeriesWriter};
use crate::record::stress::{Faces, LargestTension, MapPoints, strengths};
use crate::record::target::{Kind, check_writable, is_same};
use crate::scene::{self, Fault, Scene, Source};
use crate::solve::linear::has_mumps;

use super::Run;
use super::follow::Follower;
use super::interrupt::Interrupt;
use super::keeping::Keeping;
use super::load::{Loaded, STANDARD_INPUT, load};
use super::notes::{self, Verdict, describe_model, verdict};
use super::progress::Progress;
use super::provenance::{model_details, provenance};
use super::recording::Recording;
use super::restart::{Moment, Past, go_on};
use super::summary::Summary;
use super::{note, tell, warn_of_unused_options};

/// Runs a scene; returns the exit status. Collective.
///
/// # Errors
/// All that [`Error`] names.
pub fn run(comm: &Comm, arguments: &Run) -> Result<i32> {
    let Loaded { scene, source, is_of_result } = load(comm, &arguments.scene, &arguments.overrides)?;
    let given = arguments.output.as_ref().or(arguments.restart.as_ref());
    // A pipe is there for one reader, and its name tells nothing.
    let is_file_by_name = arguments.scene.metadata().map_or(true, |there| there.is_file());
    let unnamed = match given {
        None if is_of_result => Some("the scene of a result"),
        None if arguments.scene == Path::new(STANDARD_INPUT) => Some("a scene from standard input"),
        None if !is_file_by_name => Some("a scene from a pipe"),
        _ => None,
    };
    if let Some(what) = unnamed {
        return Err(Error::Usage(format!("{what} needs a name for its result: -o OUT.h5")));
    }
    let output = given.cloned().unwrap_or_else(|| default_output(&arguments.scene));
    let from = arguments.restart.as_deref().unwrap_or(&output);
    // Of rank 0: held to the end, and what it goes on from.
    let (mut lock, mut moment) = (None, None);
    // Before minutes of work whose result could not be written.
    let start = decided(comm, || {
        let is_continued = arguments.restart.as_ref().is_some_and(|result| is_same(result, &output));
        let replaced = match (is_continued, arguments.force) {
            (true, _) => Replaced::ByItself,
            (_, true) => Replaced::Anyway,
            _ => Replaced::UnlessInterrupted,
        };
        check_output(&scene, &output, replaced)?;
        if given.is_none() && !arguments.force {
            check_own(&output, source.folder())?;
        }
        lock = Some(Lock::take(&output)?);
        let Some(result) = &arguments.restart else { return Ok(Start::Anew) };
        Ok(match Past::read((result, &output), (&scene, &source))? {
            Past::Complete => {
                tell(format_args!("{} is complete: there is nothing to continue", from.display()));
                // Of a run that was killed between its last row and this.
                checkpoint::remove(from)?;
                Start::Nothing
            }
            Past::Beginning => {
                note(format_args!("note: {} has no checkpoint beside it: from the beginning", from.display()));
                Start::Anew
            }
            Past::Moment(there) => {
                moment = Some(there);
                Start::GoOn
            }
        })
    })?;
    let past = match start {
        Start::Nothing => return Ok(0),
        Start::Anew => None,
        Start::GoOn => Some(moment),
    };
    let written = Written { output: &output, force: arguments.force, has_summary: true };
    let solved = solve(comm, (&scene, &source), (past, from), &written);
    drop(lock);
    solved.map_err(|error| error.in_scene(&source))
}

/// The radial tension at the edge of the contact times α/F, 1/m²: (1 − 2ν)/(2πR).
fn ring(scene: &Scene) -> Option<f64> {
    let radius = scene.impactor.radius.filter(|_| scene.output.stress)?;
    Some((1.0 - 2.0 * scene.body.struck().poisson) / (2.0 * PI * radius))
}

/// Refuses a strength of a face that the body does not have.
fn check_strength(scene: &Scene, faces: &[String]) -> Result<()> {
    let wrong = scene.strength.by_face.keys().find(|name| !faces.contains(name));
    let key = match wrong {
        Some(name) => format!("strength.face.{name}"),
        None if scene.strength.is_given() && faces.is_empty() => "strength".to_owned(),
        None => return Ok(()),
    };
    let help = match faces {
        [] => "a theory whose stresses are read: \"mindlin\" or \"solid\"; on a mesh, named surfaces".to_owned(),
        faces => format!("one of {}", faces.join(", ")),
    };
    Err(Fault::new(key, "the model has no such face", help).into())
}

/// What is to be done of a scene.
#[derive(Debug, Serialize, Deserialize)]
enum Start {
    /// Its result is complete.
    Nothing,
    /// All of it.
    Anew,
    /// What is behind a checkpoint.
    GoOn,
}

/// What may happen to an earlier run at the place of a result.
pub(super) enum Replaced {
    /// It is continued.
    ByItself,
    /// It is replaced.
    Anyway,
    /// It is replaced unless it was interrupted and can be continued.
    UnlessInterrupted,
}

/// Whether a run can be written, with its checkpoint and its fields.
///
/// # Errors
/// [`Error::Io`] where it cannot.
pub(super) fn check_output(scene: &Scene, output: &Path, replaced: Replaced) -> Result<()> {
    check_writable(output, Kind::Run)?;
    if !matches!(replaced, Replaced::ByItself) {
        checkpoint::check_writable(output)?;
    }
    if matches!(replaced, Replaced::UnlessInterrupted) {
        check_not_interrupted(output)?;
    }
    if scene.output.fields.is_some() { fields::check_writable(output) } else { Ok(()) }
}

/// Refuses to replace a run that was interrupted and can be continued.
fn check_not_interrupted(output: &Path) -> Result<()> {
    if !output.exists() {
        return Ok(());
    }
    let (origin, _, complete) = read::origin(output)?;
    if complete || !checkpoint::is_there(output, origin.run_id) {
        return Ok(());
    }
    let shown = output.display();
    let reason =
        format!("holds an interrupted run with a checkpoint: --restart {shown} continues it, --force replaces it");
    Err(Error::io(output, reason))
}

/// Refuses to replace the result of a scene of the same name in another folder, where the user has not named the result.
fn check_own(output: &Path, folder: &Path) -> Result<()> {
    if !output.exists() {
        return Ok(());
    }
    let other = read::provenance(output)?.folder;
    // A folder that was moved says nothing.
    if !Path::new(&other).exists() || is_same(Path::new(&other), &Path::new(".").join(folder)) {
        return Ok(());
    }
    Err(Error::io(output, format!("holds the result of another scene, in {other}: -o names this one's result")))
}

fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.with_extension("h5").file_name().unwrap_or("ricochet.h5".as_ref()))
}

/// How a run is written.
pub(super) struct Written<'a> {
    /// The result.
    pub output: &'a Path,
    /// Whether it is computed even if its estimated error makes it useless.
    pub force: bool,
    /// Whether its summary is printed.
    pub has_summary: bool,
}

/// Computes a run, or what is missing of it, and writes it; returns the exit status. Collective.
///
/// # Errors
/// All that [`Error`] names.
pub(super) fn solve(
    comm: &Comm,
    (scene, source): (&Scene, &Source),
    (past, from): (Option<Option<Box<Moment>>>, &Path),
    &Written { output, force, has_summary }: &Written<'_>,
) -> Result<i32> {
    if !matches!(scene.body.model, scene::Model::HalfSpace | scene::Model::InfinitePlate) {
        // Part of the program's start, not of the run.
        comm.session().petsc()?;
    }
    let begin = Instant::now();
    if comm.is_root() {
        // Before the model, which may take long for such values.
        let odd = notes::texts(notes::of_values(scene, source));
        odd.iter().for_each(|warning| tell(format_args!("warning: {warning}")));
    }
    let interrupt = Rc::new(Interrupt::on_signals());
    let follower = Follower::new(comm, interrupt.clone());
    let model = Model::watched(comm, scene, &follower)?;
    let modelled = begin.elapsed().as_secs_f64();
    let mut poor = None;
    if let Some(Verdict { message, is_useless }) = verdict(&model, scene) {
        if is_useless && !force {
            return Err(Error::Solve(format!(
                "{message}. The result would be of no use; --force computes it all the same"
            )));
        }
        poor = Some(message);
    }
    let was_warned = poor.is_some();
    let patch = model.dynamics.patch();
    let linearity = Linearity::new(scene, model.theory, patch.as_ref());
    let warnings = notes::texts(notes::of_geometry(scene, model.measures.as_ref()));
    let (described, reason) = (describe_model(&model, scene.measure), model.reason.clone());
    let of_measure = notes::note_of_measure(&model, scene);
    let is_factorised = model.dynamics.is_factorised_on_ranks();
    let details = model_details(&model);
    let of_model = (model::name(model.theory), model.reduction(), model.unknowns);
    let mut provenance = provenance(comm, scene, source, of_model)?;
    provenance.model_details = Some(details);
    follower.at(Stage::Steps)?;
    let mut impact = Simulation::new(scene, model)?;
    drop(follower);
    provenance.planned_rows = impact.steps().map(|steps| steps / scene.output.every + 1);
    let assembled = begin.elapsed().as_secs_f64();
    tracing::info!(modelled, assembled, "ready");
    if comm.is_root() {
        if let Some(message) = poor {
            tell(format_args!("warning: {message}"));
        }
        note(format_args!("{described}"));
        if let Some(reason) = reason {
            note(format_args!("{reason}"));
        }
        for warning in warnings {
            tell(format_args!("warning: {warning}"));
        }
        let of_scene = notes::notes(scene, patch.as_ref(), impact.plan().as_ref());
        for line in notes::texts(of_scene).into_iter().chain(of_measure) {
            note(format_args!("note: {line}"));
        }
        if is_factorised && !has_mumps(comm.session())? {
            note(format_args!(
                "note: this PETSc is without MUMPS: each rank factorises all of a matrix for itself, so that more ranks save nothing there"
            ));
        }
    }
    check_strength(scene, &of_root(comm, Some(impact.faces().to_vec())))?;
    let points = Points {
        probes: scene.output.probes.iter().map(|probe| probe.name.clone()).collect(),
        faces: Faces {
            names: impact.faces().to_vec(),
            map: MapPoints::new(scene, impact.face_points().to_vec()),
            ring: ring(scene),
        },
    };
    let strengths = strengths(&scene.strength, &points.faces.names);
    let earlier = match past {
        Some(moment) => go_on(comm, moment, (from, &provenance, &points), &mut impact)?,
        None => None,
    };
    let steps = impact.steps();
    let recording = impact.take_sampler().map(|sampler| Recording::new(sampler, output, scene.output.fields, steps));
    let parts = match (comm.is_root(), earlier) {
        (false, _) => None,
        (true, None) => Some((SeriesWriter::with_points(output, &provenance, &points)?, recording, Summary::default())),
        (true, Some((earlier, summary))) => {
            note(format_args!("continuing from t = {:.6e} s", summary.end()));
            let writer = SeriesWriter::continued(output, &provenance, &points, earlier)?;
            let recording = recording.map(|recording| recording.behind(from, summary.end(), &writer)).transpose()?;
            Some((writer, recording, summary))
        }
    };
    let desk = parts.map(|(writer, recording, summary)| Desk {
        writer: if scene.time.modal { writer.all_at_once() } else { writer }.every(scene.output.every),
        recording,
        progress: Progress::new([summary.end(), scene.time.end]),
        summary: summary.following(linearity),
        strengths,
    });
    let keeping = Keeping::new(comm, (scene, source.text()), output, &impact);
    let mut watch = Watch { comm: comm.clone(), interrupt, keeping, desk };
    let stepped = impact.run_watched(&mut watch);
    let total = begin.elapsed().as_secs_f64();
    let (count, estimate) = (impact.count(), impact.error());
    tracing::info!(?estimate, "estimated");
    let error = estimate.total().map(|errors| errors.history);
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
    let complete = flow == Some(ControlFlow::Continue(()));
    let mut ended = Ok(());
    if let Some(Desk { mut writer, mut recording, progress, summary, .. }) = watch.desk {
        progress.finish();
        let episodes = writer.episodes().clone();
        // What was computed is kept, whatever ended the run; where nothing was, all is left as it is.
        let fields = recording.as_mut().filter(|_| complete || writer.has_begun());
        let recorded = fields.map_or(Ok(()), Recording::flush);
        // Where the run has failed already, that is what is told: a full disk fails the steps first and then the end.
        let stress_error = estimate.total().map_or(f64::NAN, |errors| errors.stress);
        writer.set_largest(LargestTension { error_estimate: stress_error, ..summary.largest_tension() });
        ended = writer.finish(&cost, complete).and(recorded);
        if let (Some(flow), Ok(())) = (flow, &ended) {
            // Of a file system that cannot be read at once, the run is as good.
            let extremes = extremes(output).ok().flatten();
            if has_summary {
                summary.print(&episodes, extremes.as_ref(), &cost, &estimate.causes(), output);
            }
            if let Some(warning) = summary.warning() {
                tell(format_args!("warning: {warning}"));
            }
            for missed in estimate
                .total()
                .iter()
                .flat_map(|errors| notes::missed(errors, (scene.measure, scene.tolerance), was_warned))
            {
                note(format_args!("note: {missed}"));
            }
            if flow.is_break() {
                tell(format_args!("interrupted: {} holds the run up to t = {:.6e} s", output.display(), summary.end()));
                if checkpoint::beside(output).exists() {
                    note(format_args!("note: --restart {} continues it", output.display()));
                }
            } else {
                checkpoint::remove(output)?;
            }
            warn_of_unused_options(comm)?;
        }
    }
    // First of all: an error of one rank alone must not wait for the others in a collective call.
    let is_alone = |error: &Error| !error.is_everywhere() || matches!(error, Error::Unwritten(_));
    if stepped.as_ref().err().is_some_and(is_alone) {
        return stepped.map(|_| 0);
    }
    let why = stepped.as_ref().err().map_or(String::new(), |error| format!(" (before that: {error})"));
    let ended = ended.map_err(|error| Error::Output(format!("{error}{why}")));
    agree(comm, ended.map_err(|error| error.to_string())).map_err(Error::Unwritten)?;
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
    /// Of the faces, in their order, Pa.
    strengths: Vec<Option<f64>>,
}

impl Desk {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<()> {
        if let Some(recording) = &mut self.recording {
            recording.step(step, reading, &self.writer)?;
        }
        self.writer.push_read(step, reading)?;
        self.progress.step(step);
        self.summary.step(step);
        self.summary.tensions(step.time, &reading.faces, &self.strengths);
        Ok(())
    }
}

/// What happens with every step.
struct Watch {
    comm: Comm,
    interrupt: Rc<Interrupt>,
    keeping: Keeping,
    desk: Option<Desk>,
}

impl Observer for Watch {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>> {
        let written = self.desk.as_mut().map_or(Ok(()), |desk| desk.step(step, reading));
        let is_late = self.desk.is_some() && self.keeping.is_due_by_time();
        let (interrupted, [late, failed]) = self.interrupt.poll(&self.comm, [is_late, written.is_err()]);
        if failed {
            // Rank 0 tells it, and all end in order.
            return Err(Error::Unwritten(written.err().map_or(String::new(), |error| error.to_string())));
        }
        self.keeping.step(step, late);
        Ok(if interrupted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    fn is_interrupted(&mut self) -> bool {
        self.interrupt.is_raised(&self.comm)
    }

    fn settled(&mut self, interrupted: bool, checkpoint: &mut dyn FnMut() -> Result<Checkpoint>) -> Result<()> {
        let record = self.desk.as_mut().map(|desk| (&mut desk.writer, desk.recording.as_mut(), &mut desk.summary));
        self.keeping.settled(record, interrupted, checkpoint)
    }
}
