//! Largest tension of a whole run: attributes of the root.

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;
use serde::Serialize;

use crate::error::Result;
use crate::impact::Errors;
use crate::impact::checkpoint::Visitor;
use crate::record::provenance::{text, write_scalar, write_text};
use crate::scene::{Scene, Vec3};
use crate::space::evaluate::FaceTension;

/// Largest tension of a run over all steps and faces, and the time at which the strength was exceeded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LargestTension {
    /// Largest principal stress, Pa; NaN if stresses are not read.
    pub value: f64,
    /// Number of the face.
    #[serde(skip)]
    pub face: usize,
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub point: Vec3,
    /// Time at which the tension first exceeds the strength of a face, s; NaN if it never does.
    pub strength_passed_at: f64,
    /// Number of that face; meaningless if it never does.
    #[serde(skip)]
    pub strength_passed_face: usize,
    /// Estimated error divided by the value; NaN if there is no estimate.
    pub error_estimate: f64,
}

/// Largest tension of a run, with the names of the faces.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct TensionExtreme {
    /// Value, time and position of the largest tension.
    #[serde(flatten)]
    pub largest: LargestTension,
    /// Name of the face.
    pub face: String,
    /// Name of the face whose strength is exceeded first; empty if no strength is exceeded.
    pub strength_passed_face: String,
}

impl Default for LargestTension {
    fn default() -> Self {
        let none = f64::NAN;
        Self {
            value: none,
            face: 0,
            time: none,
            point: [none; 3],
            strength_passed_at: none,
            strength_passed_face: 0,
            error_estimate: none,
        }
    }
}

impl LargestTension {
    /// Sets the estimated error, or NaN if the largest tension is or may be at a clamped edge. There the stresses of a
    /// solid are singular, and the estimate, which is for the tension under the impact point, does not apply.
    pub fn with_error(self, error: f64, scene: &Scene) -> Self {
        let is_estimated = scene.hit_near_clamped_edge().is_none() && !scene.is_at_clamped_edge(self.point);
        Self { error_estimate: if is_estimated { error } else { f64::NAN }, ..self }
    }

    /// The estimated error that applies to the largest tension: that of the first contact, which ends at a time (s), or that
    /// of the whole run.
    pub fn error_of(&self, errors: &Errors, first_end: f64) -> f64 {
        if self.time <= first_end { errors.stress } else { errors.stress_history }
    }

    /// Includes the tensions (by face) at a step; `strengths` has the strength of each face, Pa.
    pub fn take(&mut self, time: f64, tensions: &[FaceTension], strengths: &[Option<f64>]) {
        for (face, tension) in tensions.iter().enumerate() {
            if self.value.is_nan() || tension.largest > self.value {
                *self = Self { value: tension.largest, face, time, point: tension.point, ..*self };
            }
            let is_passed = strengths.get(face).copied().flatten().is_some_and(|strength| tension.largest > strength);
            if is_passed && self.strength_passed_at.is_nan() {
                (self.strength_passed_at, self.strength_passed_face) = (time, face);
            }
        }
    }

    /// Saves the values to a checkpoint or restores them from it.
    ///
    /// # Errors
    /// Same as [`Visitor`].
    pub fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.number("largest_stress", &mut self.value)?;
        visitor.count("largest_stress_face", &mut self.face)?;
        visitor.number("largest_stress_time", &mut self.time)?;
        for (name, x) in ["x", "y", "z"].into_iter().zip(&mut self.point) {
            visitor.number(&format!("largest_stress_{name}"), x)?;
        }
        visitor.number("strength_passed_at", &mut self.strength_passed_at)?;
        visitor.count("strength_passed_face", &mut self.strength_passed_face)
    }

    /// Creates the attributes of the root, with NaN and empty text.
    pub(in crate::record) fn begin(root: &hdf5::Location) -> hdf5::Result<()> {
        for name in NUMBERS {
            write_scalar(root, name, f64::NAN)?;
        }
        write_text(root, FACE, "")?;
        write_text(root, PASSED_FACE, "")?;
        root.new_attr::<f64>().shape(3).create(POINT)?.write(&[f64::NAN; 3])
    }

    /// Writes the values to the attributes; `names` are the names of the faces.
    pub(in crate::record) fn update(&self, root: &hdf5::Location, names: &[String]) -> hdf5::Result<()> {
        let values = [self.value, self.time, self.strength_passed_at, self.error_estimate];
        for (name, value) in NUMBERS.into_iter().zip(values) {
            root.attr(name)?.write_scalar(&value)?;
        }
        let faces = [(FACE, self.face, self.value), (PASSED_FACE, self.strength_passed_face, self.strength_passed_at)];
        for (attribute, face, known) in faces {
            let face = names.get(face).filter(|_| !known.is_nan()).map_or("", String::as_str);
            let face: VarLenUnicode = face.parse().unwrap_or_default();
            root.attr(attribute)?.write_scalar(&face)?;
        }
        root.attr(POINT)?.write(&self.point)
    }

    /// Reads the attributes written by [`Self::update`]; `None` if the result is older than these attributes. They are
    /// NaN for a run without stresses or a killed run.
    pub(in crate::record) fn read(root: &hdf5::Location) -> Option<TensionExtreme> {
        let [value, time, strength_passed_at, error_estimate] =
            NUMBERS.map(|name| root.attr(name).and_then(|attr| attr.read_scalar::<f64>()).unwrap_or(f64::NAN));
        let point = root.attr(POINT).and_then(|attr| attr.read_raw::<f64>()).ok()?;
        let point = [*point.first()?, *point.get(1)?, *point.get(2)?];
        let largest = Self { value, time, point, strength_passed_at, error_estimate, ..Self::default() };
        let [face, strength_passed_face] = [FACE, PASSED_FACE].map(|name| text(root, name).unwrap_or_default());
        Some(TensionExtreme { largest, face, strength_passed_face })
    }
}

const NUMBERS: [&str; 4] = ["largest_stress", "largest_stress_time", "strength_passed_at", "stress_error_estimate"];
const FACE: &str = "largest_stress_face";
const PASSED_FACE: &str = "strength_passed_face";
const POINT: &str = "largest_stress_point";
