//! How many processes work at the same time.

use std::sync::{Condvar, Mutex, PoisonError};

/// A machine's cores, of which a test takes as many as it has ranks, or all.
pub struct Cores {
    total: usize,
    free: Mutex<usize>,
    returned: Condvar,
}

impl Cores {
    /// All that this process may use.
    pub fn of_this_machine() -> Self {
        let total = std::thread::available_parallelism().map_or(1, usize::from);
        Self { total, free: Mutex::new(total), returned: Condvar::new() }
    }

    /// Does work that keeps so many processes busy, once the cores for them are free.
    pub fn with<R>(&self, processes: usize, work: impl FnOnce() -> R) -> R {
        let taken = processes.min(self.total);
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let mut free = self.returned.wait_while(free, |free| *free < taken).unwrap_or_else(PoisonError::into_inner);
        *free -= taken;
        drop(free);
        // Given back also where the work panics.
        let _taken = Taken { cores: self, count: taken };
        work()
    }
}

/// Cores that work is being done on.
struct Taken<'a> {
    cores: &'a Cores,
    count: usize,
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        *self.cores.free.lock().unwrap_or_else(PoisonError::into_inner) += self.count;
        self.cores.returned.notify_all();
    }
}
