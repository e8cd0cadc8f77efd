//! Creation of meshes from lists of cells, and their distribution.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_sys as sys;

use super::{CellType, Plex};
use crate::Int;
use crate::comm::Comm;
use crate::error::{Error, Result, check, require};
use crate::text::int;

impl Plex {
    /// Creates a box of hexahedra, all on rank 0 until [`Plex::distribute`]. Collective.
    ///
    /// # Errors
    /// If there is no cell along an edge, if there are more points than PETSc's integers can number, or if a PETSc call
    /// fails.
    pub fn hexahedral_box(comm: &Comm, cells: [usize; 3], lower: [f64; 3], upper: [f64; 3]) -> Result<Self> {
        require(cells.iter().all(|n| *n > 0), "a box without cells")?;
        // Number of cells, faces, edges and vertices: PETSc multiplies without an overflow check. The cones have at
        // most twelve entries for each cell, and the closures more.
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

    /// Creates a mesh of cells of one shape. Each rank gives its own cells, and they stay on that rank. Collective.
    ///
    /// `vertices` are the global numbers of the vertices of this rank's cells, in the order of Gmsh and VTK within a
    /// cell. `coordinates` are the coordinates of this rank's share of all vertices: rank 0 has the first ones, and so
    /// on, with any share sizes. This rank's cells become its points of dimension 3 in the given order, and their
    /// vertices its points of dimension 0 by ascending number.
    ///
    /// # Errors
    /// On all ranks: if the cells are neither tetrahedra nor hexahedra, if no rank has a vertex, if a cell has a vertex
    /// twice, if no rank has a cell, or if there are more points than PETSc's integers can number. On one rank alone:
    /// if a PETSc call fails because hexahedra do not fit together.
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
        // Cone entries of a hexahedron that shares nothing: 6 faces, 24 edges and 24 vertices. PETSc adds without an
        // overflow check.
        let is_small = int((vertices.len() / corners.max(1)).saturating_mul(64)).is_ok() && int(total as usize).is_ok();
        require(sum(u64::from(!is_good)) == 0, "cells of other vertices than their shape and the mesh have")?;
        if sum(u64::from(!is_small)) > 0 {
            return Err(Error::TooLarge { number: vertices.len().max(total as usize) });
        }
        require(sum(vertices.len() as u64) > 0, "a mesh without cells")?;
        let mut cells = vertices.to_vec();
        for cell in cells.chunks_exact_mut(corners) {
            // DMPlex lists these in the opposite order.
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
        // SAFETY: the arrays hold the announced number of cells with this number of vertices each, all of which exist,
        // and three coordinates for each vertex of this rank's share. The sizes of the shares sum to the total. The
        // owners and numbers of vertices are not requested.
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

    /// Distributes the mesh over the ranks with PETSc's partitioner (`-petscpartitioner_type`). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
        // SAFETY: the mesh is valid; there is no overlap, and the migration is not requested.
        check(unsafe { sys::DMPlexDistribute(self.raw(), 0, std::ptr::null_mut(), &raw mut raw) })?;
        // On a single rank PETSc makes no second mesh.
        if raw.is_null() {
            return Ok(self);
        }
        let comm = self.0.comm().clone();
        self.0.destroy()?;
        // SAFETY: the new mesh is ours.
        Ok(unsafe { Self::from_raw(raw, &comm) })
    }
}

/// Whether PT-Scotch, with which PETSc partitions, uses integers of another size than PETSc. This is so in Debian's
/// build with 64-bit indices, where PT-Scotch would corrupt the memory.
fn is_scotch_of_another_size() -> bool {
    // SAFETY: a C string; no library is loaded.
    let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"SCOTCH_numSizeof".as_ptr()) };
    if found.is_null() {
        return false;
    }
    // SAFETY: Scotch declares the function like this: `int SCOTCH_numSizeof (void)`.
    let size = unsafe { std::mem::transmute::<*mut libc::c_void, unsafe extern "C" fn() -> libc::c_int>(found) };
    // SAFETY: it returns a constant.
    usize::try_from(unsafe { size() }).is_ok_and(|size| size != size_of::<Int>())
}
