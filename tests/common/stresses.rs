//! Adds largest stresses to a result that has none.

use hdf5_metno as hdf5;

use crate::texts::set_text;

/// Largest stresses of the lower and the upper face, Pa.
pub const PEAKS: [f64; 2] = [41e6, 12e6];

/// Place of the largest stress of the lower face, m.
pub const POINT: [f64; 3] = [0.01, -0.02, -0.01];

/// Adds stresses to a result: half a wave over the rows on each face, and the ring of the contact. Returns the time of
/// the largest stress, s.
pub fn add(file: &hdf5::File, strength_passed_at: f64) -> f64 {
    let time = file.dataset("series/time").unwrap().read_raw::<f64>().unwrap();
    let rows = time.len();
    let wave = |peak: f64| -> Vec<f64> {
        (0..rows).map(|n| peak * (std::f64::consts::PI * n as f64 / (rows - 1) as f64).sin()).collect()
    };
    let units = |dataset: &hdf5::Dataset, units: &str| set_text(dataset, "units", units);
    for (face, peak) in ["lower", "upper"].into_iter().zip(PEAKS) {
        let largest = format!("series/stress/{face}/largest");
        units(&file.new_dataset_builder().with_data(&wave(peak)).create(largest.as_str()).unwrap(), "Pa");
        let points = ndarray::Array2::from_shape_fn((rows, 3), |(_, axis)| POINT[axis]);
        let point = format!("series/stress/{face}/point");
        units(&file.new_dataset_builder().with_data(&points).create(point.as_str()).unwrap(), "m");
    }
    units(&file.new_dataset_builder().with_data(&wave(90e6)).create("series/stress/ring").unwrap(), "Pa");
    let at = time[rows / 2];
    for (name, value) in [
        ("stress_error_estimate", 0.05),
        ("largest_stress", PEAKS[0]),
        ("largest_stress_time", at),
        ("strength_passed_at", strength_passed_at),
    ] {
        file.attr(name).unwrap().write_scalar(&value).unwrap();
    }
    file.attr("largest_stress_point").unwrap().write(&POINT).unwrap();
    set_text(file, "largest_stress_face", "lower");
    if strength_passed_at.is_finite() {
        set_text(file, "strength_passed_face", "lower");
    }
    at
}
