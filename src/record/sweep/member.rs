//! Data stored for one member of a sweep.

use crate::impact::Probe;
use crate::impact::step::Step;
use crate::record::columns::SERIES;
use serde::{Deserialize, Serialize};

use crate::record::episodes::{Episode, Episodes};
use crate::record::probes::{self, ProbeHistory};
use crate::record::stress::LargestTension;

/// Status of a member.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
    /// Not computed yet.
    Missing = 0,
    /// Computed to the end of the run.
    Done = 1,
    /// Solution failed.
    Failed = 2,
    /// Scene rejected when its mesh was known.
    Refused = 3,
}

impl Status {
    /// Status with a number; [`Self::Missing`] for unknown numbers.
    pub fn from_number(number: u8) -> Self {
        [Self::Done, Self::Failed, Self::Refused].into_iter().find(|s| *s as u8 == number).unwrap_or(Self::Missing)
    }
}

/// Scalar result stored for each member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Largest contact force F at a step, N.
    PeakForce,
    /// Largest deceleration F/m0 at a step, m/s².
    PeakAcceleration,
    /// Time of the largest force, s.
    PeakTime,
    /// Impulse ∫ F dt of all contacts, N s.
    Impulse,
    /// Number of contact episodes.
    Contacts,
    /// 1 if the contact lasts at the end of the run, otherwise 0.
    OpenAtEnd,
    /// Velocity of the impactor at the end along its initial direction, m/s; negative after a rebound.
    ReboundSpeed,
    /// Estimated error of the acceleration history divided by its peak.
    ErrorEstimate,
    /// Error of the acceleration in the first contact divided by its peak, as estimated before the first step.
    FirstContactError,
    /// Largest magnitude of the displacement of the surface under the impactor, m.
    LargestDeflection,
    /// Estimated error of that displacement over the whole history, divided by its largest magnitude; NaN without one.
    DeflectionErrorEstimate,
    /// Largest deflection under the impactor divided by the thickness of the body.
    DeflectionOverThickness,
    /// Largest tension on any face, Pa.
    LargestStress,
    /// Face of the largest tension: its number in the order "upper", "lower", or in the order of the names of a mesh's
    /// surfaces, from 0.
    LargestStressFace,
    /// Time of the largest tension, s.
    LargestStressTime,
    /// Time at which the tension first exceeds the strength of a face, s; NaN if it never does.
    StrengthPassedAt,
    /// Verdict on the strength: 0 not exceeded, 1 exceeded, 2 undecided; NaN without a strength.
    StrengthVerdict,
    /// Estimated error of the largest tension divided by its value.
    StressErrorEstimate,
    /// Number of unknowns, including the impactor's.
    Unknowns,
    /// Wall time, s.
    WallTime,
}

impl Quantity {
    /// All quantities in their order, with the names of their datasets and their units.
    pub(super) const ALL: [(Self, &'static str, &'static str); 20] = [
        (Self::PeakForce, "peak_force", "N"),
        (Self::PeakAcceleration, "peak_acceleration", "m/s2"),
        (Self::PeakTime, "peak_time", "s"),
        (Self::Impulse, "impulse", "N s"),
        (Self::Contacts, "contacts", "1"),
        (Self::OpenAtEnd, "open_at_end", "1"),
        (Self::ReboundSpeed, "rebound_speed", "m/s"),
        (Self::ErrorEstimate, "error_estimate", "1"),
        (Self::FirstContactError, "first_contact_error", "1"),
        (Self::LargestDeflection, "largest_deflection", "m"),
        (Self::DeflectionErrorEstimate, "deflection_error_estimate", "1"),
        (Self::DeflectionOverThickness, "deflection_over_thickness", "1"),
        (Self::LargestStress, "largest_stress", "Pa"),
        (Self::LargestStressFace, "largest_stress_face", "1"),
        (Self::LargestStressTime, "largest_stress_time", "s"),
        (Self::StrengthPassedAt, "strength_passed_at", "s"),
        (Self::StrengthVerdict, "strength_verdict", "1"),
        (Self::StressErrorEstimate, "stress_error_estimate", "1"),
        (Self::Unknowns, "unknowns", "1"),
        (Self::WallTime, "wall_time", "s"),
    ];

