//! Reads the largest principal stresses of a result: `/series/stress` and the attributes of the root.

use std::path::Path;

use hdf5_metno as hdf5;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::record::read::{check_run, open};
use crate::record::storage;
use crate::scene::Vec3;

use super::{LargestTension, StressMaps, TensionExtreme};

/// Relative rounding of the tensions in a map, which is in single precision, with a margin.
const MAP_ROUNDING: f64 = 1e-6;

/// Largest principal stresses of a run, by face.
#[derive(Debug, Clone, PartialEq)]
pub struct Stresses {
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// Faces, the struck one first, then the opposite one; for layers, from the struck one down.
    pub faces: Vec<Face>,
    /// Hertz's radial tension at the edge of the contact in each row, Pa; empty if not recorded.
    pub ring: Vec<f64>,
    /// Largest stress of all faces and steps; `None` if there is no row.
    pub largest: Option<Largest>,
    /// Estimated error of the largest stress divided by its value; NaN if there is no estimate.
    pub error_estimate: f64,
    /// Reason why there is no estimate, as a clause; may be empty.
    pub without_estimate: String,
    /// Where and when a strength was first exceeded; `None` if none was.
    pub strength_passed: Option<Passed>,
}

/// First excess of a strength.
#[derive(Debug, Clone, PartialEq)]
pub struct Passed {
    /// Time, s.
    pub time: f64,
    /// Name of the face.
    pub face: String,
}

/// Largest principal stress on one face.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Name: `upper` (the struck face), `lower`, or the name of a surface of a mesh; for layers such as `2-upper`.
    pub name: String,
    /// Stress in each row, Pa; tension is positive.
    pub largest: Vec<f64>,
    /// Position of the stress in each row, m.
    pub point: Vec<Vec3>,
}

/// Stress with its position and time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Largest {
    /// Stress, Pa.
    pub value: f64,
    /// Name of the face.
    pub face: String,
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub point: Vec3,
}

impl Face {
    /// Largest stress of all rows that are not NaN; the first of equal ones.
    pub fn peak(&self, time: &[f64]) -> Option<Largest> {
        let rows = self.largest.iter().zip(time).zip(&self.point).filter(|((value, _), _)| !value.is_nan());
        let ((value, time), point) = rows.reduce(|one, other| if other.0.0 > one.0.0 { other } else { one })?;
        Some(Largest { value: *value, face: self.name.clone(), time: *time, point: *point })
    }
}

impl Stresses {
    /// Largest stress on any face in each row, Pa.
    pub fn largest_of_rows(&self) -> Vec<f64> {
        let largest = |row: usize| self.faces.iter().fold(f64::NAN, |largest, face| largest.max(face.largest[row]));
        (0..self.time.len()).map(largest).collect()
    }

    /// Largest stress on a face: of the whole run if it occurred on this face, otherwise of the recorded rows.
    pub fn peak_on(&self, face: &str) -> Option<Largest> {
        let of_run = self.largest.clone().filter(|largest| largest.face == face);
        of_run.or_else(|| self.faces.iter().find(|of| of.name == face)?.peak(&self.time))
    }

    /// Largest stress on each face in all steps. The maps have those between the recorded rows; without maps, only the
    /// rows are known.
    pub fn peaks(&self, maps: Option<&StressMaps>) -> Vec<Largest> {
        let of_map = |name: &str| {
            let map = maps?.faces.iter().find(|map| map.name == name)?;
            let at = map.largest()?;
            Some(Largest { value: map.tension[at], face: name.to_owned(), time: map.time[at], point: map.points[at] })
        };
        let is_larger = |other: &Largest, one: &Largest| other.value - one.value > MAP_ROUNDING * one.value.abs();
        let larger = |one: Largest, other: Largest| if is_larger(&other, &one) { other } else { one };
        let of_face = |name: &str| self.peak_on(name).into_iter().chain(of_map(name)).reduce(larger);
        self.faces.iter().filter_map(|face| of_face(&face.name)).collect()
    }

    /// Reads the stresses of the result `path`; `None` if the result has none. After a kill, the lengths of the
    /// datasets may differ by the rows of one flush; only the rows present in all of them are returned.
    ///
    /// # Errors
    /// Same as [`crate::record::read::history`]; [`Error::Io`] if the stresses cannot be read.
    pub fn read(path: &Path) -> Result<Option<Self>> {
        let file = open(path)?;
        check_run(&file, path)?;
        let Ok(group) = file.group("series/stress") else { return Ok(None) };
        let read = Self::of(&file, &group);
        read.map(Some).map_err(|error| Error::io(path, format!("its stresses cannot be read: {error}")))
    }

    fn of(file: &hdf5::File, group: &hdf5::Group) -> hdf5::Result<Self> {
        let mut time = storage::read::<f64>(file, "series/time")?;
        let mut faces = Vec::new();
        for of_face in group.groups()? {
            let name = of_face.name().rsplit('/').next().unwrap_or_default().to_owned();
            let largest = storage::read::<f64>(&of_face, "largest")?;
            let points = storage::read::<f64>(&of_face, "point")?;
            faces.push(Face { name, largest, point: points.as_chunks().0.to_vec() });
        }
        faces.sort_by(|one, other| order(&one.name).cmp(&order(&other.name)));
        let mut ring = match group.dataset("ring") {
            Ok(dataset) => storage::values(&dataset)?,
            Err(_) => Vec::new(),
        };
        let lengths = faces.iter().flat_map(|face| [face.largest.len(), face.point.len()]);
        let rows = lengths.chain((!ring.is_empty()).then_some(ring.len())).fold(time.len(), usize::min);
        time.truncate(rows);
        ring.truncate(rows);
        for face in &mut faces {
            face.largest.truncate(rows);
            face.point.truncate(rows);
        }
        // The attributes include all steps, recorded or not. A run that was interrupted may lack them; then the rows
        // are used.
        let of_rows = faces.iter().filter_map(|face| face.peak(&time));
        let of_rows = of_rows.max_by(|one, other| one.value.total_cmp(&other.value));
        let TensionExtreme { largest: found, face, strength_passed_face, .. } =
            LargestTension::read(file).unwrap_or_default();
        let is_complete = found.value.is_finite() && found.time.is_finite();
        let of_run = is_complete.then_some(Largest { value: found.value, face, time: found.time, point: found.point });
        Ok(Self {
            time,
            faces,
            ring,
            largest: of_run.or(of_rows),
            error_estimate: found.error_estimate,
            without_estimate: found.without_estimate,
            strength_passed: (found.strength_passed_at.is_finite())
                .then_some(Passed { time: found.strength_passed_at, face: strength_passed_face }),
        })
    }
}

/// Sort key of the faces: the layer, from the struck face down; the upper face before the lower; then the name.
pub(in crate::record) fn order(name: &str) -> (usize, usize, &str) {
    let (layer, side) = name.split_once('-').and_then(|(n, side)| Some((n.parse().ok()?, side))).unwrap_or((0, name));
    let rank = ["upper", "lower"].iter().position(|known| *known == side).unwrap_or(2);
    (layer, rank, name)
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn faces_are_sorted_from_the_hit_down() {
        let mut names = ["10-lower", "frame", "2-upper", "lower", "10-upper", "upper", "a-upper"];
        names.sort_by(|one, other| order(one).cmp(&order(other)));
        assert_eq!(names, ["upper", "lower", "a-upper", "frame", "2-upper", "10-upper", "10-lower"]);
    }
}
