//! How long tests take: a line for each in the file that `MPI_TEST_TIMES` names, for whoever looks for the slowest.

use std::fs::{OpenOptions, read_to_string};
use std::io::Write;
use std::time::Instant;

/// Runs a test, which tells what its ranks have taken of the processor (s) where that is known, and notes its time (s), that and its name.
pub fn timed<E>(name: &str, test: impl FnOnce() -> Result<Option<f64>, E>) -> Result<(), E> {
    let begin = Instant::now();
    let processor = test()?;
    if let Some(path) = std::env::var_os("MPI_TEST_TIMES") {
        let processor = processor.map_or("     -".to_owned(), |time| format!("{time:6.2}"));
        let line = format!("{:8.2} {processor} {name}\n", begin.elapsed().as_secs_f64());
        // A note that cannot be taken fails no test.
        let _ = OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .and_then(|mut file| file.write_all(line.as_bytes()));
    }
    Ok(())
}

/// What this process has taken of the processor so far, s; 0 where the system does not tell.
pub fn of_processor() -> f64 {
    /// Linux's unit of these times, s, the same on all its machines.
    const TICK: f64 = 0.01;
    let stat = read_to_string("/proc/self/stat").unwrap_or_default();
    // The name in brackets may hold anything; behind it utime and stime are the fields 12 and 13, from 1.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    TICK * fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>()
}
