//! Tensile strength of the material, by face.

use std::collections::BTreeMap;

/// Names of the faces of a box, starting at the impacted one: two for a single layer, two for each of several layers.
pub fn face_names(layers: usize) -> Vec<String> {
    let sides = ["upper", "lower"].map(str::to_owned);
    if layers < 2 {
        return sides.to_vec();
    }
    (1..=layers).flat_map(|layer| sides.each_ref().map(|side| format!("{layer}-{side}"))).collect()
}

/// Tensile strength of the faces, Pa.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strength {
    /// Strength of faces that are not in `by_face`, Pa.
    pub tension: Option<f64>,
    /// Strength by the name of a face, Pa.
    pub by_face: BTreeMap<String, f64>,
}

impl Strength {
    /// Strength of a face, Pa; `None` if the scene does not give it.
    pub fn of(&self, face: &str) -> Option<f64> {
        self.by_face.get(face).copied().or(self.tension)
    }

    /// Whether the scene gives a strength.
    pub fn is_given(&self) -> bool {
        self.tension.is_some() || !self.by_face.is_empty()
    }
}
