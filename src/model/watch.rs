//! Follows the making of a model, and may interrupt it.

use mpi::traits::{Communicator, Root};
use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::scene::Model as Theory;

/// Stage of making a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// The mesh and matrices of a theory's body are made.
    Assembly {
        /// The theory.
        theory: Theory,
        /// Estimated time until the construction can be stopped again, s; 0 if it is short or unknown.
        seconds: f64,
    },
    /// The matrix S = K + sC + s²M of the shift s is factorised for a basis.
    Factor,
    /// A basis is enlarged.
    Basis {
        /// Number of vectors so far.
        vectors: usize,
        /// Accuracy of the last basis that was checked; `None` before the first, and for a basis that only serves a
        /// comparison.
        judged: Option<Judged>,
    },
    /// The matrices of the first time steps are made and factorised.
    Steps,
    /// An impact on a basis is computed, to estimate the error of the basis.
    Trial,
}

/// Accuracy of a basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Number of vectors.
    pub vectors: usize,
    /// Estimated error, over the peak, in the quantity that the tolerance applies to. If the error of the deflection is
    /// limited as well and is farther above its limit, it is that error, scaled so that its limit is `wanted`.
    pub error: f64,
    /// Allowed error.
    pub wanted: f64,
}

/// Follows the making of a model.
pub trait Watch {
    /// Called before each stage. Collective.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if the stage is not to be done.
    fn at(&self, stage: Stage) -> Result<()>;

    /// Whether this rank already knows that the next stage will be interrupted. It may then stop work that it does
    /// alone.
    fn is_raised_here(&self) -> bool {
        false
    }

    /// Returns the first rank's number on all ranks. Every rank computes plates for itself, and ranks on different
    /// processors round differently. Decisions based on such a number must be the same everywhere, because all ranks
    /// must reach the same stages. Collective.
    fn agreed(&self, mine: f64) -> f64;
}

impl dyn Watch + '_ {
    /// Returns the first rank's decision on all ranks. Collective.
    pub fn decided(&self, mine: bool) -> bool {
        self.agreed(f64::from(u8::from(mine))) > 0.5
    }

    /// Returns this rank's result if the first rank has succeeded; otherwise an error on all ranks. Collective.
    ///
    /// # Errors
    /// This rank's error, or a general one if only the first rank failed; [`Error::Alone`] if this rank failed and the
    /// first did not.
    pub fn shared<T>(&self, mine: Result<T>) -> Result<T> {
        match (self.decided(mine.is_ok()), mine) {
            (true, Err(error)) => Err(Error::Alone(Box::new(error))),
            (false, Ok(_)) => Err(Error::Solve("the first rank has not solved this".into())),
            (_, mine) => mine,
        }
    }
}

/// Returns the first rank's number on all ranks. Collective.
pub fn of_first(comm: &Comm, mut mine: f64) -> f64 {
    comm.mpi().process_at_rank(0).broadcast_into(&mut mine);
    mine
}

/// A watch that never interrupts.
pub struct Unwatched<'a>(pub &'a Comm);

impl Watch for Unwatched<'_> {
    fn at(&self, _: Stage) -> Result<()> {
        Ok(())
    }

    fn agreed(&self, mine: f64) -> f64 {
        of_first(self.0, mine)
    }
}

/// A watch that interrupts when a function returns true; it must return the same on all ranks.
pub struct Until<'a>(pub &'a Comm, pub &'a dyn Fn() -> bool);

impl Watch for Until<'_> {
    fn at(&self, _: Stage) -> Result<()> {
        if (self.1)() { Err(Error::Interrupted) } else { Ok(()) }
    }

    fn agreed(&self, mine: f64) -> f64 {
        of_first(self.0, mine)
    }
}
