//! Localisation of the paper: the contact force acts at one point of the surface.

use petsc_wrap::Int;

use super::location::site;
use crate::contact::Localization;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::Impactor;

impl Localization {
    /// Shape functions at the impact point times the direction of travel: one entry for each node of the facet that
    /// contains the point, and for each component of the direction. Collective.
    ///
    /// # Errors
    /// A fault of the scene, if the point is off the surface or the direction leads out of the body. If a PETSc call
    /// fails.
    pub fn point(mesh: &Mesh, impactor: &Impactor) -> Result<Self> {
        let site = site(mesh, impactor)?;
        let mut weights: Vec<(Int, f64)> = site.nodes.into_iter().zip(site.weights).collect();
        weights.sort_by_key(|(node, _)| *node);
        Self::of_nodes(mesh, &weights, impactor.direction)
    }
}
