//! Summary of a report: the impact in a sentence, the key figures, and the conclusions.

use crate::impact::step::{Contact, Energy, Motion, Step};
use crate::model::{self, Linearity};
use crate::record::extremes::Extreme;
use crate::record::stress::{Passed, StrengthVerdict};
use crate::record::useless::Printed;
use crate::scene::Model;

use super::data::Data;
use super::model::{acceleration_error, deflection_error, stress_error};
use super::number::{ACCELERATION, FORCE, LENGTH, MASS, SPEED, STRESS, TIME, Units, computed, given, percent};
use super::page::{Fact, Grade, Summary, Verdict};
use super::scene::sentence;
use super::tension::{face_name, most_used};

/// Makes the summary.
pub fn summary(data: &Data) -> Summary {
    let first = data.velocity.values.first().copied().unwrap_or(f64::NAN);
    let unread = || {
        format!(
            "An impactor of {} hits an elastic body at {}.",
            given(data.provenance.impactor_mass, MASS),
            computed(first, SPEED)
        )
    };
    Summary {
        sentence: data.scene.as_ref().map_or_else(|_| unread(), sentence),
        verdicts: [incomplete(data), useless(data), strength(data), deflection(data)].into_iter().flatten().collect(),
        facts: facts(data),
    }
}

fn verdict(grade: Grade, title: &str, text: String) -> Verdict {
    Verdict { grade, title: title.to_owned(), text }
}

/// Conclusion if the run did not reach its end.
fn incomplete(data: &Data) -> Option<Verdict> {
    let wanted = data.scene.as_ref().map_or(String::new(), |scene| format!(" of {}", given(scene.time.end, TIME)));
    let text = format!("The run was ended at {}{wanted}. All values are those up to then.", computed(data.end(), TIME));
    (!data.is_complete).then(|| verdict(Grade::Open, "Incomplete", text))
}

/// Conclusion if the estimated error of a key figure is so large that it is of no use.
fn useless(data: &Data) -> Option<Verdict> {
    let (largest, details) = (data.extremes.as_ref()?, data.provenance.model_details.as_ref());
    let printed = Printed {
        first_end: data.contacts.episodes.first().map(|first| first.end),
        peak_time: largest.force.time,
        first_contact_error: details.map_or(f64::NAN, |details| details.first_contact_error),
        history_error: data.cost.error_estimate,
        deflection_error: data.cost.deflection_error_estimate,
        stress_error: data.stresses.as_ref().map_or(f64::NAN, |of| of.error_estimate),
    };
    let useless: Vec<String> =
        printed.useless().iter().map(|(name, error)| format!("{name}: {}", percent(*error))).collect();
    let text = format!("Estimated errors over the peak: {}. Do not use these numbers.", useless.join("; "));
    (!useless.is_empty()).then(|| verdict(Grade::Open, "Numbers of no use", text))
}

/// Conclusion on the strength; `None` if the scene gives no strength.
fn strength(data: &Data) -> Option<Verdict> {
    if !data.strength.is_given() {
        return None;
    }
    let (Some(stresses), Some(used)) = (&data.stresses, most_used(data)) else {
        let text = "The scene gives a strength, but this result holds no stresses to hold against it.".to_owned();
        return Some(verdict(Grade::Open, "Strength not assessed", text));
    };
    let part = used.part();
    let what = format!(
        "On the {} the largest tension, {}, is {} of the strength of {}",
        face_name(&used.largest.face),
        computed(used.largest.value, STRESS),
        percent(part),
        given(used.strength, STRESS)
    );
    let judged = used.verdict(stresses);
    if judged == StrengthVerdict::Exceeded || stresses.strength_passed.is_some() {
        let when = stresses.strength_passed.as_ref().map_or(String::new(), |Passed { time, face }| {
            let on = if face.is_empty() || *face == used.largest.face {
                String::new()
            } else {
                format!(" of the {}", face_name(face))
            };
            format!("; the strength{on} is first exceeded at {}", computed(*time, TIME))
        });
        return Some(verdict(Grade::Bad, "Strength exceeded", format!("{what}{when}.")));
    }
    let error = used.error(stresses);
    Some(if judged == StrengthVerdict::NotExceeded {
        let grade = if data.is_complete { Grade::Good } else { Grade::Open };
        let text = format!("{what}; the estimated error of the tension is {}.", percent(error));
        verdict(grade, "Strength not exceeded", text)
    } else if error.is_nan() {
        let why = match stresses.without_estimate.as_str() {
            "" => "".to_owned(),
            why => format!(": {why}"),
        };
        verdict(Grade::Open, "Strength undecided", format!("{what}. The error of the tension is not estimated{why}."))
    } else {
        let text = format!(
            "{what}. The estimated error of the tension, {}, is larger than the margin to the strength.",
            percent(error)
        );
        verdict(Grade::Open, "Strength undecided", text)
    })
}

