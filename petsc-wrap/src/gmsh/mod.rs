//! Reads meshes from Gmsh files; each rank keeps its part.

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
use walk::GmshReader;

/// A mesh from a Gmsh file.
pub struct GmshMesh {
    /// The mesh, distributed over the ranks.
    pub plex: Plex,
    /// Shape of all cells.
    pub shape: CellType,
    /// The physical surfaces that the file names, on every rank.
    pub surfaces: Vec<PhysicalGroup>,
    /// The physical volumes that the file names, on every rank.
    pub named_volumes: Vec<PhysicalGroup>,
    /// Number of regions of the cells, where two regions differ in their physical groups.
    pub volumes: usize,
    /// Number of parts of the mesh that share no node.
    pub parts: usize,
}

/// A physical group of faces or of cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhysicalGroup {
    /// The value of its faces in the label `Face Sets`, or of its cells in the label `Cell Sets`.
    pub number: Int,
    /// Name of the group.
    pub name: String,
}

impl Plex {
    /// Reads a mesh of first-order tetrahedra or hexahedra from a Gmsh file (2.2 or 4.1, text or binary) and
    /// distributes it over the ranks like [`Self::distribute`]. On one rank the cells are in the file's order.
    ///
    /// The label `Face Sets` has the value n on the faces of physical group n. In version 4.1 a face gets the values of
    /// all its groups, in version 2.2 only the first. The same holds for cells and the label `Cell Sets`.
    ///
    /// Every rank reads the whole file, piece by piece, checks it, and keeps an equal share of its elements, facets
    /// included. The cells of these shares form the mesh that is then distributed. Nobody may write to the file during
    /// the call. Collective.
    ///
    /// # Errors
    /// [`Error::MeshFile`], on all ranks, if the file does not exist or does not follow its format. If a PETSc call
    /// fails, on one rank alone, for hexahedra that do not fit together.
    pub fn gmsh(comm: &Comm, path: &Path) -> Result<GmshMesh> {
        let refused = |message: String| Error::MeshFile { path: path.to_owned(), message };
        let (ranks, rank) = (comm.size(), comm.rank());
        let file = File::open(path).map_err(|error| format!("cannot be read: {error}"));
        let read = file.and_then(|file| GmshReader::begin(file, comm.is_root())).and_then(|mut walk| {
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

    /// Labels cells and faces by their physical groups. `cells` are the cells of the mesh, in its order. Collective.
    fn label_groups(&self, walk: &mut GmshReader<File>, cells: Cells) -> std::result::Result<(), String> {
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

/// Returns the value if no rank has an error; otherwise, on every rank, the error of the lowest rank that has one.
/// Collective.
fn agree<T>(comm: &Comm, mine: std::result::Result<T, String>) -> std::result::Result<T, String> {
    let (rank, mut first) = (if mine.is_err() { comm.rank() } else { comm.size() }, 0);
    comm.mpi().all_reduce_into(&rank, &mut first, SystemOperation::min());
    if first == comm.size() {
        return mine;
    }
    let message = mine.err().filter(|_| rank == first).unwrap_or_default();
    let message = String::from_utf8_lossy(&comm.all_gather(message.as_bytes())).into_owned();
    // An error that all ranks see is reported by rank 0, without a rank number.
    Err(if first == 0 { message } else { format!("{message} (on rank {first})") })
}
