//! Limits the number of processes that work at the same time.

use std::sync::{Condvar, Mutex, PoisonError};

/// The cores of a machine. A test takes one core for each of its ranks, or all if there are fewer.
pub struct Cores {
    total: usize,
    free: Mutex<usize>,
    returned: Condvar,
}

impl Cores {
    /// All cores that this process may use.
    pub fn of_this_machine() -> Self {
        let total = std::thread::available_parallelism().map_or(1, usize::from);
        Self { total, free: Mutex::new(total), returned: Condvar::new() }
    }

    /// Does work that keeps this number of processes busy, once the cores for them are free.
    pub fn with<R>(&self, processes: usize, work: impl FnOnce() -> R) -> R {
        let taken = processes.min(self.total);
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let mut free = self.returned.wait_while(free, |free| *free < taken).unwrap_or_else(PoisonError::into_inner);
        *free -= taken;
        drop(free);
        // The cores are released even if the work panics.
        let _taken = Taken { cores: self, count: taken };
        work()
    }
}

/// Cores in use; dropping it releases them.
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
