//! The tension that the material bears.

use std::collections::BTreeMap;

/// Names of the faces of a box that is hit, from the hit down: of one layer its own two, of several both of each.
pub fn face_names(layers: usize) -> Vec<String> {
    let sides = ["upper", "lower"].map(str::to_owned);
    if layers < 2 {
        return sides.to_vec();
    }
    (1..=layers).flat_map(|layer| sides.each_ref().map(|side| format!("{layer}-{side}"))).collect()
}

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
