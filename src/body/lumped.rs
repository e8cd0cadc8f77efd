//! Lumped mass and damping of a body: diagonals, for steps that solve nothing.

use petsc_wrap::Vector;

use crate::error::Result;
use crate::form::{SurfaceForms, lump};
use crate::mesh::Mesh;
use crate::scene::{Scene, Vec3};

use super::assembly::{assemble, into_vector};
use super::solid::{everywhere, forms};

/// The diagonals in the places of M and C, one value an unknown, those of held ones included.
pub struct Lumped {
    /// Of M, kg: positive, each component summing to the body's mass.
    pub mass: Vector,
    /// Of C of the dampers (13), N s/m: not negative; `None` where the scene has no damper.
    pub damping: Option<Vector>,
}

impl Lumped {
    /// Sums the cells' and facets' lumped matrices ([`lump`]). Collective.
    ///
    /// # Errors
    /// A fault of the mesh, a tangled cell; PETSc's.
    ///
    /// # Panics
    /// When the mesh has not the surfaces that the scene names: building a [`Body`](super::Body) finds that out.
    pub fn new(scene: &Scene, mesh: &Mesh) -> Result<Self> {
        Ok(Self { mass: mass(scene, mesh)?, damping: damping(scene, mesh)? })
    }
}

fn mass(scene: &Scene, mesh: &Mesh) -> Result<Vector> {
    let cells = &mesh.cells;
    let mut mass = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    let mut forms = forms(scene, mesh);
    let size = 3 * cells.nodes_each();
    let mut consistent = vec![0.0; size * size];
    let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| {
        forms.mass(x, &mut consistent)?;
        lump(&consistent, block);
        Ok(())
    };
    everywhere(mesh, assemble(cells, 0..cells.len(), size, kernel, into_vector(&mut mass)))?;
    mass.assemble()?;
    Ok(mass)
}

fn damping(scene: &Scene, mesh: &Mesh) -> Result<Option<Vector>> {
    let mut dampers = scene.supports.iter().filter(|support| support.damping != [0.0; 3]).peekable();
    if dampers.peek().is_none() {
        return Ok(None);
    }
    let facets = &mesh.facets;
    let mut damping = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    let mut forms = SurfaceForms::new(facets.shape, facets.order);
    let size = 3 * facets.nodes_each();
    let mut consistent = vec![0.0; size * size];
    for support in dampers {
        let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| {
            forms.spring(x, support.damping, &mut consistent);
            lump(&consistent, block);
            Ok(())
        };
        let chosen = mesh.surfaces[&support.surface].iter().copied();
        everywhere(mesh, assemble(facets, chosen, size, kernel, into_vector(&mut damping)))?;
    }
    damping.assemble()?;
    Ok(Some(damping))
}
