//! The largest principal stresses of a result, read back: `/series/stress` and their attributes of the root.

use std::path::Path;

use hdf5_metno as hdf5;

use crate::error::{Error, Result};
use crate::record::read::{check_run, open};
use crate::scene::Vec3;

use super::LargestTension;

/// The largest principal stresses of a run, face by face.
#[derive(Debug, Clone, PartialEq)]
pub struct Stresses {
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// The hit face first, then the opposite one; of layers from the hit down.
    pub faces: Vec<Face>,
    /// Hertz's radial tension at the edge of the contact in each row, Pa; empty where it was not recorded.
    pub ring: Vec<f64>,
    /// The largest stress of all faces and rows; `None` without a row.
    pub largest: Option<Largest>,
    /// Estimated error of the largest stress over its peak; NaN where there is no estimate.
    pub error_estimate: f64,
    /// When the strength was first passed, s; `None` where it was not.
    pub strength_passed_at: Option<f64>,
}

/// The largest principal stress on one face.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// `upper` (the hit one), `lower`, or the name of a mesh's surface.
    pub name: String,
    /// Its value in each row, Pa; tension is positive.
    pub largest: Vec<f64>,
    /// Its place in each row, m.
    pub point: Vec<Vec3>,
}

/// A stress with its place and time.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest {
    /// Pa.
    pub value: f64,
    /// Name of the face.
    pub face: String,
    /// s.
    pub time: f64,
    /// m.
    pub point: Vec3,
}

impl Face {
    /// The largest stress of all rows that have a number, the first of equal ones.
    pub fn peak(&self, time: &[f64]) -> Option<Largest> {
        let rows = self.largest.iter().zip(time).zip(&self.point).filter(|((value, _), _)| !value.is_nan());
        let ((value, time), point) = rows.reduce(|one, other| if other.0.0 > one.0.0 { other } else { one })?;
        Some(Largest { value: *value, face: self.name.clone(), time: *time, point: *point })
    }
}

impl Stresses {
    /// The largest stress on any face in each row, Pa.
    pub fn largest_of_rows(&self) -> Vec<f64> {
        let largest = |row: usize| self.faces.iter().fold(f64::NAN, |largest, face| largest.max(face.largest[row]));
        (0..self.time.len()).map(largest).collect()
    }

    /// The largest stress on a face: that of the whole run where it is of this face, otherwise of the rows.
    pub fn peak_on(&self, face: &str) -> Option<Largest> {
        let of_run = self.largest.clone().filter(|largest| largest.face == face);
        of_run.or_else(|| self.faces.iter().find(|of| of.name == face)?.peak(&self.time))
    }

    /// Reads the stresses of the result `path`; `None` where it was made without them. After a kill, datasets may differ in length by one
    /// flush: the rows are those that all have.
    ///
    /// # Errors
    /// [`Error::Io`] as [`crate::record::read::history`].
    pub fn read(path: &Path) -> Result<Option<Self>> {
        let file = open(path)?;
        check_run(&file, path)?;
        let Ok(group) = file.group("series/stress") else { return Ok(None) };
        let read = Self::of(&file, &group);
        read.map(Some).map_err(|error| Error::io(path, format!("its stresses cannot be read: {error}")))
    }

    fn of(file: &hdf5::File, group: &hdf5::Group) -> hdf5::Result<Self> {
        let mut time = file.dataset("series/time")?.read_raw::<f64>()?;
        let mut faces = Vec::new();
        for of_face in group.groups()? {
            let name = of_face.name().rsplit('/').next().unwrap_or_default().to_owned();
            let largest = of_face.dataset("largest")?.read_raw::<f64>()?;
            let points = of_face.dataset("point")?.read_raw::<f64>()?;
            let point: Vec<Vec3> = points.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect();
            faces.push(Face { name, largest, point });
        }
        faces.sort_by(|one, other| order(&one.name).cmp(&order(&other.name)));
        let mut ring = match group.dataset("ring") {
            Ok(dataset) => dataset.read_raw::<f64>()?,
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
        // All steps count for the attributes, recorded or not. A run that was interrupted may lack them: then its rows tell.
        let of_rows = faces.iter().filter_map(|face| face.peak(&time));
        let of_rows = of_rows.max_by(|one, other| one.value.total_cmp(&other.value));
        let attributes = LargestTension::read(file);
        let of_run = attributes.clone().filter(|(found, _)| found.value.is_finite() && found.time.is_finite());
        let of_run =
            of_run.map(|(found, face)| Largest { value: found.value, face, time: found.time, point: found.point });
        let (found, _) = attributes.unwrap_or_default();
        Ok(Self {
            time,
            faces,
            ring,
            largest: of_run.or(of_rows),
            error_estimate: found.error_estimate,
            strength_passed_at: Some(found.strength_passed_at).filter(|time| time.is_finite()),
        })
    }
}

/// By what faces are sorted: their layer, from the hit down; the upper face before the lower; then the name.
pub(super) fn order(name: &str) -> (usize, usize, &str) {
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
