//! Runs tests under `mpirun` on several numbers of ranks, with the command line of `cargo test` (names, filters,
//! `--list`).
//!
//! MPI can be initialised only once in a process, so such tests cannot run in the threads of the standard harness. A
//! test program with `harness = false` describes its tests as a [`Suite`]. Each test becomes one trial for every number
//! of ranks, for example `vectors::dot::on_2_ranks`. When the first trial for two ranks is due, the program starts
//! itself again under `mpirun -n 2`. These processes then wait, without using the processor, for the names of further
//! tests. A filter that matches nothing starts no mpirun.

mod cores;
mod launch;
mod message;
mod pool;
mod times;
mod worker;

use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Trial};

pub use launch::{keep_files_in, mpirun};

use cores::Cores;
use pool::Pool;

/// A named test. Its argument is the value that the `start` function of [`Suite::new`] makes once in each process.
pub type Test<T> = (&'static str, fn(&T));

/// A named test that runs in the test program itself, without MPI.
pub type PlainTest = (&'static str, fn());

/// Tests with the names of their functions: `tests![a, b]` is `[("a", a), ("b", b)]`.
#[macro_export]
macro_rules! tests {
    ($($name:ident),* $(,)?) => { &[$((stringify!($name), $name)),*] };
}

/// Tests of one module that run on the same numbers of ranks.
struct Group<T: 'static> {
    module: &'static str,
    ranks: &'static [usize],
    tests: &'static [Test<T>],
    is_long: bool,
}

/// The tests of a program.
pub struct Suite<T: 'static> {
    start: fn() -> T,
    between: fn(&T),
    groups: Vec<Group<T>>,
}

impl<T> Suite<T> {
    /// A suite whose processes each call `start` once, before their first test.
    pub fn new(start: fn() -> T) -> Self {
        Self { start, between: |_| (), groups: Vec::new() }
    }

    /// Makes all ranks call `tidy` after each test.
    pub fn between(self, tidy: fn(&T)) -> Self {
        Self { between: tidy, ..self }
    }

    /// Adds the tests of a module, to be run on each of these numbers of ranks.
    pub fn group(mut self, module: &'static str, ranks: &'static [usize], tests: &'static [Test<T>]) -> Self {
        self.groups.push(Group { module, ranks, tests, is_long: false });
        self
    }

    /// Same as [`Suite::group`], for tests that take long: they are ignored unless `--include-ignored` or `--ignored`
    /// is given.
    pub fn long_group(mut self, module: &'static str, ranks: &'static [usize], tests: &'static [Test<T>]) -> Self {
        self.groups.push(Group { module, ranks, tests, is_long: true });
        self
    }

    /// Runs the tests that the command line selects; under `mpirun`, this process's part of them.
    pub fn run(self) -> ExitCode {
        let tests = self.groups.iter().flat_map(|group| {
            group.tests.iter().map(|(name, test)| worker::Named { name: full_name(group.module, name), test: *test })
        });
        if let Some(role) = worker::Role::of_this_process() {
            return worker::work(&role, self.start, self.between, &tests.collect::<Vec<_>>());
        }
        let arguments = Arguments::from_args();
        let pool = Arc::new(Pool::new(Cores::of_this_machine(), arguments.nocapture));
        let mut due: Vec<(usize, Trial)> = Vec::new();
        for group in &self.groups {
            for (name, _) in group.tests {
                for &ranks in group.ranks {
                    let (pool, test) = (Arc::clone(&pool), full_name(group.module, name));
                    let name = format!("{test}::on_{ranks}_rank{}", if ranks == 1 { "" } else { "s" });
                    let timed = name.clone();
                    let trial = Trial::test(name, move || pool.run(ranks, &test, &timed));
                    due.push((ranks, trial.with_ignored_flag(group.is_long)));
                }
            }
        }
        // Tests on few ranks come first, so that tests that use the whole machine do not wait for one that does not.
        due.sort_by_key(|(ranks, _)| *ranks);
        let outcome = libtest_mimic::run(&arguments, due.into_iter().map(|(_, trial)| trial).collect());
        if let Err(message) = pool.finish() {
            eprintln!("{message}");
            return ExitCode::FAILURE;
        }
        outcome.exit_code()
    }
}

fn full_name(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
}

/// Runs tests of one file on each of these numbers of ranks.
pub fn run<T: 'static>(ranks: &'static [usize], start: fn() -> T, tests: &'static [Test<T>]) -> ExitCode {
    Suite::new(start).group("", ranks, tests).run()
}

/// The reason why a test cannot run here, if there is one: most often a tool that is not installed.
pub type Missing = Option<String>;

/// Tests that run in the test program itself, with the same command line and report of times. Its groups can state at
/// run time why they are ignored.
#[derive(Default)]
pub struct PlainSuite {
    trials: Vec<Trial>,
}

impl PlainSuite {
    /// Adds the tests of a module.
    pub fn group(self, module: &'static str, tests: &'static [PlainTest]) -> Self {
        self.add(module, tests, None)
    }

    /// Same as [`PlainSuite::group`], for tests that take long: they are ignored unless `--include-ignored` or
    /// `--ignored` is given.
    pub fn long_group(self, module: &'static str, tests: &'static [PlainTest]) -> Self {
        self.add(module, tests, Some("long".to_owned()))
    }

    /// Same as [`PlainSuite::group`], for tests with requirements that may be missing: they are then ignored, with the
    /// reason.
    pub fn group_unless(self, missing: Missing, module: &'static str, tests: &'static [PlainTest]) -> Self {
        self.add(module, tests, missing)
    }

    fn add(mut self, module: &'static str, tests: &'static [PlainTest], ignored: Missing) -> Self {
        self.trials.extend(tests.iter().map(|&(name, test)| {
            let name = full_name(module, name);
            let timed = name.clone();
            let trial = Trial::test(name, move || {
                times::timed(&timed, || {
                    test();
                    Ok(None)
                })
            });
            trial.with_ignored_flag(ignored.is_some()).with_kind(ignored.clone().unwrap_or_default())
        }));
        self
    }

    /// Runs the tests that the command line selects.
    pub fn run(self) -> ExitCode {
        libtest_mimic::run(&Arguments::from_args(), self.trials).exit_code()
    }
}
