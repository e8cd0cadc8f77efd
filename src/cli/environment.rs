//! Sets environment variables for MPI and BLAS where the user has set none.

use petsc_wrap::set_default_environment;

/// Settings of Open MPI for a process started without a launcher: no daemon for processes that it might spawn, and no
/// search for networks. These take a third of a second, many times the duration of a small impact simulation. No
/// session folder either: without the daemon, all such processes would share one, and the first to end would delete it.
const ALONE: [(&str, &str); 3] =
    [("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_orte_create_session_dirs", "0"), ("OMPI_MCA_pml", "ob1")];

/// Environment variables that mpirun and srun set.
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK"];

/// One BLAS thread per rank. The ranks share the cores, and the fronts in the factorisation of a plate are so small
/// that a second thread mostly waits (docs/performance.md).
const ONE_THREAD: (&str, &str) = ("OMP_NUM_THREADS", "1");

/// Variables with which a user chooses the number of threads.
const THREADS: [&str; 3] = [ONE_THREAD.0, "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// Sets the variables above if they are not set. Must be called before MPI and (with PETSc) BLAS read them.
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
