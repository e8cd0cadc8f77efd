//! Integrals over one cell or facet: numbers in, small dense matrices out. Pure: no mesh, no solver.
//!
//! Unknowns of a cell are numbered node-major: 3·node + component, nodes in the order of [`crate::element::Element`].
//! With n nodes a matrix is a row-major slice of (3n)² and a vector a slice of 3n; both are overwritten. The vertex
//! coordinates `x` come in the order of the shape's reference vertices. Nothing is allocated after construction.

mod disc;
pub mod elastic;
mod lumping;
mod pad;
pub mod plate;
mod pressure;
mod solid;
pub(crate) mod spline;
mod spread;
pub mod stress;
mod surface;
pub mod tensor;

pub use disc::{hertz_terms, hertz_wave, pressure_rule};
pub use lumping::lump;
pub use pad::{PadForms, PadPoint, pressed_depth};
pub use pressure::PressureForms;
pub use solid::{Material, SolidForms, Tangled};
pub use spline::{Parity, Spline};
pub use spread::Spread;
pub use surface::SurfaceForms;

use crate::element::Table;

/// Σ_q s_q φ_a φ_b into the n×n slice `out`, with the scale s of each point.
///
/// The lower triangle is copied from the upper one: rounding must not break the symmetry.
fn scalar_products(table: &Table, scale: &[f64], out: &mut [f64]) {
    let n = table.nodes();
    out.fill(0.);
    for (q, &scale) in scale.iter().enumerate() {
        let values = table.values(q);
        for (a, row) in out.chunks_exact_mut(n).enumerate() {
            let factor = scale * values[a];
            for (entry, b) in row[a..].iter_mut().zip(&values[a..]) {
                *entry += factor * b;
            }
        }
    }
    for a in 1..n {
        for b in 0..a {
            out[a * n + b] = out[b * n + a];
        }
    }
}

/// Adds `factor` times the n×n `block` to the entries of `out` that couple one component with itself.
fn add_component(block: &[f64], n: usize, component: usize, factor: f64, out: &mut [f64]) {
    let rows = out.chunks_exact_mut(3 * n).skip(component).step_by(3);
    for (row, block) in rows.zip(block.chunks_exact(n)) {
        for (entry, value) in row[component..].iter_mut().step_by(3).zip(block) {
            *entry += factor * value;
        }
    }
}

/// Adds the value at a point, times the shape functions there, to a vector.
fn add_point_load(values: &[f64], load: [f64; 3], out: &mut [f64]) {
    for (entries, value) in out.chunks_exact_mut(3).zip(values) {
        for (entry, load) in entries.iter_mut().zip(load) {
            *entry += value * load;
        }
    }
}
