//! From a scene's geometry to a [`Mesh`], through DMPlex.

use std::collections::BTreeMap;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{CellType, Comm, GmshMesh, Int, Numbering, PhysicalGroup, Plex};

use crate::agree::agree;
use crate::element::{Element, Shape};
use crate::error::Result;
use crate::scene::{Body, Fault, Geometry, Parts, Vec3};

use super::gmsh;
use super::grid::Grid;
use super::sound::{check_extent, check_untangled};
use super::{Elements, Mesh};

/// Label of the facets on the boundary of the whole body.
const BOUNDARY: &str = "ricochet boundary";

/// DMPlex's labels of faces and of cells in physical groups, by number.
const FACES: &str = "Face Sets";
const CELLS: &str = "Cell Sets";

impl Mesh {
    /// Makes or reads the mesh and spreads it over the ranks. Collective.
    ///
    /// # Errors
    /// A mesh file that cannot be used (a fault of `body.mesh`), the same on all ranks; PETSc's.
    pub fn new(comm: &Comm, body: &Body) -> Result<Self> {
        match &body.geometry {
            Geometry::Box { planes, .. } => {
                let grid = Grid::new(planes, &body.symmetry);
                let plex = distribute(grid.cubes(comm)?)?;
                let part = Part::new(&plex, body.order, |vertex| grid.place(vertex))?;
                let (cells, facets, _) = part.elements(&[])?;
                let (facets, mirror_nodes) = grid.cut(&facets);
                let surfaces = grid.surfaces(&facets);
                let parts_of_cells = of_layers(&body.composition.interfaces(), &cells);
                let mesh = Self::collect(comm, part.numbering.owned, cells, facets, surfaces);
                Ok(Self { mirror_nodes, parts_of_cells, copies: grid.copies(), ..mesh })
            }
            Geometry::Gmsh(path) => {
                let GmshMesh { plex, surfaces: groups, named_volumes, volumes, parts } = gmsh::read(comm, path)?;
                if volumes > 1 && !matches!(body.composition.parts, Parts::Volumes(_)) {
                    let message = format!(
                        "{}: it has {volumes} physical volumes, and the scene has one material",
                        path.display()
                    );
                    let help = "[material.NAME] for each of them, or one physical volume, or none";
                    return Err(Fault::new("body.mesh", message, help).into());
                }
                let plex = distribute(plex)?;
                let part = Part::new(&plex, body.order, |vertex| vertex)?;
                let parts_of_cells = match &body.composition.parts {
                    Parts::Volumes(materials) => of_volumes(&plex, materials.keys(), &named_volumes)?,
                    _ => vec![0; plex.points(3)?.len()],
                };
                let (cells, facets, marks) = part.elements(&groups)?;
                let mut surfaces = BTreeMap::new();
                for (PhysicalGroup { name, .. }, mark) in groups.into_iter().zip(marks) {
                    if check_surface(comm, &name, &mark)? {
                        surfaces.insert(name, mark.facets);
                    }
                }
                check_untangled(comm, &cells)?;
                let mesh = Self::collect(comm, part.numbering.owned, cells, facets, surfaces);
                Ok(Self { parts, parts_of_cells, ..mesh })
            }
        }
    }

    /// A whole body's mesh from its parts. Collective.
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
            copies: 1,
            parts: 1,
            comm: comm.clone(),
            cells,
            facets,
            surfaces,
            mirror_nodes: Default::default(),
        }
    }
}

/// The number of the layer of each cell, from below, between the heights of their interfaces (m).
fn of_layers(interfaces: &[f64], cells: &Elements) -> Vec<usize> {
    let layer = |i: usize| {
        let height = super::mean(cells.x(i).iter().copied())[2];
        interfaces.iter().skip(1).take_while(|top| **top < height).count()
    };
    (0..cells.len()).map(layer).collect()
}