    /// Quantity of a dataset of `/members`, with its unit; `None` for other names.
    pub fn named(name: &str) -> Option<(Self, &'static str)> {
        Self::ALL.into_iter().find(|(_, of, _)| *of == name).map(|(quantity, _, units)| (quantity, units))
    }

    /// Names of all datasets.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().map(|(_, name, _)| name)
    }
}

/// Results of one member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Number of the member, from 0.
    pub index: usize,
    /// Status at the end of the computation.
    pub status: Status,
    /// Reason for a failure or, with a strength, why the error of the largest tension is not estimated; otherwise empty.
    pub message: String,
    /// Values by [`Quantity`]; NaN where unknown.
    pub quantities: [f64; Quantity::ALL.len()],
    /// Contact episodes.
    pub contacts: Vec<Episode>,
    /// Series, one list for each dataset of `/series` of a run; `None` if they are not stored.
    pub series: Option<Vec<Vec<f64>>>,
    /// Values of the probes in the rows of the series, in the order of the scene.
    pub probes: Vec<ProbeHistory>,
}

impl Member {
    /// New member that is not computed yet. With `has_series` its steps are stored.
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

    /// Value of a quantity.
    pub fn get(&self, quantity: Quantity) -> f64 {
        self.quantities[quantity as usize]
    }

    /// Sets the value of a quantity.
    pub fn set(&mut self, quantity: Quantity, value: f64) {
        self.quantities[quantity as usize] = value;
    }

    /// Adds an accepted step to the largest values. If series are stored and the number of the step is a multiple of `every`,
    /// the step and the values of the probes are appended to the series.
    pub fn push(&mut self, step: &Step, read: &[Probe], every: usize) {
        // Without a contact the peak is zero at the first step.
        if step.number == 0 || step.contact.force > self.get(Quantity::PeakForce) {
            self.set(Quantity::PeakForce, step.contact.force);
            self.set(Quantity::PeakAcceleration, step.impactor.acceleration);
            self.set(Quantity::PeakTime, step.time);
        }
        // The maximum ignores NaN, with which a member begins.
        let deflection = step.contact.surface_displacement.abs();
        self.set(Quantity::LargestDeflection, self.get(Quantity::LargestDeflection).max(deflection));
        self.set(Quantity::ReboundSpeed, step.impactor.velocity);
        if let Some(series) = self.series.as_mut().filter(|_| step.number.is_multiple_of(every)) {
            series.iter_mut().zip(&SERIES).for_each(|(values, column)| values.push((column.value)(step)));
            self.probes.resize(read.len(), ProbeHistory::default());
            self.probes.iter_mut().zip(read).for_each(|(whole, probe)| probes::push(whole, probe));
        }
    }

    /// Stores the largest tension of all steps.
    pub fn set_tension(&mut self, tension: &LargestTension) {
        let LargestTension { value, face, time, strength_passed_at, error_estimate, .. } = *tension;
        if let Some(verdict) = tension.verdict() {
            self.set(Quantity::StrengthVerdict, verdict.number());
            self.message.clone_from(&tension.without_estimate);
        }
        self.set(Quantity::LargestStress, value);
        self.set(Quantity::LargestStressFace, if value.is_nan() { f64::NAN } else { face as f64 });
        self.set(Quantity::LargestStressTime, time);
        self.set(Quantity::StrengthPassedAt, strength_passed_at);
        self.set(Quantity::StressErrorEstimate, error_estimate);
    }

    /// Stores the contacts of all steps.
    pub fn set_contacts(&mut self, episodes: &Episodes) {
        self.contacts = episodes.all().to_vec();
        self.set(Quantity::Impulse, self.contacts.iter().map(|contact| contact.impulse).sum());
        self.set(Quantity::Contacts, self.contacts.len() as f64);
        self.set(Quantity::OpenAtEnd, f64::from(u8::from(episodes.is_open())));
    }

    /// Discards all results and stores a status and a message instead.
    pub fn fail(self, status: Status, message: String) -> Self {
        Self { status, message, ..Self::new(self.index, self.series.is_some()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_in_their_order() {
        assert!(Quantity::ALL.iter().enumerate().all(|(n, (quantity, ..))| *quantity as usize == n));
    }
}
