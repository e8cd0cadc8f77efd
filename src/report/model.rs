//! Section of a report with the model, the reason for its selection, its estimated errors and its assumptions.

use crate::model::LARGE_ERROR_OF_DEFLECTION;
use crate::record::provenance::ModelDetails;
use crate::record::stress::Stresses;
use crate::scene::{Model, Scene};

use super::data::Data;
use super::number::percent;
use super::page::{Block, Fact, Section};

/// Makes the section.
pub fn section(data: &Data) -> Section {
    let origin = &data.provenance;
    let mut rows = vec![Fact::new("Theory", theory(&origin.model))];
    rows.push(Fact::new("Selected", selected(data)));
    if let Some(details) = &origin.model_details {
        rows.push(Fact::new("Discretisation", &details.discretisation));
    }
    rows.push(Fact::new(
        "Reduction",
        if origin.reduction == "none" { "none: all unknowns" } else { origin.reduction.as_str() },
    ));
    rows.push(Fact::new("Unknowns", format!("{}, with the impactor’s", origin.unknowns)));
    let details = origin.model_details.as_ref().filter(|details| details.first_contact_error.is_finite());
    if let Some(ModelDetails { first_contact_error, error_causes, .. }) = details {
        let error = format!("{} of the peak, by {error_causes}", percent(*first_contact_error));
        rows.push(Fact::new("Estimated error in the first contact", error));
    }
    rows.push(acceleration_error(data));
    rows.extend(deflection_error(data));
    rows.extend(data.stresses.as_ref().map(stress_error));
    let mut parts = vec![
        Block::Facts { caption: "Model", rows },
        Block::Text(
            "The estimate of the acceleration’s error combines the estimated errors of the cells, the basis, the selected theory, \
             the time steps and the contact patch, as far as each applies, divided by the peak. It does not include the error of a theory, \
             of a time step or of a mesh that the scene prescribes, nor that of its material data."
                .to_owned(),
        ),
        Block::Text(
            "Assumptions: small deflections (the model is geometrically linear), linear materials, elastic or viscoelastic in shear, that do not fail, \
             an impactor that is rigid except for its contact, and a contact force by the law given above."
                .to_owned(),
        ),
    ];
    let said = origin.warnings.lines().filter_map(|line| line.split_once(": "));
    let rows: Vec<Fact> =
        said.map(|(kind, text)| Fact::new(sentence(kind).trim_end_matches('.'), sentence(text))).collect();
    if !rows.is_empty() {
        parts.push(Block::Facts { caption: "Warnings and notes of the run", rows });
    }
    Section { id: "model", title: "Model", parts }
}

/// Readable name of a theory.
fn theory(name: &str) -> String {
    match name {
        "half-space" => "Half-space: the local indentation alone",
        "infinite-plate" => "Infinite plate (Zener 1941): bending waves without reflections",
        "kirchhoff" => "Kirchhoff’s plate: bending of a thin plate",
        "layerwise" => "a layerwise plate: Mindlin’s theory in each layer, bonded to the next",
        "mindlin" => "Mindlin’s plate (Reissner 1945, Mindlin 1951): bending with shear and rotary inertia",
        "solid" => "Three-dimensional elasticity",
        other => other,
    }
    .to_owned()
}

/// States whether the scene or the program selected the theory, and the reason.
fn selected(data: &Data) -> String {
    let asked = data.scene.as_ref().map(|scene| scene.body.model);
    let reason = data.provenance.model_details.as_ref().map(|details| &details.reason);
    match (asked, reason.filter(|reason| !reason.is_empty())) {
        (Ok(model), _) if model != Model::Auto => "by the scene".to_owned(),
        (_, Some(reason)) => format!("by ricochet, the cheapest theory that meets the tolerance. {}", sentence(reason)),
        (Ok(_), None) => "by ricochet, the cheapest theory that meets the tolerance".to_owned(),
        (Err(_), None) => "not known".to_owned(),
    }
}

/// Adds a capital letter at the start and a full stop at the end.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str().trim_end_matches('.'))
}

/// An estimated error, with its reference value and scope; or, without an estimate, with the reason.
fn estimated(of_what: &str, error: f64, scope: String, reason: &str) -> Fact {
    let reason = if reason.is_empty() { String::new() } else { format!("({reason})") };
    let (value, note) = if error.is_nan() { ("not estimated".to_owned(), reason) } else { (percent(error), scope) };
    Fact::new(format!("Estimated error of the {of_what}"), value).noted(note)
}

/// Estimated error of the acceleration, with the tolerance.
pub fn acceleration_error(data: &Data) -> Fact {
    let reason = if data.is_complete { "" } else { "the run did not reach its end" };
    let tolerance = data.scene.as_ref().map_or(String::new(), |Scene { tolerance, .. }| {
        format!(" (tolerance in the first contact: {})", percent(*tolerance))
    });
    let without =
        if is_theory_left_out(data) { ", without that of the theory, which the scene prescribes" } else { "" };
    let scope = format!("of the peak, over the whole history{tolerance}{without}");
    estimated("acceleration", data.cost.error_estimate, scope, reason)
}

/// Whether the scene prescribes a theory simpler than the solid. The error of such a theory is not estimated.
fn is_theory_left_out(data: &Data) -> bool {
    let is_named = |scene: &Scene| !matches!(scene.body.model, Model::Auto | Model::Solid);
    data.scene.as_ref().is_ok_and(is_named)
}

/// Estimated error of the deflection under the impactor; `None` if it is not estimated.
pub fn deflection_error(data: &Data) -> Option<Fact> {
    let error = data.cost.deflection_error_estimate;
    let mut scope = "of its largest value, over the whole history".to_owned();
    if error > LARGE_ERROR_OF_DEFLECTION {
        scope += ". Deflections elsewhere may have errors as large";
    }
    (!error.is_nan()).then(|| estimated("deflection under the impactor", error, scope, ""))
}

/// Estimated error of the largest tension.
pub fn stress_error(stresses: &Stresses) -> Fact {
    let scope = "of the peak, in the first contact".to_owned();
    estimated("largest tension", stresses.error_estimate, scope, &stresses.without_estimate)
}
