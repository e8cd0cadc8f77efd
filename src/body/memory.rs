//! Refuses what the machine has no memory for, before it is begun: the system would end the program without a word.

use std::fs;

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
    let message = format!("{what} would take {:.0} MB, and {:.0} MB are free", 1e-6 * needed, -1e-6 * free);
    Err(Fault::new(key, message, help).into())
}

/// Number of ranks of the run on this machine, as Open MPI tells it; 1 if it is unknown.
fn ranks_here() -> usize {
    let told = std::env::var("OMPI_COMM_WORLD_LOCAL_SIZE").ok();
    told.and_then(|told| told.parse().ok()).unwrap_or(1)
}

/// Memory that this process and others of its control group can still get, bytes; `None` if the system does not tell.
fn available() -> Option<f64> {
    let number = |text: &str| text.split_whitespace().next()?.parse::<f64>().ok();
    let of_system = fs::read_to_string("/proc/meminfo").ok()?;
    let of_system = 1024.0 * of_system.lines().find_map(|line| number(line.strip_prefix("MemAvailable:")?))?;
    // A batch system or a container sets the limit of a group; the file holds "max" where there is none.
    let group = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let group = group.lines().find_map(|line| line.strip_prefix("0::")).unwrap_or_default().to_owned();
    let of_group = |name: &str| number(&fs::read_to_string(format!("/sys/fs/cgroup{group}/memory.{name}")).ok()?);
    let left = of_group("max").zip(of_group("current")).map(|(most, now)| (most - now).max(0.0));
    Some(left.map_or(of_system, |left| left.min(of_system)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused() {
        let need =
            |bytes: f64| check(None, Need { bytes, what: "the matrices", key: "body.cells", help: "coarser cells" });
        assert!(need(1.0).is_ok());
        let error = need(1e18).expect_err("an exabyte").to_string();
        assert!(error.contains("the matrices would take 1000000000000 MB") && error.contains("are free"), "{error}");
    }
}
