//! Lumped mass and damping matrices of a body: diagonal matrices, for explicit time steps without a linear solve.

use petsc_wrap::Vector;

use super::assembly::{assemble, into_vector};
use super::facets::FiniteElements;
use super::volume::{everywhere, forms};
use crate::body::Lumped;
use crate::description::{Description, Part};
use crate::error::Result;
use crate::form::lump;
use crate::mesh::Mesh;
use crate::scene::Vec3;
use crate::space::{Add, Space};

impl Lumped {
    /// Sums the lumped matrices of cells and facets ([`lump`]). Collective.
    ///
    /// # Errors
    /// A fault of the mesh, if a cell is tangled (inverted). If a PETSc call fails.
    ///
    /// # Panics
    /// If the mesh lacks a surface that the description names. Building a [`Body`](crate::body::Body) checks this.
    pub fn new(description: &Description, mesh: &Mesh) -> Result<Self> {
        Ok(Self { mass: mass(&description.parts, mesh)?, damping: damping(description, mesh)? })
    }
}

fn mass(parts: &[Part], mesh: &Mesh) -> Result<Vector> {
    let cells = &mesh.cells;
    let mut mass = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    let mut forms = forms(parts, mesh);
    let size = 3 * cells.nodes_each();
    let mut consistent = vec![0.0; size * size];
    let kernel = |i: usize, x: &[Vec3], block: &mut [f64]| {
        forms[mesh.parts_of_cells[i]].mass(x, &mut consistent)?;
        lump(&consistent, block);
        Ok(())
    };
    everywhere(mesh, assemble(cells, 0..cells.len(), size, kernel, into_vector(&mut mass)))?;
    mass.assemble()?;
    Ok(mass)
}

fn damping(description: &Description, mesh: &Mesh) -> Result<Option<Vector>> {
    if description.dampers.is_empty() {
        return Ok(None);
    }
    let space = FiniteElements::new(mesh);
    let fill = |add: &mut Add| {
        let (mut consistent, mut lumped) = (Vec::new(), Vec::new());
        for damper in &description.dampers {
            for place in &damper.region {
                space.visit(place, &mut |unknowns, element| {
                    consistent.resize(unknowns.len().pow(2), 0.0);
                    lumped.resize(unknowns.len(), 0.0);
                    element.spring(damper.coefficient, &mut consistent);
                    lump(&consistent, &mut lumped);
                    add(unknowns, &lumped)
                })?;
            }
        }
        Ok(())
    };
    space.vector(fill).map(Some)
}
