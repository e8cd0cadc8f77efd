//! One-sided elastic support (12) over one facet.

use super::{add_component, add_point_load, scalar_products};
use crate::element::{Element, Quadrature, Shape, Table};

/// A pad under one facet, with the space that its terms need.
///
/// With n the unit vector into the pad, each component i with n_i ≠ 0 pushes back where its penetration
/// g_i = s_i (u_i − ū_i), s_i = sign n_i, is positive. The integrand has a kink, so the rule is part of the model: it is
/// the one of degree 2·order, on triangles of order 2 the symmetric 6-point rule.
#[derive(Debug, Clone)]
pub struct PadForms {
    table: Table,
    stiffness: [f64; 3],
    /// s_i, 0 where n_i = 0.
    sign: [f64; 3],
    displacement: [f64; 3],
    scale: Vec<f64>,
    block: Vec<f64>,
}

impl PadForms {
    /// Forms on a facet's shape with elements of order 1 or 2; `stiffness` k (N/m³) by component, `normal` into the pad,
    /// `displacement` ū of the pad (m).
    pub fn new(shape: Shape, order: usize, stiffness: [f64; 3], normal: [f64; 3], displacement: [f64; 3]) -> Self {
        let element = Element::new(shape, order);
        let table = Table::new(&element, &Quadrature::exact(shape, 2 * order));
        Self {
            stiffness,
            sign: normal.map(|n| if n == 0. { 0. } else { n.signum() }),
            displacement,
            scale: vec![0.; table.points()],
            block: vec![0.; table.nodes() * table.nodes()],
            table,
        }
    }

    /// Number of nodes of the facet.
    pub fn nodes(&self) -> usize {
        self.table.nodes()
    }

    /// Σ_i ∫ k_i ⟨g_i⟩ s_i v_i dS at the facet's unknowns `u`, N; with unknowns `from`, the mean of ⟨g_i⟩ between the two that
    /// does just the potential's work (its discrete gradient).
    pub fn residual(&self, x: &[[f64; 3]], from: Option<&[f64]>, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for (q, area) in self.table.areas(x).enumerate() {
            let push = self.push(q, from, u);
            let force = [0, 1, 2].map(|i| area * self.stiffness[i] * push[i].0 * self.sign[i]);
            add_point_load(self.table.values(q), force, out);
        }
    }

    /// The semi-smooth derivative of the residual with respect to `u`, N/m: Σ_i ∫ k_i u_i v_i dS over the points where g_i > 0,
    /// or with what the mean has of it.
    pub fn tangent(&mut self, x: &[[f64; 3]], from: Option<&[f64]>, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for i in 0..3 {
            if self.sign[i] == 0. {
                continue;
            }
            let mut touched = false;
            for (q, area) in self.table.areas(x).enumerate() {
                let slope = self.push(q, from, u)[i].1;
                self.scale[q] = slope * area;
                touched |= slope != 0.;
            }
            if touched {
                scalar_products(&self.table, &self.scale, &mut self.block);
                add_component(&self.block, self.table.nodes(), i, self.stiffness[i], out);
            }
        }
    }

    /// Σ_i ∫ k_i u_i v_i dS over the components that the pad resists, N: the tangent of a pad pressed everywhere, which is the
    /// largest, times `u`.
    pub fn pressed(&self, x: &[[f64; 3]], u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for (q, area) in self.table.areas(x).enumerate() {
            let at_point = self.displacement_at(q, u);
            let force = [0, 1, 2].map(|i| area * self.stiffness[i] * self.sign[i].abs() * at_point[i]);
            add_point_load(self.table.values(q), force, out);
        }
    }

    /// Σ_i ½ ∫ k_i ⟨g_i⟩² dS, J.
    pub fn potential(&self, x: &[[f64; 3]], u: &[f64]) -> f64 {
        let density = |q| {
            let g = self.penetration(q, u).map(positive_part);
            (0..3).map(|i| 0.5 * self.stiffness[i] * g[i].powi(2)).sum::<f64>()
        };
        self.table.areas(x).enumerate().map(|(q, area)| area * density(q)).sum()
    }

    /// The points of a facet with the components that are resisted there: what the sums above consist of.
    pub fn points<'a>(&'a self, x: &'a [[f64; 3]]) -> impl Iterator<Item = PadPoint<'a>> {
        self.table.areas(x).enumerate().flat_map(move |(q, area)| {
            let resisted = (0..3).filter(|&i| self.sign[i] != 0. && self.stiffness[i] > 0.);
            resisted.map(move |component| PadPoint {
                component,
                weight: self.stiffness[component] * area,
                sign: self.sign[component],
                offset: self.sign[component] * self.displacement[component],
                values: self.table.values(q),
            })
        })
    }

    /// ⟨g⟩ or its mean at a point, by component, with its derivative.
    fn push(&self, q: usize, from: Option<&[f64]>, u: &[f64]) -> [(f64, f64); 3] {
        let g = self.penetration(q, u);
        let before = from.map(|from| self.penetration(q, from));
        [0, 1, 2].map(|i| pressed_depth(before.map(|before| before[i]), g[i]))
    }

    /// g at a point, by component.
    fn penetration(&self, q: usize, u: &[f64]) -> [f64; 3] {
        let u = self.displacement_at(q, u);
        [0, 1, 2].map(|i| self.sign[i] * (u[i] - self.displacement[i]))
    }

    /// u at a point.
    fn displacement_at(&self, q: usize, u: &[f64]) -> [f64; 3] {
        let mut sum = [0.; 3];
        for (value, u) in self.table.values(q).iter().zip(u.chunks_exact(3)) {
            for i in 0..3 {
                sum[i] += value * u[i];
            }
        }
        sum
    }
}

/// One component of a pad at one quadrature point: it pushes back with w ⟨g⟩, g = s Σ φ_a u_a − s ū.
#[derive(Debug, Clone, Copy)]
pub struct PadPoint<'a> {
    /// Which component.
    pub component: usize,
    /// w = k dS, N/m.
    pub weight: f64,
    /// s, 1 or −1.
    pub sign: f64,
    /// s ū, m.
    pub offset: f64,
    /// φ_a, by the facet's nodes.
    pub values: &'a [f64],
}

/// ⟨g⟩ (m) of a penetration, or, with the penetration `from` before a step, the mean of ⟨·⟩ that does just the work of ½⟨g⟩²;
/// and the derivative with respect to `to`.
pub fn pressed_depth(from: Option<f64>, to: f64) -> (f64, f64) {
    match from {
        None => (positive_part(to), if to > 0. { 1. } else { 0. }),
        Some(from) => mean(from, to),
    }
}

/// ⟨g⟩; it keeps NaN, so that a failed step is seen.
fn positive_part(g: f64) -> f64 {
    g.clamp(0., f64::INFINITY)
}

/// The difference of ½⟨g⟩² between two penetrations over their difference, and its derivative in the second.
fn mean(from: f64, to: f64) -> (f64, f64) {
    match (from > 0., to > 0.) {
        (true, true) => (0.5 * (from + to), 0.5),
        (false, false) => (0. * (from + to), 0.),
        (false, true) => {
            let part = to / (to - from);
            (0.5 * to * part, part * (1. - 0.5 * part))
        }
        (true, false) => {
            let part = from / (from - to);
            (0.5 * from * part, 0.5 * part * part)
        }
    }
}
