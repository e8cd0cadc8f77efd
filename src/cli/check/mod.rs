//! `ricochet check`: reports how a scene is solved, and at what cost.

mod cost;
mod facts;
mod text;

use std::rc::Rc;
use std::time::{Duration, Instant};

use mpi::traits::{Communicator, Root};
use petsc_wrap::Comm;

use crate::body::Body;
use crate::error::{Error, Result};
use crate::impact::{ImpactParameters, Plan};
use crate::mesh::{Measures, Mesh};
use crate::model::{Dynamics, Model, ModelContext};
use crate::scene::{Geometry, Scene, Source};

use super::Check;
use super::follow::Follower;
use super::interrupt::{Ending, Interrupt};
use super::load::{Loaded, load};
use super::notes::{self, Verdict, verdict};
use cost::Cost;

/// Time after which the construction of a model stops without `--full`, s. A check should answer within five seconds.
const PATIENCE: f64 = 3.0;

/// Largest number of unknowns for which matrices are assembled without `--full`: about one second of work.
const MOST_UNKNOWNS: f64 = 8e4;
/// Size of the largest mesh file that is read without `--full`, bytes: about one second of work.
const LARGEST_FILE: u64 = 8_000_000;

/// Shortest estimate of the time of `--full` that is shown, s.
const LEAST_OUTLOOK: f64 = 5.0;

/// Facts about a scene before it is run.
struct Report<'a> {
    scene: &'a Scene,
    /// The model, or the reason why there is none.
    model: std::result::Result<Model, String>,
    /// Mass of the body, kg.
    mass: Option<f64>,
    /// Measures of a mesh from a file.
    measures: Option<Measures>,
    plan: Option<Plan>,
    cost: Option<Cost>,
    warnings: Vec<String>,
    notes: Vec<String>,
}

/// Checks a scene and prints how it will be solved. Collective.
///
/// # Errors
/// If the scene is wrong, or if a PETSc call fails.
pub fn check(comm: &Comm, arguments: &Check) -> Result<()> {
    let begin = Instant::now();
    let Loaded { scene, source, .. } = load(comm, &arguments.scene)?;
    let deadline = (!arguments.full).then(|| begin + Duration::from_secs_f64(PATIENCE));
    let report = report(comm, (&scene, &source), deadline).map_err(|error| error.in_scene(&source))?;
    if comm.is_root() {
        if arguments.json { facts::print(&report) } else { text::print(&report) }
    }
    Ok(())
}

/// Collects the facts about a scene that can be found before a deadline. Collective.
fn report<'a>(comm: &Comm, (scene, source): (&'a Scene, &Source), deadline: Option<Instant>) -> Result<Report<'a>> {
    let bytes = mesh_bytes(comm, scene);
    let model = model(comm, scene, bytes, deadline)?;
    let mut report = Report {
        scene,
        model,
        mass: scene.body.mass(),
        measures: None,
        plan: scene.time.step.map(|step| Plan::Equal { step }),
        cost: None,
        warnings: Vec::new(),
        notes: Vec::new(),
    };
    match &mut report.model {
        Ok(model) => {
            report.measures = model.measures.take();
            match &mut model.dynamics {
                Dynamics::Modal(_) => report.cost = Some(Cost::modal()),
                Dynamics::Stepped(body) => {
                    let plan = Plan::new(scene, body, &ImpactParameters::new(&scene.impactor, body))?;
                    report.cost = Some(Cost::of_steps(scene, body, &plan)?);
                    report.plan = Some(plan);
                    if report.mass.is_none() {
                        report.mass = Some(mass(body)?);
                    }
                }
            }
        }
        Err(_) => {
            if bytes.is_some_and(|bytes| bytes <= LARGEST_FILE) {
                report.measures = Some(Mesh::new(comm, &scene.body)?.measures(&scene.impactor));
            }
        }
    }
    let of_volume =
        report.measures.as_ref().and_then(|measures| Some(scene.body.composition.density()? * measures.volume));
    report.mass = report.mass.or(of_volume);
    let footprint = report.model.as_ref().ok().map(|model| model.dynamics.footprint());
    if let Ok(model) = &report.model {
        report.notes.extend(notes::note_of_measure(model, scene));
        let estimate = model.error_before_steps();
        let is_elsewhere = scene.hit_near_clamped_edge().is_some();
        let of_largest = if is_elsewhere { f64::NAN } else { estimate.of_tension().stress };
        report.notes.extend(notes::of_tension(&estimate, scene, of_largest));
        report.notes.extend(notes::of_deflection(&estimate, scene));
        report.warnings.extend(verdict(model, scene).map(|Verdict { message, .. }| message));
        let faces = model.gauges.as_ref().map_or_else(Vec::new, |gauges| gauges.readout.face_names());
        report.warnings.extend(notes::missing_faces(scene, &faces).map(|remark| remark.text));
    }
    report.warnings.extend(notes::texts(notes::of_values(scene, source)));
    report.warnings.extend(notes::texts(notes::of_geometry(scene, report.measures.as_ref())));
    report.notes.splice(0..0, notes::texts(notes::notes(scene, footprint, report.plan.as_ref())));
    Ok(report)
}

