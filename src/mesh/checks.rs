//! Checks that reject unusable meshes.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;

use crate::agree::agree;
use crate::element::{Element, Quadrature, Table};
use crate::error::Result;
use crate::scene::{Fault, Vec3};

use super::{Elements, mean};

/// Largest allowed coordinate, m. No body is larger, and squares and cubes of much larger lengths would overflow.
const LARGEST_COORDINATE: f64 = 1e6;

/// Rejects coordinates beyond the largest allowed one. Collective.
pub(super) fn check_extent(comm: &Comm, coordinates: &[Vec3]) -> Result<()> {
    let here = coordinates.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut most = 0.0;
    comm.mpi().all_reduce_into(&here, &mut most, SystemOperation::max());
    if most <= LARGEST_COORDINATE {
        return Ok(());
    }
    let message = format!("the mesh has a coordinate of {most:e} m");
    Err(Fault::new(
        "body.mesh",
        message,
        format!("coordinates in m, of at most {LARGEST_COORDINATE:e}: mend or remake the mesh"),
    )
    .into())
}

/// Rejects cells that are inverted at a vertex, e.g. because two of their nodes are exchanged: the faces of such a cell
/// do not fit its neighbours. A cell without such a vertex may still have a negative determinant inside; this is
/// detected at its quadrature points. Collective.
pub(super) fn check_untangled(comm: &Comm, cells: &Elements) -> Result<()> {
    let points = cells.shape.reference_vertices().to_vec();
    let at_vertices = Quadrature { weights: vec![0.0; points.len()], points };
    let table = Table::new(&Element::new(cells.shape, 1), &at_vertices);
    let is_tangled = |x: &[Vec3]| {
        let each: Vec<f64> = (0..table.points()).map(|q| table.jacobian(q, x).determinant()).collect();
        let largest = each.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        // If nodes coincide, the determinant is zero up to rounding.
        each.iter().any(|d| *d < -1e-9 * largest)
    };
    let first = (0..cells.len()).find(|i| is_tangled(cells.x(*i)));
    let found = first.map_or(Ok(()), |i| {
        let [x, y, z] = mean(cells.x(i).iter().copied());
        Err(format!("the mesh has a tangled cell at [{x:.6}, {y:.6}, {z:.6}]: it is inside out at a vertex"))
    });
    Ok(agree(comm, found).map_err(|message| Fault::new("body.mesh", message, "mend or remake the mesh"))?)
}
