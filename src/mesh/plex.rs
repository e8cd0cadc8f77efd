//! Creation of a [`Mesh`] from the geometry of a scene: a file, read through DMPlex, or a box.

use std::collections::BTreeMap;
use std::path::Path;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{CellType, Comm, GmshMesh, PhysicalGroup, Plex};

use crate::element::Shape;
use crate::error::Result;
use crate::scene::{Body, Fault, Geometry, Parts, is_name_of_result};

use super::checks::check_untangled;
use super::gmsh;
use super::grid::Grid;
use super::lattice::BoxPart;
use super::part::{BOUNDARY, Mark, RankPart};
use super::{Elements, Mesh};

/// DMPlex's label of the cells in physical groups, whose value is the number of the group.
const CELLS: &str = "Cell Sets";

/// Name of the stresses at the edge of the contact in results, beside those on surfaces.
const RING: &str = "ring";

impl Mesh {
    /// Creates or reads the mesh and distributes it over the ranks. Collective.
    ///
    /// # Errors
    /// If a mesh file cannot be used (a fault of `body.mesh`, the same on all ranks), or if a PETSc call fails.
    pub fn new(comm: &Comm, body: &Body) -> Result<Self> {
        match &body.geometry {
            Geometry::Box { planes, .. } => {
                let grid = Grid::new(planes, &body.symmetry);
                let BoxPart { cells, facets, owned_nodes } = grid.part(comm, body.order)?;
                let (facets, mirror_nodes) = grid.cut(&facets);
                let surfaces = grid.surfaces(&facets);
                let parts_of_cells = of_layers(&body.composition.interfaces(), &cells);
                let mesh = Self::collect(comm, owned_nodes, cells, facets, surfaces);
                Ok(Self { mirror_nodes, parts_of_cells, multiplicity: grid.multiplicity(), ..mesh })
            }
            Geometry::Gmsh(path) => {
                let GmshMesh { plex, shape, surfaces: groups, named_volumes, volumes, parts } = gmsh::read(comm, path)?;
                if volumes > 1 && !matches!(body.composition.parts, Parts::Volumes(_)) {
                    let message = format!(
                        "{}: it has {volumes} physical volumes, and the scene has one material",
                        path.display()
                    );
                    let help = "[material.NAME] for each of them, or one physical volume, or none";
                    return Err(Fault::new("body.mesh", message, help).into());
                }
                plex.label_boundary(BOUNDARY)?;
                let shape = if shape == CellType::Tetrahedron { Shape::Tetrahedron } else { Shape::Hexahedron };
                let part = RankPart::new(&plex, shape, body.order, |vertex| vertex)?;
                let parts_of_cells = match &body.composition.parts {
                    Parts::Volumes(materials) => of_volumes(&plex, materials.keys(), &named_volumes)?,
                    _ => vec![0; plex.points(3)?.len()],
                };
                let (cells, facets, marks) = part.elements(&groups)?;
                let (mut surfaces, mut unusable_surfaces) = (BTreeMap::new(), BTreeMap::new());
                for (PhysicalGroup { name, .. }, mark) in groups.into_iter().zip(marks) {
                    check_name(path, &name)?;
                    match why_unusable(comm, &mark) {
                        None => surfaces.insert(name, mark.facets).map(|_| ()),
                        Some(reason) => unusable_surfaces.insert(name, reason).map(|_| ()),
                    };
                }
                check_untangled(comm, &cells)?;
                let mesh = Self::collect(comm, part.numbering.owned, cells, facets, surfaces);
                Ok(Self { parts, parts_of_cells, unusable_surfaces, ..mesh })
            }
        }
    }

    /// Builds the mesh of a body from its cells, facets and surfaces. Collective.
    fn collect(
        comm: &Comm,
        owned_nodes: usize,
        cells: Elements,
        facets: Elements,
        surfaces: BTreeMap<String, Vec<usize>>,
    ) -> Self {
        let sum = |local: usize| {
            let mut total = 0;
            comm.mpi().all_reduce_into(&local, &mut total, SystemOperation::sum());
            total
        };
        Self {
            nodes: sum(owned_nodes),
            total_cells: sum(cells.len()),
            owned_nodes,
            diameter: diameter(comm, &cells),
            parts_of_cells: Vec::new(),
            multiplicity: 1,
            parts: 1,
            comm: comm.clone(),
            cells,
            facets,
            surfaces,
            unusable_surfaces: BTreeMap::new(),
            mirror_nodes: Default::default(),
        }
    }
}

