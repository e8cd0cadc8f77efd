//! `ricochet run --restart`: what is there of a run, and how it goes on.

use std::path::Path;

use petsc_wrap::Comm;

use crate::agree::agree;
use crate::error::{Error, Result};
use crate::impact::checkpoint::{Checkpoint, Visitor};
use crate::model::Simulation;
use crate::record::checkpoint::{Kept, beside};
use crate::record::episodes::Episodes;
use crate::record::provenance::Provenance;
use crate::record::read;
use crate::record::series::{Earlier, Points};
use crate::record::target::is_same;
use crate::scene::{self, Geometry, Output, Scene, Source};
use crate::space::evaluate::TensionMap;

use super::collect::{gathered, shared};
use super::keeping::Known;
use super::load::{changed, mesh_digest};
use super::summary::Summary;
use super::tell;

/// A run that is to go on.
pub enum Past {
    /// It came to its end: nothing is left to do.
    Complete,
    /// No checkpoint of it was kept.
    Beginning,
    /// It goes on from here.
    Moment(Box<Moment>),
}

/// What there is of a run, and its checkpoint.
pub struct Moment {
    origin: Provenance,
    kept: Kept,
}

impl Past {
    /// Reads what is left of the run of a scene whose result is at `result`, and which is to go on in `output`.
    ///
    /// # Errors
    /// [`Error::Io`] where that cannot be read; [`Error::Usage`] where it is of another scene.
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

/// Where a result comes from, whether it is complete, and otherwise its checkpoint.
fn there(result: &Path) -> Result<(Provenance, bool, Option<Kept>)> {
    let (origin, _, complete) = read::origin(result)?;
    let kept = if complete { None } else { Kept::read(result)? };
    if kept.as_ref().is_some_and(|kept| kept.run_id != origin.run_id) {
        return Err(Error::io(&beside(result), format!("is of another run than {}", result.display())));
    }
    Ok((origin, complete, kept))
}

/// Nothing is left to do of a complete run only where nothing else is wanted.
fn check_complete(
    origin: &Provenance,
    (result, output): (&Path, &Path),
    (scene, text): (&Scene, &str),
) -> std::result::Result<(), String> {
    let shown = result.display();
    let of_result = parsed(&shown.to_string(), &origin.scene, scene)?;
    let end = of_result.time.end;
    let mut same = of_result;
    same.time.end = scene.time.end;
    if same != *scene {
        return Err(format!(
            "{shown} is complete and of another scene ({}): without --restart this one is run anew",
            differing(&origin.scene, text, result)
        ));
    }
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

/// A run without a checkpoint is begun anew: it must be of the scene that is run, but for its end and what is written of it.
fn check_begun(origin: &Provenance, result: &Path, (scene, text): (&Scene, &str)) -> std::result::Result<(), String> {
    let shown = result.display();
    let mut same = parsed(&shown.to_string(), &origin.scene, scene)?;
    same.output = scene.output.clone();
    same.time.end = scene.time.end;
    if same != *scene {
        return Err(format!(
            "{shown} is of another scene ({}), and has no checkpoint: without --restart, --force replaces it",
            differing(&origin.scene, text, result)
        ));
    }
    Ok(())
}

/// The scene of a checkpoint must be the one that is run, but for its end and what is written of it.
fn check_scene(
    origin: &Provenance,
    kept: &Kept,
    result: &Path,
    (scene, text): (&Scene, &str),
) -> std::result::Result<(), String> {
    let shown = beside(result).display().to_string();
    let of_kept = parsed(&shown, &kept.scene, scene)?;
    let end = of_kept.time.end;
    let mut same = of_kept;
    same.output.every = scene.output.every;
    same.time.end = scene.time.end;
    if same != *scene {
        return Err(format!(
            "{shown} is of another scene ({}): only its end, its title and [output] but for probes and fields may change",
            differing(&kept.scene, text, result)
        ));
    }
    // Chosen steps may pass the end by one, so the same end is never too early.
    if scene.time.end < end && scene.time.end < kept.time * (1.0 - 1e-9) {
        return Err(format!("{shown} is at t = {:.6e} s, beyond the end at {:e} s", kept.time, scene.time.end));
    }
    check_mesh(origin, result, scene)
}

/// Which keys differ from those of a result's scene, in words.
fn differing(there: &str, now: &str, result: &Path) -> String {
    const FREE: [&str; 5] =
        ["title", "time.end", "output.every", "output.checkpoint_steps", "output.checkpoint_minutes"];
    let mut keys = scene::differences(there, now);
    keys.retain(|key| !FREE.contains(&key.as_str()));
    let show = format!("`ricochet info {} --scene` shows it", result.display());
    if keys.is_empty() { show } else { format!("other values of {}; {show}", keys.join(", ")) }
}

/// The scene of a text, with what makes no other run of it taken from `scene`.
fn parsed(name: &str, text: &str, scene: &Scene) -> std::result::Result<Scene, String> {
    let (mut there, _) = Scene::parse(name, text, &[]).map_err(|error| error.to_string())?;
    there.title.clone_from(&scene.title);
    // Probes and fields go on; what has not been read of the time before cannot be had any more.
    let Output { every, probes, fields, stress, .. } = there.output;
    there.output = Output { every, probes, fields, stress, ..scene.output.clone() };
    // Its path may be another one; what it holds is compared.
    if let (Geometry::Gmsh(_), Geometry::Gmsh(_)) = (&there.body.geometry, &scene.body.geometry) {
        there.body.geometry.clone_from(&scene.body.geometry);
    }
    Ok(there)
}

fn check_mesh(origin: &Provenance, result: &Path, scene: &Scene) -> std::result::Result<(), String> {
    if origin.mesh_digest == mesh_digest(scene) { Ok(()) } else { Err(changed(result, scene)) }
}

/// Sets a simulation to the moment; on rank 0 what there is of the series, and of the summary. Collective.
///
/// # Errors
/// [`Error::Output`] where checkpoint and series do not fit the simulation.
pub fn go_on(
    comm: &Comm,
    moment: Option<Box<Moment>>,
    (result, provenance, points): (&Path, &Provenance, &Points),
    impact: &mut Simulation,
) -> Result<Option<(Earlier, Summary)>> {
    let named = |why: String| format!("{}: {why}", beside(result).display());
    let past = moment.as_ref().map(|moment| {
        for note in differences(&moment.origin, provenance) {
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

/// What of the program and its options was another one when a result was computed.
fn differences(origin: &Provenance, now: &Provenance) -> Vec<String> {
    let of = |provenance: &Provenance| {
        let Provenance { version, commit, petsc_version, .. } = provenance;
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

/// What rank 0 has of the time before a checkpoint.
fn earlier(
    Moment { origin, kept }: &Moment,
    result: &Path,
    points: &Points,
    named: impl Fn(String) -> String,
) -> std::result::Result<(Earlier, Summary), String> {
    // The mass is not among what is carried: no impulse is computed of it before the next step.
    let episodes = Episodes::new(origin.impactor_mass);
    let mut known = Known { rows: 0, episodes, summary: Summary::default(), map: TensionMap::default() };
    let checkpoint: &Checkpoint = &kept.checkpoint;
    known.visit(&mut Visitor::restore(checkpoint)).map_err(|error| named(error.to_string()))?;
    let Known { rows, episodes, summary, map } = known;
    let mapped: usize = points.faces.map.faces.iter().map(Vec::len).sum();
    if !map.tension.is_empty() && map.tension.len() != mapped {
        return Err(named(format!("has tensions at {} points, and the body is read at {mapped}", map.tension.len())));
    }
    let read = || {
        let (columns, probes) = (read::rows(result, rows)?, read::probes(result, &points.probes, rows)?);
        let tensions = read::tensions(result, &points.faces.names, rows)?;
        Ok(Earlier { result: result.to_owned(), run_id: origin.run_id, columns, probes, tensions, map, episodes })
    };
    let earlier = read().map_err(|error: Error| error.to_string())?;
    Ok((earlier, summary))
}
