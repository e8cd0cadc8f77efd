//! Geometry of a scene as cells, named boundary facets and numbered nodes, distributed over the ranks.
//!
//! For a mesh file, and for a box on one rank, DMPlex numbers the nodes (`plex`). On several ranks the nodes of a box
//! are numbered by their position in its grid (`lattice`). The rest of the program uses plain arrays.

mod block;
mod checks;
mod gmsh;
mod grid;
mod lattice;
mod locate;
mod measure;
mod mirror;
mod part;
mod plex;
mod whole;

use std::collections::BTreeMap;

use petsc_wrap::{Comm, Int};

use crate::element::{Element, Shape};

pub use locate::Site;
pub use measure::{Measures, Surface};
pub(crate) use mirror::add_image;
pub use whole::Whole;

/// This rank's part of a mesh. Every cell is on one rank; a node between ranks is owned by one of them. The mesh may be
/// a quarter of the body, between two planes of symmetry.
pub struct Mesh {
    /// Communicator of the ranks.
    pub comm: Comm,
    /// Cells of this rank.
    pub cells: Elements,
    /// For each of this rank's cells, the number of its part of the body ([`crate::description::Description::parts`]).
    pub parts_of_cells: Vec<usize>,
    /// This rank's facets on the boundary of the whole body, without planes of symmetry. Vertices are in right-handed
    /// order about the outward normal.
    pub facets: Elements,
    /// Named surfaces as indices into `facets`; all ranks have the same names.
    pub surfaces: BTreeMap<String, Vec<usize>>,
    /// Named surfaces that can carry no support and no load, and why: a clause without its subject. On all ranks.
    pub unusable_surfaces: BTreeMap<String, String>,
    /// For each axis, the global numbers of the nodes on the plane of symmetry normal to it, of those nodes that this
    /// rank's cells touch.
    pub mirror_nodes: [Vec<Int>; 3],
    /// Number of such meshes that make up the whole body: 1, or 4 for a quarter.
    pub multiplicity: usize,
    /// Number of nodes that this rank owns; their global numbers are contiguous.
    pub owned_nodes: usize,
    /// Number of nodes on all ranks.
    pub nodes: usize,
    /// Number of cells on all ranks.
    pub total_cells: usize,
    /// Diagonal of the bounding box of the mesh, m.
    pub diameter: f64,
    /// Number of parts of the mesh that share no node.
    pub parts: usize,
}

/// Cells or facets of one shape with elements of one order.
pub struct Elements {
    /// Shape of each cell or facet.
    pub shape: Shape,
    /// Order of the elements.
    pub order: usize,
    x: Vec<[f64; 3]>,
    vertices_each: usize,
    nodes: Vec<Int>,
    nodes_each: usize,
    element: Element,
}

impl Elements {
    fn new(shape: Shape, order: usize) -> Self {
        let element = Element::new(shape, order);
        Self {
            shape,
            order,
            x: Vec::new(),
            vertices_each: shape.reference_vertices().len(),
            nodes: Vec::new(),
            nodes_each: element.nodes(),
            element,
        }
    }

    fn push(&mut self, x: impl IntoIterator<Item = [f64; 3]>, nodes: impl IntoIterator<Item = Int>) {
        self.x.extend(x);
        self.nodes.extend(nodes);
    }

    /// Number of cells or facets.
    pub fn len(&self) -> usize {
        self.x.len() / self.vertices_each
    }

    /// Whether there are no cells or facets.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Number of nodes of each cell or facet.
    pub fn nodes_each(&self) -> usize {
        self.nodes_each
    }

    /// Coordinates of the vertices of element `i`, m.
    pub fn x(&self, i: usize) -> &[[f64; 3]] {
        &self.x[i * self.vertices_each..(i + 1) * self.vertices_each]
    }

    /// Coordinates of the nodes of element `i`, m. Each is the mean of the vertices of its vertex, edge, face or cell.
    pub fn node_positions(&self, i: usize) -> impl Iterator<Item = [f64; 3]> {
        let x = self.x(i);
        self.element.node_vertices().iter().map(move |of| mean(of.iter().map(|&v| x[v])))
    }

    /// Global numbers of the nodes of element `i`; the unknowns of node n are 3n, 3n + 1, 3n + 2.
    pub fn nodes(&self, i: usize) -> &[Int] {
        &self.nodes[i * self.nodes_each..(i + 1) * self.nodes_each]
    }
}

/// Mean of some points; there must be at least one.
pub fn mean(points: impl ExactSizeIterator<Item = [f64; 3]>) -> [f64; 3] {
    let n = points.len() as f64;
    points.fold([0.0; 3], |sum, x| [0, 1, 2].map(|i| sum[i] + x[i] / n))
}
