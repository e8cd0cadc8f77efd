//! The largest tension on each face: `/series/stress/<face>/{largest, point}` and `/series/stress/ring`, row by row, and what the root says
//! of the whole run.

use hdf5_metno as hdf5;
use hdf5_metno::plist::dataset_create::FillTime;
use hdf5_metno::types::VarLenUnicode;
use ndarray::ArrayView2;
use serde::Serialize;

use crate::error::Result;
use crate::impact::checkpoint::Carrier;
use crate::impact::step::Step;
use crate::record::provenance::{text, write_scalar, write_text};
use crate::scene::{Strength, Vec3};
use crate::space::evaluate::FaceTension;

/// The group of all.
const GROUP: &str = "series/stress";

/// The datasets of all faces, in their order, and that of the ring.
pub(super) struct TensionDatasets {
    faces: Vec<[hdf5::Dataset; 2]>,
    ring: Option<hdf5::Dataset>,
}

/// What is to be recorded of stresses.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faces {
    /// Names of the faces.
    pub names: Vec<String>,
    /// Radial tension at the edge of the contact times α/F, 1/m²: (1 − 2ν)/(2πR), where the impactor has a radius R.
    pub ring: Option<f64>,
}

impl Faces {
    fn ring(&self, step: &Step) -> f64 {
        let contact = &step.contact;
        let is_closed = contact.force > 0.0 && contact.indentation > 0.0;
        self.ring.map_or(f64::NAN, |factor| if is_closed { factor * contact.force / contact.indentation } else { 0.0 })
    }
}

impl TensionDatasets {
    /// Empty ones, which grow; a chunk holds so many rows.
    pub fn new(file: &hdf5::File, of: &Faces, chunk: usize) -> hdf5::Result<Self> {
        let dataset = |name: String, columns: usize, units: &str| {
            let builder = file.new_dataset::<f64>();
            let builder = match columns {
                1 => builder.shape((0..,)).chunk((chunk,)),
                _ => builder.shape((0.., columns)).chunk((chunk, columns)),
            };
            // As of the series: only new rows are written, the rest of a chunk stays a hole.
            let dataset =
                builder.chunk_cache(0, 0, 1.0).fill_time(FillTime::Never).create(format!("{GROUP}/{name}").as_str())?;
            write_text(&dataset, "units", units)?;
            Ok::<_, hdf5::Error>(dataset)
        };
        let face = |name: &String| {
            Ok([dataset(format!("{name}/largest"), 1, "Pa")?, dataset(format!("{name}/point"), 3, "m")?])
        };
        Ok(Self {
            faces: of.names.iter().map(face).collect::<hdf5::Result<_>>()?,
            ring: of.ring.map(|_| dataset("ring".to_owned(), 1, "Pa")).transpose()?,
        })
    }

    /// Writes rows, each with the tension of every face, from a row on, and cuts the datasets behind them.
    pub fn append(&self, first: usize, rows: &[Vec<FaceTension>], ring: &[f64]) -> hdf5::Result<()> {
        let end = first + rows.len();
        for (number, [largest, point]) in self.faces.iter().enumerate() {
            if largest.size() != end {
                largest.resize((end,))?;
                point.resize((end, 3))?;
            }
            let at = |row: &Vec<FaceTension>| row.get(number).copied().unwrap_or(FaceTension::UNKNOWN);
            largest.write_slice(&rows.iter().map(|row| at(row).largest).collect::<Vec<f64>>(), first..end)?;
            let points: Vec<Vec3> = rows.iter().map(|row| at(row).point).collect();
            point.write_slice(ArrayView2::from(&points[..]), (first..end, ..))?;
        }
        if let Some(dataset) = &self.ring {
            if dataset.size() != end {
                dataset.resize((end,))?;
            }
            dataset.write_slice(ring, first..end)?;
        }
        Ok(())
    }
}

/// The first rows of what a result holds of stresses.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EarlierTensions {
    /// Of each row the largest tension on every face.
    pub faces: Vec<Vec<FaceTension>>,
    /// Of each row the tension at the edge of the contact, where it is recorded.
    pub ring: Option<Vec<f64>>,
}

/// The ring's tension at each step.
pub(super) fn rings(of: &Faces, steps: &[Step]) -> Vec<f64> {
    steps.iter().map(|step| of.ring(step)).collect()
}

