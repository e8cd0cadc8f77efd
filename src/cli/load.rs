//! A scene on all ranks: from its file, or from a result, which holds it.

use std::path::{Path, PathBuf};

use mpi::traits::{Communicator, Root};
use petsc_wrap::{Comm, options};

use crate::agree::{agree, broadcast};
use crate::error::{Error, Result};
use crate::record::provenance::{Provenance, digest};
use crate::record::read;
use crate::scene::{Geometry, Scene, Source};

/// Reads a scene on rank 0 and parses it on all, so that all of them get the same data or the same error. A result is the scene that it
/// was computed of, with its options for PETSc where no others are given. Collective.
///
/// # Errors
/// [`Error::Usage`] where the file cannot be read; [`Error::Scene`] where the scene is wrong.
pub fn load(comm: &Comm, path: &Path, overrides: &[String]) -> Result<(Scene, Source)> {
    if !is_result(comm, path) {
        let read = if comm.is_root() { Scene::text(path) } else { Ok(String::new()) };
        let text = agree(comm, read).map_err(Error::Usage)?;
        return Scene::from_text(path, &broadcast(comm, 0, text), overrides);
    }
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

/// Whether a file is a result, by its first bytes. Collective.
pub fn is_result(comm: &Comm, path: &Path) -> bool {
    const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";
    let mut found = false;
    if comm.is_root() {
        let mut first = [0; 8];
        let read = std::fs::File::open(path).and_then(|mut file| std::io::Read::read_exact(&mut file, &mut first));
        found = read.is_ok() && first == SIGNATURE;
    }
    comm.mpi().process_at_rank(0).broadcast_into(&mut found);
    found
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
