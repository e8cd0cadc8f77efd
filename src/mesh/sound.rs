//! What no body's mesh has.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;

use crate::agree::agree;
use crate::element::{Element, Quadrature, Table};
use crate::error::Result;
use crate::scene::{Fault, Vec3};

use super::{Elements, mean};

/// No body reaches further from the origin, m; beyond that squares and cubes of lengths leave the numbers that there are.
const FAR: f64 = 1e6;

/// Refuses coordinates that are none of a body. Collective.
pub(super) fn check_extent(comm: &Comm, coordinates: &[Vec3]) -> Result<()> {
    let here = coordinates.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut most = 0.0;
    comm.mpi().all_reduce_into(&here, &mut most, SystemOperation::max());
    if most <= FAR {
        return Ok(());
    }
    let message = format!("the mesh has a coordinate of {most:e} m");
    Err(Fault::new("body.mesh", message, format!("coordinates in m, of at most {FAR:e}: mend or remake the mesh"))
        .into())
}

/// Refuses cells that are turned inside out at a vertex, as where two of their nodes are exchanged: the faces of such a cell lead nowhere.
/// (Of a cell without such a vertex the volume may still be negative somewhere: that shows at its quadrature points.) Collective.
pub(super) fn check_untangled(comm: &Comm, cells: &Elements) -> Result<()> {
    let points = cells.shape.reference_vertices().to_vec();
    let at_vertices = Quadrature { weights: vec![0.0; points.len()], points };
    let table = Table::new(&Element::new(cells.shape, 1), &at_vertices);
    let is_tangled = |x: &[Vec3]| {
        let each: Vec<f64> = (0..table.points()).map(|q| table.jacobian(q, x).determinant()).collect();
        let largest = each.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        // Where nodes lie on each other it is zero, but for rounding.
        each.iter().any(|d| *d < -1e-9 * largest)
    };
    let first = (0..cells.len()).find(|i| is_tangled(cells.x(*i)));
    let found = first.map_or(Ok(()), |i| {
        let [x, y, z] = mean(cells.x(i).iter().copied());
        Err(format!("the mesh has a tangled cell at [{x:.6}, {y:.6}, {z:.6}]: it is inside out at a vertex"))
    });
    Ok(agree(comm, found).map_err(|message| Fault::new("body.mesh", message, "mend or remake the mesh"))?)
}