/// The number of the material of each of this rank's cells, by the names of physical volumes. Collective.
fn of_volumes<'a>(
    plex: &Plex,
    materials: impl Iterator<Item = &'a String>,
    volumes: &[PhysicalGroup],
) -> Result<Vec<usize>> {
    let mut numbers = Vec::new();
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
        numbers.push(volume.number);
    }
    let (mut parts, mut without) = (Vec::new(), 0_usize);
    for cell in plex.points(3)? {
        let mut part = None;
        for (i, number) in numbers.iter().enumerate() {
            if part.is_none() && plex.has_label_value(CELLS, *number, cell)? {
                part = Some(i);
            }
        }
        without += usize::from(part.is_none());
        parts.push(part.unwrap_or_default());
    }
    let mut total = 0;
    plex.comm().mpi().all_reduce_into(&without, &mut total, SystemOperation::sum());
    if total > 0 {
        let message = format!("{total} cells are in no physical volume that the scene has a material for");
        return Err(Fault::new("body.mesh", message, "[material.NAME] for each physical volume of the mesh").into());
    }
    Ok(parts)
}

/// The mesh over all ranks, with its boundary labelled. Collective.
fn distribute(plex: Plex) -> Result<Plex> {
    plex.label_boundary(BOUNDARY)?;
    Ok(plex.distribute()?)
}

/// The one shape of all cells. Collective.
fn shape(plex: &Plex) -> Result<Shape> {
    let fault = |message: String| {
        Fault::new("body.mesh", message, "mesh the volume with tetrahedra, or with hexahedra, and save all elements")
    };
    let dimension = plex.dimension()?;
    if dimension != 3 {
        return Err(fault(format!("the mesh is of dimension {dimension}, a solid needs 3")).into());
    }
    let (mut counts, mut totals) = ([0usize; 3], [0usize; 3]);
    for cell in plex.points(3)? {
        counts[match plex.cell_type(cell)? {
            CellType::Tetrahedron => 0,
            CellType::Hexahedron => 1,
            _ => 2,
        }] += 1;
    }
    plex.comm().mpi().all_reduce_into(&counts, &mut totals, SystemOperation::sum());
    match totals {
        [0, 0, 0] => Err(fault("the mesh has no cells".to_owned()).into()),
        [_, 0, 0] => Ok(Shape::Tetrahedron),
        [0, _, 0] => Ok(Shape::Hexahedron),
        [tetrahedra, hexahedra, others] => {
            let message =
                format!("the mesh mixes shapes: {tetrahedra} tetrahedra, {hexahedra} hexahedra, {others} others");
            Err(fault(message).into())
        }
    }
}

/// What a physical surface marks on this rank.
#[derive(Default)]
struct Mark {
    /// Facets on the boundary of the body, by index.
    facets: Vec<usize>,
    /// Faces inside the body, each counted by both of its cells.
    inside: usize,
}

/// This rank's part of a mesh while it is turned into arrays.
struct Part<'a> {
    plex: &'a Plex,
    shape: Shape,
    order: usize,
    numbering: Numbering,
    coordinates: Vec<Vec3>,
    first_vertex: Int,
    first_face: Int,
    first_edge: Int,
    /// Vertices of each edge, and of each face, unordered.
    edges: Vec<Vec<Int>>,
    faces: Vec<Vec<Int>>,
}

