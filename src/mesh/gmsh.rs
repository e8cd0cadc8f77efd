//! Meshes from Gmsh files.

use std::path::Path;

use petsc_wrap::{Comm, GmshMesh, Plex};

use crate::error::Result;
use crate::scene::Fault;

/// Reads a file, of which each rank keeps its part. What is wrong with it reaches all ranks as one fault. Collective.
pub(super) fn read(comm: &Comm, path: &Path) -> Result<GmshMesh> {
    let fault = |message: String| {
        let help = "give the path, relative to the scene file, of a volume meshed and saved by Gmsh as MSH 2.2 or 4.1";
        Fault::new("body.mesh", format!("{}: {message}", path.display()), help)
    };
    Ok(Plex::gmsh(comm, path).map_err(|error| match error {
        petsc_wrap::Error::MeshFile { message, .. } => fault(message),
        petsc_wrap::Error::TooLarge { .. } | petsc_wrap::Error::Invalid { .. } => fault(error.to_string()),
        // What is still wrong stops one rank alone, inside the collective call: only then are the others aborted.
        petsc_wrap::Error::Petsc { message, .. } => fault(plain(&message)).on_one_rank(),
        other => fault(other.to_string()).on_one_rank(),
    })?)
}

/// What DMPlex says of a mesh, in the words of who has made it.
fn plain(message: &str) -> String {
    // In one rank's part, or between two.
    if message.contains("Could not find orientation") || message.contains("missing connection in point SF") {
        "two of its cells go round a face that they share in ways that do not fit: are nodes of one exchanged?"
            .to_owned()
    } else {
        format!("its cells do not fit together ({message})")
    }
}
