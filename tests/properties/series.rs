//! The result file: everything written can be read, even if the process ends in between.

use crate::alone;
use crate::sample::{COST, HALF_PERIOD, provenance, step};
use crate::texts::text;
use hdf5_metno as hdf5;
use ricochet::error::Error;
use ricochet::impact::Reading;
use ricochet::impact::step::Step;
use ricochet::record::read::history;
use ricochet::record::series::{Points, SeriesWriter};
use ricochet::record::target::{Kind, check_writable};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

type Column = (&'static str, &'static str, fn(&Step) -> f64);

/// Every dataset of the series: path, unit, value.
const SERIES: [Column; 15] = [
    ("time", "s", |s| s.time),
    ("impactor/position", "m", |s| s.impactor.position),
    ("impactor/velocity", "m/s", |s| s.impactor.velocity),
    ("impactor/acceleration", "m/s2", |s| s.impactor.acceleration),
    ("contact/force", "N", |s| s.contact.force),
    ("contact/indentation", "m", |s| s.contact.indentation),
    ("contact/surface_displacement", "m", |s| s.contact.surface_displacement),
    ("energy/kinetic", "J", |s| s.energy.kinetic),
    ("energy/elastic", "J", |s| s.energy.elastic),
    ("energy/support", "J", |s| s.energy.support),
    ("energy/impactor", "J", |s| s.energy.impactor),
    ("energy/contact", "J", |s| s.energy.contact),
    ("energy/dissipated", "J", |s| s.energy.dissipated),
    ("energy/external", "J", |s| s.energy.external),
    ("energy/total", "J", |s| s.energy.total),
];

const CONTACTS: [(&str, &str); 5] =
    [("start", "s"), ("end", "s"), ("peak_force", "N"), ("peak_time", "s"), ("impulse", "N s")];

fn number<T: hdf5::H5Type>(at: &hdf5::Location, name: &str) -> T {
    at.attr(name).unwrap().read_scalar().unwrap()
}

fn values(file: &hdf5::File, path: &str, units: &str) -> Vec<f64> {
    let dataset = file.dataset(path).unwrap();
    assert_eq!(text(&dataset, "units"), units, "{path}");
    dataset.read_raw().unwrap()
}

/// Number of rows that all datasets have; each row is checked against every `every`-th step.
fn checked_rows(file: &hdf5::File, every: usize) -> usize {
    let rows = values(file, "series/time", "s").len();
    for (path, units, value) in SERIES {
        let found = values(file, &format!("series/{path}"), units);
        assert!(found.len() >= rows, "{path} is shorter than the time");
        for (n, found) in found.iter().enumerate() {
            assert_eq!(*found, value(&step(n * every)), "{path}, row {n}");
        }
    }
    rows
}

/// Checks the contacts of the steps up to `last`.
fn check_contacts(file: &hdf5::File, last: usize) {
    let [start, end, peak_force, peak_time, impulse] =
        CONTACTS.map(|(name, units)| values(file, &format!("contacts/{name}"), units));
    // There is contact around each maximum of the cosine.
    let half = HALF_PERIOD as f64 / 2.0;
    let count = (last as f64 / half + 1.0) as usize / 4 + 1;
    assert_eq!(start.len(), count);
    for n in 0..count {
        let middle = 4.0 * half * n as f64;
        // The zeros are at steps, except for the rounding of the cosine.
        let near = |found: f64, steps: f64| (found - 1e-5 * steps).abs() < 1e-12;
        let starts = (middle - half).max(0.0);
        let ends = (middle + half).min(last as f64);
        assert!(near(start[n], starts) && near(end[n], ends), "{n}");
        if last as f64 >= middle {
            assert!(peak_force[n] == 1.0 && near(peak_time[n], middle));
        }
        // ∫ cos over the steps from `starts` to `ends`.
        let angle = |steps: f64| (steps / (2.0 * half) * std::f64::consts::PI).sin();
        let exact = 1e-5 * 2.0 * half / std::f64::consts::PI * (angle(ends) - angle(starts));
        assert!((impulse[n] - exact).abs() < 1e-6 * exact + 1e-12, "{n}");
    }
    let contacts = file.group("contacts").unwrap();
    assert_eq!(number::<bool>(&contacts, "open_at_end"), step(last).contact.force > 0.0);
}

