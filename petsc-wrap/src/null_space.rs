//! Exact and near null spaces.

use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{Result, check, require};
use crate::layout::Layout;
use crate::object::Object;
use crate::vector::VectorView;

/// An orthonormal basis of the vectors that a matrix maps to zero, or nearly to zero.
pub struct NullSpace(Object<sys::_p_MatNullSpace>);

impl NullSpace {
    /// The six rigid motions of nodes in space, from their coordinates (three entries for each node). Collective.
    ///
    /// # Errors
    /// If a rank does not have three entries for each of its nodes, or if a PETSc call fails.
    pub fn rigid_body(coordinates: &mut VectorView) -> Result<Self> {
        let ends = coordinates.layout().ranges();
        require(ends.iter().all(|end| end % 3 == 0), "a node has not three coordinates")?;
        // SAFETY: the vector is valid here and below.
        check(unsafe { sys::VecSetBlockSize(coordinates.raw(), 3) })?;
        let mut raw = std::ptr::null_mut();
        // SAFETY: as above, and the out-pointer is valid.
        check(unsafe { sys::MatNullSpaceCreateRigidBody(coordinates.raw(), &raw mut raw) })?;
        // SAFETY: the new space is ours.
        Ok(unsafe { Self::from_raw(raw, coordinates.comm()) })
    }

    /// Takes ownership of a PETSc null space.
    ///
    /// # Safety
    /// `raw` is a reference to a valid null space, of vectors on `comm`, which nobody else releases or changes.
    pub unsafe fn from_raw(raw: sys::MatNullSpace, comm: &Comm) -> Self {
        // SAFETY: guaranteed by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::MatNullSpace {
        self.0.raw()
    }

    pub(crate) fn raw(&self) -> sys::MatNullSpace {
        self.0.raw()
    }

    /// Returns an error if a layout differs from the layout of the vectors: PETSc's preconditioners read the vectors
    /// with the matrix's layout.
    pub(crate) fn require_layout(&self, layout: Layout) -> Result<()> {
        let (mut constants, mut count, mut vectors) = (sys::FALSE, 0, std::ptr::null());
        // SAFETY: the space is valid; the vectors belong to it.
        check(unsafe { sys::MatNullSpaceGetVecs(self.raw(), &raw mut constants, &raw mut count, &raw mut vectors) })?;
        for i in 0..count as usize {
            let mut ranges = std::ptr::null();
            // SAFETY: PETSc has `count` vectors, all valid.
            check(unsafe { sys::VecGetOwnershipRanges(*vectors.add(i), &raw mut ranges) })?;
            // SAFETY: the array of a vector's layout stays as long as the vector.
            layout.require_same(unsafe { Layout::from_raw(self.0.comm(), ranges) })?;
        }
        Ok(())
    }
}
