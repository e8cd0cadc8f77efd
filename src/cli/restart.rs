//! `ricochet run --restart`: checks what exists of a run, and continues it.

use std::path::Path;

use petsc_wrap::Comm;

use crate::agree::agree;
use crate::error::{Error, Result};
use crate::impact::checkpoint::{Checkpoint, Visitor};
use crate::model::Simulation;
use crate::record::checkpoint::{StoredCheckpoint, beside};
use crate::record::provenance::{Origin, Provenance};
use crate::record::read;
use crate::record::series::{Earlier, Points};
use crate::record::target::is_same;
use crate::scene::{self, Geometry, Output, Scene, Source};

use super::checkpoint_writer::Known;
use super::collect::{gathered, shared};
use super::load::{changed, mesh_digest};
use super::summary::Summary;
use super::tell;

/// State of a run that is to be continued.
pub enum RestartState {
    /// The run is complete: nothing is left to do.
    Complete,
    /// The run has no checkpoint.
    Beginning,
    /// The run continues from this checkpoint.
    Moment(Box<Moment>),
}

/// Origin of a run, and its checkpoint.
pub struct Moment {
    origin: Provenance,
    kept: StoredCheckpoint,
}

impl RestartState {
    /// Reads the state of a run of a scene. Its result is at `result`, and it is to be continued in `output`.
    ///
    /// # Errors
    /// [`Error::Io`] if the files cannot be read; [`Error::Usage`] if they belong to another scene.
    pub fn read((result, output): (&Path, &Path), (scene, source): (&Scene, &Source)) -> Result<Self> {
        let (origin, is_complete, kept) = there(result)?;
        let text = source.text();
        Ok(match kept {
            _ if is_complete => {
                check_complete(&origin, (result, output), (scene, text)).map_err(Error::Usage)?;
                Self::Complete
            }
            None => {
                check_begun(&origin, result, (scene, text)).map_err(Error::Usage)?;
                Self::Beginning
            }
            Some(kept) => {
                check_scene(&origin, &kept, result, (scene, text)).map_err(Error::Usage)?;
                Self::Moment(Box::new(Moment { origin, kept }))
            }
        })
    }
}

/// Origin of a result, whether it is complete, and its checkpoint if it is not.
fn there(result: &Path) -> Result<(Provenance, bool, Option<StoredCheckpoint>)> {
    let (origin, _, complete) = read::origin(result)?;
    let kept = if complete { None } else { StoredCheckpoint::read(result)? };
    if kept.as_ref().is_some_and(|kept| kept.run_id != origin.run_id) {
        return Err(Error::io(&beside(result), format!("is of another run than {}", result.display())));
    }
    Ok((origin, complete, kept))
}

/// Refuses to continue a complete run if another scene, end or output is asked for.
fn check_complete(
    origin: &Provenance,
    (result, output): (&Path, &Path),
    (scene, text): (&Scene, &str),
) -> std::result::Result<(), String> {
    let shown = result.display();
    let of_result = parsed(&shown.to_string(), &origin.origin.scene, scene)?;
    let end = same_but_for_end(of_result, (scene, text), (result, &origin.origin.scene))
        .map_err(|other| format!("{shown} is complete and {other}: without --restart this one is run anew"))?;
    if end != scene.time.end {
        return Err(format!(
            "{shown} is complete, to its end at {end:e} s, and a complete run has no checkpoint: without --restart the scene is run anew to \
             another end"
        ));
    }
    check_mesh(origin, result, scene)?;
    if !is_same(result, output) {
        return Err(format!(
            "{shown} is complete: there is nothing to continue, and {} would be a copy of it",
            output.display()
        ));
    }
    Ok(())
}

/// A run without a checkpoint begins again. Its scene must be the same, except for the end and the output.
fn check_begun(origin: &Provenance, result: &Path, (scene, text): (&Scene, &str)) -> std::result::Result<(), String> {
    let shown = result.display();
    let of_result = parsed(&shown.to_string(), &origin.origin.scene, scene)?;
    let of_result = Scene { output: scene.output.clone(), ..of_result };
    same_but_for_end(of_result, (scene, text), (result, &origin.origin.scene))
        .map(|_| ())
        .map_err(|other| format!("{shown} is {other}, and has no checkpoint: without --restart, --force replaces it"))
}

/// The scene of a checkpoint must be the same, except for the end and parts of the output.
fn check_scene(
    origin: &Provenance,
    kept: &StoredCheckpoint,
    result: &Path,
    (scene, text): (&Scene, &str),
) -> std::result::Result<(), String> {
    let shown = beside(result).display().to_string();
    let mut of_kept = parsed(&shown, &kept.scene, scene)?;
    of_kept.output.every = scene.output.every;
    let end = same_but_for_end(of_kept, (scene, text), (result, &kept.scene)).map_err(|other| {
        format!("{shown} is {other}: only its end, its title and [output] but for probes and fields may change")
    })?;
    // With controlled steps, the run may pass the end by one step. Therefore the same end is always accepted.
    if scene.time.end < end && scene.time.end < kept.time * (1.0 - 1e-9) {
        return Err(format!("{shown} is at t = {:.6e} s, beyond the end at {:e} s", kept.time, scene.time.end));
    }
    check_mesh(origin, result, scene)
}

