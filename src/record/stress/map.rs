//! Largest tension over time at each point of the faces: `/stress_map/<face>/{points, tension, time}`.
//!
//! The datasets have their final size from the beginning, so that a kill does not damage them. They are written with
//! the rows if they have changed.

use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::plist::dataset_create::AllocTime;
use ndarray::ArrayView2;

use crate::error::{Error, Result};
use crate::record::read::{check_run, open};
use crate::record::storage::{self, read_list, write_text};
use crate::scene::{Scene, Symmetry, Vec3};
use crate::space::evaluate::TensionMap;

use super::read::order;

/// Group of the maps in a result, and their name for the command `plot`.
pub const STRESS_MAP: &str = "stress_map";
/// Attributes of the group: position of the impact point, m, and axes across which the map has mirror images.
const HIT: &str = "hit";
const MIRRORED: &str = "mirrored";

/// Points of the faces at which tensions are mapped.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MapPoints {
    /// Points of each face, m; empty if there is no map.
    pub faces: Vec<Vec<Vec3>>,
    /// Position of the impact point, m.
    pub hit: Vec3,
    /// For each axis: whether the plane where its coordinate is zero is a plane of symmetry of a modelled quarter.
    pub mirrored: [bool; 3],
}

impl MapPoints {
    /// Points on the faces of the body of a scene, with its impact point and its planes of symmetry.
    pub fn new(scene: &Scene, faces: Vec<Vec<Vec3>>) -> Self {
        let mirrored = match scene.body.symmetry {
            Symmetry::Quarter { axes } => [0, 1, 2].map(|axis| axes.contains(&axis)),
            Symmetry::None { .. } | Symmetry::Parts { .. } => [false; 3],
        };
        Self { faces, hit: scene.impactor.point, mirrored }
    }
}

/// Datasets of tension and time for each face.
pub(in crate::record) struct MapDatasets {
    faces: Vec<[hdf5::Dataset; 2]>,
}

impl MapDatasets {
    /// Creates the datasets, filled with NaN.
    pub fn new(file: &hdf5::File, names: &[String], points: &MapPoints) -> hdf5::Result<Self> {
        let mut faces = Vec::new();
        for (name, points) in names.iter().zip(&points.faces) {
            let path = |of: &str| format!("{STRESS_MAP}/{name}/{of}");
            let place = file.new_dataset_builder().with_data(ArrayView2::from(&points[..]));
            let place = place.create(path("points").as_str())?;
            write_text(&place, "units", "m")?;
            let dataset = |of: &str, units: &str| {
                let builder = file.new_dataset::<f64>().shape(points.len()).fill_value(f64::NAN);
                let dataset = builder.alloc_time(Some(AllocTime::Early)).create(path(of).as_str())?;
                write_text(&dataset, "units", units)?;
                Ok::<_, hdf5::Error>(dataset)
            };
            faces.push([dataset("tension", "Pa")?, dataset("time", "s")?]);
        }
        if !faces.is_empty() {
            let group = file.group(STRESS_MAP)?;
            group.new_attr::<f64>().shape(3).create(HIT)?.write(&points.hit)?;
            group.new_attr::<bool>().shape(3).create(MIRRORED)?.write(&points.mirrored)?;
        }
        Ok(Self { faces })
    }

    /// Writes a map of the same points.
    pub fn write(&self, map: &TensionMap) -> hdf5::Result<()> {
        let mut first = 0;
        for [tension, time] in &self.faces {
            let points = first..first + tension.size();
            first = points.end;
            let Some(values) = map.tension.get(points.clone()) else { return Ok(()) };
            // Points that are not read have neither tension nor time.
            let number = |point: usize, value: f64| if map.tension[point].is_finite() { value } else { f64::NAN };
            let values = points.clone().zip(values).map(|(point, value)| number(point, f64::from(*value)));
            tension.write_raw(&values.collect::<Vec<f64>>())?;
            time.write_raw(&points.map(|point| number(point, map.time_at(point))).collect::<Vec<f64>>())?;
        }
        Ok(())
    }
}

/// Largest tension over time at each point of the faces of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct StressMaps {
    /// Maps of the faces, the struck face first, in the order of [`super::Stresses`].
    pub faces: Vec<FaceMap>,
    /// Position of the impact point, m.
    pub hit: Vec3,
    /// For each axis: whether the map has mirror images across the plane where its coordinate is zero.
    pub mirrored: [bool; 3],
}

/// Map of one face.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceMap {
    /// Name of the face.
    pub name: String,
    /// Points at which tensions are read, m; for a quarter, in the modelled part.
    pub points: Vec<Vec3>,
    /// Largest principal stress of all steps at each point, Pa; tension is positive. NaN at points that are not read,
    /// and if the run was killed before the map was written.
    pub tension: Vec<f64>,
    /// Time at which it was reached, s; NaN where there is no tension.
    pub time: Vec<f64>,
}

impl FaceMap {
    /// Number of the point with the largest tension; `None` if no point has a tension.
    pub fn largest(&self) -> Option<usize> {
        let read = self.tension.iter().enumerate().filter(|(_, tension)| !tension.is_nan());
        read.max_by(|one, other| one.1.total_cmp(other.1)).map(|(point, _)| point)
    }
}

impl StressMaps {
    /// Reads the maps of the result `path`; `None` if it has none.
    ///
    /// # Errors
    /// Same as [`crate::record::read::history`]; [`Error::Io`] if the maps cannot be read.
    pub fn read(path: &Path) -> Result<Option<Self>> {
        let file = open(path)?;
        check_run(&file, path)?;
        let Ok(group) = file.group(STRESS_MAP) else { return Ok(None) };
        let wrong = |error: hdf5::Error| Error::io(path, format!("its map of stresses cannot be read: {error}"));
        Self::of(&group).map(Some).map_err(wrong)
    }

    fn of(group: &hdf5::Group) -> hdf5::Result<Self> {
        let mut faces = Vec::new();
        for of_face in group.groups()? {
            let name = of_face.name().rsplit('/').next().unwrap_or_default().to_owned();
            let column = |of: &str| storage::read::<f64>(&of_face, of);
            let points: Vec<Vec3> = column("points")?.as_chunks().0.to_vec();
            let face = FaceMap { name, points, tension: column("tension")?, time: column("time")? };
            if face.tension.len() != face.points.len() || face.time.len() != face.points.len() {
                return Err(format!("/{STRESS_MAP}/{} has columns of unlike lengths", face.name).into());
            }
            faces.push(face);
        }
        faces.sort_by(|one, other| order(&one.name).cmp(&order(&other.name)));
        let (hit, mirrored) = (read_list::<f64>(group, HIT)?, read_list::<bool>(group, MIRRORED)?);
        let three = |name: &str| format!("the attribute {name} of /{STRESS_MAP} has no three entries");
        Ok(Self {
            faces,
            hit: hit.try_into().map_err(|_| three(HIT))?,
            mirrored: mirrored.try_into().map_err(|_| three(MIRRORED))?,
        })
    }
}
