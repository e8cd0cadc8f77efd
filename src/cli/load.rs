//! A scene on all ranks: from its file, or from a result, which holds it.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use mpi::traits::{Communicator, Root};
use petsc_wrap::{Comm, options};

use crate::agree::{agree, broadcast};
use crate::error::{Error, Result};
use crate::record::provenance::{Provenance, digest};
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

/// Reads a scene on rank 0 and parses it on all, so that all of them get the same data or the same error. A result is the scene that it
/// was computed of, with its options for PETSc where no others are given; `-` is standard input. Collective.
///
/// # Errors
/// [`Error::Output`] where the file cannot be read; [`Error::Usage`] where it is no text; [`Error::Scene`] where the scene is wrong.
pub fn load(comm: &Comm, path: &Path, overrides: &[String]) -> Result<Loaded> {
    let given = if comm.is_root() { given(path) } else { Ok(None) };
    let bytes = agree(comm, given.map_err(|reason| format!("{}: {reason}", shown(path)))).map_err(Error::Output)?;
    let mut is_of_result = comm.is_root() && bytes.is_none();
    comm.mpi().process_at_rank(0).broadcast_into(&mut is_of_result);
    if is_of_result {
        let (scene, source) = of_result(comm, path, overrides)?;
        return Ok(Loaded { scene, source, is_of_result });
    }
    let text = bytes.map_or(Ok(String::new()), |bytes| Scene::decode(&shown(path), bytes));
    let text = broadcast(comm, 0, agree(comm, text).map_err(Error::Usage)?);
    let folder = path.parent().unwrap_or(Path::new(""));
    let (scene, source) = agreed(comm, Scene::within(&shown(path), folder, &text, overrides))?;
    Ok(Loaded { scene, source, is_of_result })
}

/// A scene where all ranks have it: the file of a table may be missing on some of their machines. Collective.
fn agreed(comm: &Comm, parsed: Result<(Scene, Source)>) -> Result<(Scene, Source)> {
    let mine = parsed.as_ref().map(|_| ()).map_err(ToString::to_string);
    let all = agree(comm, mine).map_err(Error::Usage);
    parsed.and_then(|found| all.map(|()| found))
}

/// What messages call a scene's file.
fn shown(path: &Path) -> String {
    if path == Path::new(STANDARD_INPUT) { "standard input".to_owned() } else { path.display().to_string() }
}

/// The bytes of a scene; `None` for a result, of which only the first are read. Read once: a pipe gives them once.
fn given(path: &Path) -> std::result::Result<Option<Vec<u8>>, String> {
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
fn of_result(comm: &Comm, path: &Path, overrides: &[String]) -> Result<(Scene, Source)> {
    let read = || read::provenance(path).map(Some).map_err(|error| error.to_string());
    let origin = agree(comm, if comm.is_root() { read() } else { Ok(None) }).map_err(Error::Output)?;
    let of = |text: fn(Provenance) -> String| broadcast(comm, 0, origin.clone().map(text).unwrap_or_default());
    let (text, given) = (of(|origin| origin.scene), of(|origin| origin.petsc_options));
    if words(&options::all(comm.session())?).next().is_none() {
        set_options(comm, &given)?;
    }
    let folder = PathBuf::from(of(|origin| origin.folder));
    let (scene, source) = Scene::within(&path.display().to_string(), &folder, &text, overrides)?;
    let wanted = of(|origin| origin.mesh_digest.unwrap_or_default());
    let there = if comm.is_root() { mesh_digest(&scene).unwrap_or_default() } else { wanted.clone() };
    let same = if there == wanted { Ok(()) } else { Err(changed(path, &scene)) };
    agree(comm, same).map_err(Error::Usage)?;
    Ok((scene, source))
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
    Some(format!("{:016x}", digest(&std::fs::read(path).ok()?)))
}

/// The words of options in one line, as PETSc lists them, but for the one that every session has.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split_whitespace().filter(|word| *word != "-no_signal_handler")
}

/// Sets options in one line.
fn set_options(comm: &Comm, line: &str) -> Result<()> {
    let mut words = words(line).peekable();
    while let Some(name) = words.next() {
        // A number may begin with a minus sign.
        let value = words.next_if(|word| !word.starts_with('-') || word.parse::<f64>().is_ok());
        options::set(comm.session(), name, value.unwrap_or_default())?;
    }
    Ok(())
}
