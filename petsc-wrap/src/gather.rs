//! Fetches entries of a distributed vector to the ranks that need them.

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, check, check_indices};
use crate::layout::Layout;
use crate::object::Object;
use crate::text::int;
use crate::vector::{ReadGuard, Vector, VectorView};

/// Fetches chosen entries of vectors of one layout, any number of times.
///
/// ```
/// # fn main() -> petsc_wrap::Result<()> {
/// use petsc_wrap::{Gather, Session, Vector};
///
/// let session = Session::start(&[]).expect("the first session")?;
/// let mut x = Vector::new(&session.world(), 3)?;
/// x.write()?.copy_from_slice(&[1.0, 2.0, 3.0]);
/// assert_eq!(*Gather::new(&x, &[2, 0])?.fetch(&x)?, [3.0, 1.0]);
/// # Ok(())
/// # }
/// ```
pub struct Gather {
    scatter: Object<sys::_p_PetscSF>,
    here: Vector,
    /// The layout of the vectors. PETSc does not check it, and would read out of bounds in a vector of another layout.
    comm: Comm,
    ranges: Vec<Int>,
}

impl Gather {
    /// Prepares to fetch the entries with these global indices, in any order, repetitions allowed. Each rank gives its
    /// own list. Collective.
    ///
    /// # Errors
    /// If an index is out of range (on all ranks), or if a PETSc call fails.
    pub fn new(like: &VectorView, indices: &[Int]) -> Result<Self> {
        let comm = like.comm();
        comm.agree(check_indices(indices, like.len()))?;
        let here = Vector::new(&comm.session().alone(), indices.len())?;
        let mut set = std::ptr::null_mut();
        let copy = sys::PetscCopyMode::PETSC_COPY_VALUES;
        let n = int(indices.len())?;
        // SAFETY: the slice holds `n` indices, which PETSc copies.
        check(unsafe { sys::ISCreateGeneral(comm.petsc()?, n, indices.as_ptr(), copy, &raw mut set) })?;
        // SAFETY: the new set is ours.
        let set: Object<sys::_p_IS> = unsafe { Object::new(set, comm) };
        let mut scatter = std::ptr::null_mut();
        // SAFETY: all are valid; no index set for the target means all of it in order.
        check(unsafe {
            sys::VecScatterCreate(like.raw(), set.raw(), here.raw(), std::ptr::null_mut(), &raw mut scatter)
        })?;
        set.destroy()?;
        // SAFETY: the new scatter is ours.
        let scatter = unsafe { Object::new(scatter, comm) };
        Ok(Self { scatter, here, comm: comm.clone(), ranges: like.layout().ranges().to_vec() })
    }

    /// Returns the entries in the order of the indices. Collective.
    ///
    /// # Errors
    /// If the vector has another layout (on all ranks), or if a PETSc call fails.
    pub fn fetch(&mut self, from: &VectorView) -> Result<ReadGuard<'_>> {
        Layout::new(&self.comm, &self.ranges).require_same(from.layout())?;
        let (insert, forward) = (sys::InsertMode::INSERT_VALUES, sys::ScatterMode::SCATTER_FORWARD);
        // SAFETY: all are valid here and below; the layout is the one for which the scatter was made.
        check(unsafe { sys::VecScatterBegin(self.scatter.raw(), from.raw(), self.here.raw(), insert, forward) })?;
        // SAFETY: as above.
        check(unsafe { sys::VecScatterEnd(self.scatter.raw(), from.raw(), self.here.raw(), insert, forward) })?;
        self.here.read()
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::VecScatter {
        self.scatter.raw()
    }
}
