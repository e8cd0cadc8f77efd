//! Elastic supports (11), dampers (13) and tractions (3) over one facet.

use super::{add_component, add_point_load, scalar_products};
use crate::element::{Element, Quadrature, Shape, Table};

/// Linear terms on one facet, with the space that they need.
#[derive(Debug, Clone)]
pub struct SurfaceForms {
    table: Table,
    scale: Vec<f64>,
    block: Vec<f64>,
}

impl SurfaceForms {
    /// Forms on a facet's shape with elements of order 1 or 2, by a rule of degree 2·order: exact on triangles and
    /// parallelograms.
    pub fn new(shape: Shape, order: usize) -> Self {
        let element = Element::new(shape, order);
        let table = Table::new(&element, &Quadrature::exact(shape, 2 * order));
        Self { scale: vec![0.; table.points()], block: vec![0.; table.nodes() * table.nodes()], table }
    }

    /// Number of nodes of the facet.
    pub fn nodes(&self) -> usize {
        self.table.nodes()
    }

    /// Σ_i ∫ k_i u_i v_i dS with one coefficient a component: N/m for the k of (11), N s/m for the c of (13).
    pub fn spring(&mut self, x: &[[f64; 3]], k: [f64; 3], out: &mut [f64]) {
        for (scale, area) in self.scale.iter_mut().zip(self.table.areas(x)) {
            *scale = area;
        }
        scalar_products(&self.table, &self.scale, &mut self.block);
        out.fill(0.);
        for (component, k) in k.into_iter().enumerate() {
            add_component(&self.block, self.table.nodes(), component, k, out);
        }
    }

    /// ∫ f·v dS with the traction `f` (N/m²) at a point of space, N.
    pub fn traction(&self, x: &[[f64; 3]], f: impl Fn([f64; 3]) -> [f64; 3], out: &mut [f64]) {
        out.fill(0.);
        for (q, area) in self.table.areas(x).enumerate() {
            let force = f(self.table.position(q, x)).map(|f| area * f);
            add_point_load(self.table.values(q), force, out);
        }
    }

    /// The facet's area, m².
    pub fn area(&self, x: &[[f64; 3]]) -> f64 {
        self.table.areas(x).sum()
    }
}
