//! Meshes from Gmsh files, of which each rank keeps its part.

mod facets;
mod nodes;
mod share;
mod walk;
mod words;

use std::fs::File;
use std::path::Path;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Error, Result};
use crate::plex::{CellType, LabelledPoint, Plex};

use facets::Facets;
use share::{Cells, Share};
use walk::Walk;

/// A mesh from a Gmsh file.
pub struct GmshMesh {
    /// The mesh, spread over the ranks.
    pub plex: Plex,
    /// Shape of all its cells.
    pub shape: CellType,
    /// The physical surfaces that the file names, on every rank.
    pub surfaces: Vec<PhysicalGroup>,
    /// The physical volumes that the file names, on every rank.
    pub named_volumes: Vec<PhysicalGroup>,
    /// How many regions the cells are in that differ in their physical groups.
    pub volumes: usize,
    /// How many parts the cells make that share no node.
    pub parts: usize,
}

/// A physical group of faces or of cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhysicalGroup {
    /// The value of its faces in the label `Face Sets`, or of its cells in the label `Cell Sets`.
    pub number: Int,
    /// Its name.
    pub name: String,
}

impl Plex {
    /// A mesh of tetrahedra or of hexahedra, of first order, from a Gmsh file (2.2 or 4.1, text or binary), spread over the ranks as by
    /// [`Self::distribute`]; on one rank its cells are in the file's order.
    ///
    /// The faces of physical group n have the value n of the label `Face Sets`, in files of version 4.1 for every group that they are in, in
    /// those of 2.2 for the first. So have cells in the label `Cell Sets`.
    ///
    /// Every rank reads the file, piece by piece, checks it and keeps a part of as many elements as the others', facets among them; the cells
    /// of these parts are the mesh that is distributed. Nobody may write to the file meanwhile. Collective.
    ///
    /// # Errors
    /// [`Error::MeshFile`], on all ranks, for a file that is not there or does not keep what its format promises. PETSc's, on one rank alone, where
    /// hexahedra do not fit together.
    pub fn gmsh(comm: &Comm, path: &Path) -> Result<GmshMesh> {
        let refused = |message: String| Error::MeshFile { path: path.to_owned(), message };
        let (ranks, rank) = (comm.size(), comm.rank());
        let file = File::open(path).map_err(|error| format!("cannot be read: {error}"));
        let read = file.and_then(|file| Walk::begin(file, comm.is_root())).and_then(|mut walk| {
            let share = Share::take(&mut walk, ranks, rank)?;
            Ok((walk, share))
        });
        let (mut walk, mut share) = agree(comm, read).map_err(refused)?;
        let digests = comm.all_gather(&[walk.words.digest()]);
        let is_same = digests.iter().all(|digest| *digest == digests[0]);
        agree(comm, is_same.then_some(()).ok_or_else(|| "ranks read different files of this name".to_owned()))
            .map_err(refused)?;
        let shape = share.shape();
        let cells = std::mem::take(&mut share.cells);
        let plex = Self::from_cells(comm, shape, &cells.vertices, &share.places)?;
        drop(share.places);
        plex.label_groups(&mut walk, cells).map_err(refused)?;
        let plex = plex.distribute()?;
        let (mut parts, [surfaces, named_volumes]) = (0, walk.named);
        comm.mpi().all_reduce_into(&share.parts, &mut parts, SystemOperation::max());
        Ok(GmshMesh { plex, shape, surfaces, named_volumes, volumes: share.volumes, parts })
    }

    /// Labels cells, which are the mesh's in their order, and faces by their physical groups. Collective.
    fn label_groups(&self, walk: &mut Walk<File>, cells: Cells) -> std::result::Result<(), String> {
        let Cells { mut vertices, regions } = cells;
        vertices.sort_unstable();
        vertices.dedup();
        let told = |error: Error| error.to_string();
        let first_vertex = agree(self.comm(), self.points(0).map_err(told))?.start;
        let facets = agree(self.comm(), Facets::read(walk, &vertices, first_vertex))?;
        let labelled = |dimension: usize, point: Int, region: &i32| -> Vec<LabelledPoint> {
            let groups = walk.groups(dimension, region).iter();
            groups.map(|group| LabelledPoint { point, value: Int::from(*group) }).collect()
        };
        let cell_points = agree(self.comm(), self.points(3).map_err(told))?;
        let cells = cell_points.zip(&regions).flat_map(|(cell, region)| labelled(3, cell, region));
        let mut faces = Vec::new();
        let found = facets.find(self, |face, region| faces.extend(labelled(2, face, &region)));
        let labels = self.label("Cell Sets", cells).and_then(|()| self.label("Face Sets", faces)).map_err(told);
        agree(self.comm(), labels)?;
        match agree(self.comm(), found.map_err(told))? {
            true => Ok(()),
            false => Err("a surface has a face that is none of any cell".to_owned()),
        }
    }
}

/// The value where no rank has an error; otherwise the error of the lowest rank that has one, on every rank. Collective.
fn agree<T>(comm: &Comm, mine: std::result::Result<T, String>) -> std::result::Result<T, String> {
    let (rank, mut first) = (if mine.is_err() { comm.rank() } else { comm.size() }, 0);
    comm.mpi().all_reduce_into(&rank, &mut first, SystemOperation::min());
    if first == comm.size() {
        return mine;
    }
    let message = mine.err().filter(|_| rank == first).unwrap_or_default();
    let message = String::from_utf8_lossy(&comm.all_gather(message.as_bytes())).into_owned();
    // Of what all ranks see rank 0 tells.
    Err(if first == 0 { message } else { format!("{message} (on rank {first})") })
}
