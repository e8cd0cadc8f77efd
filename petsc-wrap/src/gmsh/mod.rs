//! Reads meshes from Gmsh files.

mod file;
mod nodes;
mod tokens;

use std::collections::BTreeSet;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Error, Result};
use crate::plex::{CellType, LabelledPoint, Plex};

use file::GmshFile;
use nodes::count_parts;

/// A mesh from a Gmsh file.
pub struct GmshMesh {
    /// The mesh, distributed over the ranks.
    pub plex: Plex,
    /// Shape of all cells.
    pub shape: CellType,
    /// The physical surfaces of the file, on every rank.
    pub surfaces: Vec<PhysicalGroup>,
    /// The physical volumes of the file, on every rank.
    pub named_volumes: Vec<PhysicalGroup>,
    /// Number of regions of the cells, where two regions differ in their physical groups.
    pub volumes: usize,
    /// Number of parts of the mesh that share no node.
    pub parts: usize,
}

/// A physical group of faces or of cells, or all groups of one name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhysicalGroup {
    /// The value of its faces in the label `Face Sets`, or of its cells in the label `Cell Sets`.
    pub number: Int,
    /// Name of the group; the number of a group without a name.
    pub name: String,
}

impl Plex {
    /// Reads a mesh of first-order tetrahedra or hexahedra from a Gmsh file (2.2 or 4.1, text or binary) and
    /// distributes it over the ranks like [`Self::distribute`]. On one rank the cells are in the file's order.
    ///
    /// The label `Face Sets` has the value n on the faces of physical group n. Groups of the same name are one group,
    /// with the number of the first of them. A face gets the values of all its groups. The same holds for cells and the
    /// label `Cell Sets`.
    ///
    /// Rank 0 reads the file and checks it. Nobody may write to the file during the call. Collective.
    ///
    /// # Errors
    /// [`Error::MeshFile`], on all ranks, if the file does not exist or does not follow its format. If a PETSc call
    /// fails, on one rank alone, for hexahedra whose faces do not match.
    pub fn gmsh(comm: &Comm, path: &Path) -> Result<GmshMesh> {
        let refused = |message: String| Error::MeshFile { path: path.to_owned(), message };
        let read = || {
            let file = File::open(path).map_err(|error| format!("cannot be read: {error}"))?;
            GmshFile::parse(BufReader::with_capacity(1 << 18, file))
        };
        let file = on_root(comm, || read().map(Some)).map_err(refused)?.unwrap_or_default();
        let shape = if file.cells.counts[0] > 0 { CellType::Tetrahedron } else { CellType::Hexahedron };
        let corners = if shape == CellType::Tetrahedron { 4 } else { 8 };
        let sets: BTreeSet<usize> = file.cells.set_of.iter().copied().collect();
        let volumes = sets.into_iter().filter(|set| !file.cells.sets[*set].is_empty()).count();
        let parts = count_parts(file.nodes.coordinates.len(), file.cells.vertices.chunks(corners));
        let mut numbers = [usize::from(shape == CellType::Tetrahedron) as f64, volumes as f64, parts as f64];
        comm.broadcast_from_root(&mut numbers);
        let shape = if numbers[0] == 1.0 { CellType::Tetrahedron } else { CellType::Hexahedron };
        let [surfaces, named_volumes] = [0, 1].map(|i| file.groups[i].clone()).map(|groups| share(comm, groups));
        let plex = Self::from_cells(comm, shape, &file.cells.vertices, &file.nodes.coordinates)?;
        // Labels are distributed if every rank has them.
        plex.label("Cell Sets", [])?;
        plex.label("Face Sets", [])?;
        on_root(comm, || plex.label_groups(&file)).map_err(refused)?;
        drop(file);
        let [volumes, parts] = [numbers[1] as usize, numbers[2] as usize];
        Ok(GmshMesh { plex: plex.distribute()?, shape, surfaces, named_volumes, volumes, parts })
    }

    /// Labels the cells and faces of this rank by their physical groups. This rank has the whole mesh.
    fn label_groups(&self, file: &GmshFile) -> std::result::Result<(), String> {
        let told = |error: Error| error.to_string();
        let labelled = |point: Int, groups: &BTreeSet<Int>| -> Vec<LabelledPoint> {
            groups.iter().map(|value| LabelledPoint { point, value: *value }).collect()
        };
        let cells = self.points(3).map_err(told)?.enumerate();
        let labels = cells.flat_map(|(i, cell)| labelled(cell, file.cells.groups(i)));
        self.label("Cell Sets", labels).map_err(told)?;
        // The mesh's vertices are the nodes of cells.
        let mut vertices = file.cells.vertices.clone();
        vertices.sort_unstable();
        vertices.dedup();
        let first = self.points(0).map_err(told)?.start;
        let (mut labels, mut is_found) = (Vec::new(), vec![false; file.facets.set_of.len()]);
        for face in self.points(2).map_err(told)? {
            let mut corners = Vec::with_capacity(8);
            for edge in self.cone(face).map_err(told)? {
                corners.extend(self.cone(*edge).map_err(told)?.iter().map(|point| vertices[(point - first) as usize]));
            }
            corners.sort_unstable();
            corners.dedup();
            if let Some(i) = file.facets.find(&corners) {
                is_found[i] = true;
                labels.extend(labelled(face, file.facets.groups(i)));
            }
        }
        if let Some(i) = is_found.iter().position(|is_found| !is_found) {
            let groups = file.facets.groups(i);
            let names = file.groups[0].iter().filter(|group| groups.contains(&group.number));
            let names: Vec<String> = names.map(|group| format!(" of the surface {:?}", group.name)).collect();
            return Err(format!("a face{} is not a face of any cell", names.join(" and")));
        }
        self.label("Face Sets", labels).map_err(told)
    }
}

/// Groups of rank 0, on every rank. Collective.
fn share(comm: &Comm, groups: Vec<PhysicalGroup>) -> Vec<PhysicalGroup> {
    let numbers: Vec<i64> = groups.iter().map(|group| group.number as i64).collect();
    // A name is on one line.
    let names: String = groups.iter().map(|group| group.name.clone() + "\n").collect();
    let (numbers, names) = (comm.all_gather(&numbers), comm.all_gather(names.as_bytes()));
    let names = String::from_utf8_lossy(&names).into_owned();
    numbers
        .iter()
        .zip(names.lines())
        .map(|(n, name)| PhysicalGroup { number: *n as Int, name: name.to_owned() })
        .collect()
}

/// Does something on rank 0; the other ranks get the default value. An error is returned on every rank. Collective.
fn on_root<T: Default>(
    comm: &Comm,
    action: impl FnOnce() -> std::result::Result<T, String>,
) -> std::result::Result<T, String> {
    let done = if comm.is_root() { action() } else { Ok(T::default()) };
    let message = comm.all_gather(done.as_ref().err().map_or(&[][..], |message| message.as_bytes()));
    if message.is_empty() { done } else { Err(String::from_utf8_lossy(&message).into_owned()) }
}
