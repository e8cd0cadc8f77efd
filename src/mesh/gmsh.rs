//! Meshes from Gmsh files.

use std::path::Path;

use petsc_wrap::{Comm, GmshMesh, Plex};

use crate::error::Result;
use crate::scene::Fault;

/// Reads a mesh file and distributes the mesh over the ranks. Errors in the file are reported on all ranks as one
/// fault. Collective.
pub(super) fn read(comm: &Comm, path: &Path) -> Result<GmshMesh> {
    let fault = |message: String| {
        let help = "give the path, relative to the scene file, of a volume meshed and saved by Gmsh as MSH 2.2 or 4.1";
        Fault::new("body.mesh", format!("{}: {message}", path.display()), help)
    };
    Ok(Plex::gmsh(comm, path).map_err(|error| match error {
        petsc_wrap::Error::MeshFile { message, .. } => fault(message),
        petsc_wrap::Error::TooLarge { .. } | petsc_wrap::Error::Invalid { .. } => fault(error.to_string()),
        // Other errors occur on one rank only, inside the collective call; then the other ranks are aborted.
        petsc_wrap::Error::Petsc { message, .. } => fault(plain(&message)).on_one_rank(),
        other => fault(other.to_string()).on_one_rank(),
    })?)
}

/// Translates a message of DMPlex about a mesh into terms that the author of the mesh understands.
fn plain(message: &str) -> String {
    // The first message is about one rank's part, the second about the interface of two parts.
    if message.contains("Could not find orientation") || message.contains("missing connection in point SF") {
        "two of its cells go round a face that they share in ways that do not fit: are nodes of one exchanged?"
            .to_owned()
    } else {
        format!("its cells do not fit together ({message})")
    }
}
