//! Collects remarks on the members of a sweep. Each kind of remark is printed once, with the number of members and the
//! worst one.

use std::collections::BTreeMap;

use crate::impact::{Plan, beside, estimated};
use crate::model::{
    Edges, LARGE_ERROR_OF_DEFLECTION, LARGE_ERROR_OF_TENSION, edges, largest_linear, may_lack_rotations,
};
use crate::record::sweep::{Quantity, Status, Sweep};
use crate::record::useless::USELESS;
use crate::scene::{Measure, Scene, Source};
use crate::study::sweep::Grid;

use super::notes::{self, Remark, UNESTIMATED_ROTATIONS, history_above, of_large_deflection_error, remedy_of_tension};
use super::summary::{beyond, ends_at_peak};
use super::{note, tell};

/// What may lower the error of a member.
const REMEDIES: &str = "a smaller accuracy.tolerance may lower the error; so may `ricochet run` of this member alone, which shares no basis with other members and says what lowers its error";

/// Remarks on members, sorted by kind.
#[derive(Default)]
pub struct Remarks {
    warnings: Kinds,
    notes: Kinds,
}

/// Facts about the scene of a member that decide on remarks about its results.
pub struct MemberFacts {
    tolerance: f64,
    /// Quantity that the tolerance applies to.
    measure: Measure,
    /// What may lower a large error of the tension.
    remedy_of_tension: &'static str,
    /// End of the run, s.
    end: f64,
    edges: Edges,
    /// Same as [`may_lack_rotations`].
    may_lack_rotations: bool,
    /// Whether the scene gives a strength.
    pub has_strength: bool,
}

impl MemberFacts {
    /// Facts about a scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            tolerance: scene.tolerance,
            measure: scene.measure,
            remedy_of_tension: remedy_of_tension(scene),
            may_lack_rotations: may_lack_rotations(scene),
            end: scene.time.end,
            edges: edges(scene),
            has_strength: scene.strength.is_given(),
        }
    }
}

/// For each kind: the worst remark, its member, and the number of members with such a remark.
#[derive(Default)]
struct Kinds(BTreeMap<String, (Remark, usize, usize)>);

impl Kinds {
    fn add(&mut self, member: usize, remark: Remark) {
        match self.0.get_mut(&remark.kind) {
            None => {
                self.0.insert(remark.kind.clone(), (remark, member, 1));
            }
            Some((worst, at, count)) => {
                *count += 1;
                if remark.size > worst.size {
                    (*worst, *at) = (remark, member);
                }
            }
        }
    }

    fn lines<'a>(&'a self, grid: &'a Grid) -> impl Iterator<Item = String> + 'a {
        self.0.values().map(|(worst, at, count)| {
            let all = grid.len();
            format!("{count} of {all} members, most of all {}: {}", grid.name(*at), worst.text)
        })
    }
}

impl Remarks {
    /// Adds the remarks that a run would print about the scene of a member before it is computed.
    pub fn of_scene(&mut self, member: usize, scene: &Scene, source: &Source) {
        let values = notes::of_values(scene, source).into_iter().chain(notes::of_geometry(scene, None));
        values.for_each(|remark| self.warnings.add(member, remark));
        let plan = scene.time.step.map(|step| Plan::Equal { step });
        notes::notes(scene, None, plan.as_ref()).into_iter().for_each(|remark| self.notes.add(member, remark));
    }

