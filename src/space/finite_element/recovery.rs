//! Stresses at the nodes of a mesh by superconvergent patch recovery (O. C. Zienkiewicz & J. Z. Zhu, The
//! superconvergent patch recovery and a posteriori error estimates, part 1, Int. J. Numer. Methods Eng. 33, 1992).
//!
//! Around each vertex, a polynomial of the order of the elements is fitted by least squares to the stresses at Gauss
//! points of the adjacent cells. The stress at the vertex is the value of this polynomial. At a node between vertices,
//! it is the mean of the values of their polynomials. A patch of few cells, for example at an edge of the body, is
//! extended by the neighbours of its cells. Terms that cannot be distinguished from lower ones at the samples, such as
//! z² in a single layer of cells, are left out.

use std::collections::BTreeSet;

use crate::element::{Element, Quadrature, Shape, Table};
use crate::mesh::Whole;
use crate::scene::Vec3;

use crate::space::evaluate::{Form, summed};

/// Smallest ratio of the number of samples of a patch to the number of terms of its polynomial.
const LEAST_SAMPLES_PER_TERM: usize = 2;

/// Smallest norm at the samples of a term without its components along lower terms, divided by the norm of the term,
/// for which the term is used.
const INDEPENDENT: f64 = 0.02;

/// Stress recovery on a mesh, with the points at which stresses are sampled.
pub struct Recovery {
    /// Gradients of the shape functions at the samples of a cell.
    table: Table,
    /// Positions of all samples, m.
    places: Vec<Vec3>,
    /// Cells around each vertex; empty for other nodes.
    about: Vec<Vec<usize>>,
    /// Vertices whose polynomials are averaged at each node.
    vertices: Vec<Vec<usize>>,
}

impl Recovery {
    /// Recovery on a mesh. A hexahedron has 2³ Gauss points as samples; a tetrahedron has its centroid (order 1) or
    /// four points (order 2). Stresses jump between materials. Therefore a patch contains cells of only one part of the
    /// body; at a vertex between two parts, the cells of the stiffer part. `stiffness` is the stiffness of each part,
    /// Pa.
    pub fn new(mesh: &Whole, stiffness: &[f64]) -> Self {
        let element = Element::new(mesh.shape, mesh.order);
        let degree = match mesh.shape {
            Shape::Tetrahedron => mesh.order,
            _ => 3,
        };
        let table = Table::new(&element, &Quadrature::exact(mesh.shape, degree));
        let mut places = Vec::with_capacity(mesh.len() * table.points());
        let mut about = vec![Vec::new(); mesh.nodes.len()];
        let mut vertices = vec![Vec::new(); mesh.nodes.len()];
        for i in 0..mesh.len() {
            let (x, cell) = (mesh.x(i), mesh.cell(i));
            places.extend((0..table.points()).map(|q| table.position(q, &x)));
            for (&node, of) in cell.iter().zip(element.node_vertices()) {
                if vertices[node].is_empty() {
                    vertices[node] = of.iter().map(|&v| cell[v]).collect();
                }
            }
            cell[..x.len()].iter().for_each(|&vertex| about[vertex].push(i));
        }
        for cells in &mut about {
            let at = |cell: &usize| stiffness[mesh.parts_of_cells[*cell]];
            let stiffest = cells.iter().max_by(|a, b| at(a).total_cmp(&at(b))).map(|cell| mesh.parts_of_cells[*cell]);
            cells.retain(|cell| Some(mesh.parts_of_cells[*cell]) == stiffest);
        }
        Self { table, places, about, vertices }
    }

    /// Number of samples of each cell.
    pub fn samples_each(&self) -> usize {
        self.table.points()
    }

    /// Position of a sample, m; samples are numbered cell by cell.
    pub fn place(&self, sample: usize) -> Vec3 {
        self.places[sample]
    }

    /// Gradients ∂φ/∂x of the shape functions of a cell at one of its samples, 1/m.
    pub fn gradients(&self, mesh: &Whole, cell: usize, sample: usize) -> Vec<Vec3> {
        let jacobian = self.table.jacobian(sample, &mesh.x(cell));
        // Tangled (inverted) cells are rejected when the body is assembled.
        let to_space = jacobian.try_inverse().unwrap_or_default().transpose();
        let gradients = self.table.gradients(sample).iter();
        gradients.map(|&gradient| (to_space * nalgebra::Vector3::from(gradient)).into()).collect()
    }

