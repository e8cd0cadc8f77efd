//! What DMPlex holds of a mesh on one rank, as arrays of cells and boundary facets.

use petsc_wrap::{Int, Numbering, PhysicalGroup, Plex};

use crate::element::{Element, Shape};
use crate::error::Result;
use crate::scene::{Fault, Vec3};

use super::Elements;
use super::sound::check_extent;

/// Label of the facets on the boundary of the whole body.
pub(super) const BOUNDARY: &str = "ricochet boundary";

/// DMPlex's label of faces in physical groups, by number.
const FACES: &str = "Face Sets";

/// What a physical surface marks on this rank.
#[derive(Default)]
pub(super) struct Mark {
    /// Facets on the boundary of the body, by index.
    pub facets: Vec<usize>,
    /// Faces inside the body, each counted by both of its cells.
    pub inside: usize,
}

/// This rank's part of a mesh while it is turned into arrays.
pub(super) struct Part<'a> {
    plex: &'a Plex,
    /// Of all cells.
    pub shape: Shape,
    order: usize,
    /// Of the nodes.
    pub numbering: Numbering,
    coordinates: Vec<Vec3>,
    first_vertex: Int,
    first_face: Int,
    first_edge: Int,
    /// Vertices of each edge, and of each face, unordered.
    edges: Vec<Vec<Int>>,
    faces: Vec<Vec<Int>>,
}

impl<'a> Part<'a> {
    /// A mesh whose cells are all of one shape; `place` moves a vertex to where it belongs. Collective.
    pub fn new(plex: &'a Plex, shape: Shape, order: usize, place: impl Fn(Vec3) -> Vec3) -> Result<Self> {
        // Which points carry a node of the element: P1 and Q1 vertices, P2 also edges, Q2 every point.
        let numbering = plex.number(|dimension| match (shape, order) {
            (_, 1) => usize::from(dimension == 0),
            (Shape::Tetrahedron, _) => usize::from(dimension <= 1),
            _ => 1,
        })?;
        let coordinates = plex.vertex_coordinates()?.expect("PETSc's boxes and lists of cells have straight edges");
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
    pub fn elements(&self, groups: &[PhysicalGroup]) -> Result<(Elements, Elements, Vec<Mark>)> {
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
