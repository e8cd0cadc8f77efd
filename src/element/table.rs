//! Shape functions of an element at quadrature points, with the degree-1 map of the cell geometry.

use nalgebra::{Matrix3, Vector3};

use super::{Element, Quadrature};

/// Values and gradients of shape functions and geometry at quadrature points, as needed for integrals over one cell or
/// facet.
#[derive(Debug, Clone)]
pub struct Table {
    nodes: usize,
    vertices: usize,
    weights: Vec<f64>,
    values: Vec<f64>,
    gradients: Vec<[f64; 3]>,
    vertex_values: Vec<f64>,
    vertex_gradients: Vec<[f64; 3]>,
}

impl Table {
    /// Tabulates the element at the points of a quadrature on the same shape.
    pub fn new(element: &Element, quadrature: &Quadrature) -> Self {
        let geometry = Element::new(element.shape(), 1);
        let tabulate = |element: &Element| {
            let (n, points) = (element.nodes(), &quadrature.points);
            let mut values = vec![0.; n * points.len()];
            let mut gradients = vec![[0.; 3]; n * points.len()];
            for (q, &xi) in points.iter().enumerate() {
                element.values(xi, &mut values[q * n..][..n]);
                element.gradients(xi, &mut gradients[q * n..][..n]);
            }
            (values, gradients)
        };
        let (values, gradients) = tabulate(element);
        let (vertex_values, vertex_gradients) = tabulate(&geometry);
        Self {
            nodes: element.nodes(),
            vertices: geometry.nodes(),
            weights: quadrature.weights.clone(),
            values,
            gradients,
            vertex_values,
            vertex_gradients,
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Number of quadrature points.
    pub fn points(&self) -> usize {
        self.weights.len()
    }

    /// Quadrature weight of point `q` on the reference cell.
    pub fn weight(&self, q: usize) -> f64 {
        self.weights[q]
    }

    /// Values of the shape functions at point `q`.
    pub fn values(&self, q: usize) -> &[f64] {
        &self.values[q * self.nodes..][..self.nodes]
    }

    /// Gradients of the shape functions at point `q` with respect to the reference coordinates.
    pub fn gradients(&self, q: usize) -> &[[f64; 3]] {
        &self.gradients[q * self.nodes..][..self.nodes]
    }

    /// Position of point `q` in the cell with vertices `x`.
    pub fn position(&self, q: usize, x: &[[f64; 3]]) -> [f64; 3] {
        let values = &self.vertex_values[q * self.vertices..][..self.vertices];
        values.iter().zip(x).fold([0.; 3], |sum, (&value, vertex)| [0, 1, 2].map(|c| sum[c] + value * vertex[c]))
    }

    /// Jacobian ∂x/∂ξ at point `q` of the cell with vertices `x`: one row per component of x, one column per reference
    /// coordinate.
    pub fn jacobian(&self, q: usize, x: &[[f64; 3]]) -> Matrix3<f64> {
        let gradients = &self.vertex_gradients[q * self.vertices..][..self.vertices];
        jacobian(gradients, x)
    }

    /// Weight times area element |∂x/∂ξ × ∂x/∂η| at each point of the facet with vertices `x`.
    pub fn areas(&self, x: &[[f64; 3]]) -> impl Iterator<Item = f64> {
        (0..self.points()).map(move |q| {
            let j = self.jacobian(q, x);
            self.weights[q] * j.column(0).cross(&j.column(1)).norm()
        })
    }
}

/// Σ x ⊗ ∇φ over the vertices of the cell.
pub(super) fn jacobian(gradients: &[[f64; 3]], x: &[[f64; 3]]) -> Matrix3<f64> {
    let mut j = Matrix3::zeros();
    for (&gradient, &vertex) in gradients.iter().zip(x) {
        j += Vector3::from(vertex) * Vector3::from(gradient).transpose();
    }
    j
}