/// The end of a stored scene, s, if it is otherwise the same as `scene`; else text that says how they differ. `text` and
/// `there` are their texts.
fn same_but_for_end(
    mut stored: Scene,
    (scene, text): (&Scene, &str),
    (result, there): (&Path, &str),
) -> std::result::Result<f64, String> {
    let end = std::mem::replace(&mut stored.time.end, scene.time.end);
    if stored == *scene { Ok(end) } else { Err(format!("of another scene ({})", differing(there, text, result))) }
}

/// Text that names the keys whose values differ from the scene of a result.
fn differing(there: &str, now: &str, result: &Path) -> String {
    const FREE: [&str; 5] =
        ["title", "time.end", "output.every", "output.checkpoint_steps", "output.checkpoint_minutes"];
    let mut keys = scene::differences(there, now);
    keys.retain(|key| !FREE.contains(&key.as_str()));
    let show = format!("`ricochet info {} --scene` shows it", result.display());
    if keys.is_empty() { show } else { format!("other values of {}; {show}", keys.join(", ")) }
}

/// The scene of a text, with all values that do not change the run taken from `scene`.
fn parsed(name: &str, text: &str, scene: &Scene) -> std::result::Result<Scene, String> {
    let (mut there, _) = Scene::parse(name, text, &[]).map_err(|error| error.to_string())?;
    there.title.clone_from(&scene.title);
    // Probes, fields and stresses must stay the same: values that were not recorded before the checkpoint are lost.
    let Output { every, probes, fields, stress, .. } = there.output;
    there.output = Output { every, probes, fields, stress, ..scene.output.clone() };
    // The mesh file may have moved. Its contents are compared separately.
    if let (Geometry::Gmsh(_), Geometry::Gmsh(_)) = (&there.body.geometry, &scene.body.geometry) {
        there.body.geometry.clone_from(&scene.body.geometry);
    }
    Ok(there)
}

fn check_mesh(origin: &Provenance, result: &Path, scene: &Scene) -> std::result::Result<(), String> {
    if origin.mesh_digest == mesh_digest(scene) { Ok(()) } else { Err(changed(result, scene)) }
}

/// Sets a simulation to the state of a checkpoint. On rank 0, returns the earlier rows of the series and the summary.
/// Collective.
///
/// # Errors
/// [`Error::Output`] if the checkpoint and the series do not fit the simulation.
pub fn go_on(
    comm: &Comm,
    moment: Option<Box<Moment>>,
    (result, provenance, points): (&Path, &Provenance, &Points),
    impact: &mut Simulation,
) -> Result<Option<(Earlier, Summary)>> {
    let named = |why: String| format!("{}: {why}", beside(result).display());
    let past = moment.as_ref().map(|moment| {
        for note in differences(&moment.origin.origin, &provenance.origin) {
            tell(format_args!("note: {} {note}", result.display()));
        }
        earlier(moment, result, points, named)
    });
    let past = agree(comm, past.transpose()).map_err(Error::Output)?;
    let mine = impact.nodes();
    let nodes = mine.map(|nodes| gathered(comm, nodes.as_flattened()).as_chunks().0.to_vec());
    let whole = moment.map(|moment| moment.kept.at(nodes.as_deref()));
    let wrong = |why| named(format!("does not go on this body: {why}"));
    let whole = agree(comm, whole.transpose().map_err(wrong)).map_err(Error::Output)?;
    let part = shared(comm, whole, mine.map(|nodes| 3 * nodes.len()));
    let resumed = match impact.resume(&part) {
        Err(Error::Output(why)) => Err(named(why)),
        other => Ok(other?),
    };
    agree(comm, resumed).map_err(Error::Output)?;
    Ok(past)
}

/// Notes on differences in the versions and the options between an earlier run and now.
fn differences(origin: &Origin, now: &Origin) -> Vec<String> {
    let of = |origin: &Origin| {
        let Origin { version, commit, petsc_version, .. } = origin;
        format!("ricochet {version} ({commit}) and PETSc {petsc_version}")
    };
    let mut all = Vec::new();
    if of(origin) != of(now) {
        all.push(format!("was begun by {}", of(origin)));
    }
    if origin.petsc_options != now.petsc_options {
        all.push(format!("was begun with other options for PETSc: {:?}", origin.petsc_options));
    }
    all
}

/// Series and summary of the time before a checkpoint, on rank 0.
fn earlier(
    Moment { origin, kept }: &Moment,
    result: &Path,
    points: &Points,
    named: impl Fn(String) -> String,
) -> std::result::Result<(Earlier, Summary), String> {
    let mut known = Known::default();
    let checkpoint: &Checkpoint = &kept.checkpoint;
    known.visit(&mut Visitor::restore(checkpoint)).map_err(|error| named(error.to_string()))?;
    let Known { rows, episodes, summary, map } = known;
    let mapped: usize = points.faces.map.faces.iter().map(Vec::len).sum();
    if !map.tension.is_empty() && map.tension.len() != mapped {
        return Err(named(format!("has tensions at {} points, and the body is read at {mapped}", map.tension.len())));
    }
    let rows = read::Rows::read(result, points, rows).map_err(|error| error.to_string())?;
    Ok((Earlier { result: result.to_owned(), run_id: origin.run_id, rows, map, episodes }, summary))
}
