//! Runs of sweeps, and reading of their results.
#![allow(dead_code, reason = "not every test that shares this module uses all of it")]

use crate::results;
use std::collections::BTreeMap;
use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::types::FixedUnicode;

/// The small box with a support, so that its stiffness can be varied; with the default theory, basis and coordinates.
pub fn supported() -> String {
    let text = crate::program::BOX.replace("newton = \"full\"", "newton = \"condensed\"");
    text.replace("model = \"solid\"\nreduction = \"none\"\n", "")
        + "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n"
}

/// A dataset, as numbers.
pub fn numbers(path: &Path, name: &str) -> Vec<f64> {
    let dataset = results::open(path).dataset(name).unwrap_or_else(|error| panic!("{name}: {error}"));
    dataset.read_raw().unwrap()
}

/// A dataset with one value for each member.
pub fn members(path: &Path, name: &str) -> Vec<f64> {
    numbers(path, &format!("members/{name}"))
}

/// Error messages of the members.
pub fn messages(path: &Path) -> Vec<String> {
    let dataset = results::open(path).dataset("members/message").unwrap();
    dataset.read_raw::<FixedUnicode<400>>().unwrap().iter().map(|message| message.to_string()).collect()
}

/// Collects all numeric datasets in a group and below it: paths and the bits of the values. Every dataset must have a
/// unit.
fn collect(group: &hdf5::Group, into: &mut BTreeMap<String, Vec<u64>>) {
    for dataset in group.datasets().unwrap() {
        assert!(dataset.attr("units").is_ok(), "{} has no unit", dataset.name());
        if let Ok(values) = dataset.read_raw::<f64>() {
            into.insert(dataset.name(), values.into_iter().map(f64::to_bits).collect());
        }
    }
    group.groups().unwrap().iter().for_each(|group| collect(group, into));
}

/// All numbers of a file except the wall times.
pub fn content(path: &Path) -> BTreeMap<String, Vec<u64>> {
    let mut all = BTreeMap::new();
    collect(&results::open(path), &mut all);
    assert!(all.remove("/members/wall_time").is_some());
    all
}
