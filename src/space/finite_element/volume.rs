//! Integrals over the cells.

use petsc_wrap::{Insert, Int, Matrix};

use super::assembly::{Stopped, assemble, into_matrix};
use crate::agree::agree;
use crate::error::Result;
use crate::form::{Material, SolidForms};
use crate::mesh::Mesh;
use crate::scene::{Fault, Vec3};

/// K summed over all cells into a matrix of zeros. Collective.
pub(super) fn stiffness(material: &Material, mesh: &Mesh, mut matrix: Matrix) -> Result<Matrix> {
    let mut forms = forms(material, mesh);
    let size = (3 * mesh.cells.nodes_each()).pow(2);
    let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| forms.stiffness(x, block);
    everywhere(mesh, assemble(&mesh.cells, 0..mesh.cells.len(), size, kernel, into_matrix(&mut matrix)))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// M, alike in all three components, summed with one entry for a pair of nodes into a matrix of zeros. Collective.
pub(super) fn mass_by_node(material: &Material, mesh: &Mesh, mut matrix: Matrix) -> Result<Matrix> {
    let cells = &mesh.cells;
    let mut forms = forms(material, mesh);
    let mut numbers = vec![0; cells.nodes_each()];
    let sink = |indices: &[Int], block: &[f64]| {
        numbers.iter_mut().zip(indices.iter().step_by(3)).for_each(|(node, unknown)| *node = unknown / 3);
        Ok(matrix.set_values(&numbers, &numbers, block, Insert::Add)?)
    };
    let size = cells.nodes_each().pow(2);
    everywhere(mesh, assemble(cells, 0..cells.len(), size, |_, x, block| forms.mass_by_node(x, block), sink))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// The kernels of a material on the mesh's cells.
pub(super) fn forms(material: &Material, mesh: &Mesh) -> SolidForms {
    SolidForms::new(mesh.cells.shape, mesh.cells.order, *material)
}

/// A tangled cell on one rank made a fault on all of them. Collective.
pub(super) fn everywhere(mesh: &Mesh, done: std::result::Result<(), Stopped>) -> Result<()> {
    let done = match done {
        Err(Stopped::Sink(error)) => return Err(error),
        Err(Stopped::Tangled([x, y, z])) => {
            Err(format!("the mesh has a tangled cell at [{x:.6}, {y:.6}, {z:.6}]: its volume is not positive"))
        }
        Ok(()) => Ok(()),
    };
    agree(&mesh.comm, done).map_err(|message| Fault::new("body.mesh", message, "mend or remake the mesh").into())
}
