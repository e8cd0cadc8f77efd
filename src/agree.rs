//! Communication between ranks: agreement on values, decisions and errors, sent as their types.

use mpi::collective::SystemOperation;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use petsc_wrap::Comm;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error;

/// Returns the value if no rank has an error; otherwise, on every rank, the error of the lowest rank that has one.
/// Collective.
///
/// # Errors
/// If any rank has an error.
pub fn agree<T, E: Serialize + DeserializeOwned>(comm: &Comm, result: Result<T, E>) -> Result<T, E> {
    let mpi = comm.mpi();
    let mine = if result.is_err() { mpi.rank() } else { mpi.size() };
    let mut first = 0;
    mpi.all_reduce_into(&mine, &mut first, SystemOperation::min());
    if first == mpi.size() {
        return result;
    }
    Err(of_rank(comm, first as usize, result.err()))
}

/// Result of `decide` on rank 0, sent to every rank: a value or an error. The other ranks do not call `decide`.
/// Collective.
///
/// # Errors
/// If rank 0 has an error. If it cannot be sent (an excerpt of a scene, PETSc's frames), the other ranks get its text.
pub fn decided<T: Serialize + DeserializeOwned>(
    comm: &Comm,
    decide: impl FnOnce() -> error::Result<T>,
) -> error::Result<T> {
    let mine = comm.is_root().then(decide).map(|found| found.map_err(error::Error::of_all_ranks));
    let sent = mine.as_ref().map(|found| found.as_ref().map_err(error::Error::as_told));
    let bytes = broadcast(comm, 0, sent.as_ref().map_or_else(Vec::new, encoded));
    mine.unwrap_or_else(|| decoded::<Result<T, error::Error>>(&bytes))
}

/// The value of rank 0, on every rank. The values of other ranks are ignored. Collective.
pub fn of_root<T: Serialize + DeserializeOwned>(comm: &Comm, value: Option<T>) -> T {
    of_rank(comm, 0, value)
}

/// The value of one rank, on every rank. Collective.
fn of_rank<T: Serialize + DeserializeOwned>(comm: &Comm, rank: usize, value: Option<T>) -> T {
    let is_mine = comm.mpi().rank() as usize == rank;
    let value = value.filter(|_| is_mine);
    let bytes = broadcast(comm, rank, value.as_ref().map_or_else(Vec::new, encoded));
    value.unwrap_or_else(|| decoded(&bytes))
}

/// Encodes a value as bytes for a message between the ranks of a run.
pub fn encoded<T: Serialize>(value: &T) -> Vec<u8> {
    postcard::to_stdvec(value).expect("what ranks exchange has lengths and no foreign serialisers")
}

/// Decodes a value from the bytes of [`encoded`].
pub fn decoded<T: DeserializeOwned>(bytes: &[u8]) -> T {
    postcard::from_bytes(bytes).expect("all ranks run the same program, so that types are alike")
}

/// The bytes of one rank, on every rank. Collective.
fn broadcast(comm: &Comm, rank: usize, mut bytes: Vec<u8>) -> Vec<u8> {
    let process = comm.mpi().process_at_rank(rank as i32);
    let mut length = bytes.len();
    process.broadcast_into(&mut length);
    bytes.resize(length, 0);
    process.broadcast_into(&mut bytes[..]);
    bytes
}