/// The first rows of a result, each with the tension of every face.
pub(super) fn rows(file: &hdf5::File, names: &[String], rows: usize) -> hdf5::Result<Vec<Vec<FaceTension>>> {
    let mut all = vec![Vec::with_capacity(names.len()); rows];
    for name in names {
        let column = |of: &str| file.dataset(&format!("{GROUP}/{name}/{of}"))?.read_raw::<f64>();
        let (largest, points) = (column("largest")?, column("point")?);
        if largest.len() < rows {
            return Err(format!("/{GROUP}/{name} has {} rows, and its checkpoint {rows}", largest.len()).into());
        }
        for ((row, largest), point) in all.iter_mut().zip(largest).zip(points.chunks_exact(3)) {
            row.push(FaceTension { largest, point: [point[0], point[1], point[2]] });
        }
    }
    Ok(all)
}

/// The largest tension of a run, over all steps and faces, and when the strength was passed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LargestTension {
    /// Pa; NaN where stresses are not read.
    pub value: f64,
    /// The number of its face.
    #[serde(skip)]
    pub face: usize,
    /// s.
    pub time: f64,
    /// m.
    pub point: Vec3,
    /// When the strength of a face was passed first, s; NaN where none was.
    pub strength_passed_at: f64,
    /// Estimated error over its value; NaN where there is no estimate.
    pub error_estimate: f64,
}

impl Default for LargestTension {
    fn default() -> Self {
        let none = f64::NAN;
        Self { value: none, face: 0, time: none, point: [none; 3], strength_passed_at: none, error_estimate: none }
    }
}

impl LargestTension {
    /// Takes a step.
    pub fn take(&mut self, time: f64, tensions: &[FaceTension], strengths: &[Option<f64>]) {
        for (face, tension) in tensions.iter().enumerate() {
            if self.value.is_nan() || tension.largest > self.value {
                *self = Self { value: tension.largest, face, time, point: tension.point, ..*self };
            }
            let is_passed = strengths.get(face).copied().flatten().is_some_and(|strength| tension.largest > strength);
            if is_passed && self.strength_passed_at.is_nan() {
                self.strength_passed_at = time;
            }
        }
    }

    /// To a checkpoint or from it.
    ///
    /// # Errors
    /// Those of [`Carrier`].
    pub fn carry(&mut self, carrier: &mut Carrier) -> Result<()> {
        carrier.number("largest_stress", &mut self.value)?;
        carrier.count("largest_stress_face", &mut self.face)?;
        carrier.number("largest_stress_time", &mut self.time)?;
        for (name, x) in ["x", "y", "z"].into_iter().zip(&mut self.point) {
            carrier.number(&format!("largest_stress_{name}"), x)?;
        }
        carrier.number("strength_passed_at", &mut self.strength_passed_at)
    }

    /// Makes the attributes of the root, with nothing in them yet.
    pub(super) fn begin(root: &hdf5::Location) -> hdf5::Result<()> {
        for name in NUMBERS {
            write_scalar(root, name, f64::NAN)?;
        }
        write_text(root, FACE, "")?;
        root.new_attr::<f64>().shape(3).create(POINT)?.write(&[f64::NAN; 3])
    }

    /// Fills them in.
    pub(super) fn update(&self, root: &hdf5::Location, names: &[String]) -> hdf5::Result<()> {
        let values = [self.value, self.time, self.strength_passed_at, self.error_estimate];
        for (name, value) in NUMBERS.into_iter().zip(values) {
            root.attr(name)?.write_scalar(&value)?;
        }
        let face = names.get(self.face).filter(|_| !self.value.is_nan()).map_or("", String::as_str);
        let face: VarLenUnicode = face.parse().unwrap_or_default();
        root.attr(FACE)?.write_scalar(&face)?;
        root.attr(POINT)?.write(&self.point)
    }

    /// Reads what [`Self::update`] has written, with the name of the face; `None` of a result that is older than
    /// these attributes. Of a run without stresses, or that was killed, they are NaN.
    pub(super) fn read(root: &hdf5::Location) -> Option<(Self, String)> {
        let [value, time, strength_passed_at, error_estimate] =
            NUMBERS.map(|name| root.attr(name).and_then(|attr| attr.read_scalar::<f64>()).unwrap_or(f64::NAN));
        let point = root.attr(POINT).and_then(|attr| attr.read_raw::<f64>()).ok()?;
        let point = [*point.first()?, *point.get(1)?, *point.get(2)?];
        let found = Self { value, face: 0, time, point, strength_passed_at, error_estimate };
        Some((found, text(root, FACE).unwrap_or_default()))
    }
}

const NUMBERS: [&str; 4] = ["largest_stress", "largest_stress_time", "strength_passed_at", "stress_error_estimate"];
const FACE: &str = "largest_stress_face";
const POINT: &str = "largest_stress_point";

/// The strengths of faces, in their order.
pub fn strengths(strength: &Strength, names: &[String]) -> Vec<Option<f64>> {
    names.iter().map(|name| strength.of(name)).collect()
}
