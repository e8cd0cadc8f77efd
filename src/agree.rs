//! One rank's error made every rank's, so that all of them stop with one message.

use mpi::collective::SystemOperation;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use petsc_wrap::Comm;

/// The value where no rank has an error; otherwise, on every rank, the message of the lowest rank that has one.
/// Collective.
///
/// # Errors
/// That message.
pub fn agree<T>(comm: &Comm, result: Result<T, String>) -> Result<T, String> {
    let mpi = comm.mpi();
    let mine = if result.is_err() { mpi.rank() } else { mpi.size() };
    let mut first = 0;
    mpi.all_reduce_into(&mine, &mut first, SystemOperation::min());
    if first == mpi.size() {
        return result;
    }
    let message = result.err().unwrap_or_default();
    Err(broadcast(comm, first as usize, message))
}

/// The text of one rank, on every rank. Collective.
pub fn broadcast(comm: &Comm, root: usize, text: String) -> String {
    let process = comm.mpi().process_at_rank(root as i32);
    let mut bytes = text.into_bytes();
    let mut length = bytes.len();
    process.broadcast_into(&mut length);
    bytes.resize(length, 0);
    process.broadcast_into(&mut bytes[..]);
    String::from_utf8_lossy(&bytes).into_owned()
}
