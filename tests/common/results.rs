//! Scenes put into folders, run, and their results read back.
#![allow(dead_code, reason = "not every test that shares this module uses all of it")]

use std::fs;
use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;
use tempfile::TempDir;

use crate::program::{BOX, Outcome, ricochet, run};

/// As [`BOX`], for minutes.
pub fn long() -> String {
    BOX.replace("end = 1e-3", "end = 10").replace("[4, 4, 1]", "[8, 8, 1]")
}

/// A folder with a scene in it.
pub fn folder(scene: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    folder
}

pub fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split_whitespace()
}

pub fn good(folder: &TempDir, ranks: usize, line: &str) -> Outcome {
    let outcome = run(ricochet(folder.path(), ranks).args(words(line)));
    assert_eq!(outcome.status, Some(0), "{line}: {outcome:#?}");
    outcome
}

pub fn text(at: &hdf5::Location, name: &str) -> String {
    at.attr(name).unwrap().read_scalar::<VarLenUnicode>().unwrap().to_string()
}

pub fn number<T: hdf5::H5Type>(file: &hdf5::File, name: &str) -> T {
    file.attr(name).unwrap().read_scalar().unwrap()
}

/// A series of a result.
pub fn column(path: &Path, name: &str) -> Vec<f64> {
    hdf5::File::open(path).unwrap().dataset(&format!("series/{name}")).unwrap().read_raw().unwrap()
}

pub fn is_complete(path: &Path) -> bool {
    number(&hdf5::File::open(path).unwrap(), "complete")
}

/// Largest difference of two series, over the largest value.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().chain(b).all(|x| x.is_finite()));
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0f64, |m, (x, y)| m.max((x - y).abs())) / largest
}
