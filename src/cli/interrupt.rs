//! Ends the work in order after a signal.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;
use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1, SIGXFSZ};

/// Ignores SIGXFSZ: a write beyond the system's limit on file size then fails like a write on a full disk. By default
/// the signal ends the program without a message.
pub fn outlive_limits() {
    if let Err(error) = signal_hook::flag::register(SIGXFSZ, Arc::default()) {
        tracing::debug!("a limit on the size of files ends the program: {error}");
    }
}

/// A flag that is set by SIGINT, SIGTERM and SIGUSR1, which then do not end the process. Queueing systems send the last
/// two before their time limit.
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Installs the signal handlers.
    pub fn on_signals() -> Self {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM, SIGUSR1] {
            if let Err(error) = signal_hook::flag::register(signal, flag.clone()) {
                tracing::warn!("signal {signal} ends the program at once: {error}");
            }
        }
        Self(flag)
    }

    /// Whether any rank has received a signal. Collective.
    pub fn is_raised(&self, comm: &Comm) -> bool {
        self.poll(comm, []).0
    }

    /// Whether any rank has received a signal, and for each question in `asked` whether it is true on any rank.
    /// Collective.
    pub fn poll<const N: usize>(&self, comm: &Comm, asked: [bool; N]) -> (bool, [bool; N]) {
        const { assert!(N < 31, "one bit for each question and one for the signal") };
        let answers = asked.into_iter().chain([self.is_raised_here()]);
        let mine = answers.rev().fold(0_i32, |bits, answer| 2 * bits + i32::from(answer));
        let mut all = 0_i32;
        comm.mpi().all_reduce_into(&mine, &mut all, SystemOperation::bitwise_or());
        let is_true = |n: usize| all >> n & 1 == 1;
        (is_true(N), std::array::from_fn(is_true))
    }

    /// Whether this rank has received a signal.
    pub fn is_raised_here(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
