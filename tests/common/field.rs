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

/// A field of second degree; its linear part is [`linear`].
pub fn quadratic([x, y, z]: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = linear([x, y, z]);
    [a + 3.0 * x * y - z * z, b + x * x - 2.0 * y * z, c + y * y + x * z + 5.0 * x * x]
}

/// A linear field.
pub fn linear([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.3 + x - 2.0 * y + 0.5 * z, -0.2 + 0.7 * x + y - z, 0.1 - x + 0.4 * y + 3.0 * z]
}
