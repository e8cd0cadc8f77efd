//! Stresses at the nodes of a mesh: superconvergent patch recovery (O. C. Zienkiewicz & J. Z. Zhu, The superconvergent patch recovery
//! and a posteriori error estimates, part 1, Int. J. Numer. Methods Eng. 33, 1992).
//!
//! About each vertex a polynomial of the elements' order is fitted by least squares to the stresses at Gauss points of the cells that
//! meet there, and taken at the vertex; at a node between vertices the mean of theirs is. A patch of few cells, as at an edge of the
//! body, takes the neighbours of its cells too. Terms that its points do not tell apart from lower ones, as z² in a single layer of
//! cells, are left out.

use std::collections::BTreeSet;

use crate::element::{Element, Quadrature, Shape, Table};
use crate::mesh::Whole;
use crate::scene::Vec3;

use crate::space::evaluate::{Form, summed};

/// Samples of a patch over the terms of its polynomial, at least.
const ENOUGH: usize = 2;

/// What is left of a term at the samples without the lower terms, over the term itself, from which it counts.
const INDEPENDENT: f64 = 0.02;

/// A mesh with the points at which stresses are sampled.
pub struct Recovery {
    /// Gradients of the shape functions at the samples of a cell.
    table: Table,
    /// Where all samples are, m.
    places: Vec<Vec3>,
    /// Cells about each vertex; none about other nodes.
    about: Vec<Vec<usize>>,
    /// Vertices whose mean each node is.
    vertices: Vec<Vec<usize>>,
}

impl Recovery {
    /// Of a mesh: 2³ Gauss points in a hexahedron, in a tetrahedron its middle (order 1) or four points (order 2). Stresses jump between
    /// materials: a patch has cells of one part of the body, about a vertex between two of them those of the stiffer part. `stiffness` is each
    /// part's, Pa.
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

    /// Samples of each cell.
    pub fn samples_each(&self) -> usize {
        self.table.points()
    }

    /// Where a sample is, m; they are numbered cell by cell.
    pub fn place(&self, sample: usize) -> Vec3 {
        self.places[sample]
    }

    /// ∂φ/∂x of a cell's shape functions at one of its samples, 1/m.
    pub fn gradients(&self, mesh: &Whole, cell: usize, sample: usize) -> Vec<Vec3> {
        let jacobian = self.table.jacobian(sample, &mesh.x(cell));
        // Tangled cells are refused where the body is assembled.
        let to_space = jacobian.try_inverse().unwrap_or_default().transpose();
        let gradients = self.table.gradients(sample).iter();
        gradients.map(|&gradient| (to_space * nalgebra::Vector3::from(gradient)).into()).collect()
    }

    /// Each wanted node's stress as a sum over the samples, numbered cell by cell; the others' stay empty.
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
        while cells.len() * self.samples_each() < ENOUGH * terms {
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

/// A polynomial fitted to samples, by terms that are orthonormal on them.
struct Patch {
    order: usize,
    origin: Vec3,
    /// Half of the patch's extent along each axis, m.
    size: Vec3,
    samples: Vec<usize>,
    /// For each monomial its parts along the terms before it and, where it is a term itself, its length without them.
    parts: Vec<(Vec<f64>, Option<f64>)>,
    /// The terms' values at the samples.
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

    /// Weights of the samples in the polynomial's value at a point.
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

/// All monomials up to an order of 1 or 2, by ascending degree.
fn monomials(order: usize, [x, y, z]: Vec3) -> Vec<f64> {
    let mut all = vec![1.0, x, y, z];
    if order > 1 {
        all.extend([x * x, y * y, z * z, y * z, x * z, x * y]);
    }
    all
}