    /// Weights of the samples, numbered cell by cell, in the stress at each wanted node; empty for other nodes.
    pub fn weights(&self, mesh: &Whole, is_wanted: impl Fn(usize) -> bool) -> Vec<Form> {
        let mut of_vertex = vec![Vec::new(); mesh.nodes.len()];
        for node in (0..mesh.nodes.len()).filter(|&node| is_wanted(node)) {
            self.vertices[node].iter().for_each(|&vertex| of_vertex[vertex].push(node));
        }
        let mut weights = vec![Form::new(); mesh.nodes.len()];
        for (vertex, nodes) in of_vertex.iter().enumerate().filter(|(_, nodes)| !nodes.is_empty()) {
            let patch = self.patch(mesh, vertex);
            for &node in nodes {
                let part = 1.0 / self.vertices[node].len() as f64;
                let values = patch.at(mesh.nodes[node]);
                weights[node].extend(patch.samples.iter().copied().zip(values.into_iter().map(|value| part * value)));
            }
        }
        weights.into_iter().map(summed).collect()
    }

    fn patch(&self, mesh: &Whole, vertex: usize) -> Patch {
        let terms = monomials(mesh.order, [0.0; 3]).len();
        let mut cells: BTreeSet<usize> = self.about[vertex].iter().copied().collect();
        while cells.len() * self.samples_each() < LEAST_SAMPLES_PER_TERM * terms {
            let before = cells.len();
            let corners = self.vertices_of(mesh, &cells);
            let part = cells.first().map(|cell| mesh.parts_of_cells[*cell]);
            let about = corners.into_iter().flat_map(|corner| self.about[corner].iter().copied());
            cells.extend(about.filter(|cell| Some(mesh.parts_of_cells[*cell]) == part));
            if cells.len() == before {
                break;
            }
        }
        let each = self.samples_each();
        let samples: Vec<usize> = cells.iter().flat_map(|cell| cell * each..(cell + 1) * each).collect();
        Patch::new(mesh.order, mesh.nodes[vertex], samples, &self.places)
    }

    fn vertices_of(&self, mesh: &Whole, cells: &BTreeSet<usize>) -> BTreeSet<usize> {
        let count = mesh.shape.reference_vertices().len();
        cells.iter().flat_map(|&cell| mesh.cell(cell)[..count].iter().copied()).collect()
    }
}

/// A polynomial fitted to samples, with terms that are orthonormal at the samples.
struct Patch {
    order: usize,
    origin: Vec3,
    /// Half of the extent of the patch along each axis, m.
    size: Vec3,
    samples: Vec<usize>,
    /// For each monomial, its components along the previous terms and, if it is used as a term, the norm of the
    /// remainder.
    parts: Vec<(Vec<f64>, Option<f64>)>,
    /// Values of the terms at the samples.
    terms: Vec<Vec<f64>>,
}

impl Patch {
    fn new(order: usize, origin: Vec3, samples: Vec<usize>, places: &[Vec3]) -> Self {
        let reach = |axis: usize| {
            let largest = samples.iter().map(|&s| (places[s][axis] - origin[axis]).abs()).fold(0.0, f64::max);
            if largest > 0.0 { largest } else { 1.0 }
        };
        let mut patch =
            Self { order, origin, size: [reach(0), reach(1), reach(2)], samples, parts: Vec::new(), terms: Vec::new() };
        let rows: Vec<Vec<f64>> = patch.samples.iter().map(|&s| patch.monomials(places[s])).collect();
        for number in 0..rows[0].len() {
            let mut term: Vec<f64> = rows.iter().map(|row| row[number]).collect();
            let before = length(&term);
            let parts: Vec<f64> = patch
                .terms
                .iter()
                .map(|other| {
                    let part = other.iter().zip(&term).map(|(a, b)| a * b).sum::<f64>();
                    term.iter_mut().zip(other).for_each(|(a, b)| *a -= part * b);
                    part
                })
                .collect();
            let left = length(&term);
            let counts = left > INDEPENDENT * before;
            if counts {
                term.iter_mut().for_each(|value| *value /= left);
                patch.terms.push(term);
            }
            patch.parts.push((parts, counts.then_some(left)));
        }
        patch
    }

    fn monomials(&self, x: Vec3) -> Vec<f64> {
        monomials(self.order, [0, 1, 2].map(|axis| (x[axis] - self.origin[axis]) / self.size[axis]))
    }

    /// Weights of the samples in the value of the polynomial at a point.
    fn at(&self, x: Vec3) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.terms.len());
        for (monomial, (parts, left)) in self.monomials(x).into_iter().zip(&self.parts) {
            if let Some(left) = left {
                let known: f64 = parts.iter().zip(&values).map(|(part, value)| part * value).sum();
                values.push((monomial - known) / left);
            }
        }
        let of_sample = |s: usize| self.terms.iter().zip(&values).map(|(term, value)| term[s] * value).sum();
        (0..self.samples.len()).map(of_sample).collect()
    }
}

fn length(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// All monomials up to the order 1 or 2, by ascending degree.
fn monomials(order: usize, [x, y, z]: Vec3) -> Vec<f64> {
    let mut all = vec![1.0, x, y, z];
    if order > 1 {
        all.extend([x * x, y * y, z * z, y * z, x * z, x * y]);
    }
    all
}
