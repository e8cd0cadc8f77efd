//! Runs every example, and programs that need processes of their own, on one and two ranks. Each checks its own answer.

use std::process::{ExitCode, Stdio};

use mpi_test::{PlainSuite, PlainTest};

/// Environment variable with an example's name, for the processes under mpirun.
const EXAMPLE: &str = "PETSC_WRAP_EXAMPLE";

#[path = "../examples/bratu.rs"]
mod bratu;
#[path = "problems/ends.rs"]
mod ends;
#[path = "problems/failing.rs"]
mod failing;
#[path = "../examples/lazy.rs"]
mod lazy;
#[path = "../examples/mesh.rs"]
mod mesh;
#[path = "../examples/options.rs"]
mod options;
#[path = "../examples/poisson.rs"]
mod poisson;
#[path = "../examples/ranks.rs"]
mod ranks;

type Example = fn() -> Result<(), Box<dyn std::error::Error>>;

const EXAMPLES: [(&str, Example); 8] = [
    ("bratu", bratu::main),
    ("ends", ends::main),
    ("failing", failing::main),
    ("lazy", lazy::main),
    ("mesh", mesh::main),
    ("options", options::main),
    ("poisson", poisson::main),
    ("ranks", ranks::main),
];

const TESTS: &[PlainTest] = &[
    ("bratu", || on_ranks("bratu")),
    ("ends", || on_ranks("ends")),
    ("failing", || on_ranks("failing")),
    ("lazy", || on_ranks("lazy")),
    ("mesh", || on_ranks("mesh")),
    ("options", || on_ranks("options")),
    ("poisson", || on_ranks("poisson")),
    ("ranks", || on_ranks("ranks")),
];

fn main() -> ExitCode {
    if let Ok(chosen) = std::env::var(EXAMPLE) {
        let (_, run) = EXAMPLES.iter().find(|(name, _)| *name == chosen).expect("an example");
        run().expect("the example runs");
        return ExitCode::SUCCESS;
    }
    PlainSuite::default().group("examples", TESTS).run()
}

/// Runs an example under mpirun.
fn on_ranks(example: &str) {
    let program = std::env::current_exe().expect("the path of the test program");
    let folder = tempfile::tempdir().expect("a temporary folder");
    for ranks in [1, 2] {
        let mut mpirun = mpi_test::mpirun(ranks);
        mpi_test::keep_files_in(folder.path(), &mut mpirun);
        // Without this, mpirun would read the standard input of the process that runs the tests.
        let status = mpirun.arg(&program).env(EXAMPLE, example).stdin(Stdio::null()).status();
        assert!(status.is_ok_and(|status| status.success()), "{example} on {ranks} rank(s)");
    }
}
