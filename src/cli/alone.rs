//! Quick starts of a process that nobody launched.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::process::Command;

use petsc_wrap::set_default_environment;

/// Settings of Open MPI: no daemon for processes that it might spawn, and no search for networks. They take a third of a second, many times
/// what a small impact does. What the user sets stands. No folder for the session either: without the daemon all such processes would have
/// the same one, which the first to end takes from the others.
const ALONE: [(&str, &str); 3] =
    [("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_orte_create_session_dirs", "0"), ("OMPI_MCA_pml", "ob1")];

/// What mpirun and srun leave in the environment.
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK"];

/// Set for a process that has begun again, so that it does so once.
const AGAIN: &str = "RICOCHET_STARTED_AGAIN";

/// Makes MPI start quickly in a process that neither mpirun nor srun has launched. Nothing else has been done before.
pub fn start_quickly() {
    let is_set = |name: &&str| std::env::var_os(name).is_some();
    if LAUNCHED.iter().any(is_set) || is_set(&AGAIN) || set_default_environment(&ALONE) {
        return;
    }
    // A library has started threads as it was loaded, as OpenBLAS does, and they may read the environment: so the program begins again with
    // another one. That takes a tenth of what it saves.
    let Ok(program) = std::env::current_exe() else { return };
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let unset = ALONE.into_iter().filter(|(name, _)| !is_set(name));
    let mut command = Command::new(program);
    if let Some((name, arguments)) = arguments.split_first() {
        command.arg0(name).args(arguments);
    }
    let error = command.envs(unset).env(AGAIN, "1").exec();
    tracing::debug!("the program could not begin again, MPI starts slowly: {error}");
}
