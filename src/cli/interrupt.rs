//! Ends the program after a signal: in order where something would be lost, at once where not, and at once after a second
//! signal.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::Duration;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGXFSZ};
use signal_hook::iterator::Signals;

use crate::error::{Error, INTERRUPTED};
use crate::record::lock;

use super::{is_root_by_environment, tell};

/// How a first signal ends the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// At once: nothing would be lost.
    AtOnce,
    /// In order if that takes no longer than two seconds: the files on the disk are consistent at any time.
    Soon,
    /// In order, however long the present step takes.
    InOrder,
}

/// Time for an end in order.
const GRACE: Duration = Duration::from_secs(2);

/// Whether a signal has come, and the [`Ending`].
static IS_RAISED: AtomicBool = AtomicBool::new(false);
static ENDING: AtomicU8 = AtomicU8::new(Ending::AtOnce as u8);

/// Handles signals from now on: SIGINT, SIGTERM, SIGHUP and SIGUSR1. Queueing systems send SIGTERM and SIGUSR1 before their
/// time limit. A write beyond the system's limit on file size (SIGXFSZ) fails like a write on a full disk.
pub fn install() {
    if let Err(error) = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default()) {
        tracing::debug!("a limit on the size of files ends the program: {error}");
    }
    let hang_up = (!is_hang_up_ignored()).then_some(SIGHUP);
    match Signals::new([SIGINT, SIGTERM, SIGUSR1].into_iter().chain(hang_up)) {
        // A thread of its own, since the others may be in a library that does not return for minutes.
        Ok(mut signals) => drop(std::thread::spawn(move || signals.forever().for_each(|_| obey()))),
        Err(error) => tracing::warn!("signals cannot be handled, and end the program at once: {error}"),
    }
}

/// Whether the process was started so that it outlives its terminal, as by `nohup`. Unknown where there is no /proc.
fn is_hang_up_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or_default();
    mask >> (SIGHUP - 1) & 1 == 1
}

fn obey() {
    let is_second = IS_RAISED.swap(true, Ordering::Relaxed);
    let ending = ENDING.load(Ordering::Relaxed);
    if is_second || ending == Ending::AtOnce as u8 {
        end_at_once();
    }
    if ending == Ending::Soon as u8 {
        std::thread::spawn(|| {
            std::thread::sleep(GRACE);
            end_at_once();
        });
    }
}

fn end_at_once() -> ! {
    lock::abandon_all();
    if is_root_by_environment() {
        match ENDING.load(Ordering::Relaxed) == Ending::AtOnce as u8 {
            true => tell(format_args!("{}", Error::Interrupted)),
            false => tell(format_args!("interrupted: what was already written is kept")),
        }
    }
    // Without the exit handlers of libraries, which would wait for the other ranks and for calls that are under way.
    signal_hook::low_level::exit(INTERRUPTED)
}

/// Knows whether a signal has come.
pub struct Interrupt(());

impl Interrupt {
    /// From now on, a first signal ends the program in this way.
    pub fn new(ending: Ending) -> Self {
        let interrupt = Self(());
        interrupt.set(ending);
        interrupt
    }

    /// Changes how a first signal ends the program.
    pub fn set(&self, ending: Ending) {
        ENDING.store(ending as u8, Ordering::Relaxed);
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
        IS_RAISED.load(Ordering::Relaxed)
    }
}
