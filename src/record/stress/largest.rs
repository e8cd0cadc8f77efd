//! The largest tension of a whole run: attributes of the root.

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;
use serde::Serialize;

use crate::error::Result;
use crate::impact::checkpoint::Visitor;
use crate::record::provenance::{text, write_scalar, write_text};
use crate::scene::{Scene, Vec3};
use crate::space::evaluate::FaceTension;

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
    /// With its estimated error, unless it is at a clamped edge: the estimate follows the tension under the hit, and at such an edge stresses of a solid have
    /// no limit.
    pub fn with_error(self, error: f64, scene: &Scene) -> Self {
        Self { error_estimate: if scene.is_at_clamped_edge(self.point) { f64::NAN } else { error }, ..self }
    }

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
    /// Those of [`Visitor`].
    pub fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.number("largest_stress", &mut self.value)?;
        visitor.count("largest_stress_face", &mut self.face)?;
        visitor.number("largest_stress_time", &mut self.time)?;
        for (name, x) in ["x", "y", "z"].into_iter().zip(&mut self.point) {
            visitor.number(&format!("largest_stress_{name}"), x)?;
        }
        visitor.number("strength_passed_at", &mut self.strength_passed_at)
    }

    /// Makes the attributes of the root, with nothing in them yet.
    pub(in crate::record) fn begin(root: &hdf5::Location) -> hdf5::Result<()> {
        for name in NUMBERS {
            write_scalar(root, name, f64::NAN)?;
        }
        write_text(root, FACE, "")?;
        root.new_attr::<f64>().shape(3).create(POINT)?.write(&[f64::NAN; 3])
    }

    /// Fills them in.
    pub(in crate::record) fn update(&self, root: &hdf5::Location, names: &[String]) -> hdf5::Result<()> {
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
    pub(in crate::record) fn read(root: &hdf5::Location) -> Option<(Self, String)> {
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
