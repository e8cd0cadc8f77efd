//! A scene on all ranks: from its file, or from a result, which holds it.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use petsc_wrap::{Comm, options};
use serde::{Deserialize, Serialize};

use crate::agree::decided;
use crate::error::{Error, Result};
use crate::record::provenance::digest_of_file;
use crate::record::read;
use crate::scene::{Geometry, Scene, Source};

/// The name that stands for standard input.
pub const STANDARD_INPUT: &str = "-";

/// A scene as it was given.
pub struct Loaded {
    /// What is to be solved.
    pub scene: Scene,
    /// Its text.
    pub source: Source,
    /// Whether it was taken from a result.
    pub is_of_result: bool,
}

/// What rank 0 reads.
#[derive(Serialize, Deserialize)]
struct Given {
    source: Source,
    is_of_result: bool,
    /// The options for PETSc of a result.
    petsc_options: Option<String>,
}

/// Reads a scene, with all files that it names but its mesh, on rank 0, so that all ranks get the same data or the same error. A result
/// is the scene that it was computed of, with its options for PETSc where no others are given; `-` is standard input. Collective.
///
/// # Errors
/// [`Error::Output`] where the file cannot be read; [`Error::Usage`] where it is no text; [`Error::Scene`] where the scene is wrong.
pub fn load(comm: &Comm, path: &Path, overrides: &[String]) -> Result<Loaded> {
    let Given { source, is_of_result, petsc_options } = decided(comm, || given(path, overrides))?;
    if let Some(given) = petsc_options
        && options::all(comm.session())?.is_empty()
    {
        set_options(comm, &given)?;
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
    Ok(Given { source, is_of_result: false, petsc_options: None })
}

/// What messages call a scene's file.
fn shown(path: &Path) -> String {
    if path == Path::new(STANDARD_INPUT) { "standard input".to_owned() } else { path.display().to_string() }
}

/// The bytes of a scene; `None` for a result, of which only the first are read. Read once: a pipe gives them once.
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
        input.read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    };
    read().map_err(|error: io::Error| format!("the scene cannot be read: {error}"))
}

/// The scene of a result.
fn of_result(path: &Path, overrides: &[String]) -> Result<Given> {
    let origin = read::provenance(path)?;
    let folder = PathBuf::from(origin.folder);
    let (scene, source) = Scene::within(&path.display().to_string(), &folder, &origin.scene, overrides)?;
    if mesh_digest(&scene).unwrap_or_default() != origin.mesh_digest.unwrap_or_default() {
        return Err(Error::Usage(changed(path, &scene)));
    }
    Ok(Given { source, is_of_result: true, petsc_options: Some(origin.petsc_options) })
}

/// That a scene's mesh is not that of a result.
pub fn changed(path: &Path, scene: &Scene) -> String {
    let mesh = match &scene.body.geometry {
        Geometry::Gmsh(mesh) => mesh.display().to_string(),
        Geometry::Box { .. } => String::new(),
    };
    format!("the mesh {mesh} is missing or is not the one that {} was computed on", path.display())
}

/// Digest of a scene's mesh file, as far as there is one that can be read.
pub fn mesh_digest(scene: &Scene) -> Option<String> {
    let Geometry::Gmsh(path) = &scene.body.geometry else { return None };
    Some(format!("{:016x}", digest_of_file(path).ok()?))
}

/// Sets options in one line, as PETSc lists them.
fn set_options(comm: &Comm, line: &str) -> Result<()> {
    let mut words = line.split_whitespace().peekable();
    while let Some(name) = words.next() {
        // A number may begin with a minus sign.
        let value = words.next_if(|word| !word.starts_with('-') || word.parse::<f64>().is_ok());
        options::set(comm.session(), name, value.unwrap_or_default())?;
    }
    Ok(())
}