/// Conclusion if the deflection is too large for a geometrically linear model.
fn deflection(data: &Data) -> Option<Verdict> {
    let theories =
        [Model::HalfSpace, Model::InfinitePlate, Model::Kirchhoff, Model::Mindlin, Model::Layerwise, Model::Solid];
    let theory = theories.into_iter().find(|theory| model::name(*theory) == data.provenance.model)?;
    let linearity = Linearity::new(data.scene.as_ref().ok()?, theory, None)?;
    let energy = |name: &str| data.energies.parts.iter().find(|part| part.name == name).map(|part| &part.values);
    let (elastic, support) = (energy("elastic")?, energy("support")?);
    let rows = data.deflection.values.len().min(data.position.values.len()).min(elastic.len());
    let step = |n: usize| Step {
        time: data.deflection.time[n],
        impactor: Motion { position: data.position.values[n], ..Motion::default() },
        contact: Contact { surface_displacement: data.deflection.values[n], ..Contact::default() },
        energy: Energy { elastic: elastic[n], support: support[n], ..Energy::default() },
        ..Step::default()
    };
    let largest = (0..rows).map(|n| linearity.deflection(&step(n))).fold(0.0, f64::max);
    let ratio = linearity.excess(largest)?;
    let text = format!(
        "The body bends by {}, which is {} of its thickness. The model is geometrically linear and neglects membrane forces, \
         which stiffen the body: expect larger forces and smaller deflections.",
        computed(largest, LENGTH),
        percent(ratio)
    );
    Some(verdict(Grade::Open, "Large deflection", text))
}

fn facts(data: &Data) -> Vec<Fact> {
    let mut facts = Vec::new();
    let at = |time: f64| format!("at {}", computed(time, TIME));
    if let Some(largest) = &data.extremes {
        let extreme = |name: &str, Extreme { value, time }: Extreme, units: Units| {
            Fact::new(name, computed(value, units)).noted(at(time))
        };
        let backwards =
            if largest.deflection.value < 0.0 { ", opposite to the impactor's direction of travel" } else { "" };
        let note = format!("under the impactor, {}{backwards}", at(largest.deflection.time));
        facts.extend([
            extreme("Peak contact force", largest.force, FORCE),
            extreme("Peak acceleration", largest.acceleration, ACCELERATION),
            extreme("Largest deflection", largest.deflection, LENGTH).noted(note),
        ]);
    }
    match &data.contacts.episodes[..] {
        [] => facts.push(Fact::new("Contact", "none")),
        [first, rest @ ..] => {
            let is_open = data.contacts.is_open && rest.is_empty();
            let count = match (rest.len(), is_open) {
                (_, true) => "not over at the end".to_owned(),
                (0, _) => "the only contact".to_owned(),
                (more, _) => format!("the first of {} contacts", more + 1),
            };
            facts.push(Fact::new("Contact duration", computed(first.end - first.start, TIME)).noted(count));
        }
    }
    let velocities = data.velocity.values.first().zip(data.velocity.values.last());
    if let Some((before, after)) = velocities {
        let note = format!("{} at the start", computed(*before, SPEED));
        facts.push(Fact::new("Impactor’s velocity at the end", computed(*after, SPEED)).noted(note));
    }
    if let Some((stresses, largest)) = data.stresses.as_ref().and_then(|of| Some((of, of.largest.as_ref()?))) {
        let note = format!("{}, {}", face_name(&largest.face), at(largest.time));
        facts.extend([
            Fact::new("Largest tension", computed(largest.value, STRESS)).noted(note),
            stress_error(stresses),
        ]);
    }
    facts.extend(deflection_error(data));
    facts.push(acceleration_error(data));
    facts
}