impl<'a> Part<'a> {
    /// `place` moves a vertex to where it belongs. Collective.
    fn new(plex: &'a Plex, order: usize, place: impl Fn(Vec3) -> Vec3) -> Result<Self> {
        let shape = shape(plex)?;
        // Which points carry a node of the element: P1 and Q1 vertices, P2 also edges, Q2 every point.
        let numbering = plex.number(|dimension| match (shape, order) {
            (_, 1) => usize::from(dimension == 0),
            (Shape::Tetrahedron, _) => usize::from(dimension <= 1),
            _ => 1,
        })?;
        let coordinates = plex.vertex_coordinates()?;
        let known = coordinates.ok_or("the mesh has curved cells (elements of higher order)".to_owned());
        let coordinates = agree(plex.comm(), known)
            .map_err(|message| Fault::new("body.mesh", message, "save it from Gmsh with Mesh.ElementOrder = 1"))?;
        let coordinates: Vec<Vec3> = coordinates.into_iter().map(place).collect();
        check_extent(plex.comm(), &coordinates)?;
        let edges = plex.points(1)?.map(|edge| Ok(plex.cone(edge)?.to_vec())).collect::<Result<Vec<_>>>()?;
        let first_edge = plex.points(1)?.start;
        let faces = plex
            .points(2)?
            .map(|face| {
                let mut vertices = Vec::with_capacity(4);
                for edge in plex.cone(face)? {
                    vertices.extend(&edges[(edge - first_edge) as usize]);
                }
                vertices.sort_unstable();
                vertices.dedup();
                Ok(vertices)
            })
            .collect::<Result<Vec<_>>>()?;
        let (first_vertex, first_face) = (plex.points(0)?.start, plex.points(2)?.start);
        Ok(Self { plex, shape, order, numbering, coordinates, first_vertex, first_face, first_edge, edges, faces })
    }

    /// Cells, boundary facets, and what each group marks among the latter.
    fn elements(&self, groups: &[PhysicalGroup]) -> Result<(Elements, Elements, Vec<Mark>)> {
        let element = Element::new(self.shape, self.order);
        let facet_shape = self.shape.facet();
        let facet_element = Element::new(facet_shape, self.order);
        let mut cells = Elements::new(self.shape, self.order);
        let mut facets = Elements::new(facet_shape, self.order);
        let mut marks: Vec<Mark> = groups.iter().map(|_| Mark::default()).collect();
        for cell in self.plex.points(3)? {
            let closure = Closure::new(self, cell)?;
            let nodes = element.node_vertices().iter().map(|vertices| closure.node(vertices));
            cells.push(closure.x.iter().copied(), nodes.collect::<Result<Vec<_>>>()?);
            for local in self.shape.facets() {
                let face = closure.point(local)?;
                let boundary = self.plex.has_label(BOUNDARY, face)?;
                for (PhysicalGroup { number, .. }, mark) in groups.iter().zip(&mut marks) {
                    if self.plex.has_label_value(FACES, *number, face)? {
                        if boundary {
                            mark.facets.push(facets.len());
                        } else {
                            mark.inside += 1;
                        }
                    }
                }
                if boundary {
                    let nodes = facet_element.node_vertices().iter().map(|vertices| {
                        let in_cell: Vec<usize> = vertices.iter().map(|&i| local[i]).collect();
                        closure.node(&in_cell)
                    });
                    facets.push(local.iter().map(|&i| closure.x[i]), nodes.collect::<Result<Vec<_>>>()?);
                }
            }
        }
        Ok((cells, facets, marks))
    }
}

/// A cell with the points that bound it, told apart by the cell's vertices that they hold.
struct Closure<'a> {
    part: &'a Part<'a>,
    x: Vec<Vec3>,
    /// Bit i is set where the point holds the cell's vertex i.
    points: Vec<(u8, Int)>,
}

