//! Unknowns constrained by clamps (2) and planes of symmetry.

use petsc_wrap::{Insert, Int, Vector};

use crate::body::Clamps;
use crate::description::Clamp;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::Vec3;

/// Unknowns constrained by clamps and planes of symmetry. The prescribed displacement ū is a function of the reference
/// position of the node. If two clamps constrain an unknown, the later one applies. Collective.
///
/// # Errors
/// If a PETSc call fails.
pub fn held(mesh: &Mesh, clamps: &[Clamp], value: impl Fn(&Clamp, Vec3) -> Vec3) -> Result<Clamps> {
    let mut free = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    free.fill(1.0)?;
    let mut displacement = free.duplicate()?;
    for clamp in clamps {
        for &facet in &mesh.surfaces[&clamp.surface] {
            for (&node, x) in mesh.facets.nodes(facet).iter().zip(mesh.facets.node_positions(facet)) {
                let u = value(clamp, x);
                for component in (0..3).filter(|&c| clamp.components[c]) {
                    let unknown = [3 * node + component as Int];
                    free.set_values(&unknown, &[0.0], Insert::Replace)?;
                    displacement.set_values(&unknown, &[u[component]], Insert::Replace)?;
                }
            }
        }
        free.assemble()?;
        displacement.assemble()?;
    }
    for (axis, nodes) in mesh.mirror_nodes.iter().enumerate() {
        for node in nodes {
            let unknown = [3 * node + axis as Int];
            free.set_values(&unknown, &[0.0], Insert::Replace)?;
            displacement.set_values(&unknown, &[0.0], Insert::Replace)?;
        }
    }
    free.assemble()?;
    displacement.assemble()?;
    Clamps::new(free, displacement)
}