#[test]
fn everything_written_is_read_back() {
    let _alone = alone();
    // One chunk that fits, one that the series exceeds twice, and no planned length.
    for planned in [Some(2501), Some(1000), None] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.h5");
        let given = provenance("Plate h = 0,1 m, ν = 0,23", planned);
        let mut writer = SeriesWriter::create(&path, &given, &Points::default()).unwrap().every(4);
        for n in 0..=10_001 {
            writer.push(&step(n), &Reading::default()).unwrap();
        }
        writer.finish(&COST, true).unwrap();

        let file = hdf5::File::open(&path).unwrap();
        assert_eq!(checked_rows(&file, 4), 2501);
        check_contacts(&file, 10_001);
        assert_eq!(text(&file, "title"), given.origin.title);
        // Longer than an attribute may be.
        let scene = file.dataset("scene").unwrap().read_raw::<u8>().unwrap();
        assert_eq!(String::from_utf8(scene).unwrap(), given.origin.scene);
        assert_eq!(text(&file, "version"), given.origin.version);
        assert_eq!(text(&file, "commit"), given.origin.commit);
        assert_eq!(text(&file, "petsc_version"), given.origin.petsc_version);
        assert_eq!(text(&file, "petsc_options"), given.origin.petsc_options);
        assert_eq!(text(&file, "model"), given.model);
        assert_eq!(text(&file, "reduction"), given.reduction);
        assert_eq!(number::<u64>(&file, "ranks"), 2);
        assert_eq!(number::<u64>(&file, "unknowns"), 4711);
        assert_eq!(number::<f64>(&file, "error_estimate"), 1e-3);
        assert_eq!(file.attr("planned_rows").is_ok(), planned.is_some());
        assert!(number::<bool>(&file, "complete"));
        for (phase, seconds) in [("model", 0.125), ("setup", 0.25), ("steps", 1.5), ("total", 2.0)] {
            assert_eq!(number::<f64>(&file, &format!("wall_time_{phase}")), seconds);
        }
        assert_eq!(number::<u64>(&file, "newton_iterations"), 42);
        assert_eq!(number::<u64>(&file, "solves"), 21);

        let history = history(&path).unwrap();
        assert_eq!(history.title, given.origin.title);
        assert_eq!(history.time.len(), 2501);
        assert_eq!(history.contacts.len(), 3);
    }
}

#[test]
fn first_step_is_on_the_disk_at_once_and_a_drop_writes_the_rest() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.h5");
    let mut writer = SeriesWriter::create(&path, &provenance("", None), &Points::default()).unwrap();
    assert!(!path.exists());
    writer.push(&step(0), &Reading::default()).unwrap();
    // A copy, because this process shares the data that HDF5 has not flushed yet.
    let copy = folder.path().join("copy.h5");
    fs::copy(&path, &copy).unwrap();
    assert_eq!(checked_rows(&hdf5::File::open(&copy).unwrap(), 1), 1);
    (1..7).for_each(|n| writer.push(&step(n), &Reading::default()).unwrap());
    drop(writer);
    let file = hdf5::File::open(&path).unwrap();
    assert_eq!(checked_rows(&file, 1), 7);
    assert!(!number::<bool>(&file, "complete"));
}

fn start(job: &str, path: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "series::child", "--nocapture"])
        .env("RICOCHET_TEST_JOB", job)
        .env("RICOCHET_TEST_PATH", path)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The child process that the other tests start; it does nothing without a job.
#[test]
fn child() {
    let Ok(job) = std::env::var("RICOCHET_TEST_JOB") else {
        return;
    };
    let path = std::env::var("RICOCHET_TEST_PATH").unwrap();
    let path = Path::new(&path);
    if job == "provoke errors" {
        history(path).unwrap_err();
        check_writable(path, Kind::Run).unwrap_err();
        return;
    }
    let between: usize = job.parse().unwrap();
    let mut writer = SeriesWriter::create(path, &provenance("", Some(200_000)), &Points::default()).unwrap();
    for n in 0..200_000 {
        writer.push(&step(n), &Reading::default()).unwrap();
        if n % between == between - 1 {
            writer.flush().unwrap();
        }
    }
    // The parent kills the process before this ends.
    std::thread::sleep(Duration::from_secs(60));
}

