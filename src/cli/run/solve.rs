//! Computes a run from its scene to the closed result.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;
use std::rc::Rc;
use std::time::Instant;

use petsc_wrap::Comm;

use crate::agree::{agree, of_root};
use crate::error::{Error, INTERRUPTED, Result};
use crate::impact::{Cause, Errors};
use crate::model::watch::{Stage, Watch as _};
use crate::model::{self, Linearity, Model, ModelContext, Simulation};
use crate::record::provenance::{Cost, Provenance};
use crate::record::series::{Points, SeriesWriter};
use crate::record::stress::{Faces, MapPoints, Ring, strengths};
use crate::scene::{Contact, Fault, Scene, Source};

use super::super::checkpoint_writer::CheckpointWriter;
use super::super::follow::Follower;
use super::super::interrupt::{Ending, Interrupt};
use super::super::notes::{self, Said};
use super::super::progress::Progress;
use super::super::provenance::{model_details, provenance};
use super::super::recording::Recording;
use super::super::restart::{Moment, go_on};
use super::super::summary::Summary;
use super::super::{note, warn_of_unused_options};
use super::announcement::Announcement;
use super::recorder::{End, Recorder, Watch};

/// Start of a run.
pub(in crate::cli) enum Beginning<'a> {
    /// From t = 0.
    Anew,
    /// From a checkpoint.
    Checkpoint {
        /// The result that the checkpoint belongs to.
        result: &'a Path,
        /// Contents of the checkpoint, on rank 0.
        moment: Option<Box<Moment>>,
    },
}

/// Options for writing a run.
pub(in crate::cli) struct Written<'a> {
    /// Path of the result.
    pub output: &'a Path,
    /// Whether the run is computed even if its estimated error makes it useless.
    pub force: bool,
    /// Whether the summary is printed.
    pub has_summary: bool,
    /// Estimated errors of the theory that the scene names, if it and its cells were chosen before.
    pub of_theory: Option<Errors>,
}

/// Computes a run, or the missing part of it, and writes it; returns the exit status. Collective.
///
/// # Errors
/// Any [`Error`].
pub(in crate::cli) fn solve(
    comm: &Comm,
    (scene, source): (&Scene, &Source),
    beginning: Beginning<'_>,
    &Written { output, force, has_summary, of_theory }: &Written<'_>,
) -> Result<i32> {
    if !scene.time.modal {
        // Counted as the start of the program, not as part of the run. In modal coordinates most bodies need no PETSc.
        comm.session().petsc()?;
    }
    let begin = Instant::now();
    let mut said = Said::default();
    if comm.is_root() {
        // Before the model is built, which may take long with such values.
        said.warn(notes::texts(notes::of_values(scene, source)));
        said.print(said.count());
    }
    let interrupt = Rc::new(Interrupt::new(Ending::AtOnce));
    let follower = Follower::new(comm, interrupt.clone());
    let context = ModelContext { keeps_cells: of_theory.is_some(), ..ModelContext::new(comm, &follower) };
    let mut model = Model::made(&context, scene)?;
    if let Some(of_theory) = of_theory {
        model.error = model.error.with(Cause::Theory, of_theory);
    }
    let modelled = begin.elapsed().as_secs_f64();
    let announcement = Announcement::new(&model, scene, force)?;
    let was_warned = announcement.poor.is_some();
    let linearity = Linearity::new(scene, model.theory, model.dynamics.patch().as_ref());
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
        announcement.print(comm, scene, &impact, &mut said)?;
    }
    check_strength(scene, &of_root(comm, Some(impact.faces().to_vec())))?;
    provenance.warnings = said.text();
    interrupt.set(Ending::InOrder);
    let recorder = record(comm, scene, (output, &provenance), beginning, (linearity, said), &mut impact)?;
    let keeping = CheckpointWriter::new(comm, (scene, source.text()), output, &impact);
    let mut watch = Watch { comm: comm.clone(), interrupt, keeping, recorder };
    let stepped = impact.run_watched(&mut watch);
    let total = begin.elapsed().as_secs_f64();
    let (count, estimate) = (impact.count(), impact.error());
    tracing::info!(?estimate, "estimated");
    let cost = Cost {
        model: modelled,
        setup: assembled - modelled,
        steps: total - assembled,
        total,
        newton_iterations: count.iterations,
        solves: count.solves,
        error_estimate: estimate.total().map_or(f64::NAN, |errors| errors.history),
        deflection_error_estimate: estimate.of_deflection(),
    };
    let flow = stepped.as_ref().ok().copied();
    let end = End { cost: &cost, estimate: &estimate, output, has_summary, was_warned, force };
    let mut ended = Ok(None);
    if let Some(recorder) = watch.recorder {
        ended = recorder.finish(scene, flow, &end);
        if flow.is_some() && ended.is_ok() {
            warn_of_unused_options(comm)?;
        }
    }
    // Checked first: an error of a single rank must not wait for the others in a collective call.
    let is_alone = |error: &Error| !error.is_everywhere() || matches!(error, Error::Unwritten(_));
    if stepped.as_ref().err().is_some_and(is_alone) {
        return stepped.map(|_| 0);
    }
    let why = stepped.as_ref().err().map_or(String::new(), |error| format!(" (before that: {error})"));
    let ended = ended.map_err(|error| Error::Output(format!("{error}{why}")));
    let useless = agree(comm, ended.map_err(|error| error.to_string())).map_err(Error::Unwritten)?;
    let flow = stepped?;
    drop(impact);
    comm.collect_garbage()?;
    if let Some(message) = of_root(comm, Some(useless)) {
        return Err(Error::Solve(message));
    }
    Ok(match flow {
        ControlFlow::Continue(()) => 0,
        ControlFlow::Break(()) => INTERRUPTED,
    })
}

