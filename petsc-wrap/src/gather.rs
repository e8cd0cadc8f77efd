//! Entries of a distributed vector, fetched to the ranks that need them.

use petsc_sys as sys;

use crate::Int;
use crate::error::{Result, check, check_indices};
use crate::object::Object;
use crate::vector::{ReadGuard, Vector};

/// Fetches chosen entries of vectors of one layout, again and again.
pub struct Gather {
    scatter: Object<sys::_p_PetscSF>,
    here: Vector,
}

impl Gather {
    /// Entries by global index, in any order and repeated at will, each rank its own. Collective.
    ///
    /// # Errors
    /// An index out of range, or PETSc's.
    pub fn new(like: &Vector, indices: &[Int]) -> Result<Self> {
        check_indices(indices, like.len())?;
        let comm = like.comm();
        let here = Vector::new(&comm.session().alone(), indices.len())?;
        let mut set = std::ptr::null_mut();
        let copy = sys::PetscCopyMode::PETSC_COPY_VALUES;
        let n = indices.len() as Int;
        // SAFETY: the slice holds `n` indices, which PETSc copies.
        check(unsafe { sys::ISCreateGeneral(comm.raw(), n, indices.as_ptr(), copy, &raw mut set) })?;
        let set: Object<sys::_p_IS> = Object::new(set, comm);
        let mut scatter = std::ptr::null_mut();
        // SAFETY: all are valid; no index set for the target means all of it in order.
        check(unsafe {
            sys::VecScatterCreate(like.raw(), set.raw(), here.raw(), std::ptr::null_mut(), &raw mut scatter)
        })?;
        set.destroy()?;
        Ok(Self { scatter: Object::new(scatter, comm), here })
    }

    /// The entries, in the order of the indices. Collective.
    ///
    /// # Errors
    /// PETSc's, e.g. for a vector of another layout.
    pub fn fetch(&mut self, from: &Vector) -> Result<ReadGuard<'_>> {
        let (insert, forward) = (sys::InsertMode::INSERT_VALUES, sys::ScatterMode::SCATTER_FORWARD);
        // SAFETY: all are valid here and below; PETSc checks the layouts.
        check(unsafe { sys::VecScatterBegin(self.scatter.raw(), from.raw(), self.here.raw(), insert, forward) })?;
        // SAFETY: as above.
        check(unsafe { sys::VecScatterEnd(self.scatter.raw(), from.raw(), self.here.raw(), insert, forward) })?;
        self.here.read()
    }
}
