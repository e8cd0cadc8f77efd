//! The largest principal stresses on the faces of a body: what is written of them, and how it is read back.
//!
//! `/series/stress` has a row for each recorded step, `/stress_map` the largest tension over all steps at each point, and the attributes of
//! the root the largest of all.

mod largest;
mod map;
mod read;
mod write;

pub use largest::LargestTension;
pub use map::{FaceMap, MapPoints, STRESS_MAP, StressMaps};
pub use read::{Face, Largest, Stresses};
pub use write::EarlierTensions;

pub(super) use map::MapDatasets;
pub(super) use write::{TensionDatasets, rings, rows};

use crate::impact::step::Step;
use crate::scene::Strength;

/// What is to be recorded of stresses.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faces {
    /// Names of the faces.
    pub names: Vec<String>,
    /// Where their tensions are mapped.
    pub map: MapPoints,
    /// Radial tension at the edge of the contact times α/F, 1/m²: (1 − 2ν)/(2πR), where the impactor has a radius R.
    pub ring: Option<f64>,
}

impl Faces {
    /// Hertz's radial tension at a step, Pa; NaN where it is not recorded.
    pub(super) fn ring(&self, step: &Step) -> f64 {
        let contact = &step.contact;
        let is_closed = contact.force > 0.0 && contact.indentation > 0.0;
        self.ring.map_or(f64::NAN, |factor| if is_closed { factor * contact.force / contact.indentation } else { 0.0 })
    }
}

/// The strengths of faces, in their order.
pub fn strengths(strength: &Strength, names: &[String]) -> Vec<Option<f64>> {
    names.iter().map(|name| strength.of(name)).collect()
}
