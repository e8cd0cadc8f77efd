//! Meshes from Gmsh files: DMPlex reads them, after a look at what it would take on trust.

mod nodes;
mod walk;
mod words;

use std::path::Path;

use mpi::traits::{Communicator, Root};
use petsc_wrap::{Comm, Int, Plex};

use crate::agree::{agree, broadcast};
use crate::error::Result;
use crate::scene::Fault;

/// A physical surface: number and name.
pub(super) type Group = (Int, String);

/// Reads a file through DMPlex, with its physical surfaces. Rank 0 looks first, so that what is wrong with it reaches all
/// ranks as one fault. Collective.
pub(super) fn read(comm: &Comm, path: &Path) -> Result<(Plex, Vec<Group>)> {
    let fault = |message: String| {
        let help = "give the path, relative to the scene file, of a volume meshed and saved by Gmsh as MSH 2.2 or 4.1";
        Fault::new("body.mesh", format!("{}: {message}", path.display()), help)
    };
    let looked = if comm.is_root() {
        let bytes = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"));
        bytes.and_then(|bytes| walk::look(&bytes)).map(Some)
    } else {
        Ok(None)
    };
    let contents = agree(comm, looked).map_err(fault)?;
    let (mut all_tags, mut names) = (false, String::new());
    if let Some(contents) = contents {
        all_tags = contents.all_tags;
        names = contents.surfaces.iter().map(|(number, name)| format!("{number} {name}\n")).collect();
    }
    comm.mpi().process_at_rank(0).broadcast_into(&mut all_tags);
    let names = broadcast(comm, 0, names);
    let groups = names
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter_map(|(n, name)| Some((n.parse().ok()?, name.to_owned())));
    // What is still wrong stops rank 0 alone, inside the collective call: only then are the others aborted.
    let plex = Plex::gmsh(comm, path, all_tags).map_err(|error| match error {
        petsc_wrap::Error::Petsc { message, .. } => fault(message).on_one_rank(),
        other => fault(other.to_string()).on_one_rank(),
    })?;
    Ok((plex, groups.collect()))
}
