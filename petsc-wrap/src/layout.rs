//! Distribution of entries over the ranks, and the check that two objects agree on it.
//!
//! PETSc compares global sizes in some functions, local sizes in fewer, and communicators only in debugging builds.
//! Without a check, local arrays of different lengths would be combined. So each pair of objects is compared here.
//! Every rank knows the ranges of all ranks, so all ranks detect a difference alike and none waits for another.

use crate::Int;
use crate::comm::Comm;
use crate::error::{Result, require};

/// The first index of each rank, followed by the total number of entries.
#[derive(Clone, Copy)]
pub(crate) struct Layout<'a> {
    comm: &'a Comm,
    ranges: &'a [Int],
}

impl<'a> Layout<'a> {
    pub(crate) fn new(comm: &'a Comm, ranges: &'a [Int]) -> Self {
        Self { comm, ranges }
    }

    /// Wraps PETSc's own array of ranges.
    ///
    /// # Safety
    /// `ranges` is the array of a layout on `comm`, which neither changes nor is freed during `'a`.
    pub(crate) unsafe fn from_raw(comm: &'a Comm, ranges: *const Int) -> Self {
        assert!(!ranges.is_null(), "PETSc has set up the layout");
        // SAFETY: guaranteed by the caller; PETSc's array has one entry more than there are ranks.
        Self { comm, ranges: unsafe { std::slice::from_raw_parts(ranges, comm.size() + 1) } }
    }

    /// Number of entries on all ranks.
    pub(crate) fn size(&self) -> usize {
        self.ranges.last().map_or(0, |size| *size as usize)
    }

    pub(crate) fn ranges(&self) -> &'a [Int] {
        self.ranges
    }

    fn is(&self, other: &Layout) -> bool {
        // Copies of an object share PETSc's array.
        (std::ptr::eq(self.ranges, other.ranges) || self.ranges == other.ranges) && self.comm.is_congruent(other.comm)
    }

    /// Returns an error if the layouts differ.
    #[track_caller]
    pub(crate) fn require_same(&self, other: Layout) -> Result<()> {
        if self.is(&other) {
            return Ok(());
        }
        let describe = |layout: &Layout| format!("{} entries on {} rank(s)", layout.size(), layout.comm.size());
        require(false, &format!("the layouts differ: {} and {}", describe(self), describe(&other)))
    }
}
