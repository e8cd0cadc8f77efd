//! Lagrange elements of order 1 and 2: P1, P2, Q1, Q2.

use super::Shape;

/// Scalar Lagrange element on a reference cell.
///
/// Nodes are numbered in VTK's order: vertices first, then edges, faces and the interior (quadratic tetrahedron and
/// triangle, biquadratic quadrilateral, triquadratic hexahedron).
#[derive(Debug, Clone)]
pub struct Element {
    shape: Shape,
    order: usize,
    nodes: Vec<[f64; 3]>,
}

impl Element {
    /// Element of the given order on a shape.
    ///
    /// # Panics
    /// If the order is neither 1 nor 2; a scene allows no other order.
    pub fn new(shape: Shape, order: usize) -> Self {
        assert!(matches!(order, 1 | 2), "no Lagrange element of order {order}");
        let vertices = shape.reference_vertices();
        let mean = |of: &&[usize]| [0, 1, 2].map(|d| of.iter().map(|&v| vertices[v][d]).sum::<f64>() / of.len() as f64);
        Self { shape, order, nodes: node_vertices(shape, order).iter().map(mean).collect() }
    }

    /// Shape of the reference cell.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Coordinates of the nodes on the reference cell.
    pub fn reference_nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// For each node, the vertices of the cell whose mean is the node: one vertex, or all vertices of an edge, face or
    /// cell.
    pub fn node_vertices(&self) -> &'static [&'static [usize]] {
        node_vertices(self.shape, self.order)
    }

    /// Values of the shape functions at `xi`, one per node. On a facet `xi[2]` is ignored.
    pub fn values(&self, xi: [f64; 3], out: &mut [f64]) {
        match self.shape {
            Shape::Tetrahedron | Shape::Triangle => {
                let (l, _) = barycentric(self.shape, xi);
                for (value, of) in out.iter_mut().zip(self.node_vertices()) {
                    *value = match (self.order, *of) {
                        (1, [i, ..]) => l[*i],
                        (_, [i, j]) => 4. * l[*i] * l[*j],
                        (_, of) => l[of[0]] * (2. * l[of[0]] - 1.),
                    };
                }
            }
            Shape::Hexahedron | Shape::Quadrilateral => {
                for (value, node) in out.iter_mut().zip(&self.nodes) {
                    *value = (0..self.shape.dimension()).map(|d| line(self.order, node[d], xi[d]).0).product();
                }
            }
        }
    }

    /// Gradients of the shape functions at `xi` with respect to the reference coordinates, one per node. On a facet the
    /// third component is 0.
    pub fn gradients(&self, xi: [f64; 3], out: &mut [[f64; 3]]) {
        match self.shape {
            Shape::Tetrahedron | Shape::Triangle => {
                let (l, g) = barycentric(self.shape, xi);
                for (gradient, of) in out.iter_mut().zip(self.node_vertices()) {
                    *gradient = [0, 1, 2].map(|d| match (self.order, *of) {
                        (1, [i, ..]) => g[*i][d],
                        (_, [i, j]) => 4. * (l[*i] * g[*j][d] + l[*j] * g[*i][d]),
                        (_, of) => (4. * l[of[0]] - 1.) * g[of[0]][d],
                    });
                }
            }
            Shape::Hexahedron | Shape::Quadrilateral => {
                let dimension = self.shape.dimension();
                for (gradient, node) in out.iter_mut().zip(&self.nodes) {
                    *gradient = [0.; 3];
                    for (d, slot) in gradient.iter_mut().enumerate().take(dimension) {
                        *slot = (0..dimension)
                            .map(|e| {
                                let (value, slope) = line(self.order, node[e], xi[e]);
                                if e == d { slope } else { value }
                            })
                            .product();
                    }
                }
            }
        }
    }
}

/// Value and slope at `x` of the Lagrange polynomial on \[−1, 1\] that is 1 at `node` (−1, 0 or 1).
fn line(order: usize, node: f64, x: f64) -> (f64, f64) {
    if order == 1 {
        (0.5 * (1. + node * x), 0.5 * node)
    } else if node == 0. {
        (1. - x * x, -2. * x)
    } else {
        (0.5 * x * (x + node), x + 0.5 * node)
    }
}

/// Barycentric coordinates and their gradients; for a triangle the last ones are 0.
fn barycentric(shape: Shape, xi: [f64; 3]) -> ([f64; 4], [[f64; 3]; 4]) {
    match shape.dimension() {
        2 => ([1. - xi[0] - xi[1], xi[0], xi[1], 0.], [[-1., -1., 0.], [1., 0., 0.], [0., 1., 0.], [0.; 3]]),
        _ => ([1. - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]], [[-1.; 3], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]),
    }
}

fn node_vertices(shape: Shape, order: usize) -> &'static [&'static [usize]] {
    let all: &'static [&'static [usize]] = match shape {
        Shape::Tetrahedron => &[&[0], &[1], &[2], &[3], &[0, 1], &[1, 2], &[2, 0], &[0, 3], &[1, 3], &[2, 3]],
        Shape::Triangle => &[&[0], &[1], &[2], &[0, 1], &[1, 2], &[2, 0]],
        Shape::Quadrilateral => &[&[0], &[1], &[2], &[3], &[0, 1], &[1, 2], &[2, 3], &[3, 0], &[0, 1, 2, 3]],
        Shape::Hexahedron => &[
            &[0],
            &[1],
            &[2],
            &[3],
            &[4],
            &[5],
            &[6],
            &[7],
            &[0, 1],
            &[1, 2],
            &[2, 3],
            &[3, 0],
            &[4, 5],
            &[5, 6],
            &[6, 7],
            &[7, 4],
            &[0, 4],
            &[1, 5],
            &[2, 6],
            &[3, 7],
            &[0, 3, 7, 4],
            &[1, 2, 6, 5],
            &[0, 1, 5, 4],
            &[3, 2, 6, 7],
            &[0, 1, 2, 3],
            &[4, 5, 6, 7],
            &[0, 1, 2, 3, 4, 5, 6, 7],
        ],
    };
    if order == 1 { &all[..shape.reference_vertices().len()] } else { all }
}
