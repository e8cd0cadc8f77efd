//! Refuses what the machine has no memory for, before it is begun: the system would end the program without a word.

use std::fs;
use std::path::Path;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::Comm;

use crate::error::Result;
use crate::scene::Fault;

/// What needs memory, for a message.
pub(crate) struct Need<'a> {
    /// Bytes on this rank.
    pub bytes: f64,
    /// What they hold.
    pub what: &'a str,
    /// Key of the scene on which it depends.
    pub key: &'a str,
    /// What lowers it.
    pub help: &'a str,
}

/// Checks that the machine of each of the `ranks` has the memory; without ranks, this process alone needs it. Collective.
///
/// # Errors
/// A fault of the scene, on all ranks.
pub(crate) fn check(ranks: Option<&Comm>, Need { bytes, what, key, help }: Need<'_>) -> Result<()> {
    let needed = bytes * ranks.map_or(1, |_| ranks_here()) as f64;
    let free = available().unwrap_or(f64::INFINITY);
    // Of all ranks, the needs and the negative of what is free.
    let mut worst = [needed - free, needed, -free];
    if let Some(comm) = ranks {
        let mine = worst;
        comm.mpi().all_reduce_into(&mine, &mut worst, SystemOperation::max());
    }
    let [lack, needed, free] = worst;
    if lack <= 0.0 {
        return Ok(());
    }
    let message =
        format!("{what} would take {:.0} MB on one machine, and {:.0} MB are free", 1e-6 * needed, -1e-6 * free);
    Err(Fault::new(key, message, help).into())
}

/// Number of ranks of the run on this machine, as Open MPI tells it; 1 if it is unknown.
fn ranks_here() -> usize {
    let told = std::env::var("OMPI_COMM_WORLD_LOCAL_SIZE").ok();
    told.and_then(|told| told.parse().ok()).unwrap_or(1)
}

/// Memory that this process can still get, bytes; `None` if the system does not tell.
fn available() -> Option<f64> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let of_system = 1024.0 * value(&read("/proc/meminfo"), "MemAvailable:")?;
    let limits = read("/proc/self/limits");
    let status = read("/proc/self/status");
    let within = |limit: &str, used: &str| Some(value(&limits, limit)? - 1024.0 * value(&status, used)?);
    let of_process = [within("Max address space", "VmSize:"), within("Max data size", "VmData:")];
    // A batch system or a container limits a group or one that contains it. Its file holds "max" where there is no limit.
    let group = read("/proc/self/cgroup").lines().find_map(|line| line.strip_prefix("0::").map(str::to_owned));
    let group = format!("/sys/fs/cgroup{}", group.unwrap_or_default());
    let of_groups = Path::new(&group).ancestors().take_while(|path| path.starts_with("/sys/fs/cgroup")).map(|path| {
        let of = |name: &str| read(&path.join(name).to_string_lossy());
        // Pages of files that are not in use are given up for others.
        let used = value(&of("memory.current"), "")? - value(&of("memory.stat"), "inactive_file ").unwrap_or_default();
        Some(value(&of("memory.max"), "")? - used)
    });
    let left = of_process.into_iter().chain(of_groups).flatten();
    Some(left.fold(of_system, f64::min).max(0.0))
}

/// First number after a name at the beginning of a line; `None` if there is none.
fn value(text: &str, name: &str) -> Option<f64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    rest.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The files of the system are read as they are written: a limit, and none.
    #[test]
    fn numbers_of_the_system_are_read() {
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
            Max data size             unlimited            unlimited            bytes     \n\
            Max address space         1048576000           unlimited            bytes     \n";
        assert_eq!(value(limits, "Max address space"), Some(1_048_576_000.0));
        assert_eq!(value(limits, "Max data size"), None);
        assert_eq!([value("max\n", ""), value("4096\n", "")], [None, Some(4096.0)]);
        assert_eq!(value("VmPeak:\t  9 kB\nVmSize:\t  226304 kB\n", "VmSize:"), Some(226_304.0));
    }

    #[test]
    fn what_no_machine_has_is_refused() {
        let need =
            |bytes: f64| check(None, Need { bytes, what: "the matrices", key: "body.cells", help: "coarser cells" });
        assert!(need(1.0).is_ok());
        let error = need(1e18).expect_err("an exabyte").to_string();
        assert!(
            error.contains("the matrices would take 1000000000000 MB on one machine") && error.contains("are free"),
            "{error}"
        );
    }
}
