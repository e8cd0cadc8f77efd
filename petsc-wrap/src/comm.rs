//! A group of ranks, with the session kept alive.

use std::rc::Rc;

use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::topology::{CommunicatorRelation, SimpleCommunicator};
use mpi::traits::{AsRaw, Communicator, CommunicatorCollectives, Equivalence, Root};
use petsc_sys as sys;

use crate::error::{Result, check};
use crate::session::Session;

/// An MPI communicator that keeps MPI and PETSc alive; cheap to clone.
#[derive(Clone)]
pub struct Comm {
    // Declared first, dropped first: the communicator goes before the session.
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

    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The lists of all ranks, one after the other, on every rank. Collective.
    ///
    /// # Panics
    /// When there are more items in all than MPI counts (2³¹ − 1), on every rank.
    pub fn all_gather<T: Equivalence + Clone + Default>(&self, mine: &[T]) -> Vec<T> {
        let mut counts = vec![0; self.size()];
        self.mpi.all_gather_into(&(mine.len() as u64), &mut counts[..]);
        let Parts { counts, starts, total } = Parts::new(&counts).expect("more items than MPI counts");
        let mut all = vec![T::default(); total];
        if total == 0 {
            // Open MPI takes the addresses of two empty lists for one buffer given twice, and ends the process.
            return all;
        }
        self.mpi.all_gather_varcount_into(mine, &mut PartitionMut::new(&mut all[..], counts, starts));
        all
    }

    /// The lists of all ranks, one after the other, on rank 0; nothing on the others. Collective.
    ///
    /// # Panics
    /// As [`Self::all_gather`].
    pub fn gather_to_root<T: Equivalence + Clone + Default>(&self, mine: &[T]) -> Vec<T> {
        let mut counts = vec![0; self.size()];
        self.mpi.all_gather_into(&(mine.len() as u64), &mut counts[..]);
        let Parts { counts, starts, total } = Parts::new(&counts).expect("more items than MPI counts");
        let root = self.mpi.process_at_rank(0);
        if total == 0 {
            // As of `all_gather`.
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

    /// Replaces each rank's values by those of rank 0. Collective.
    ///
    /// # Panics
    /// When the ranks have not as many values as rank 0, on every rank.
    pub fn broadcast_from_root(&self, values: &mut [f64]) {
        // (Types are given wherever ranks are asked: MPI writes as many bytes as it is sent.)
        let (mine, mut least, mut most) = (values.len() as u64, 0_u64, 0_u64);
        self.mpi.all_reduce_into(&mine, &mut least, SystemOperation::min());
        self.mpi.all_reduce_into(&mine, &mut most, SystemOperation::max());
        assert_eq!(least, most, "a rank has not as many values as another");
        self.mpi.process_at_rank(0).broadcast_into(values);
    }

    /// Destroys what dropped handles left behind. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

    /// Whether both have the same ranks in the same order.
    pub(crate) fn is_congruent(&self, other: &Self) -> bool {
        Rc::ptr_eq(&self.mpi, &other.mpi)
            || self.raw() == other.raw()
            || matches!(
                self.mpi.compare(&*other.mpi),
                CommunicatorRelation::Identical | CommunicatorRelation::Congruent
            )
    }

    /// The raw communicator for an object of PETSc's, which is initialised for it if need be.
    ///
    /// # Errors
    /// PETSc's, where it does not start.
    pub(crate) fn petsc(&self) -> Result<mpi::ffi::MPI_Comm> {
        self.session.petsc()?;
        Ok(self.raw())
    }

    fn raw(&self) -> mpi::ffi::MPI_Comm {
        self.mpi.as_raw()
    }
}

/// Where the parts of ranks lie in a list of all, in MPI's integers.
#[derive(Debug, PartialEq)]
struct Parts {
    counts: Vec<i32>,
    starts: Vec<i32>,
    total: usize,
}

impl Parts {
    /// `None` where MPI's integers do not reach.
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

    /// MPI counts in 32 bits: a wrapped sum would be a buffer shorter than what is written to it.
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
