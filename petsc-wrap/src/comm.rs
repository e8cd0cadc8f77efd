//! A communicator that keeps the session alive.

use std::rc::Rc;

use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::topology::{CommunicatorRelation, SimpleCommunicator};
use mpi::traits::{AsRaw, Communicator, CommunicatorCollectives, Equivalence, Root};
use petsc_sys as sys;

use crate::error::{Result, check, require};
use crate::session::Session;

/// An MPI communicator that keeps MPI and PETSc alive; cheap to clone.
#[derive(Clone)]
pub struct Comm {
    // Declared first, so dropped first: the communicator is freed before the session ends.
    mpi: Rc<SimpleCommunicator>,
    session: Session,
}

impl Comm {
    pub(crate) fn new(session: Session, mpi: SimpleCommunicator) -> Self {
        Self { mpi: Rc::new(mpi), session }
    }

    /// This rank's number.
    pub fn rank(&self) -> usize {
        self.mpi.rank() as usize
    }

    /// Number of ranks.
    pub fn size(&self) -> usize {
        self.mpi.size() as usize
    }

    /// Whether this is rank 0.
    pub fn is_root(&self) -> bool {
        self.mpi.rank() == 0
    }

    /// The communicator of the `mpi` crate, for collective calls.
    pub fn mpi(&self) -> &SimpleCommunicator {
        &self.mpi
    }

    /// The session of this communicator.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Concatenates the lists of all ranks, in rank order, on every rank. Collective.
    ///
    /// # Panics
    /// On every rank, if the total number of items exceeds MPI's range (2³¹ − 1).
    pub fn all_gather<T: Equivalence + Clone + Default>(&self, mine: &[T]) -> Vec<T> {
        let mut counts = vec![0; self.size()];
        self.mpi.all_gather_into(&(mine.len() as u64), &mut counts[..]);
        let Parts { counts, starts, total } = Parts::new(&counts).expect("more items than MPI counts");
        let mut all = vec![T::default(); total];
        if total == 0 {
            // Open MPI takes the equal addresses of two empty lists for an aliased buffer, and aborts.
            return all;
        }
        self.mpi.all_gather_varcount_into(mine, &mut PartitionMut::new(&mut all[..], counts, starts));
        all
    }

    /// Concatenates the lists of all ranks, in rank order, on rank 0; returns an empty list on the others. Collective.
    ///
    /// # Panics
    /// Same as [`Self::all_gather`].
    pub fn gather_to_root<T: Equivalence + Clone + Default>(&self, mine: &[T]) -> Vec<T> {
        let mut counts = vec![0; self.size()];
        self.mpi.all_gather_into(&(mine.len() as u64), &mut counts[..]);
        let Parts { counts, starts, total } = Parts::new(&counts).expect("more items than MPI counts");
        let root = self.mpi.process_at_rank(0);
        if total == 0 {
            // As in `all_gather`.
            return Vec::new();
        }
        if !self.is_root() {
            root.gather_varcount_into(mine);
            return Vec::new();
        }
        let mut all = vec![T::default(); total];
        root.gather_varcount_into_root(mine, &mut PartitionMut::new(&mut all[..], counts, starts));
        all
    }

    /// Replaces each rank's values by the values of rank 0. Collective.
    ///
    /// # Panics
    /// On every rank, if the ranks do not all have the same number of values.
    pub fn broadcast_from_root(&self, values: &mut [f64]) {
        // (Types are written out where ranks communicate: MPI writes the number of bytes that it receives.)
        let (mine, mut least, mut most) = (values.len() as u64, 0_u64, 0_u64);
        self.mpi.all_reduce_into(&mine, &mut least, SystemOperation::min());
        self.mpi.all_reduce_into(&mine, &mut most, SystemOperation::max());
        assert_eq!(least, most, "a rank has not as many values as another");
        self.mpi.process_at_rank(0).broadcast_into(values);
    }

    /// Returns this rank's error or, if only other ranks have one, an error that says so. Collective: without it, the
    /// ranks without an error would wait in PETSc's next collective call for the others.
    pub(crate) fn agree(&self, mine: Result<()>) -> Result<()> {
        let (has_failed, mut any) = (u8::from(mine.is_err()), 0_u8);
        self.mpi.all_reduce_into(&has_failed, &mut any, SystemOperation::max());
        mine.and_then(|()| require(any == 0, "another rank has refused its arguments"))
    }

    /// Destroys the objects whose handles were dropped. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn collect_garbage(&self) -> Result<()> {
        if !self.session.has_petsc() {
            return Ok(());
        }
        // SAFETY: PETSc is initialised, and the communicator is valid while `self` lives.
        check(unsafe { sys::PetscGarbageCleanup(self.raw()) })
    }

    /// The raw communicator. It is valid while `self` lives.
    pub fn as_raw(&self) -> mpi::ffi::MPI_Comm {
        self.raw()
    }

    /// Whether both communicators have the same ranks in the same order.
    pub(crate) fn is_congruent(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.mpi, &other.mpi)
            || self.raw() == other.raw()
            || matches!(
                self.mpi.compare(&*other.mpi),
                CommunicatorRelation::Identical | CommunicatorRelation::Congruent
            )
    }

    /// Returns the raw communicator for a new PETSc object; initialises PETSc first if needed.
    ///
    /// # Errors
    /// If PETSc does not start.
    pub(crate) fn petsc(&self) -> Result<mpi::ffi::MPI_Comm> {
        self.session.petsc()?;
        Ok(self.raw())
    }

    fn raw(&self) -> mpi::ffi::MPI_Comm {
        self.mpi.as_raw()
    }
}

/// Lengths and starts of the ranks' parts in a concatenated list, in MPI's integers.
#[derive(Debug, PartialEq)]
struct Parts {
    counts: Vec<i32>,
    starts: Vec<i32>,
    total: usize,
}

impl Parts {
    /// Returns `None` if the total exceeds MPI's integers.
    fn new(lengths: &[u64]) -> Option<Self> {
        let (mut counts, mut starts, mut next) = (Vec::new(), Vec::new(), 0_i32);
        for length in lengths {
            let count = i32::try_from(*length).ok()?;
            counts.push(count);
            starts.push(next);
            next = next.checked_add(count)?;
        }
        Some(Self { counts, starts, total: next as usize })
    }
}

#[cfg(test)]
mod tests {
    use super::Parts;

    /// Lists that exceed MPI's 32-bit counts are refused: with a wrapped sum the buffer would be shorter than the data
    /// written to it.
    #[test]
    fn parts_that_mpi_cannot_count_are_refused() {
        let most = i32::MAX as u64;
        assert_eq!(Parts::new(&[2, 0, 3]), Some(Parts { counts: vec![2, 0, 3], starts: vec![0, 2, 2], total: 5 }));
        assert_eq!(Parts::new(&[most - 1, 1]).map(|parts| parts.total), Some(i32::MAX as usize));
        assert_eq!(Parts::new(&[most, 1]), None);
        assert_eq!(Parts::new(&[most + 1]), None);
        assert_eq!(Parts::new(&[u64::MAX, 2]), None);
    }
}
