//! Held components of the displacement, (2), and those normal to planes of symmetry.

use petsc_wrap::{Insert, Int, Vector};

use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::{Support, SupportKind, Vec3};

/// Which unknowns are held, and where.
pub struct Clamps {
    /// 1 for a free unknown, 0 for a held one.
    pub free: Vector,
    /// ū of the held unknowns, m; 0 for the free ones.
    pub displacement: Vector,
    /// Global numbers of this rank's held unknowns.
    pub rows: Vec<Int>,
}

impl Clamps {
    /// The clamps among the supports and the planes of symmetry; where two hold one unknown, the later one's ū stands. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(mesh: &Mesh, supports: &[Support]) -> Result<Self> {
        Self::with(mesh, supports, |support, _| support.displacement)
    }

    /// As [`Clamps::new`], with ū a function of the node's reference position: for tests by manufactured solutions.
    ///
    /// # Errors
    /// PETSc's.
    pub fn with(mesh: &Mesh, supports: &[Support], value: impl Fn(&Support, Vec3) -> Vec3) -> Result<Self> {
        let mut free = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
        free.fill(1.0)?;
        let mut displacement = free.duplicate()?;
        for support in supports {
            let SupportKind::Clamped { components } = support.kind else { continue };
            for &facet in &mesh.surfaces[&support.surface] {
                for (&node, x) in mesh.facets.nodes(facet).iter().zip(mesh.facets.node_positions(facet)) {
                    let u = value(support, x);
                    for component in (0..3).filter(|&c| components[c]) {
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
        let first = free.range().start;
        let held = |(i, free): (usize, &f64)| (*free == 0.0).then_some(first + i as Int);
        let rows = free.read()?.iter().enumerate().filter_map(held).collect();
        Ok(Self { free, displacement, rows })
    }

    /// Sets the held unknowns of a vector, which may be longer, to zero.
    ///
    /// # Errors
    /// PETSc's.
    pub fn zero(&self, vector: &mut Vector) -> petsc_wrap::Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let first = vector.range().start;
        let mut values = vector.write()?;
        for row in &self.rows {
            values[(row - first) as usize] = 0.0;
        }
        Ok(())
    }
}