impl<'a> Closure<'a> {
    fn new(part: &'a Part, cell: Int) -> Result<Self> {
        let closure = part.plex.closure(cell)?;
        let vertex_range = part.plex.points(0)?;
        let mut vertices: Vec<Int> = closure.iter().copied().filter(|point| vertex_range.contains(point)).collect();
        // DMPlex lists the bottom of a hexahedron the other way round.
        if part.shape == Shape::Hexahedron {
            vertices.swap(1, 3);
        }
        let at = |vertex: &Int| part.coordinates[(vertex - part.first_vertex) as usize];
        let x: Vec<Vec3> = vertices.iter().map(at).collect();
        if orientation(part.shape, &x) < 0.0 {
            // A mirrored cell is the same cell: the file only lists its vertices in the other order.
            match part.shape {
                Shape::Tetrahedron => vertices.swap(0, 1),
                _ => vertices.rotate_left(4),
            }
        }
        let x = vertices.iter().map(at).collect();
        let mask = |of: &[Int]| {
            let bit = |vertex| vertices.iter().position(|v| v == vertex).map_or(0, |i| 1u8 << i);
            of.iter().fold(0, |mask, vertex| mask | bit(vertex))
        };
        let points = closure
            .iter()
            .map(|&point| {
                let of = if vertex_range.contains(&point) {
                    mask(&[point])
                } else if let Some(vertices) = part.edge(point) {
                    mask(vertices)
                } else if let Some(vertices) = part.face(point) {
                    mask(vertices)
                } else {
                    mask(&vertices)
                };
                (of, point)
            })
            .collect();
        Ok(Self { part, x, points })
    }

    /// The point that holds just these vertices of the cell.
    fn point(&self, vertices: &[usize]) -> Result<Int> {
        let mask = vertices.iter().fold(0u8, |mask, &i| mask | 1 << i);
        let found = self.points.iter().find(|(of, _)| *of == mask);
        Ok(found.map(|(_, point)| *point).ok_or_else(|| self.misfit())?)
    }

    /// Two hexahedra that share the vertices of a face, and go round it in different orders.
    fn misfit(&self) -> Fault {
        let [x, y, z] = super::mean(self.x.iter().copied());
        let message = format!("the cell at [{x:.6}, {y:.6}, {z:.6}] does not fit its neighbour");
        Fault::new("body.mesh", message, "mend or remake the mesh").on_one_rank()
    }

    /// Global number of the node on the point that holds just these vertices.
    fn node(&self, vertices: &[usize]) -> Result<Int> {
        Ok(self.part.numbering.first(self.point(vertices)?).0)
    }
}

impl Part<'_> {
    fn edge(&self, point: Int) -> Option<&[Int]> {
        let index = usize::try_from(point - self.first_edge).ok()?;
        self.edges.get(index).map(Vec::as_slice)
    }

    fn face(&self, point: Int) -> Option<&[Int]> {
        let index = usize::try_from(point - self.first_face).ok()?;
        self.faces.get(index).map(Vec::as_slice)
    }
}

/// Triple product of three edges: negative for a mirrored cell. A hexahedron's edges join centres of opposite faces.
fn orientation(shape: Shape, x: &[Vec3]) -> f64 {
    let edge = |from: &[usize], to: &[usize]| {
        let [a, b] = [from, to].map(|of| super::mean(of.iter().map(|&i| x[i])));
        nalgebra::Vector3::from(b) - nalgebra::Vector3::from(a)
    };
    let [a, b, c] = match shape {
        Shape::Tetrahedron => [edge(&[0], &[1]), edge(&[0], &[2]), edge(&[0], &[3])],
        _ => {
            [edge(&[0, 3, 4, 7], &[1, 2, 5, 6]), edge(&[0, 1, 4, 5], &[2, 3, 6, 7]), edge(&[0, 1, 2, 3], &[4, 5, 6, 7])]
        }
    };
    a.cross(&b).dot(&c)
}

/// Whether a name marks anything; one with faces inside the body is refused.
fn check_surface(comm: &Comm, name: &str, mark: &Mark) -> Result<bool> {
    let (counts, mut totals) = ([mark.facets.len(), mark.inside], [0usize; 2]);
    comm.mpi().all_reduce_into(&counts, &mut totals, SystemOperation::sum());
    if totals[1] > 0 {
        let message = format!("the physical surface {name:?} has {} faces inside the body", totals[1] / 2);
        return Err(Fault::new("body.mesh", message, "name only surfaces on the boundary of the volume").into());
    }
    Ok(totals[0] > 0)
}

/// Diagonal of the box around all cells.
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