/// Opens the result on rank 0, and sets the simulation to its start. Collective.
fn record(
    comm: &Comm,
    scene: &Scene,
    (output, provenance): (&Path, &Provenance),
    beginning: Beginning<'_>,
    (linearity, said): (Option<Linearity>, Said),
    impact: &mut Simulation,
) -> Result<Option<Recorder>> {
    let points = Points {
        probes: scene.output.probes.iter().map(|probe| probe.name.clone()).collect(),
        faces: Faces {
            names: impact.faces().to_vec(),
            map: MapPoints::new(scene, impact.face_points().to_vec()),
            ring: ring(scene),
        },
    };
    let (earlier, from) = match beginning {
        Beginning::Anew => (None, output),
        Beginning::Checkpoint { result, moment } => {
            (go_on(comm, moment, (result, provenance, &points), impact)?, result)
        }
    };
    let steps = impact.steps();
    let recording = impact.take_sampler().map(|sampler| Recording::new(sampler, output, scene.output.fields, steps));
    if !comm.is_root() {
        return Ok(None);
    }
    let (writer, recording, summary) = match earlier {
        None => (SeriesWriter::create(output, provenance, &points)?, recording, Summary::default()),
        Some((earlier, summary)) => {
            note(format_args!("continuing from t = {:.6e} s", summary.end()));
            let writer = SeriesWriter::continued(output, provenance, &points, earlier)?;
            let recording = recording.map(|recording| recording.behind(from, summary.end(), &writer)).transpose()?;
            (writer, recording, summary)
        }
    };
    Ok(Some(Recorder {
        writer: if scene.time.modal { writer.all_at_once() } else { writer }.every(scene.output.every),
        recording,
        progress: Progress::new([summary.end(), scene.time.end]),
        summary: summary.following(linearity),
        strengths: strengths(&scene.strength, &points.faces.names),
        said,
    }))
}

/// Radial tension at the edge of the contact. On a patch of a given radius the contact is Hertz's; on a given area it is none.
fn ring(scene: &Scene) -> Option<Ring> {
    let curvature = scene.impactor.radius.filter(|_| scene.output.stress && scene.contact.area().is_none())?;
    let is_given = matches!(scene.contact, Contact::Patch { radius: Some(_), .. });
    let layered = scene.impactor.layered_contact().filter(|_| !is_given).cloned();
    Some(Ring { factor: (1.0 - 2.0 * scene.body.struck().poisson) / (2.0 * PI), curvature, layered })
}

/// Refuses the strength of a face that the body does not have.
fn check_strength(scene: &Scene, faces: &[String]) -> Result<()> {
    let wrong = scene.strength.by_face.keys().find(|name| !faces.contains(name));
    let key = match wrong {
        Some(name) => format!("strength.face.{name}"),
        None if scene.strength.is_given() && faces.is_empty() => "strength".to_owned(),
        None => return Ok(()),
    };
    let (message, help) = match faces {
        [] => (
            "this model has no face on which stresses are read",
            "a theory whose stresses are read: body.model = \"mindlin\" or \"solid\"; on a mesh, named surfaces"
                .to_owned(),
        ),
        faces => ("the model has no such face", format!("one of {}", faces.join(", "))),
    };
    Err(Fault::new(key, message, help).into())
}
