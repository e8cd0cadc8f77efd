//! Meshes from lists of cells, and their distribution.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_sys as sys;

use super::{CellType, Plex};
use crate::Int;
use crate::comm::Comm;
use crate::error::{Error, Result, check, require};
use crate::text::int;

impl Plex {
    /// A box cut into hexahedra, all on rank 0 until [`Plex::distribute`]. Collective.
    ///
    /// # Errors
    /// No cell along an edge; more points than PETSc's integers number; PETSc's.
    pub fn hexahedral_box(comm: &Comm, cells: [usize; 3], lower: [f64; 3], upper: [f64; 3]) -> Result<Self> {
        require(cells.iter().all(|n| *n > 0), "a box without cells")?;
        // Cells, faces, edges and vertices; PETSc multiplies unchecked. Entries of the cones are twelve a cell at most, and closures longer.
        let points = cells.iter().try_fold(1_usize, |all, n| all.checked_mul(n.checked_mul(2)?.checked_add(1)?));
        int(points.and_then(|points| points.checked_mul(4)).unwrap_or(usize::MAX))?;
        let cells = [int(cells[0])?, int(cells[1])?, int(cells[2])?];
        let (simplex, interpolate) = (sys::FALSE, sys::TRUE);
        let mut raw = std::ptr::null_mut();
        let corners = (lower.as_ptr(), upper.as_ptr());
        // SAFETY: three entries each.
        check(unsafe {
            sys::create_box_mesh(comm.petsc()?, 3, simplex, cells.as_ptr(), corners, interpolate, &raw mut raw)
        })?;
        // SAFETY: the new mesh is ours.
        Ok(unsafe { Self::from_raw(raw, comm) })
    }

    /// A mesh of cells of one shape, of which each rank gives its own; they stay where they are given. Collective.
    ///
    /// `vertices` are the vertices of this rank's cells by their numbers over all ranks, as Gmsh and VTK order those of a cell. `coordinates` are
    /// those of this rank's share of all vertices: rank 0 has the first ones, and so on, in any proportion. This rank's cells become its points
    /// of dimension 3 in the order given, and their vertices its points of dimension 0 by ascending number.
    ///
    /// # Errors
    /// On all ranks: cells that are neither tetrahedra nor hexahedra, a vertex that no rank has, or one twice in a cell, no cell on any rank;
    /// more points than PETSc's integers number. PETSc's, on one rank alone, where hexahedra do not fit together.
    pub fn from_cells(comm: &Comm, shape: CellType, vertices: &[Int], coordinates: &[[f64; 3]]) -> Result<Self> {
        let corners = match shape {
            CellType::Tetrahedron => 4,
            CellType::Hexahedron => 8,
            _ => 0,
        };
        let sum = |mine: u64| {
            let mut all = 0;
            comm.mpi().all_reduce_into(&mine, &mut all, SystemOperation::sum());
            all
        };
        let total = sum(coordinates.len() as u64);
        let is_vertex = |vertex: &Int| u64::try_from(*vertex).is_ok_and(|vertex| vertex < total);
        let has_own = |cell: &[Int]| (0..cell.len()).all(|i| is_vertex(&cell[i]) && !cell[..i].contains(&cell[i]));
        let is_good =
            corners > 0 && vertices.len().is_multiple_of(corners) && vertices.chunks_exact(corners).all(has_own);
        // Entries of the cones of a hexahedron that shares nothing: 6 faces, 24 edges and 24 vertices; PETSc adds unchecked.
        let is_small = int((vertices.len() / corners.max(1)).saturating_mul(64)).is_ok() && int(total as usize).is_ok();
        require(sum(u64::from(!is_good)) == 0, "cells of other vertices than their shape and the mesh have")?;
        if sum(u64::from(!is_small)) > 0 {
            return Err(Error::TooLarge { number: vertices.len().max(total as usize) });
        }
        require(sum(vertices.len() as u64) > 0, "a mesh without cells")?;
        let mut cells = vertices.to_vec();
        for cell in cells.chunks_exact_mut(corners) {
            // DMPlex lists these the other way round.
            match shape {
                CellType::Hexahedron => cell.swap(1, 3),
                _ => cell.swap(0, 1),
            }
        }
        let (count, own, all) = (int(cells.len() / corners)?, int(coordinates.len())?, int(total as usize)?);
        let (corners, interpolate, none) = (int(corners)?, sys::TRUE, std::ptr::null_mut());
        let (cells, places) = (cells.as_ptr(), coordinates.as_ptr().cast());
        let (vertex_owners, numbers) = (none, std::ptr::null_mut());
        let mut raw = std::ptr::null_mut();
        // SAFETY: as many cells with as many vertices each, all of which are there, and three coordinates of each of this rank's share, whose sizes
        // sum to the total; the owners and numbers of vertices are not asked for.
        check(unsafe {
            sys::DMPlexCreateFromCellListParallelPetsc(
                comm.petsc()?,
                3,
                count,
                own,
                all,
                corners,
                interpolate,
                cells,
                3,
                places,
                vertex_owners,
                numbers,
                &raw mut raw,
            )
        })?;
        // SAFETY: the new mesh is ours.
        Ok(unsafe { Self::from_raw(raw, comm) })
    }

    /// The same mesh spread over the ranks by PETSc's partitioner (`-petscpartitioner_type`). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn distribute(self) -> Result<Self> {
        let mut partitioner = std::ptr::null_mut();
        // SAFETY: the mesh is valid; the partitioner belongs to it.
        check(unsafe { sys::DMPlexGetPartitioner(self.raw(), &raw mut partitioner) })?;
        if is_scotch_of_another_size() {
            // SAFETY: as above; the type is a C string.
            check(unsafe { sys::PetscPartitionerSetType(partitioner, c"simple".as_ptr()) })?;
        }
        // SAFETY: as above.
        check(unsafe { sys::PetscPartitionerSetFromOptions(partitioner) })?;
        let mut raw = std::ptr::null_mut();
        // SAFETY: the mesh is valid; no overlap, and the migration is not asked for.
        check(unsafe { sys::DMPlexDistribute(self.raw(), 0, std::ptr::null_mut(), &raw mut raw) })?;
        // PETSc makes no second mesh on a single rank.
        if raw.is_null() {
            return Ok(self);
        }
        let comm = self.0.comm().clone();
        self.0.destroy()?;
        // SAFETY: the new mesh is ours.
        Ok(unsafe { Self::from_raw(raw, &comm) })
    }
}

/// Whether PT-Scotch, with which PETSc partitions, counts in integers of another size than PETSc: where Debian's has indices of 64 bits it
/// does, and would spoil the memory.
fn is_scotch_of_another_size() -> bool {
    // SAFETY: a C string; no library is loaded.
    let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"SCOTCH_numSizeof".as_ptr()) };
    if found.is_null() {
        return false;
    }
    // SAFETY: this is what Scotch declares: `int SCOTCH_numSizeof (void)`.
    let size = unsafe { std::mem::transmute::<*mut libc::c_void, unsafe extern "C" fn() -> libc::c_int>(found) };
    // SAFETY: it returns a constant.
    usize::try_from(unsafe { size() }).is_ok_and(|size| size != size_of::<Int>())
}
