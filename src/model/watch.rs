//! Who follows the making of a model, and may break it off.

use crate::error::Result;
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
    /// [`crate::Error::Interrupted`] where it is not to be done.
    fn at(&self, stage: Stage) -> Result<()>;
}

/// Nobody follows.
pub struct Unwatched;

impl Watch for Unwatched {
    fn at(&self, _: Stage) -> Result<()> {
        Ok(())
    }
}

/// Breaks off where a function says so, with the same answer on all ranks.
pub struct Until<'a>(pub &'a dyn Fn() -> bool);

impl Watch for Until<'_> {
    fn at(&self, _: Stage) -> Result<()> {
        if (self.0)() { Err(crate::Error::Interrupted) } else { Ok(()) }
    }
}
