//! What is kept of one member of a sweep.

use crate::impact::Probe;
use crate::impact::step::Step;
use crate::record::columns::SERIES;
use serde::{Deserialize, Serialize};

use crate::record::episodes::{Episode, Episodes};
use crate::record::probes::{self, Whole};
use crate::record::stress::LargestTension;

/// How far a member is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
    /// Not computed yet.
    Missing = 0,
    /// Computed to its end.
    Done = 1,
    /// The solve failed.
    Failed = 2,
    /// The scene turned out to be wrong on its mesh.
    Refused = 3,
}

impl Status {
    /// The status with a number; what has none is missing.
    pub fn from_number(number: u8) -> Self {
        [Self::Done, Self::Failed, Self::Refused].into_iter().find(|s| *s as u8 == number).unwrap_or(Self::Missing)
    }
}

/// A number that is kept of each member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Largest F at a step, N.
    PeakForce,
    /// Largest F/m0 at a step, m/s².
    PeakAcceleration,
    /// Its time, s.
    PeakTime,
    /// ∫ F dt over all contacts, N s.
    Impulse,
    /// Number of contact episodes.
    Contacts,
    /// 1 if the last contact lasts at the end of the run, else 0.
    OpenAtEnd,
    /// The impactor's velocity at the end along its direction of travel, m/s: negative where it rebounds.
    ReboundSpeed,
    /// Estimated error of the acceleration history over its peak.
    ErrorEstimate,
    /// The same in the first contact alone, as far as it is known before the first step.
    FirstContactError,
    /// Largest deflection under the impactor over the body's thickness.
    DeflectionOverThickness,
    /// Largest tension on any face, Pa.
    LargestStress,
    /// On which face: its number in the order of "upper", "lower", or of the names of a mesh's surfaces, from 0.
    LargestStressFace,
    /// When, s.
    LargestStressTime,
    /// When the strength of a face was passed first, s; NaN where it was not.
    StrengthPassedAt,
    /// Estimated error of the largest tension over its value.
    StressErrorEstimate,
    /// Number of unknowns, the impactor's included.
    Unknowns,
    /// Wall time, s.
    WallTime,
}

impl Quantity {
    /// All of them, with the names of their datasets and their units.
    pub(super) const ALL: [(Self, &'static str, &'static str); 17] = [
        (Self::PeakForce, "peak_force", "N"),
        (Self::PeakAcceleration, "peak_acceleration", "m/s2"),
        (Self::PeakTime, "peak_time", "s"),
        (Self::Impulse, "impulse", "N s"),
        (Self::Contacts, "contacts", "1"),
        (Self::OpenAtEnd, "open_at_end", "1"),
        (Self::ReboundSpeed, "rebound_speed", "m/s"),
        (Self::ErrorEstimate, "error_estimate", "1"),
        (Self::FirstContactError, "first_contact_error", "1"),
        (Self::DeflectionOverThickness, "deflection_over_thickness", "1"),
        (Self::LargestStress, "largest_stress", "Pa"),
        (Self::LargestStressFace, "largest_stress_face", "1"),
        (Self::LargestStressTime, "largest_stress_time", "s"),
        (Self::StrengthPassedAt, "strength_passed_at", "s"),
        (Self::StressErrorEstimate, "stress_error_estimate", "1"),
        (Self::Unknowns, "unknowns", "1"),
        (Self::WallTime, "wall_time", "s"),
    ];

    /// That of a dataset of `/members`, with its unit.
    pub fn named(name: &str) -> Option<(Self, &'static str)> {
        Self::ALL.into_iter().find(|(_, of, _)| *of == name).map(|(quantity, _, units)| (quantity, units))
    }

    /// The names of all datasets.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().map(|(_, name, _)| name)
    }
}

/// One member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Its number, from 0.
    pub index: usize,
    /// How it ended.
    pub status: Status,
    /// Why it did not come to its end; empty if it did.
    pub message: String,
    /// By [`Quantity`]; NaN where it is not known.
    pub quantities: [f64; Quantity::ALL.len()],
    /// Its contacts.
    pub contacts: Vec<Episode>,
    /// Its series where they are kept: a list a dataset of `/series` of a run.
    pub series: Option<Vec<Vec<f64>>>,
    /// What the scene's probes have read in the rows of the series, in their order.
    pub probes: Vec<Whole>,
}

impl Member {
    /// A member that is not computed yet. With `has_series` the steps that it is given are kept.
    pub fn new(index: usize, has_series: bool) -> Self {
        Self {
            index,
            status: Status::Missing,
            message: String::new(),
            quantities: [f64::NAN; Quantity::ALL.len()],
            contacts: Vec::new(),
            series: has_series.then(|| vec![Vec::new(); SERIES.len()]),
            probes: Vec::new(),
        }
    }

    /// One of its numbers.
    pub fn get(&self, quantity: Quantity) -> f64 {
        self.quantities[quantity as usize]
    }

    /// Sets one of its numbers.
    pub fn set(&mut self, quantity: Quantity, value: f64) {
        self.quantities[quantity as usize] = value;
    }

    /// Takes an accepted step into the peaks, and into the series, with what probes have read at it, where its number is a multiple of
    /// `every`.
    pub fn push(&mut self, step: &Step, read: &[Probe], every: usize) {
        // Without a contact the peak is zero, at the beginning.
        if step.number == 0 || step.contact.force > self.get(Quantity::PeakForce) {
            self.set(Quantity::PeakForce, step.contact.force);
            self.set(Quantity::PeakAcceleration, step.impactor.acceleration);
            self.set(Quantity::PeakTime, step.time);
        }
        self.set(Quantity::ReboundSpeed, step.impactor.velocity);
        if let Some(series) = self.series.as_mut().filter(|_| step.number.is_multiple_of(every)) {
            series.iter_mut().zip(&SERIES).for_each(|(values, column)| values.push((column.value)(step)));
            self.probes.resize(read.len(), Whole::default());
            self.probes.iter_mut().zip(read).for_each(|(whole, probe)| probes::push(whole, probe));
        }
    }

    /// Takes the largest tension of all its steps.
    pub fn set_tension(&mut self, tension: &LargestTension) {
        let LargestTension { value, face, time, strength_passed_at, error_estimate, .. } = *tension;
        self.set(Quantity::LargestStress, value);
        self.set(Quantity::LargestStressFace, if value.is_nan() { f64::NAN } else { face as f64 });
        self.set(Quantity::LargestStressTime, time);
        self.set(Quantity::StrengthPassedAt, strength_passed_at);
        self.set(Quantity::StressErrorEstimate, error_estimate);
    }

    /// Takes the contacts of all its steps.
    pub fn set_contacts(&mut self, episodes: &Episodes) {
        self.contacts = episodes.all().to_vec();
        self.set(Quantity::Impulse, self.contacts.iter().map(|contact| contact.impulse).sum());
        self.set(Quantity::Contacts, self.contacts.len() as f64);
        self.set(Quantity::OpenAtEnd, f64::from(u8::from(episodes.is_open())));
    }

    /// Ends it without a result: what it was given is not the answer.
    pub fn fail(self, status: Status, message: String) -> Self {
        Self { status, message, ..Self::new(self.index, self.series.is_some()) }
    }
}

/// An episode from its columns in a table of contacts.
pub(super) fn episode([start, end, peak_force, peak_time, impulse]: [f64; 5]) -> Episode {
    Episode { start, end, peak_force, peak_time, impulse }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_in_their_order() {
        assert!(Quantity::ALL.iter().enumerate().all(|(n, (quantity, ..))| *quantity as usize == n));
    }
}
