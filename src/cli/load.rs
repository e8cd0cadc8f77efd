//! Reads a scene on all ranks, from its file or from a result that contains it.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use petsc_wrap::{Comm, options};
use serde::{Deserialize, Serialize};

use crate::agree::decided;
use crate::error::{Error, Result};
use crate::record::provenance::{Provenance, digest_of_file};
use crate::record::read;
use crate::scene::{Geometry, Scene, Source};

use super::SceneArguments;

/// File name that stands for standard input.
pub const STANDARD_INPUT: &str = "-";

/// Size from which on a file is no scene, bytes.
const LARGEST: u64 = 4 << 20;

/// A scene and its origin.
pub struct Loaded {
    /// The scene after all overrides.
    pub scene: Scene,
    /// Text of the scene.
    pub source: Source,
    /// Whether the scene was taken from a result.
    pub is_of_result: bool,
}

/// Data that rank 0 reads and sends to the other ranks.
#[derive(Serialize, Deserialize)]
struct Given {
    source: Source,
    is_of_result: bool,
    stored_options: String,
}

/// Reads a scene, with all files that it names except the mesh, on rank 0. All ranks get the same data or the same
/// error. For a result, its scene is used; its options for PETSc are used if they are asked for, else only named. `-` is standard
/// input. Collective.
///
/// # Errors
/// [`Error::Output`] if the file cannot be read; [`Error::Usage`] if it is not text, or if options are to be used and the scene
/// is not from a result; [`Error::Scene`] if the scene is wrong.
pub fn load(comm: &Comm, arguments: &SceneArguments) -> Result<Loaded> {
    let SceneArguments { file: path, overrides, stored_options: is_applied, .. } = arguments;
    let Given { source, is_of_result, stored_options } = decided(comm, || given(path, overrides))?;
    match *is_applied {
        true if !is_of_result => {
            return Err(Error::Usage(format!(
                "--stored-options: {} is a scene, not a result, and has none",
                shown(path)
            )));
        }
        true => set_options(comm, &stored_options)?,
        // Such an option may write to any file, and a result may come from somebody else.
        false if !stored_options.is_empty() && comm.is_root() => tracing::warn!(
            "{} was made with options for PETSc, which are not applied: {stored_options} (`--stored-options` applies them)",
            shown(path)
        ),
        false => {}
    }
    let (scene, source) = Scene::checked(source)?;
    Ok(Loaded { scene, source, is_of_result })
}

fn given(path: &Path, overrides: &[String]) -> Result<Given> {
    let wrong = |reason: String| Error::Output(format!("{}: {reason}", shown(path)));
    let Some(bytes) = bytes(path).map_err(wrong)? else { return of_result(path, overrides) };
    let text = Scene::decode(&shown(path), bytes).map_err(Error::Usage)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let (_, source) = Scene::within(&shown(path), folder, &text, overrides)?;
    Ok(Given { source, is_of_result: false, stored_options: String::new() })
}

/// Name of a scene's file in messages.
fn shown(path: &Path) -> String {
    if path == Path::new(STANDARD_INPUT) { "standard input".to_owned() } else { path.display().to_string() }
}

/// Bytes of a scene; `None` for a result: then only the first bytes are read. The file is opened once, because a
/// pipe can be read only once.
fn bytes(path: &Path) -> std::result::Result<Option<Vec<u8>>, String> {
    const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
    let read = || {
        let mut input: Box<dyn Read> =
            if path == Path::new(STANDARD_INPUT) { Box::new(io::stdin()) } else { Box::new(File::open(path)?) };
        let mut bytes = Vec::new();
        input.by_ref().take(SIGNATURE.len() as u64).read_to_end(&mut bytes)?;
        if bytes == SIGNATURE {
            let is_file = std::fs::metadata(path).is_ok_and(|there| there.is_file());
            return if is_file { Ok(None) } else { Err(io::Error::other("a result cannot be read from a pipe")) };
        }
        input.take(LARGEST).read_to_end(&mut bytes)?;
        if bytes.len() as u64 >= LARGEST {
            return Err(io::Error::other(format!("it has more than {} MB", LARGEST >> 20)));
        }
        Ok(Some(bytes))
    };
    read().map_err(|error: io::Error| format!("the scene cannot be read: {error}"))
}

/// The scene of a result.
fn of_result(path: &Path, overrides: &[String]) -> Result<Given> {
    let Provenance { origin, folder, mesh_digest: digest, .. } = read::provenance(path)?;
    let (scene, source) = Scene::within(&path.display().to_string(), Path::new(&folder), &origin.scene, overrides)?;
    if mesh_digest(&scene).unwrap_or_default() != digest.unwrap_or_default() {
        return Err(Error::Usage(changed(path, &scene)));
    }
    Ok(Given { source, is_of_result: true, stored_options: origin.petsc_options })
}

/// Message for a scene whose mesh is not the one of a result.
pub fn changed(path: &Path, scene: &Scene) -> String {
    let mesh = match &scene.body.geometry {
        Geometry::Gmsh(mesh) => mesh.display().to_string(),
        Geometry::Box { .. } => String::new(),
    };
    format!("the mesh {mesh} is missing or is not the one that {} was computed on", path.display())
}

/// Digest of a scene's mesh file, if there is one and it can be read.
pub fn mesh_digest(scene: &Scene) -> Option<String> {
    let Geometry::Gmsh(path) = &scene.body.geometry else { return None };
    Some(format!("{:016x}", digest_of_file(path).ok()?))
}

/// Sets options for PETSc given in one line, in PETSc's own format.
///
/// # Errors
/// If PETSc does not start, or refuses an option.
fn set_options(comm: &Comm, line: &str) -> Result<()> {
    let mut words = line.split_whitespace().peekable();
    while let Some(name) = words.next() {
        // A number may begin with a minus sign.
        let value = words.next_if(|word| !word.starts_with('-') || word.parse::<f64>().is_ok());
        options::set(comm.session(), name, value.unwrap_or_default())?;
    }
    Ok(())
}