#[test]
fn killed_process_leaves_a_prefix_of_the_series() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.h5");
    let mut most = 0;
    for moment in 0..24 {
        // The child flushes almost all the time, so that most kills fall into a flush.
        let mut child = start("40", &path);
        while !path.exists() {
            std::thread::sleep(Duration::from_micros(200));
        }
        std::thread::sleep(Duration::from_micros(1300 * moment));
        child.kill().unwrap();
        child.wait().unwrap();
        let file = hdf5::File::open(&path).unwrap();
        let rows = checked_rows(&file, 1);
        assert!(rows >= 1, "moment {moment}");
        assert!(!number::<bool>(&file, "complete"));
        assert_eq!(history(&path).unwrap().time.len(), rows);
        most = most.max(rows);
        drop(file);
        fs::remove_file(&path).unwrap();
    }
    assert!(most > 100, "no child came far: {most} rows");
}

#[test]
fn result_in_writing_is_neither_replaced_nor_read() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.h5");
    let mut child = start("200000", &path);
    while !path.exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let replaced = check_writable(&path, Kind::Run).unwrap_err().to_string();
    let created = SeriesWriter::create(&path, &provenance("", None), &Points::default()).err().unwrap();
    let read = history(&path).unwrap_err().to_string();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(replaced.ends_with("another run is not finished with it"), "{replaced}");
    assert_eq!(created.to_string(), replaced);
    assert!(read.contains("still being written"), "{read}");
    assert!(checked_rows(&hdf5::File::open(&path).unwrap(), 1) >= 1);
    check_writable(&path, Kind::Run).unwrap();
}

#[test]
fn creation_replaces_an_older_result_only_when_it_succeeds() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let old = folder.path().join("old.h5");
    let mut writer = SeriesWriter::create(&old, &provenance("old", None), &Points::default()).unwrap();
    writer.push(&step(0), &Reading::default()).unwrap();
    assert!(check_writable(&old, Kind::Run).is_err(), "open in this process");
    writer.finish(&COST, true).unwrap();
    let bytes = fs::read(&old).unwrap();

    let scene = folder.path().join("scene.toml");
    fs::write(&scene, "title = 'x'").unwrap();
    let read_only = folder.path().join("read-only.h5");
    fs::copy(&old, &read_only).unwrap();
    let mut permissions = fs::metadata(&read_only).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&read_only, permissions).unwrap();
    let missing = folder.path().join("no/out.h5");
    for (path, reason) in [
        (missing.as_path(), "there is no folder"),
        (folder.path(), "is a folder"),
        (&scene, "is no readable HDF5 file"),
        (&read_only, "is read-only"),
        (Path::new("/dev/null"), "is not a regular file"),
        (Path::new("/"), "is not the name of a file"),
    ] {
        for error in [
            check_writable(path, Kind::Run).unwrap_err(),
            SeriesWriter::create(path, &provenance("new", None), &Points::default()).err().unwrap(),
        ] {
            assert!(matches!(error, Error::Io { .. }));
            assert!(error.to_string().contains(reason), "{error}");
        }
    }
    assert_eq!(fs::read(&scene).unwrap(), b"title = 'x'");
    assert_eq!(fs::read(&read_only).unwrap(), bytes);

    // An old result is not replaced by a run that fails before its first step, nor by one whose scene HDF5 cannot
    // store.
    check_writable(&old, Kind::Run).unwrap();
    drop(SeriesWriter::create(&old, &provenance("new", None), &Points::default()).unwrap());
    SeriesWriter::create(&old, &provenance("new", None), &Points::default()).unwrap().finish(&COST, false).unwrap();
    assert!(SeriesWriter::create(&old, &provenance("a\0b", None), &Points::default()).is_err());
    assert_eq!(fs::read(&old).unwrap(), bytes);
    let link = folder.path().join("link.h5");
    std::os::unix::fs::symlink(&old, &link).unwrap();
    let mut writer = SeriesWriter::create(&link, &provenance("new", None), &Points::default()).unwrap();
    writer.push(&step(0), &Reading::default()).unwrap();
    writer.finish(&COST, true).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(history(&old).unwrap().title, "new");
    let left = fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left, 4, "only the files from above");
}

#[test]
fn hdf5_prints_nothing_by_itself() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("text.h5");
    fs::write(&path, "no HDF5").unwrap();
    let output = start("provoke errors", &path).wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !stderr.contains("HDF5-DIAG"), "{stderr}");
}
