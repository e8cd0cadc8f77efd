//! Makes a figure of the largest tension over time on a face.

use crate::figure::face::{FaceFigure, Surface};
use crate::record::stress::{FaceMap, StressMaps, Stresses};

use super::number::{STRESS, TIME, computed, place, unit_for};

/// Largest relative difference between a value of the map and the same value of the run. Maps have single precision.
const SINGLE: f64 = 1e-6;

/// Makes the figure of one face of a result; `None` if no point has a tension. The largest tension is marked at the
/// position recorded by the run, which may lie between the points of the map. If the run has no record of it or the
/// values differ, the point of the map with the largest tension is marked instead.
pub fn face_figure(
    (maps, map): (&StressMaps, &FaceMap),
    stresses: Option<&Stresses>,
    title: String,
) -> Option<FaceFigure> {
    let largest = map.largest()?;
    let surface = Surface::new(&map.points, &map.tension, maps.hit, maps.mirrored)?;
    let values = || map.tension.iter().copied().filter(|tension| !tension.is_nan());
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let unit = unit_for(low.abs().max(high.abs()), STRESS);
    let of_run = stresses.and_then(|stresses| stresses.peak_on(&map.name));
    // The recorded rows may not include the step of the largest tension.
    let of_run = of_run.filter(|of_run| (of_run.value - high).abs() <= SINGLE * high.abs());
    let (point, time) = of_run.map_or((map.points[largest], map.time[largest]), |of_run| (of_run.point, of_run.time));
    let note = format!("+ largest: {} at {}, at {}", computed(high, STRESS), computed(time, TIME), place(point));
    Some(FaceFigure {
        title,
        quantity: "largest principal stress over time".to_owned(),
        unit: unit.name.to_owned(),
        // A face without stress still needs a range for its colours.
        range: if high > low { (low / unit.size, high / unit.size) } else { (low / unit.size, low / unit.size + 1.0) },
        scale: unit.size,
        mark: surface.axes.map(|axis| point[axis]),
        surface,
        note,
    })
}
