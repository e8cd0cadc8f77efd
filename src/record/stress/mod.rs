//! Largest principal stresses on the faces of a body: writing and reading.
//!
//! `/series/stress` has a row for each recorded step. `/stress_map` has the largest tension over all steps at each
//! point. The attributes of the root have the largest tension of the whole run.

mod largest;
mod map;
mod read;
mod write;

pub use largest::{LargestTension, TensionExtreme};
pub use map::{FaceMap, MapPoints, STRESS_MAP, StressMaps};
pub(in crate::record) use read::order;
pub use read::{Face, Largest, Passed, Stresses};
pub use write::EarlierTensions;

pub(super) use map::MapDatasets;
pub(super) use write::{TensionDatasets, rings, rows};

use crate::impact::step::Step;
use crate::scene::Strength;

/// Faces on which stresses are recorded.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faces {
    /// Names of the faces.
    pub names: Vec<String>,
    /// Points at which the tensions are mapped.
    pub map: MapPoints,
    /// Factor (1 − 2ν)/(2πR) of Hertz's radial tension at the edge of the contact, 1/m: the tension is the factor
    /// times F/α. `None` if the impactor has no radius R.
    pub ring: Option<f64>,
}

impl Faces {
    /// Hertz's radial tension at the edge of the contact at a step, Pa; NaN if it is not recorded.
    pub(super) fn ring(&self, step: &Step) -> f64 {
        let contact = &step.contact;
        let is_closed = contact.force > 0.0 && contact.indentation > 0.0;
        self.ring.map_or(f64::NAN, |factor| if is_closed { factor * contact.force / contact.indentation } else { 0.0 })
    }
}

/// Strength of each face (Pa) in the order of `names`; `None` where the scene gives none.
pub fn strengths(strength: &Strength, names: &[String]) -> Vec<Option<f64>> {
    names.iter().map(|name| strength.of(name)).collect()
}
