//! Writes scenes into folders, runs them, and reads the results.
#![allow(dead_code, reason = "not every test that shares this module uses all of it")]

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

use hdf5_metno as hdf5;
use tempfile::TempDir;

use crate::program::{BOX, Outcome, ricochet, run};

/// Same as [`BOX`], with a run of minutes.
pub fn long() -> String {
    BOX.replace("end = 1e-3", "end = 10").replace("[4, 4, 1]", "[8, 8, 1]")
}

/// A window pane under a steel ball, whose model takes many seconds: Mindlin's plate with a basis of a thousand
/// vectors.
pub fn pane() -> String {
    BOX.replace("model = \"solid\"\nreduction = \"none\"\n", "")
        .replace("[0.5, 0.5, 0.02]", "[1.0, 1.5, 0.008]")
        .replace("cells = [4, 4, 1]\norder = 1\nsymmetry = \"none\"\n", "")
        .replace("mass = 52", "mass = 4.11")
        .replace("speed = 1", "speed = 7.672")
        .replace("step = 2e-5\n[contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\n", "")
        + "[accuracy]\ntolerance = 1e-2\n[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [0, 0, 5e8]\n"
}

/// A folder that contains a scene.
pub fn folder(scene: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    folder
}

/// A copy of a result and of its related files, opened for reading. A copy is needed because a program that another
/// test starts at the same moment inherits the open files of this process, and with them their locks.
pub struct Opened {
    file: hdf5::File,
    _folder: TempDir,
}

impl Deref for Opened {
    type Target = hdf5::File;

    fn deref(&self) -> &hdf5::File {
        &self.file
    }
}

/// Opens a result for reading.
pub fn open(path: impl AsRef<Path>) -> Opened {
    let (path, copies) = (path.as_ref(), tempfile::tempdir().unwrap());
    let file = hdf5::File::open(copied(path, copies.path())).unwrap();
    Opened { file, _folder: copies }
}

/// Changes a result.
pub fn change(path: &Path, work: impl FnOnce(&hdf5::File)) {
    let copies = tempfile::tempdir().unwrap();
    let copy = copied(path, copies.path());
    work(&hdf5::File::open_rw(&copy).unwrap());
    fs::copy(copy, path).unwrap();
}

/// Copies a result and all files next to it whose names begin in the same way; returns the new path.
fn copied(path: &Path, to: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
    let parent = path.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new("."));
    for entry in fs::read_dir(parent).unwrap().map(Result::unwrap) {
        if entry.file_name().to_string_lossy().starts_with(&stem) && entry.path().is_file() {
            fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
    to.join(path.file_name().unwrap())
}

pub fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split_whitespace()
}

pub fn good(folder: &TempDir, ranks: usize, line: &str) -> Outcome {
    let outcome = run(ricochet(folder.path(), ranks).args(words(line)));
    assert_eq!(outcome.status, Some(0), "{line}: {outcome:#?}");
    outcome
}

pub use crate::texts::text;

pub fn number<T: hdf5::H5Type>(file: &hdf5::File, name: &str) -> T {
    file.attr(name).unwrap().read_scalar().unwrap()
}

/// A time series of a result.
pub fn column(path: &Path, name: &str) -> Vec<f64> {
    open(path).dataset(&format!("series/{name}")).unwrap().read_raw().unwrap()
}

pub fn is_complete(path: &Path) -> bool {
    number(&open(path), "complete")
}

/// Largest difference of two series, over the largest value.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().chain(b).all(|x| x.is_finite()));
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0f64, |m, (x, y)| m.max((x - y).abs())) / largest
}
