//! The command that starts programs under MPI.

use std::path::Path;
use std::process::Command;

/// `mpirun -n ranks`, with settings for machines with fewer cores than ranks, for containers and for root.
pub fn mpirun(ranks: usize) -> Command {
    let mut command = Command::new("mpirun");
    command
        .args(["-n", &ranks.to_string()])
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        // The name of the same setting in Open MPI 5.
        .env("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        // A waiting rank yields its core. Without this, three ranks on two cores alternate with the period of the
        // scheduler.
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none")
        // All ranks are on this machine. Without this, Open MPI 5 complains on standard error about network interfaces
        // that have addresses of both IPv4 and IPv6.
        .env("OMPI_MCA_btl_tcp_if_include", "lo")
        .env("OMP_NUM_THREADS", "1");
    command
}

/// Gives a command a separate folder for MPI's session files. If several mpiruns share a folder, one that ends removes
/// files of another one that is starting, which then fails.
pub fn keep_files_in(folder: &Path, command: &mut Command) {
    command.env("OMPI_MCA_orte_tmpdir_base", folder);
}
