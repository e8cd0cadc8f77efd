//! The examples of the library: each checks its own result.

use std::path::PathBuf;
use std::process::Command;

use mpi_test::PlainTest;

pub const TESTS: &[PlainTest] = &[
    ("condensed_step", || succeeds(mpi_test::mpirun(2).arg(example("condensed_step")))),
    ("reduced_plate", || succeeds(&mut Command::new(example("reduced_plate")))),
    ("contact_on_modes", || succeeds(&mut Command::new(example("contact_on_modes")))),
];

/// An example, which cargo has built next to the program.
fn example(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_BIN_EXE_ricochet")).with_file_name("examples").join(name)
}

fn succeeds(command: &mut Command) {
    let output = command.output().expect("the example starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    println!("  {}", String::from_utf8_lossy(&output.stdout));
}
