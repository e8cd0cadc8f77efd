//! A rank under `mpirun`, which waits for the names of tests and runs them.

use std::any::Any;
use std::io::BufReader;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;

use crate::message::{Order, Report, receive, send};
use crate::times;

/// Environment variable of the processes under `mpirun`: the socket from which they take orders, or [`ALONE`].
pub const ROLE: &str = "MPI_TEST_WORKER";

/// Value of [`ROLE`] for a process that runs all tests alone, for example under a debugger or valgrind.
const ALONE: &str = "alone";

/// Role of this process, if it is not the test program itself.
pub enum Role {
    /// Runs every test, as the only rank.
    Alone,
    /// Takes orders from a socket.
    Rank(PathBuf),
}

impl Role {
    /// Returns the role that the environment gives.
    pub fn of_this_process() -> Option<Self> {
        let value = std::env::var_os(ROLE)?;
        Some(if value == ALONE { Self::Alone } else { Self::Rank(PathBuf::from(value)) })
    }
}

/// A test with its full name.
pub struct Named<T> {
    pub name: String,
    pub test: fn(&T),
}

/// Exit status after a panic, the same as for any Rust program.
const PANICKED: i32 = 101;

/// Makes the context and runs the tests of this role.
pub fn work<T>(role: &Role, start: fn() -> T, between: fn(&T), tests: &[Named<T>]) -> ExitCode {
    let context = start();
    match role {
        Role::Alone => {
            for Named { name, test } in tests {
                test(&context);
                between(&context);
                println!("test {name} ... ok");
            }
        }
        Role::Rank(socket) => {
            obey(&UnixStream::connect(socket).expect("the test program listens"), &context, between, tests)
        }
    }
    ExitCode::SUCCESS
}

fn obey<T>(mut stream: &UnixStream, context: &T, between: fn(&T), tests: &[Named<T>]) {
    let mut orders = BufReader::new(stream);
    send(&Report::Ready { rank: rank() }, &mut stream).expect("the test program listens");
    // If the test program has gone, there is nothing left to do.
    while let Ok(Some(Order::Run(name))) = receive(&mut orders) {
        let before = times::of_processor();
        let run = || {
            let wanted = tests.iter().find(|test| test.name == name).expect("a test of this program");
            (wanted.test)(context);
            between(context);
        };
        match catch_unwind(AssertUnwindSafe(run)) {
            Ok(()) => {
                let processor = times::of_processor() - before;
                send(&Report::Passed { processor }, &mut stream).expect("the test program listens");
            }
            Err(panic) => {
                let _ = send(&Report::Failed { message: text(&*panic).to_owned() }, &mut stream);
                // The other ranks may be waiting in a collective call: mpirun ends them when this rank has ended.
                std::process::exit(PANICKED);
            }
        }
    }
}

/// This process's rank, as set by mpirun or a similar launcher.
fn rank() -> usize {
    ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"]
        .into_iter()
        .find_map(|name| std::env::var(name).ok()?.parse().ok())
        .unwrap_or(0)
}

fn text(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("panic")
}
