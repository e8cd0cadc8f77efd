//! What MPI and BLAS are told by the environment, where the user has told them nothing.

use petsc_wrap::set_default_environment;

/// Settings of Open MPI for a process that nobody launched: no daemon for processes that it might spawn, and no search for networks. They
/// take a third of a second, many times what a small impact does. No folder for the session either: without the daemon all such processes
/// would have the same one, which the first to end takes from the others.
const ALONE: [(&str, &str); 3] =
    [("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_orte_create_session_dirs", "0"), ("OMPI_MCA_pml", "ob1")];

/// What mpirun and srun leave in the environment.
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK"];

/// One BLAS thread a rank: ranks share the cores, and the fronts of a plate's factor are so small that a second thread mostly waits
/// (docs/performance.md).
const ONE_THREAD: (&str, &str) = ("OMP_NUM_THREADS", "1");

/// Variables by which a user chooses threads.
const THREADS: [&str; 3] = [ONE_THREAD.0, "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// Sets the variables above that are not set, before MPI and, with PETSc, BLAS read them.
pub fn set() {
    let is_set = |name: &&str| std::env::var_os(name).is_some();
    let mut wanted = Vec::new();
    if !LAUNCHED.iter().any(is_set) {
        wanted.extend(ALONE.into_iter().filter(|(name, _)| !is_set(name)));
    }
    if !THREADS.iter().any(is_set) {
        wanted.push(ONE_THREAD);
    }
    if !wanted.is_empty() && !set_default_environment(&wanted) {
        tracing::debug!(
            "the environment of MPI and BLAS stays as it is: a library has started threads, which may read it"
        );
    }
}
