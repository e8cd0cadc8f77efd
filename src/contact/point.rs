//! The paper's localisation: the contact force at one point of the surface.

use petsc_wrap::{Insert, Int, Vector};

use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::{Fault, Impactor};

/// The vector a of (14): aᵀu is the surface's displacement under the impactor, a F the load on the body.
pub struct Localization {
    /// a, distributed as the displacements.
    pub vector: Vector,
    /// The entries that are not zero, with their global numbers; all on one rank.
    pub entries: Vec<(Int, f64)>,
    /// c_l.
    pub compliance: f64,
}

impl Localization {
    /// Shape functions at the impact point times the direction of travel: one entry for each node of the facet that
    /// holds the point and each component of the direction. Collective.
    ///
    /// # Errors
    /// A fault of the scene where the point is off the surface or the direction leads out of the body; PETSc's.
    pub fn point(mesh: &Mesh, impactor: &Impactor) -> Result<Self> {
        let direction = impactor.direction;
        let site = mesh.locate(impactor.point, direction);
        // Far above rounding, far below any cell.
        if site.distance > 1e-6 * mesh.diameter {
            let [x, y, z] = site.x;
            return Err(Fault::new(
                "impactor.point",
                format!("the impact point is {:.3e} m away from the body's surface", site.distance),
                format!("the nearest point of the surface is [{x:.9}, {y:.9}, {z:.9}]"),
            )
            .into());
        }
        let inward: f64 = -site.normal.iter().zip(direction).map(|(n, d)| n * d).sum::<f64>();
        if inward <= 1e-9 {
            let [x, y, z] = site.normal.map(|n| -n);
            return Err(Fault::new(
                "impactor.direction",
                "the direction does not lead into the body at the impact point",
                format!("the inward normal there is [{x:.6}, {y:.6}, {z:.6}]"),
            )
            .into());
        }
        let mut entries = Vec::new();
        for (&node, weight) in site.nodes.iter().zip(&site.weights) {
            for (component, d) in direction.iter().enumerate() {
                let value = weight * d;
                if value != 0.0 {
                    entries.push((3 * node + component as Int, value));
                }
            }
        }
        let mut vector = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
        let (indices, values): (Vec<Int>, Vec<f64>) = entries.iter().copied().unzip();
        vector.set_values(&indices, &values, Insert::Replace)?;
        vector.assemble()?;
        Ok(Self { vector, entries, compliance: 0.0 })
    }
}
