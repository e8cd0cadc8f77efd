//! Conversion of DMPlex's mesh on one rank to arrays of cells and boundary facets.

use petsc_wrap::{Int, Numbering, PhysicalGroup, Plex};

use crate::element::{Element, Shape};
use crate::error::Result;
use crate::scene::{Fault, Vec3};

use super::Elements;
use super::checks::check_extent;

/// Label of the facets on the boundary of the whole body.
pub(super) const BOUNDARY: &str = "ricochet boundary";

/// DMPlex's label of the faces in physical groups, whose value is the number of the group.
const FACES: &str = "Face Sets";

/// Faces marked by a physical surface on this rank.
#[derive(Default)]
pub(super) struct Mark {
    /// Indices of facets on the boundary of the body.
    pub facets: Vec<usize>,
    /// Number of faces inside the body; each is counted by both of its cells.
    pub inside: usize,
}

/// This rank's part of a mesh during the conversion to arrays.
pub(super) struct RankPart<'a> {
    plex: &'a Plex,
    /// Shape of all cells.
    pub shape: Shape,
    order: usize,
    /// Numbering of the nodes.
    pub numbering: Numbering,
    coordinates: Vec<Vec3>,
    first_vertex: Int,
    first_face: Int,
    first_edge: Int,
    /// Vertices of each edge, in any order.
    edges: Vec<Vec<Int>>,
    /// Vertices of each face, in any order.
    faces: Vec<Vec<Int>>,
}

impl<'a> RankPart<'a> {
    /// Mesh whose cells all have one shape; `place` returns the final position of a vertex. Collective.
    pub fn new(plex: &'a Plex, shape: Shape, order: usize, place: impl Fn(Vec3) -> Vec3) -> Result<Self> {
        // Points that carry a node of the element: vertices for P1 and Q1, also edges for P2, all points for Q2.
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

    /// Cells, boundary facets, and the facets marked by each group.
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

/// A cell with the points of its boundary, identified by the vertices of the cell that they contain.
struct Closure<'a> {
    part: &'a RankPart<'a>,
    x: Vec<Vec3>,
    /// Points with a bit mask: bit i is set if the point contains vertex i of the cell.
    points: Vec<(u8, Int)>,
}

impl<'a> Closure<'a> {
    fn new(part: &'a RankPart, cell: Int) -> Result<Self> {
        let closure = part.plex.closure(cell)?;
        let vertex_range = part.plex.points(0)?;
        let mut vertices: Vec<Int> = closure.iter().copied().filter(|point| vertex_range.contains(point)).collect();
        // DMPlex lists the bottom vertices of a hexahedron in the opposite sense.
        if part.shape == Shape::Hexahedron {
            vertices.swap(1, 3);
        }
        let at = |vertex: &Int| part.coordinates[(vertex - part.first_vertex) as usize];
        let x: Vec<Vec3> = vertices.iter().map(at).collect();
        if orientation(part.shape, &x) < 0.0 {
            // A mirrored cell is valid; the file lists its vertices in the opposite order.
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

    /// Point that contains exactly these vertices of the cell.
    fn point(&self, vertices: &[usize]) -> Result<Int> {
        let mask = vertices.iter().fold(0u8, |mask, &i| mask | 1 << i);
        let found = self.points.iter().find(|(of, _)| *of == mask);
        Ok(found.map(|(_, point)| *point).ok_or_else(|| self.misfit())?)
    }

    /// Fault of two hexahedra that share the vertices of a face but in incompatible orders.
    fn misfit(&self) -> Fault {
        let [x, y, z] = super::mean(self.x.iter().copied());
        let message = format!("the cell at [{x:.6}, {y:.6}, {z:.6}] does not fit its neighbour");
        Fault::new("body.mesh", message, "mend or remake the mesh").on_one_rank()
    }

    /// Global number of the node on the point that contains exactly these vertices.
    fn node(&self, vertices: &[usize]) -> Result<Int> {
        Ok(self.part.numbering.first(self.point(vertices)?).0)
    }
}

impl RankPart<'_> {
    fn edge(&self, point: Int) -> Option<&[Int]> {
        let index = usize::try_from(point - self.first_edge).ok()?;
        self.edges.get(index).map(Vec::as_slice)
    }

    fn face(&self, point: Int) -> Option<&[Int]> {
        let index = usize::try_from(point - self.first_face).ok()?;
        self.faces.get(index).map(Vec::as_slice)
    }
}

/// Triple product of three edges, negative for a mirrored cell. For a hexahedron, the edges join the centres of
/// opposite faces.
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
