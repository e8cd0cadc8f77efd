//! Work that a signal ends in order.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;
use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1, SIGXFSZ};

/// Has a write beyond the largest size of files that the system allows fail as one on a full disk does, in place of ending the program without
/// a word.
pub fn outlive_limits() {
    if let Err(error) = signal_hook::flag::register(SIGXFSZ, Arc::default()) {
        tracing::debug!("a limit on the size of files ends the program: {error}");
    }
}

/// A flag that SIGINT, SIGTERM and SIGUSR1 raise, in place of ending the process at once: the last two are what a queue sends before its
/// limit.
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Takes the signals from now on.
    pub fn on_signals() -> Self {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM, SIGUSR1] {
            if let Err(error) = signal_hook::flag::register(signal, flag.clone()) {
                tracing::warn!("signal {signal} ends the program at once: {error}");
            }
        }
        Self(flag)
    }

    /// Whether any rank has got a signal. Collective.
    pub fn is_raised(&self, comm: &Comm) -> bool {
        self.poll(comm, []).0
    }

    /// Whether any rank has got a signal, and which of the questions are true on any. Collective.
    pub fn poll<const N: usize>(&self, comm: &Comm, asked: [bool; N]) -> (bool, [bool; N]) {
        let mine: Vec<i32> = asked.into_iter().chain([self.is_raised_here()]).map(i32::from).collect();
        let mut all = vec![0_i32; N + 1];
        comm.mpi().all_reduce_into(&mine[..], &mut all[..], SystemOperation::max());
        (all[N] > 0, std::array::from_fn(|n| all[n] > 0))
    }

    /// Whether this rank has got a signal.
    pub fn is_raised_here(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
