//! Distributes work that a sweep's members share over the ranks.

use petsc_wrap::Comm;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::agree::of_all;
use crate::error::{Error, Result};

/// Calls `make` for each number below `count`, each on one rank, and returns all results on all ranks. Number n is
/// computed on rank n modulo the number of ranks. Collective.
///
/// # Errors
/// The error of the lowest number that failed.
pub fn spread<T: Serialize + DeserializeOwned>(
    ranks: &Comm,
    count: usize,
    make: impl FnMut(usize) -> Result<T>,
) -> Result<Vec<T>> {
    if ranks.size() == 1 {
        return (0..count).map(make).map(|made| made.map_err(Error::of_all_ranks)).collect();
    }
    let own = (ranks.rank()..count).step_by(ranks.size());
    let mut made: Vec<std::result::Result<T, Error>> = Vec::new();
    for result in own.map(make) {
        let is_error = result.is_err();
        made.push(result.map_err(|error| error.of_all_ranks().as_told()));
        if is_error {
            break;
        }
    }
    let mut all: Vec<_> = of_all(ranks, &made).into_iter().map(Vec::into_iter).collect();
    // A rank stops at its first error. Its later numbers are not needed, because the lowest error is returned.
    (0..count).map(|number| all[number % ranks.size()].next().unwrap_or(Err(Error::Interrupted))).collect()
}
