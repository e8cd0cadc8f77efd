//! Gathers values of all ranks on rank 0, and distributes values from rank 0 to all ranks.

use mpi::datatype::{Partition, PartitionMut};
use mpi::traits::{Communicator, Root};
use petsc_wrap::Comm;

use crate::agree::of_root;
use crate::impact::checkpoint::Checkpoint;

/// The values of all ranks, in the order of the ranks, on rank 0; empty on other ranks. Collective.
pub fn gathered(comm: &Comm, values: &[f64]) -> Vec<f64> {
    let root = comm.mpi().process_at_rank(0);
    let Some((counts, starts)) = shares(comm, values.len()) else {
        root.gather_varcount_into(values);
        return Vec::new();
    };
    let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
    root.gather_varcount_into_root(values, &mut PartitionMut::new(&mut all[..], counts, starts));
    all
}

/// Distributes a checkpoint from rank 0 to all ranks. `part` is the number of values of this rank in vectors over
/// nodes: each rank gets its part of the vectors, or the whole vectors with `None`. All ranks get the numbers; the
/// lists stay on rank 0. Collective.
pub fn shared(comm: &Comm, whole: Option<Checkpoint>, part: Option<usize>) -> Checkpoint {
    let Checkpoint { vectors, numbers, lists } = whole.unwrap_or_default();
    let names: Vec<String> = of_root(comm, Some(vectors.keys().cloned().collect()));
    let vector = |name: String| {
        let all = vectors.get(&name).map_or(&[][..], Vec::as_slice);
        let mine = match part {
            Some(count) => scattered(comm, all, count),
            None => whole_to_all(comm, all),
        };
        (name, mine)
    };
    Checkpoint { vectors: names.into_iter().map(vector).collect(), numbers: of_root(comm, Some(numbers)), lists }
}

/// This rank's part, `count` values, of the values on rank 0. Collective.
fn scattered(comm: &Comm, all: &[f64], count: usize) -> Vec<f64> {
    let root = comm.mpi().process_at_rank(0);
    let mut mine = vec![0.0; count];
    match shares(comm, count) {
        Some((counts, starts)) => {
            root.scatter_varcount_into_root(&Partition::new(all, counts, starts), &mut mine[..]);
        }
        None => root.scatter_varcount_into(&mut mine[..]),
    }
    mine
}

/// The values of rank 0, on every rank. Collective.
fn whole_to_all(comm: &Comm, values: &[f64]) -> Vec<f64> {
    let root = comm.mpi().process_at_rank(0);
    let mut count = values.len();
    root.broadcast_into(&mut count);
    let mut all = values.to_vec();
    all.resize(count, 0.0);
    root.broadcast_into(&mut all[..]);
    all
}

/// Number of values of each rank, and index of its first value among those of all ranks, on rank 0; `None` on other
/// ranks. Collective.
fn shares(comm: &Comm, count: usize) -> Option<(Vec<i32>, Vec<i32>)> {
    let (root, count) = (comm.mpi().process_at_rank(0), count as i32);
    if !comm.is_root() {
        root.gather_into(&count);
        return None;
    }
    let mut counts = vec![0; comm.size()];
    root.gather_into_root(&count, &mut counts[..]);
    let starts = counts.iter().scan(0, |next, count| {
        let start = *next;
        *next += count;
        Some(start)
    });
    let starts = starts.collect();
    Some((counts, starts))
}
