//! Records how long tests take: one line for each test in the file named by `MPI_TEST_TIMES`, to find the slowest.

use std::fs::{OpenOptions, read_to_string};
use std::io::Write;
use std::time::Instant;

/// Runs a test and records its time (s), the processor time of its ranks (s), and its name. The test returns the
/// processor time if it is known.
pub fn timed<E>(name: &str, test: impl FnOnce() -> Result<Option<f64>, E>) -> Result<(), E> {
    let begin = Instant::now();
    let processor = test()?;
    if let Some(path) = std::env::var_os("MPI_TEST_TIMES") {
        let processor = processor.map_or("     -".to_owned(), |time| format!("{time:6.2}"));
        let line = format!("{:8.2} {processor} {name}\n", begin.elapsed().as_secs_f64());
        // A test does not fail if the record cannot be written.
        let _ = OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .and_then(|mut file| file.write_all(line.as_bytes()));
    }
    Ok(())
}

/// Processor time that this process has used so far, s; 0 if the system does not tell.
pub fn of_processor() -> f64 {
    /// Linux's unit of these times, s, the same on all machines.
    const TICK: f64 = 0.01;
    let stat = read_to_string("/proc/self/stat").unwrap_or_default();
    // The name in brackets may contain anything. After it, utime and stime are fields 12 and 13, counted from 1.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    TICK * fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>()
}
