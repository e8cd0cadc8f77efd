//! Impact point on a mesh, and the localisation vector a there.

use petsc_wrap::{Insert, Int, Vector};

use crate::contact::{Footprint, Localization};
use crate::error::Result;
use crate::mesh::{Mesh, Site};
use crate::scene::{Fault, Impactor, Vec3};

impl Localization {
    /// Localisation with weights by ascending node, times the direction. Collective.
    pub(super) fn of_nodes(mesh: &Mesh, weights: &[(Int, f64)], direction: Vec3) -> Result<Self> {
        let entries: Vec<(Int, f64)> = weights
            .iter()
            .flat_map(|&(node, weight)| {
                (0..).zip(direction).map(move |(component, d)| (3 * node + component, weight * d))
            })
            .filter(|(_, value)| *value != 0.0)
            .collect();
        let mut vector = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
        let here = vector.range();
        let (indices, values): (Vec<Int>, Vec<f64>) =
            entries.iter().copied().filter(|(index, _)| here.contains(index)).unzip();
        vector.set_values(&indices, &values, Insert::Replace)?;
        vector.assemble()?;
        Ok(Self { vector, entries, compliance: 0.0, footprint: Footprint::Point })
    }
}

/// Location of the impact point on the mesh. Collective.
///
/// # Errors
/// A fault of the scene, if the point is off the surface or the direction leads out of the body.
pub(super) fn site(mesh: &Mesh, impactor: &Impactor) -> Result<Site> {
    let direction = impactor.direction;
    let site = mesh.locate(impactor.point, direction);
    // This tolerance is far above rounding errors and far below the size of any cell.
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
    Ok(site)
}
