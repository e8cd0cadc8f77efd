//! Largest tension of a whole run: attributes of the root.

use hdf5_metno as hdf5;
use serde::Serialize;

use crate::error::Result;
use crate::impact::Errors;
use crate::impact::checkpoint::Visitor;
use crate::record::storage::{read_list, text, update_text, write_scalar, write_text_with_room};
use crate::scene::{Scene, Vec3};
use crate::space::evaluate::FaceTension;

use super::estimate::{StrengthVerdict, why_without_estimate};

/// Largest tension of a run over all steps and faces, and the time at which the strength was exceeded.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Largest ratio of the tension on a face to its strength; NaN if no face has a strength.
    #[serde(skip)]
    pub used: f64,
    /// Number of that face.
    #[serde(skip)]
    pub used_face: usize,
    /// Estimated error divided by the value; NaN if there is no estimate.
    pub error_estimate: f64,
    /// Reason why there is no estimate, as a clause; empty if there is one.
    pub without_estimate: String,
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
    /// Verdict on the strength: the name of a [`StrengthVerdict`]; empty if no face has a strength.
    pub strength_verdict: String,
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
            used: none,
            used_face: 0,
            error_estimate: none,
            without_estimate: String::new(),
        }
    }
}

impl LargestTension {
    /// Sets the estimated error, of the first contact or of the whole run, or NaN and the reason where there is no estimate or
    /// it does not apply at the place of the largest tension. `first_end` is the end of the first contact, s, if there was
    /// one.
    pub fn with_error(self, errors: &Errors, scene: &Scene, first_end: Option<f64>) -> Self {
        if self.value.is_nan() {
            return self;
        }
        let is_first = first_end.is_none_or(|end| self.time <= end);
        let error = if is_first { errors.stress } else { errors.stress_history };
        match why_without_estimate(scene, self.point, error, first_end.is_some()) {
            None => Self { error_estimate: error, ..self },
            Some(without_estimate) => Self { without_estimate, ..self },
        }
    }

    /// Verdict on the strength; `None` if no face has one. The error is estimated for the largest tension only.
    pub fn verdict(&self) -> Option<StrengthVerdict> {
        let error = if self.used_face == self.face { self.error_estimate } else { f64::NAN };
        (!self.used.is_nan()).then(|| StrengthVerdict::of(self.used, 1.0, error))
    }

    /// Includes the tensions (by face) at a step; `strengths` has the strength of each face, Pa.
    pub fn take(&mut self, time: f64, tensions: &[FaceTension], strengths: &[Option<f64>]) {
        for (face, tension) in tensions.iter().enumerate() {
            if self.value.is_nan() || tension.largest > self.value {
                (self.value, self.face, self.time, self.point) = (tension.largest, face, time, tension.point);
            }
            let Some(strength) = strengths.get(face).copied().flatten() else { continue };
            let used = tension.largest / strength;
            if self.used.is_nan() || used > self.used {
                (self.used, self.used_face) = (used, face);
            }
            if used > 1.0 && self.strength_passed_at.is_nan() {
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
        visitor.count("strength_passed_face", &mut self.strength_passed_face)?;
        visitor.number("strength_used", &mut self.used)?;
        visitor.count("strength_used_face", &mut self.used_face)
    }

    /// Creates the attributes of the root, with NaN and empty text.
    pub(in crate::record) fn begin(root: &hdf5::Location) -> hdf5::Result<()> {
        for name in NUMBERS {
            write_scalar(root, name, f64::NAN)?;
        }
        for name in [FACE, PASSED_FACE, WITHOUT_ESTIMATE, VERDICT] {
            write_text_with_room(root, name, "", ROOM)?;
        }
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
            update_text(root, attribute, names.get(face).filter(|_| !known.is_nan()).map_or("", String::as_str))?;
        }
        update_text(root, WITHOUT_ESTIMATE, &self.without_estimate)?;
        update_text(root, VERDICT, self.verdict().map_or("", StrengthVerdict::name))?;
        root.attr(POINT)?.write(&self.point)
    }

    /// Reads the attributes written by [`Self::update`]; `None` if the result is older than these attributes. They are
    /// NaN for a run without stresses or a killed run.
    pub(in crate::record) fn read(root: &hdf5::Location) -> Option<TensionExtreme> {
        let [value, time, strength_passed_at, error_estimate] =
            NUMBERS.map(|name| root.attr(name).and_then(|attr| attr.read_scalar::<f64>()).unwrap_or(f64::NAN));
        let point = read_list::<f64>(root, POINT).ok()?;
        let point = [*point.first()?, *point.get(1)?, *point.get(2)?];
        let [face, strength_passed_face, without_estimate, strength_verdict] =
            [FACE, PASSED_FACE, WITHOUT_ESTIMATE, VERDICT].map(|name| text(root, name).unwrap_or_default());
        let known = Self { value, time, point, strength_passed_at, error_estimate, ..Self::default() };
        let largest = Self { without_estimate, ..known };
        Some(TensionExtreme { largest, face, strength_passed_face, strength_verdict })
    }
}

/// Bytes kept for a text that is written at the end: a reason, or the name of a face.
const ROOM: usize = 500;
const NUMBERS: [&str; 4] = ["largest_stress", "largest_stress_time", "strength_passed_at", "stress_error_estimate"];
const FACE: &str = "largest_stress_face";
const PASSED_FACE: &str = "strength_passed_face";
const WITHOUT_ESTIMATE: &str = "stress_without_estimate";
const VERDICT: &str = "strength_verdict";
const POINT: &str = "largest_stress_point";
