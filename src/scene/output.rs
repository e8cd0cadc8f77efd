//! What is written of a run, and what its accuracy is for.

use super::Vec3;

/// What is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Every n-th step goes into the series.
    pub every: usize,
    /// After so many steps a checkpoint is kept.
    pub checkpoint_steps: Option<usize>,
    /// After so many minutes of wall time a checkpoint is kept.
    pub checkpoint_minutes: Option<f64>,
    /// Every n-th step's fields are written.
    pub fields: Option<usize>,
    /// Whether the largest tension on each face is looked for.
    pub stress: bool,
    /// Points that are read at every step of the series.
    pub probes: Vec<Probe>,
}

impl Output {
    /// Whether the scene has points of the body read, at which closed-form models have nothing to tell.
    pub fn has_points(&self) -> bool {
        self.fields.is_some() || !self.probes.is_empty()
    }

    /// Whether the body is read elsewhere than under the impactor.
    pub fn is_read(&self) -> bool {
        self.stress || self.has_points()
    }
}

/// What `accuracy.tolerance` is the error of, over its peak in the first contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// The impactor's acceleration.
    Acceleration,
    /// The largest tension.
    Stress,
}

impl Measure {
    /// What follows "error" or "difference" in a message; nothing for the acceleration, which is what errors are of if nothing is said.
    pub fn of_what(self) -> &'static str {
        match self {
            Self::Acceleration => "",
            Self::Stress => " of the largest tension",
        }
    }
}

/// A point of the body that is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Its name in the results, unlike the others'.
    pub name: String,
    /// Where it is, m; within the box, where the body is one.
    pub point: Vec3,
}
