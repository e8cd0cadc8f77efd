//! Prints a report as JSON, for other programs.

use serde::Serialize;

use crate::contact::ForceLaw;
use crate::model;
use crate::scene::Measure;

use super::super::notes::describe_model;
use super::super::say_json;
use super::Report;
use super::text::support_lines;

/// Facts of a report. Numbers are in SI units; unknown values are null.
#[derive(Serialize)]
struct Facts<'a> {
    title: &'a str,
    mass: Option<f64>,
    bounds: Option<[[f64; 3]; 2]>,
    volume: Option<f64>,
    surfaces: Vec<Area<'a>>,
    supports: Vec<String>,
    model: Option<ModelFacts<'a>>,
    /// Reason if there is no model.
    model_missing: Option<&'a str>,
    contact: ContactFacts,
    solver: Option<&'a str>,
    memory: Option<&'a str>,
    warnings: &'a [String],
    notes: &'a [String],
}

#[derive(Serialize)]
struct Area<'a> {
    name: &'a str,
    area: f64,
}

#[derive(Serialize)]
struct ModelFacts<'a> {
    theory: &'a str,
    description: String,
    reason: Option<&'a str>,
    unknowns: usize,
    vectors: Option<usize>,
    /// Estimated error in the first contact, over the peak of the acceleration.
    first_contact_error: Option<f64>,
    error_is_of: Vec<&'static str>,
}

/// Contact on a half-space.
#[derive(Serialize)]
struct ContactFacts {
    /// Name of the contact law in the scene.
    law: &'static str,
    /// Contact stiffness of Hertz's law; null for other laws.
    stiffness: Option<f64>,
    duration: f64,
    peak_force: f64,
    /// Area on which the contact presses, if it is given.
    area: Option<String>,
    patch_radius: Option<f64>,
    disc_radius: Option<f64>,
}

/// Prints the report as one JSON object.
pub(super) fn print(report: &Report) {
    let Report { scene, measures, cost, .. } = report;
    let made = report.model.as_ref().ok();
    let impactor = &scene.impactor;
    let surfaces = measures.iter().flat_map(|measures| &measures.surfaces);
    let facts = Facts {
        title: &scene.title,
        mass: report.mass,
        bounds: measures.as_ref().map(|measures| measures.bounds),
        volume: measures.as_ref().map(|measures| measures.volume),
        surfaces: surfaces.map(|surface| Area { name: &surface.name, area: surface.area }).collect(),
        supports: support_lines(scene),
        model: made.map(|made| ModelFacts {
            theory: model::name(made.theory),
            description: describe_model(made, scene),
            reason: made.reason.as_deref(),
            unknowns: made.unknowns,
            vectors: made.vectors,
            first_contact_error: made.error_before_steps().total().map(|errors| errors.first_contact),
            error_is_of: made.error.causes(Measure::Acceleration),
        }),
        model_missing: report.model.as_ref().err().map(String::as_str),
        contact: ContactFacts {
            law: impactor.force_law.name(),
            stiffness: match &impactor.force_law {
                ForceLaw::Hertz(law) => Some(law.stiffness),
                _ => None,
            },
            duration: impactor.contact_time(),
            peak_force: impactor.peak_force(),
            area: scene.contact.area().map(ToString::to_string),
            patch_radius: made.and_then(|made| made.dynamics.patch()).map(|patch| patch.radius),
            disc_radius: made.and_then(|made| made.dynamics.footprint().disc()),
        },
        solver: cost.as_ref().map(|cost| cost.solver.as_str()),
        memory: cost.as_ref().and_then(|cost| cost.memory.as_deref()),
        warnings: &report.warnings,
        notes: &report.notes,
    };
    say_json(&facts);
}
