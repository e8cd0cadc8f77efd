//! Quick starts of a process that nobody launched.

use petsc_wrap::set_default_environment;

/// Settings of Open MPI: no daemon for processes that it might spawn, and no search for networks. They take a third of a second, many times
/// what a small impact does. What the user sets stands. No folder for the session either: without the daemon all such processes would have
/// the same one, which the first to end takes from the others.
const ALONE: [(&str, &str); 3] =
    [("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_orte_create_session_dirs", "0"), ("OMPI_MCA_pml", "ob1")];

/// What mpirun and srun leave in the environment.
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK"];

/// Makes MPI start quickly in a process that neither mpirun nor srun has launched. It is called before there are threads.
pub fn start_quickly() {
    if !LAUNCHED.iter().any(|name| std::env::var_os(name).is_some()) {
        set_default_environment(&ALONE);
    }
}
