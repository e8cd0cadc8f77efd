//! Facets of a mesh as elements of its surface.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use nalgebra::Vector3;
use petsc_wrap::{Insert, Matrix, Vector};

use super::assembly::{assemble, unknowns, zeros};
use super::volume::{everywhere, forms};
use crate::description::{Extent, Part, Place};
use crate::element::{Element, Inverse, Quadrature, Shape, Table};
use crate::error::Result;
use crate::form::{SurfaceElement, SurfacePoint};
use crate::mesh::Mesh;
use crate::scene::Vec3;
use crate::space::clip::{AreaPoint, Clipped, clip, normal};
use crate::space::{Add, Space, Visit};

/// Quadrature rule on facets of one shape, with elements of one order.
pub struct FacetRule {
    element: Element,
    /// Rule of degree 2·order, which is exact on triangles and parallelograms. For order 2 it has six points on
    /// triangles.
    table: Table,
    degree: usize,
}

impl FacetRule {
    /// Rule for a shape of facets and an order of 1 or 2.
    pub fn new(shape: Shape, order: usize) -> Self {
        let (element, degree) = (Element::new(shape, order), 2 * order);
        Self { table: Table::new(&element, &Quadrature::exact(shape, degree)), element, degree }
    }

    /// Element with three unknowns for each node, node by node, and without quadrature points.
    fn without_points(&self) -> SurfaceElement {
        let unknowns = 3 * self.element.nodes();
        let of_component = [0, 1, 2].map(|component| (component..unknowns).step_by(3).collect());
        SurfaceElement { unknowns, of_component, points: Vec::new() }
    }

    /// Element of the portion of a facet with these vertices (m) within an extent of space. It has three unknowns for
    /// each node, node by node.
    pub fn element(&self, x: &[Vec3], extent: &Extent) -> SurfaceElement {
        let mut element = self.without_points();
        self.fill(x, extent, &mut element.points);
        element
    }

    fn fill(&self, x: &[Vec3], extent: &Extent, points: &mut Vec<SurfacePoint>) {
        match clip(x, extent, self.degree) {
            Clipped::Nothing => points.clear(),
            Clipped::Whole => {
                points.resize(self.table.points(), SurfacePoint::default());
                for (q, (point, area)) in points.iter_mut().zip(self.table.areas(x)).enumerate() {
                    set(point, self.table.position(q, x), area, self.table.values(q));
                }
            }
            Clipped::Points(clipped) => {
                points.resize(clipped.len(), SurfacePoint::default());
                let inverse = Projected::new(&self.element, x);
                let mut values = vec![0.0; self.element.nodes()];
                for (point, AreaPoint { position, area }) in points.iter_mut().zip(clipped) {
                    self.element.values(inverse.at(position), &mut values);
                    set(point, position, area, &values);
                }
            }
        }
    }
}

/// A mesh as a space: integrals are taken over its cells and facets.
pub struct FiniteElements<'a> {
    mesh: &'a Mesh,
    rule: FacetRule,
}

impl<'a> FiniteElements<'a> {
    /// Space on a mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, rule: FacetRule::new(mesh.facets.shape, mesh.facets.order) }
    }
}

/// Sets a quadrature point; the shape functions of all three components are the same.
fn set(point: &mut SurfacePoint, position: Vec3, area: f64, values: &[f64]) {
    (point.position, point.area) = (position, area);
    for shape in &mut point.shape {
        shape.clear();
        shape.extend_from_slice(values);
    }
}

/// A facet projected onto its plane.
struct Projected {
    origin: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    inverse: Inverse,
}

impl Projected {
    fn new(element: &Element, x: &[Vec3]) -> Self {
        let x: Vec<Vector3<f64>> = x.iter().copied().map(Vector3::from).collect();
        let normal = normal(&x);
        let along = x[1] - x[0];
        let first = (along - normal * normal.dot(&along)).normalize();
        let axes = [first, normal.cross(&first)];
        let plane: Vec<[f64; 2]> = x.iter().map(|v| axes.each_ref().map(|axis| axis.dot(&(v - x[0])))).collect();
        Self { origin: x[0], axes, inverse: Inverse::new(element.shape(), &plane) }
    }

    /// Reference coordinates of a point of the facet.
    fn at(&self, point: Vec3) -> Vec3 {
        let from = Vector3::from(point) - self.origin;
        self.inverse.at(self.axes.each_ref().map(|axis| axis.dot(&from)))
    }
}

impl Space for FiniteElements<'_> {
    type Matrix = Matrix;
    type Vector = Vector;

    fn visit(&self, place: &Place, visit: &mut Visit) -> Result<()> {
        let facets = &self.mesh.facets;
        let mut element = self.rule.without_points();
        let mut numbers = Vec::with_capacity(element.unknowns);
        for &facet in &self.mesh.surfaces[&place.surface] {
            self.rule.fill(facets.x(facet), &place.extent, &mut element.points);
            if !element.points.is_empty() {
                unknowns(facets.nodes(facet), &mut numbers);
                visit(&numbers, &element)?;
            }
        }
        Ok(())
    }

    fn body_force(&self, parts: &[Part], add: &mut Add) -> Result<()> {
        let Mesh { cells, parts_of_cells, .. } = self.mesh;
        let forms = forms(parts, self.mesh);
        let kernel = |i: usize, x: &[Vec3], block: &mut [f64]| {
            let part = parts_of_cells[i];
            forms[part].load(x, |_| parts[part].force, block)
        };
        everywhere(self.mesh, assemble(cells, 0..cells.len(), 3 * cells.nodes_each(), kernel, add))
    }

    fn vector(&self, fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Vector> {
        let mut vector = Vector::new(&self.mesh.comm, 3 * self.mesh.owned_nodes)?;
        fill(&mut |unknowns, values| Ok(vector.set_values(unknowns, values, Insert::Add)?))?;
        vector.assemble()?;
        Ok(vector)
    }

    fn matrix(&self, places: &[&Place], fill: impl FnOnce(&mut Add) -> Result<()>) -> Result<Matrix> {
        let Mesh { comm, owned_nodes, facets, surfaces, .. } = self.mesh;
        let chosen = places.iter().flat_map(|place| surfaces[&place.surface].iter().copied());
        let mut matrix = zeros(comm, *owned_nodes, facets, chosen)?;
        fill(&mut |unknowns, values| Ok(matrix.set_values(unknowns, unknowns, values, Insert::Add)?))?;
        matrix.assemble()?;
        Ok(matrix)
    }

    fn sum(&self, here: f64) -> f64 {
        let mut all = 0.0;
        self.mesh.comm.mpi().all_reduce_into(&here, &mut all, SystemOperation::sum());
        all
    }
}
