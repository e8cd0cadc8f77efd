//! Integrals over the cells of a mesh.

use petsc_wrap::{Insert, Int, Matrix};

use super::assembly::{Stopped, assemble, into_matrix, zeros};
use crate::agree::agree;
use crate::description::Part;
use crate::error::Result;
use crate::form::{Lame, SolidForms};
use crate::mesh::Mesh;
use crate::scene::{Fault, Vec3};

/// Stiffness matrix K summed over all cells into a matrix of zeros; viscoelastic parts have their fully relaxed moduli.
/// Collective.
pub(super) fn stiffness(parts: &[Part], mesh: &Mesh, mut matrix: Matrix) -> Result<Matrix> {
    let mut forms = forms(parts, mesh);
    let size = (3 * mesh.cells.nodes_each()).pow(2);
    let kernel = |i: usize, x: &[Vec3], block: &mut [f64]| forms[mesh.parts_of_cells[i]].stiffness(x, block);
    everywhere(mesh, assemble(&mesh.cells, 0..mesh.cells.len(), size, kernel, into_matrix(&mut matrix)))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// Distortion matrix D of the cells of some parts: their deviatoric stiffness for a shear modulus of 1 Pa. Collective.
pub(super) fn distortion(mesh: &Mesh, is_of: impl Fn(usize) -> bool) -> Result<Matrix> {
    let Mesh { comm, owned_nodes, cells, parts_of_cells, .. } = mesh;
    let chosen: Vec<usize> = (0..cells.len()).filter(|i| is_of(parts_of_cells[*i])).collect();
    let mut matrix = zeros(comm, *owned_nodes, cells, chosen.iter().copied())?;
    let mut forms = SolidForms::of_lame(cells.shape, cells.order, Lame::DEVIATORIC, 0.0);
    let size = (3 * cells.nodes_each()).pow(2);
    let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| forms.stiffness(x, block);
    everywhere(mesh, assemble(cells, chosen, size, kernel, into_matrix(&mut matrix)))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// Mass matrix M with one entry for each pair of nodes, the same for all three components, summed into a matrix of
/// zeros. Collective.
pub(super) fn mass_by_node(parts: &[Part], mesh: &Mesh, mut matrix: Matrix) -> Result<Matrix> {
    let cells = &mesh.cells;
    let mut forms = forms(parts, mesh);
    let mut numbers = vec![0; cells.nodes_each()];
    let sink = |indices: &[Int], block: &[f64]| {
        numbers.iter_mut().zip(indices.iter().step_by(3)).for_each(|(node, unknown)| *node = unknown / 3);
        Ok(matrix.set_values(&numbers, &numbers, block, Insert::Add)?)
    };
    let size = cells.nodes_each().pow(2);
    let kernel = |i: usize, x: &[Vec3], block: &mut [f64]| forms[mesh.parts_of_cells[i]].mass_by_node(x, block);
    everywhere(mesh, assemble(cells, 0..cells.len(), size, kernel, sink))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// Element forms with the material of each part, on the cells of the mesh.
pub(super) fn forms(parts: &[Part], mesh: &Mesh) -> Vec<SolidForms> {
    let of_part = |part: &Part| {
        let (lame, density) = (part.material.relaxed(), part.material.instantaneous.density);
        SolidForms::of_lame(mesh.cells.shape, mesh.cells.order, lame, density)
    };
    parts.iter().map(of_part).collect()
}

/// Turns a tangled (inverted) cell on one rank into a fault on all ranks. Collective.
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
