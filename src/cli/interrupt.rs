//! Work that a signal ends in order.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;

/// Exit status of work that a signal has ended.
pub const INTERRUPTED: i32 = 130;

/// A flag that SIGINT and SIGTERM raise, in place of ending the process at once.
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Takes the signals from now on.
    pub fn on_signals() -> Self {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
            if let Err(error) = signal_hook::flag::register(signal, flag.clone()) {
                tracing::warn!("signal {signal} ends the program at once: {error}");
            }
        }
        Self(flag)
    }

    /// Whether any rank has got a signal. Collective.
    pub fn is_raised(&self, comm: &Comm) -> bool {
        let mut all = 0;
        comm.mpi().all_reduce_into(&i32::from(self.is_raised_here()), &mut all, SystemOperation::max());
        all > 0
    }

    /// Whether this rank has got a signal.
    pub fn is_raised_here(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