/// Builds the model, or returns the reason why it was not built. Collective.
fn model(
    comm: &Comm,
    scene: &Scene,
    bytes: Option<u64>,
    deadline: Option<Instant>,
) -> Result<std::result::Result<Model, String>> {
    let interrupt = Rc::new(Interrupt::new(Ending::AtOnce));
    let mut follower = Follower::new(comm, interrupt.clone());
    if let Some(deadline) = deadline {
        follower = follower.until(deadline);
        if let Some(size) = too_large(scene, bytes) {
            return Ok(Err(format!("{size}, which takes more than a few seconds to look into: --full does it")));
        }
    }
    match Model::made(&ModelContext::new(comm, &follower), scene) {
        Err(Error::Interrupted) if !interrupt.is_raised(comm) => {
            // A check takes some seconds before it gives up, so that a shorter estimate is of no use.
            let outlook = follower.outlook().filter(|seconds| *seconds >= LEAST_OUTLOOK);
            let time = outlook.map_or(String::new(), |seconds| format!(" in about {seconds:.0} s"));
            Ok(Err(format!(
                "its choice and the estimates of errors take more than a few seconds: --full makes them{time}"
            )))
        }
        model => Ok(Ok(model?)),
    }
}

/// Size of the mesh file, bytes, as seen by rank 0, which alone reads it. `None` without a mesh file. Collective.
fn mesh_bytes(comm: &Comm, scene: &Scene) -> Option<u64> {
    let Geometry::Gmsh(path) = &scene.body.geometry else { return None };
    let mut bytes = if comm.is_root() { std::fs::metadata(path).map_or(0, |file| file.len()) } else { 0 };
    comm.mpi().process_at_rank(0).broadcast_into(&mut bytes);
    Some(bytes)
}

/// Reason why a scene is too large for a quick check; `None` if it is not.
fn too_large(scene: &Scene, bytes: Option<u64>) -> Option<String> {
    match &scene.body.geometry {
        Geometry::Gmsh(_) => {
            let large = bytes.filter(|bytes| *bytes > LARGEST_FILE);
            large.map(|bytes| format!("a mesh file of {:.0} MB", 1e-6 * bytes as f64))
        }
        Geometry::Box { is_given: true, .. } => {
            let unknowns = scene.body.grid_unknowns().filter(|unknowns| *unknowns > MOST_UNKNOWNS);
            unknowns.map(|unknowns| format!("about {unknowns:.1e} unknowns"))
        }
        Geometry::Box { .. } => None,
    }
}

/// Mass of a body of solid elements, kg. 1ᵀM1 counts it once for each component.
fn mass(body: &Body) -> Result<f64> {
    let mut ones = body.terms.load.duplicate()?;
    let mut product = body.terms.load.duplicate()?;
    ones.fill(1.0)?;
    body.mass.mult(&ones, &mut product)?;
    Ok(product.dot(&ones)? / 3.0)
}
