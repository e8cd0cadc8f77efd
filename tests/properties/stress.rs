//! Tests of reading the largest stresses from a result.

use std::path::{Path, PathBuf};

use crate::alone;
use crate::sample::{COST, provenance, step};
use crate::stresses::{PEAKS, POINT, add};
use hdf5_metno as hdf5;
use ricochet::impact::Reading;
use ricochet::record::series::{Points, SeriesWriter};
use ricochet::record::stress::{Largest, Passed, Stresses};

/// A result of 101 steps.
fn result(folder: &Path) -> PathBuf {
    let path = folder.join("out.h5");
    let mut writer = SeriesWriter::create(&path, &provenance("Plate", None), &Points::default()).unwrap();
    (0..101).for_each(|n| writer.push(&step(n), &Reading::default()).unwrap());
    writer.finish(&COST, true).unwrap();
    path
}

#[test]
fn results_without_stresses_have_none() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(Stresses::read(&result(folder.path())).unwrap(), None);
    let error = Stresses::read(&folder.path().join("missing.h5")).unwrap_err();
    assert_eq!(error.status(), 4);
}

#[test]
fn stresses_have_faces_places_and_the_largest_of_all() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = result(folder.path());
    let at = add(&hdf5::File::open_rw(&path).unwrap(), f64::NAN);
    let stresses = Stresses::read(&path).unwrap().unwrap();
    let names: Vec<&str> = stresses.faces.iter().map(|face| face.name.as_str()).collect();
    assert_eq!(names, ["upper", "lower"]);
    assert_eq!((stresses.time.len(), stresses.ring.len(), stresses.error_estimate), (101, 101, 0.05));
    let largest = Largest { value: PEAKS[0], face: "lower".into(), time: at, point: POINT };
    assert_eq!(stresses.largest.as_ref(), Some(&largest));
    // Half a wave is largest in its middle row.
    assert_eq!(stresses.faces[1].peak(&stresses.time), Some(largest));
    assert_eq!(stresses.strength_passed, None);
}

/// A killed run has neither the attributes of its end nor rows of equal length: the stresses are read from the rows.
#[test]
fn rows_tell_what_the_attributes_do_not() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = result(folder.path());
    {
        let file = hdf5::File::open_rw(&path).unwrap();
        add(&file, 4e-4);
        file.attr("largest_stress").unwrap().write_scalar(&f64::NAN).unwrap();
        file.unlink("series/stress/upper/largest").unwrap();
        file.new_dataset_builder().with_data(&[3e6; 40]).create("series/stress/upper/largest").unwrap();
    }
    let stresses = Stresses::read(&path).unwrap().unwrap();
    assert_eq!((stresses.time.len(), stresses.faces[1].largest.len()), (40, 40));
    let largest = stresses.largest.unwrap();
    assert_eq!((largest.face.as_str(), largest.time), ("lower", stresses.time[39]));
    assert_eq!(stresses.strength_passed, Some(Passed { time: 4e-4, face: "lower".into() }));
}