    /// Remarks that a run would print about its results, for all members that are done. (A tension under the impact point that is not the
    /// largest has no estimate in a sweep.) `facts` has an entry for each
    /// member.
    pub fn of_results(sweep: &Sweep, facts: &[MemberFacts]) -> Self {
        let mut all = Self::default();
        for (member, own) in facts.iter().enumerate() {
            let MemberFacts { tolerance, measure, remedy_of_tension, may_lack_rotations, end, edges, .. } = own;
            if sweep.status[member] != Status::Done {
                continue;
            }
            let of = |quantity| sweep.quantity(quantity)[member];
            let (first, whole) = (of(Quantity::FirstContactError), of(Quantity::ErrorEstimate));
            let over_thickness = of(Quantity::DeflectionOverThickness);
            let deflection_error = of(Quantity::DeflectionErrorEstimate);
            let tension_error = of(Quantity::StressErrorEstimate);
            let applies_to_acceleration = *measure != Measure::Stress || tension_error.is_nan();
            let remark = |kind: &str, size: f64, text: String| Remark { kind: kind.to_owned(), size, text };
            let of_what = if *measure == Measure::Acceleration { "" } else { " of the acceleration" };
            let of_first = format!(
                "the estimated error{of_what} in the first contact is {} of the peak, above accuracy.tolerance = {tolerance:e}",
                beside(first, *tolerance)
            );
            let (error, quantity) = match measure {
                Measure::Acceleration => (f64::NAN, ""),
                Measure::Stress => (tension_error, "the largest tension"),
                Measure::Deflection => (deflection_error, "the deflection under the impactor"),
            };
            if error > *tolerance {
                let text = format!(
                    "the estimated error of {quantity} is {} of its largest value, above accuracy.tolerance = {tolerance:e}: {REMEDIES}",
                    beside(error, *tolerance)
                );
                all.warnings.add(member, remark("quantity of the tolerance", error, text));
            }
            if *measure != Measure::Stress && tension_error > LARGE_ERROR_OF_TENSION.max(*tolerance) {
                let text = format!(
                    "the estimated error of the largest tension is {} of its peak; {remedy_of_tension} may lower this error",
                    estimated(tension_error)
                );
                all.notes.add(member, remark("error of the tension", tension_error, text));
            }
            if let Some(why) = sweep.messages.get(&member) {
                let text = format!("the error of the largest tension is not estimated: {why}");
                all.notes.add(member, remark("tension without an estimate", of(Quantity::LargestStress), text));
            }
            if *measure != Measure::Deflection && deflection_error > LARGE_ERROR_OF_DEFLECTION {
                let error = of_large_deflection_error(deflection_error);
                let text = format!("{error}; accuracy.quantity = \"deflection\" may lower this error");
                all.notes.add(member, remark("error of the deflection", deflection_error, text));
            }
            if *may_lack_rotations && deflection_error.is_nan() && !over_thickness.is_nan() {
                all.notes.add(member, remark("rotations", 1.0, UNESTIMATED_ROTATIONS.to_owned()));
            }
            let is_useless = first > USELESS;
            if is_useless {
                let text = format!(
                    "{of_first}, and its results are of no use: `ricochet check` of this member's scene shows the causes of its error"
                );
                all.warnings.add(member, remark("useless", first, text));
            } else if first > *tolerance && applies_to_acceleration {
                let text = format!("{of_first}: {REMEDIES}");
                all.warnings.add(member, remark("first contact", first, text));
            }
            let was_told = first > *tolerance && applies_to_acceleration;
            let scope =
                if applies_to_acceleration && *measure == Measure::Stress { Measure::Acceleration } else { *measure };
            let above = history_above([first, whole], [*measure, scope], *tolerance, was_told);
            if let Some(above) = above.filter(|_| !is_useless) {
                let text = format!("{above}; `ricochet run` of this member's scene says what may lower it");
                all.notes.add(member, remark("whole history", whole, text));
            }
            if over_thickness > largest_linear(*edges) {
                let text = format!("the body bends by about {}", beyond(over_thickness, *edges));
                all.warnings.add(member, remark("deflection", over_thickness, text));
            }
            // Times of steps differ from the end by rounding.
            if of(Quantity::OpenAtEnd) == 1.0 && of(Quantity::PeakTime) >= end * (1.0 - 1e-9) {
                all.warnings.add(member, remark("end", of(Quantity::PeakForce), ends_at_peak(*end)));
            }
        }
        all
    }

    /// Prints all remarks.
    pub fn tell(&self, grid: &Grid) {
        self.warnings.lines(grid).for_each(|line| tell(format_args!("warning: {line}")));
        self.notes.lines(grid).for_each(|line| note(format_args!("note: {line}")));
    }
}

/// Prints a note for each key without effect: members that differ only in this key have identical results.
pub fn tell_of_idle_keys(grid: &Grid, sweep: &Sweep) {
    const KEPT: [Quantity; 8] = [
        Quantity::PeakForce,
        Quantity::PeakTime,
        Quantity::Impulse,
        Quantity::Contacts,
        Quantity::ReboundSpeed,
        Quantity::LargestDeflection,
        Quantity::LargestStress,
        Quantity::StrengthPassedAt,
    ];
    let is_done = |member: &usize| sweep.status[*member] == Status::Done;
    for (place, key) in grid.keys().iter().enumerate() {
        let other = |member: usize| (member, grid.with_first(member, place));
        let mut pairs =
            (0..grid.len()).map(other).filter(|(one, other)| one != other && is_done(one) && is_done(other));
        let alike = |(one, other): (usize, usize)| {
            let bits = |member: usize| KEPT.map(|quantity| sweep.quantity(quantity)[member].to_bits());
            bits(one) == bits(other)
        };
        if let Some(first) = pairs.next()
            && alike(first)
            && pairs.all(alike)
        {
            note(format_args!("note: --vary {} has no effect: members that differ in it alone are alike", key.path));
        }
    }
}
