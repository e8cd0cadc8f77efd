//! Null spaces, exact or near.

use petsc_sys as sys;

use crate::error::{Result, check};
use crate::object::Object;
use crate::vector::Vector;

/// An orthonormal basis of the vectors that a matrix maps to (nearly) nothing.
pub struct NullSpace(Object<sys::_p_MatNullSpace>);

impl NullSpace {
    /// The six rigid motions of nodes in space, from their coordinates (three entries a node). Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. where a rank has not three entries for each of its nodes.
    pub fn rigid_body(coordinates: &mut Vector) -> Result<Self> {
        // SAFETY: the vector is valid here and below.
        check(unsafe { sys::VecSetBlockSize(coordinates.raw(), 3) })?;
        let mut raw = std::ptr::null_mut();
        // SAFETY: as above, and the out-pointer is valid.
        check(unsafe { sys::MatNullSpaceCreateRigidBody(coordinates.raw(), &raw mut raw) })?;
        Ok(Self(Object::new(raw, coordinates.comm())))
    }

    pub(crate) fn raw(&self) -> sys::MatNullSpace {
        self.0.raw()
    }
}
