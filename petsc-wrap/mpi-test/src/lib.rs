//! Tests that run under `mpirun` on several numbers of ranks.
//!
//! MPI and PETSc can be initialised once a process, so the threads of `cargo test` are of no use to them. A test file
//! with `harness = false` calls [`run`]: started by cargo it starts itself again under `mpirun -n N` for every N, and
//! there it calls each test in turn on all ranks.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Set for the processes under `mpirun`.
const CHILD: &str = "MPI_TEST_CHILD";

/// A named test; `T` is what [`run`]'s `start` makes once a process.
pub type Test<T> = (&'static str, fn(&T));

/// Runs the tests whose name contains the first argument that is not a flag (all without one) on each number of ranks.
///
/// A panic on any rank fails that number of ranks.
pub fn run<T>(ranks: &[usize], start: fn() -> T, tests: &[Test<T>]) -> ExitCode {
    let filter = std::env::args().skip(1).find(|arg| !arg.starts_with('-'));
    let selected: Vec<&Test<T>> =
        tests.iter().filter(|(name, _)| filter.as_ref().is_none_or(|f| name.contains(f.as_str()))).collect();
    if std::env::var_os(CHILD).is_some() { child(start, &selected) } else { parent(ranks, selected.len()) }
}

/// `mpirun -n ranks`, made fit for machines with fewer cores than ranks, for containers and for root.
pub fn mpirun(ranks: usize) -> Command {
    let mut command = Command::new("mpirun");
    command
        .args(["-n", &ranks.to_string()])
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none")
        .env("OMP_NUM_THREADS", "1");
    command
}

fn parent(ranks: &[usize], selected: usize) -> ExitCode {
    let program = std::env::current_exe().expect("the path of the test program");
    let begin = Instant::now();
    let (mut passed, mut failed) = (0, 0);
    for &n in ranks {
        println!("\nrunning {selected} tests on {n} rank(s)");
        let status = mpirun(n).arg(&program).args(std::env::args().skip(1)).env(CHILD, "1").status();
        match status {
            Ok(status) if status.success() => passed += selected,
            Ok(_) => failed += 1,
            Err(error) => {
                eprintln!("mpirun cannot be started: {error}");
                failed += 1;
            }
        }
    }
    let word = if failed == 0 { "ok" } else { "FAILED" };
    println!(
        "\ntest result: {word}. {passed} passed; {failed} failed; 0 ignored; 0 measured; 0 filtered out; finished in {:.2}s\n",
        begin.elapsed().as_secs_f64()
    );
    ExitCode::from(u8::from(failed > 0))
}

fn child<T>(start: fn() -> T, tests: &[&Test<T>]) -> ExitCode {
    let context = start();
    for (name, test) in tests {
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| test(&context))) {
            eprintln!("test {name} FAILED on rank {}: {}", rank(), text(&*panic));
            // The other ranks may wait in a collective call: mpirun ends them when this one dies.
            std::process::exit(101);
        }
        if rank() == "0" {
            println!("test {name} ... ok");
        }
    }
    ExitCode::SUCCESS
}

fn rank() -> String {
    ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"]
        .into_iter()
        .find_map(|name| std::env::var(name).ok())
        .unwrap_or_else(|| "0".to_owned())
}

fn text(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("panic")
}
