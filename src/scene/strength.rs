//! The tension that the material bears.

use std::collections::BTreeMap;

/// By face, Pa.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strength {
    /// Of faces that have none of their own.
    pub tension: Option<f64>,
    /// By the name of a face.
    pub by_face: BTreeMap<String, f64>,
}

impl Strength {
    /// Of a face, Pa; `None` where the scene gives none.
    pub fn of(&self, face: &str) -> Option<f64> {
        self.by_face.get(face).copied().or(self.tension)
    }

    /// Whether the scene gives any.
    pub fn is_given(&self) -> bool {
        self.tension.is_some() || !self.by_face.is_empty()
    }
}
