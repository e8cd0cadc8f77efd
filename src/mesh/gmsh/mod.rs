//! Meshes from Gmsh files: DMPlex reads them, after a look at what it would take on trust.

mod nodes;
mod walk;
mod words;

use std::path::Path;

use mpi::traits::{Communicator, Root};
use petsc_wrap::{Comm, Int, Plex, options};

use crate::agree::{agree, broadcast};
use crate::error::Result;
use crate::scene::Fault;

/// A physical surface: number and name.
pub(super) type Group = (Int, String);

/// PETSc's option to put a face into all sets of its tags, not the first one's alone.
const ALL_TAGS: &str = "-dm_plex_gmsh_multiple_tags";

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
    // By number, since PETSc's labels by name mix up dimensions, and in 2.2 take the geometric entity for a group.
    options::set_default(comm.session(), "-dm_plex_gmsh_use_regions", "0")?;
    // Cleared first, since the file before this one may have been of the other version.
    options::clear(comm.session(), ALL_TAGS)?;
    options::set_default(comm.session(), ALL_TAGS, if all_tags { "1" } else { "0" })?;
    // The mesh is what its cells are: surfaces that Gmsh has meshed alike stay two surfaces.
    options::set_default(comm.session(), "-dm_plex_gmsh_periodic", "0")?;
    // What is still wrong stops rank 0 alone, inside the collective call: only then are the others aborted.
    let plex = Plex::gmsh(comm, path).map_err(|error| match error {
        petsc_wrap::Error::Petsc { message, .. } => fault(message).on_one_rank(),
        other => fault(other.to_string()).on_one_rank(),
    })?;
    Ok((plex, groups.collect()))
}
