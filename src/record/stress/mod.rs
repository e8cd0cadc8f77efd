//! Largest principal stresses on the faces of a body: writing and reading.
//!
//! `/series/stress` has a row for each recorded step. `/stress_map` has the largest tension over all steps at each
//! point. The attributes of the root have the largest tension of the whole run.

mod estimate;
mod largest;
mod map;
mod read;
mod write;

pub use estimate::{StrengthVerdict, contact_beyond_edge};
pub use largest::{LargestTension, TensionExtreme};
pub use map::{FaceMap, MapPoints, STRESS_MAP, StressMaps};
pub(in crate::record) use read::order;
pub use read::{Face, Largest, Passed, Stresses};
pub use write::EarlierTensions;

pub(super) use map::MapDatasets;
pub(super) use write::{TensionDatasets, rows};

use std::sync::Arc;

use crate::contact::LayeredContact;
use crate::impact::step::Step;
use crate::scene::Strength;

/// Faces on which stresses are recorded.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faces {
    /// Names of the faces.
    pub names: Vec<String>,
    /// Points at which the tensions are mapped.
    pub map: MapPoints,
    /// Hertz's radial tension at the edge of the contact; `None` if the impactor has no radius R.
    pub ring: Option<Ring>,
}

/// Hertz's radial tension at the edge of the contact, (1 − 2ν) F/(2πa²) for the contact radius a.
#[derive(Debug, Clone, PartialEq)]
pub struct Ring {
    /// Factor (1 − 2ν)/(2π).
    pub factor: f64,
    /// Radius R of the impactor, m: a² = Rα.
    pub curvature: f64,
    /// Contact with a stack of layers, which has another contact radius.
    pub layered: Option<Arc<LayeredContact>>,
}

impl Ring {
    /// The tension under a force (N) with an indentation (m), Pa.
    fn tension(&self, force: f64, indentation: f64) -> f64 {
        match &self.layered {
            Some(layered) => self.factor * force / layered.radius(force).powi(2),
            None => self.factor / self.curvature * force / indentation,
        }
    }
}

impl Faces {
    /// Hertz's radial tension at the edge of the contact at a step, Pa; NaN if it is not recorded.
    pub(super) fn ring(&self, step: &Step) -> f64 {
        let contact = &step.contact;
        let is_closed = contact.force > 0.0 && contact.indentation > 0.0;
        let tension = |ring: &Ring| if is_closed { ring.tension(contact.force, contact.indentation) } else { 0.0 };
        self.ring.as_ref().map_or(f64::NAN, tension)
    }
}

/// Strength of each face (Pa) in the order of `names`; `None` where the scene gives none.
pub fn strengths(strength: &Strength, names: &[String]) -> Vec<Option<f64>> {
    names.iter().map(|name| strength.of(name)).collect()
}
