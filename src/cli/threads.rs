//! How many threads BLAS has.

use petsc_wrap::{Session, limit_threads};

/// Variables by which a user says it.
const GIVEN: [&str; 3] = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// One thread a rank, unless the environment says otherwise: ranks share the cores, and the fronts of a plate's factor are so small that a
/// second thread mostly waits (docs/performance.md).
pub fn limit(session: &Session) {
    if GIVEN.iter().all(|name| std::env::var_os(name).is_none()) {
        limit_threads(session, 1);
    }
}
