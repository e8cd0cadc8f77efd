//! Runs that are ended at a checkpoint, restarts that are refused, and comparisons of two results.
#![allow(dead_code, reason = "not every test that shares this module uses all of it")]

use crate::results;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use hdf5_metno as hdf5;
use tempfile::TempDir;

use crate::program::{BOX, LIMIT, Outcome, ricochet, run, send, start};
use crate::results::{is_complete, number, words};

/// Same as [`BOX`] with the condensed Newton's method, and some thousands of time steps.
pub fn scene(more: &str) -> String {
    BOX.replace("newton = \"full\"", "newton = \"condensed\"").replace("end = 1e-3", "end = 0.1") + more
}

/// Starts a run, sends it a signal when there is a new checkpoint next to out.h5, and returns its outcome. (mpirun
/// forwards SIGUSR1; on SIGTERM it ends itself and its ranks.)
pub fn ended(folder: &TempDir, ranks: usize, line: &str, signal: &str) -> Outcome {
    let checkpoint = folder.path().join("out.checkpoint.h5");
    let written = || fs::metadata(&checkpoint).and_then(|file| file.modified()).ok();
    let before = written();
    let started = start(ricochet(folder.path(), ranks).args(words(line)));
    let begin = Instant::now();
    while written().is_none_or(|now| before == Some(now)) {
        assert!(begin.elapsed() < LIMIT, "no checkpoint");
        std::thread::sleep(Duration::from_millis(2));
    }
    send(signal, &started.child.id().to_string());
    started.wait(LIMIT)
}

/// Same as [`ended`], with an orderly end and a checkpoint of the last time step.
pub fn interrupted(folder: &TempDir, ranks: usize, line: &str, signal: &str) -> Outcome {
    let outcome = ended(folder, ranks, line, signal);
    assert_eq!(outcome.status, Some(130), "{line}: {outcome:#?}");
    assert!(!is_complete(&folder.path().join("out.h5")));
    outcome
}

/// Same as [`ended`] by a kill, without mpirun; returns the time of the checkpoint, s.
pub fn killed(folder: &TempDir, line: &str) -> f64 {
    let outcome = ended(folder, 0, line, "KILL");
    assert_eq!(outcome.signal, Some(9), "{line}: {outcome:#?}");
    let file = results::open(folder.path().join("out.checkpoint.h5"));
    file.attr("time").unwrap().read_scalar().unwrap()
}

/// Paths of all datasets under a group.
fn datasets(group: &hdf5::Group) -> Vec<String> {
    let of_groups = group.groups().unwrap().iter().flat_map(datasets).collect::<Vec<_>>();
    group.datasets().unwrap().iter().map(|dataset| dataset.name()).chain(of_groups).collect()
}

/// Compares two complete results: every series, probes included, and the contacts, to a fraction of each series'
/// largest value. Energies are compared to a fraction of the total energy, since some of them are rounding. With a
/// tolerance of 0 the comparison is bit for bit and includes the run's counts. Returns the largest difference.
pub fn check_alike(path: &Path, whole: &Path, tolerance: f64) -> f64 {
    assert!(is_complete(path) && is_complete(whole));
    let [part, whole] = [path, whole].map(results::open);
    let read = |file: &hdf5::File, name: &str| -> Vec<f64> { file.dataset(name).unwrap().read_raw().unwrap() };
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    // HDF5 lists groups in an order that depends on the lengths of texts before them in the file.
    let names = |file: &hdf5::File| {
        let mut names = ["series", "contacts"].map(|group| datasets(&file.group(group).unwrap())).concat();
        names.sort();
        names
    };
    let all = names(&whole);
    assert_eq!(names(&part), all);
    assert!(all.len() >= 16 + 5, "{all:?}");
    let mut most = 0.0_f64;
    for name in all {
        let [values, of_whole] = [&part, &whole].map(|file| read(file, &name));
        let scale =
            if name.contains("/energy/") { largest(&read(&whole, "series/energy/total")) } else { largest(&of_whole) };
        assert_eq!(values.len(), of_whole.len(), "{name}");
        // Stresses are differences of displacements, which are mostly rigid motion: they magnify the displacements'
        // errors. The place of the largest stress may then jump between points of equal stress.
        let is_of_stress = name.contains("/stress/");
        if is_of_stress && name.ends_with("/point") && tolerance > 0.0 {
            continue;
        }
        let tolerance = if is_of_stress { 1e3 * tolerance } else { tolerance };
        for (n, (a, b)) in values.iter().zip(&of_whole).enumerate() {
            // False for NaN.
            assert!((a - b).abs() <= tolerance * scale, "{name}[{n}]: {a:e} and {b:e}, of {scale:e}");
        }
        if scale > 0.0 && !is_of_stress {
            most = values.iter().zip(&of_whole).fold(most, |most, (a, b)| most.max((a - b).abs() / scale));
        }
    }
    if tolerance == 0.0 {
        for count in ["solves", "newton_iterations"] {
            assert_eq!(number::<u64>(&part, count), number::<u64>(&whole, count), "{count}");
        }
    }
    most
}

/// Checks that a command is refused, alone and on two ranks, in one message with these words.
pub fn refused(folder: &TempDir, line: &str, status: i32, words_of: &[&str]) {
    for ranks in [0, 2] {
        let outcome = run(ricochet(folder.path(), ranks).args(words(line)));
        assert_eq!(outcome.status, Some(status), "{line}: {outcome:#?}");
        let errors: Vec<&str> = outcome.stderr.lines().filter(|line| line.contains("error: ")).collect();
        assert_eq!(errors.len(), 1, "{line}: {outcome:#?}");
        for word in words_of {
            assert!(errors[0].contains(word), "{line}: {word} is not in {}", errors[0]);
        }
    }
}
