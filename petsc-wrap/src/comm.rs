//! A group of ranks, with the session kept alive.

use std::rc::Rc;

use mpi::datatype::PartitionMut;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator, CommunicatorCollectives, Equivalence, Root};
use petsc_sys as sys;

use crate::error::{Result, check};
use crate::session::Session;

/// An MPI communicator that keeps PETSc alive; cheap to clone.
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
    pub fn all_gather<T: Equivalence + Clone + Default>(&self, mine: &[T]) -> Vec<T> {
        let mut counts = vec![0; self.size()];
        self.mpi.all_gather_into(&(mine.len() as i32), &mut counts[..]);
        let starts: Vec<i32> = counts
            .iter()
            .scan(0, |next, count| {
                let start = *next;
                *next += count;
                Some(start)
            })
            .collect();
        let mut all = vec![T::default(); counts.iter().sum::<i32>() as usize];
        self.mpi.all_gather_varcount_into(mine, &mut PartitionMut::new(&mut all[..], counts, starts));
        all
    }

    /// The values of rank 0 in place of each rank's own. Collective.
    pub fn take_of_root(&self, values: &mut [f64]) {
        self.mpi.process_at_rank(0).broadcast_into(values);
    }

    /// Destroys what dropped handles left behind. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn collect_garbage(&self) -> Result<()> {
        // SAFETY: the communicator is valid while `self` lives.
        check(unsafe { sys::PetscGarbageCleanup(self.raw()) })
    }

    pub(crate) fn raw(&self) -> mpi::ffi::MPI_Comm {
        self.mpi.as_raw()
    }
}