/// Number of the layer of each cell, from below, from the heights of the interfaces (m).
fn of_layers(interfaces: &[f64], cells: &Elements) -> Vec<usize> {
    let layer = |i: usize| {
        let height = super::mean(cells.x(i).iter().copied())[2];
        interfaces.iter().skip(1).take_while(|top| **top < height).count()
    };
    (0..cells.len()).map(layer).collect()
}

/// Number of the material of each of this rank's cells, from the names of physical volumes. Collective.
fn of_volumes<'a>(
    plex: &Plex,
    materials: impl Iterator<Item = &'a String>,
    volumes: &[PhysicalGroup],
) -> Result<Vec<usize>> {
    let mut used = Vec::new();
    for name in materials {
        let Some(volume) = volumes.iter().find(|volume| volume.name == *name) else {
            let known: Vec<String> = volumes.iter().map(|volume| format!("{:?}", volume.name)).collect();
            let help = match known.as_slice() {
                [] => "the mesh names no volume: give it physical volumes in Gmsh".to_owned(),
                known => format!("the mesh names {}", known.join(", ")),
            };
            let message = format!("the mesh has no physical volume {name:?}");
            return Err(Fault::new(format!("material.{name}"), message, help).into());
        };
        used.push(volume);
    }
    let (mut parts, mut without) = (Vec::new(), 0_u64);
    // Position in the list of materials of the second one of a cell, or the number of materials.
    let mut second = used.len() as u64;
    for cell in plex.points(3)? {
        let mut part = None;
        for (i, PhysicalGroup { number, .. }) in used.iter().enumerate() {
            if plex.has_label_value(CELLS, *number, cell)? {
                second = if part.is_some() { second.min(i as u64) } else { second };
                part = part.or(Some(i));
            }
        }
        without += u64::from(part.is_none());
        parts.push(part.unwrap_or_default());
    }
    let (mut total, mut first_second) = (0, 0);
    plex.comm().mpi().all_reduce_into(&without, &mut total, SystemOperation::sum());
    plex.comm().mpi().all_reduce_into(&second, &mut first_second, SystemOperation::min());
    let help = "give each cell one physical volume that has a material";
    if let Some(volume) = used.get(first_second as usize) {
        let message =
            format!("some cells of the physical volume {:?} are also in another one that has a material", volume.name);
        return Err(Fault::new("body.mesh", message, help).into());
    }
    if total > 0 {
        let message = format!("{total} cells are in no physical volume that the scene has a material for");
        return Err(Fault::new("body.mesh", message, help).into());
    }
    Ok(parts)
}

/// Checks the name of a physical surface, which is a name in results and their messages.
fn check_name(path: &Path, name: &str) -> Result<()> {
    if is_name_of_result(name) && name != RING {
        return Ok(());
    }
    let message = format!("{}: a physical surface has the name {name:?}", path.display());
    let help = format!("rename it: without / and control characters, and neither . nor {RING:?}");
    Err(Fault::new("body.mesh", message, help).into())
}

/// Why a physical surface can carry no support and no load; `None` if it can. Collective.
fn why_unusable(comm: &Comm, mark: &Mark) -> Option<String> {
    let (counts, mut totals) = ([mark.facets.len(), mark.inside], [0usize; 2]);
    comm.mpi().all_reduce_into(&counts, &mut totals, SystemOperation::sum());
    match totals {
        [0, 0] => Some("has no faces: did Gmsh save its elements with their physical group?".to_owned()),
        [_, 0] => None,
        [_, inside] => Some(format!("has {} faces inside the body, and only its boundary can be used", inside / 2)),
    }
}

/// Diagonal of the bounding box of all cells, m.
fn diameter(comm: &Comm, cells: &Elements) -> f64 {
    let mut bounds = [f64::NEG_INFINITY; 6];
    for x in (0..cells.len()).flat_map(|i| cells.x(i)) {
        for axis in 0..3 {
            bounds[axis] = bounds[axis].max(x[axis]);
            bounds[3 + axis] = bounds[3 + axis].max(-x[axis]);
        }
    }
    let mut all = [0.0f64; 6];
    comm.mpi().all_reduce_into(&bounds, &mut all, SystemOperation::max());
    (0..3).map(|axis| (all[axis] + all[3 + axis]).powi(2)).sum::<f64>().sqrt()
}
