//! Fields on the nodes of a mesh.

use petsc_wrap::{Insert, Vector};
use ricochet::mesh::Mesh;

/// The nodal interpolant of a field. Collective.
pub fn interpolate(mesh: &Mesh, into: &mut Vector, field: impl Fn([f64; 3]) -> [f64; 3]) {
    for cell in 0..mesh.cells.len() {
        for (&node, x) in mesh.cells.nodes(cell).iter().zip(mesh.cells.node_positions(cell)) {
            into.set_values(&[3 * node, 3 * node + 1, 3 * node + 2], &field(x), Insert::Replace).unwrap();
        }
    }
    into.assemble().unwrap();
}
