//! Output of a run, and the quantity for which the accuracy is given.

use super::Vec3;

/// Output of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Interval of recorded steps: every n-th step is written to the series.
    pub every: usize,
    /// Interval of checkpoints in steps; `None` for none.
    pub checkpoint_steps: Option<usize>,
    /// Interval of checkpoints in minutes of wall time; `None` for none.
    pub checkpoint_minutes: Option<f64>,
    /// Interval of steps whose fields are written; `None` for no fields.
    pub fields: Option<usize>,
    /// Whether the largest tension on each face is computed.
    pub stress: bool,
    /// Points of the body whose motion and stresses are recorded with the series.
    pub probes: Vec<Probe>,
}

impl Output {
    /// Whether fields or probes are requested. Closed-form models have neither.
    pub fn has_points(&self) -> bool {
        self.fields.is_some() || !self.probes.is_empty()
    }

    /// Whether the motion of the body is needed at other points than the impact point.
    pub fn is_read(&self) -> bool {
        self.stress || self.has_points()
    }
}

/// Quantity to which `accuracy.tolerance` applies: its error over its peak.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Acceleration of the impactor, in the first contact.
    Acceleration,
    /// Largest tension on the faces, in the first contact.
    Stress,
    /// Deflection under the impactor over the whole time history, and the acceleration in the first contact.
    Deflection,
}

/// A point of the body that is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Unique name of the probe in the results.
    pub name: String,
    /// Position, m; inside the box if the body is a box.
    pub point: Vec3,
}

/// Whether a name can be that of a group in an HDF5 file.
pub fn is_name_of_result(name: &str) -> bool {
    !name.is_empty() && name != "." && !name.contains('/') && !name.contains(char::is_control)
}
