//! Who follows the making of a model, and may break it off.

use mpi::traits::{Communicator, Root};
use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::scene::Model as Theory;

/// What is being done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// Mesh and matrices of a theory's body are made.
    Assembly(Theory),
    /// S is factorised for a basis.
    Factor,
    /// A basis grows.
    Basis {
        /// Vectors so far.
        vectors: usize,
        /// How good the last basis was that was judged; `None` before the first, and where it judges another one.
        judged: Option<Judged>,
    },
    /// The matrices of the first steps are made and factorised.
    Steps,
    /// An impact on a basis is computed, to judge it.
    Trial,
}

/// How good a basis was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Its vectors.
    pub vectors: usize,
    /// Estimated error of the acceleration in the first contact, over its peak.
    pub error: f64,
    /// What that is to become.
    pub wanted: f64,
}

/// Follows the making of a model.
pub trait Watch {
    /// Something is about to be done. Collective.
    ///
    /// # Errors
    /// [`Error::Interrupted`] where it is not to be done.
    fn at(&self, stage: Stage) -> Result<()>;

    /// Whether this rank knows already that the next stage breaks off: what a rank computes by itself need not go on.
    fn is_raised_here(&self) -> bool {
        false
    }

    /// The first rank's number. Every rank computes plates for itself, and ranks on unlike processors round differently: what is decided by
    /// such a number is to be the same on all, since all must come to the same stages. Collective.
    fn agreed(&self, mine: f64) -> f64;
}

impl dyn Watch + '_ {
    /// The first rank's decision. Collective.
    pub fn decided(&self, mine: bool) -> bool {
        self.agreed(f64::from(u8::from(mine))) > 0.5
    }

    /// A result where the first rank has one; where it has an error, that of this rank or another one. Collective.
    ///
    /// # Errors
    /// Such an error; [`Error::Alone`] where the first rank has none.
    pub fn shared<T>(&self, mine: Result<T>) -> Result<T> {
        match (self.decided(mine.is_ok()), mine) {
            (true, Err(error)) => Err(Error::Alone(Box::new(error))),
            (false, Ok(_)) => Err(Error::Solve("the first rank has not solved this".into())),
            (_, mine) => mine,
        }
    }
}

/// The first rank's number. Collective.
pub fn of_first(comm: &Comm, mut mine: f64) -> f64 {
    comm.mpi().process_at_rank(0).broadcast_into(&mut mine);
    mine
}

/// Nobody follows these ranks.
pub struct Unwatched<'a>(pub &'a Comm);

impl Watch for Unwatched<'_> {
    fn at(&self, _: Stage) -> Result<()> {
        Ok(())
    }

    fn agreed(&self, mine: f64) -> f64 {
        of_first(self.0, mine)
    }
}

/// Breaks off on these ranks where a function says so, with the same answer on all.
pub struct Until<'a>(pub &'a Comm, pub &'a dyn Fn() -> bool);

impl Watch for Until<'_> {
    fn at(&self, _: Stage) -> Result<()> {
        if (self.1)() { Err(Error::Interrupted) } else { Ok(()) }
    }

    fn agreed(&self, mine: f64) -> f64 {
        of_first(self.0, mine)
    }
}
