//! The map of the largest tension over time on a face, as a figure.

use crate::figure::face::{FaceFigure, Surface};
use crate::record::stress::{FaceMap, StressMaps};

use super::number::{STRESS, TIME, computed, place, unit_for};

/// The figure of a face of a result's maps; `None` where no point of it has a tension.
pub fn face_figure(maps: &StressMaps, map: &FaceMap, title: String) -> Option<FaceFigure> {
    let largest = map.largest()?;
    let surface = Surface::new(&map.points, &map.tension, maps.hit, maps.mirrored)?;
    let values = || map.tension.iter().copied().filter(|tension| !tension.is_nan());
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let unit = unit_for(low.abs().max(high.abs()), STRESS);
    let (point, time) = (map.points[largest], map.time[largest]);
    let note = format!("+ largest: {} at {}, at {}", computed(high, STRESS), computed(time, TIME), place(point));
    Some(FaceFigure {
        title,
        quantity: "largest principal stress over time".to_owned(),
        unit: unit.name.to_owned(),
        // A face without any stress has colours all the same.
        range: if high > low { (low / unit.size, high / unit.size) } else { (low / unit.size, low / unit.size + 1.0) },
        scale: unit.size,
        mark: surface.axes.map(|axis| point[axis]),
        surface,
        note,
    })
}
