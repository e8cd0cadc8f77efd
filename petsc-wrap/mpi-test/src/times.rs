//! How long tests take: a line for each in the file that `MPI_TEST_TIMES` names, for whoever looks for the slowest.

use std::fs::OpenOptions;
use std::io::Write;
use std::time::Instant;

/// Runs a test and notes its time (s) and name.
pub fn timed<R>(name: &str, test: impl FnOnce() -> R) -> R {
    let begin = Instant::now();
    let result = test();
    if let Some(path) = std::env::var_os("MPI_TEST_TIMES") {
        let line = format!("{:9.3} {name}\n", begin.elapsed().as_secs_f64());
        // A note that cannot be taken fails no test.
        let _ = OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .and_then(|mut file| file.write_all(line.as_bytes()));
    }
    result
}
