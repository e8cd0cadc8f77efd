//! What a user should know of a scene before its numbers are trusted.

use crate::contact::{ForceLaw, Patch};
use crate::impact::Plan;
use crate::mesh::Measures;
use crate::model::{self, Model};
use crate::scene::{Geometry, Model as Theory, Scene, Scheme};
use crate::scheme::critical_frequency;

/// The theory, its unknowns and its basis.
pub fn describe_model(model: &Model) -> String {
    let mut words = format!("{}: {}", model::name(model.theory), model.words);
    if model.unknowns > 0 {
        words += &format!(", {} unknowns", model.unknowns);
    }
    if let Some(vectors) = model.vectors {
        words += &format!(", reduced to {vectors} vectors");
    }
    if let Some((first, _)) = model.error {
        words +=
            &format!("; estimated error of {} {first:.1e} of the peak in the first contact", listed(&model.judged));
    }
    words
}

/// Error in the first contact, over the peak, from which a history is of no use.
const USELESS: f64 = 0.5;

/// What the first contact's estimated error means for a run, where it is above the tolerance.
pub fn verdict(model: &Model, tolerance: f64) -> Option<Verdict> {
    // Not true of NaN, which is no good estimate.
    let is_good = |error: &f64| *error <= tolerance;
    let error = model.first_contact_error().filter(|error| !is_good(error))?;
    let of = model.judged.iter().copied().chain(model.dynamics.patch().map(|_| "patch"));
    let of = listed(&of.collect::<Vec<_>>());
    let message = format!(
        "the estimated error in the first contact is {error:.1e} of the peak, above accuracy.tolerance = {tolerance:e} (estimated for {of})"
    );
    Some(Verdict { message, is_useless: error.is_nan() || error > USELESS })
}

/// That a history is not as good as it was to be.
pub struct Verdict {
    /// By how much, in words.
    pub message: String,
    /// Whether nothing can be read from it.
    pub is_useless: bool,
}

/// Words as a list.
pub fn listed(words: &[&str]) -> String {
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => words.concat(),
    }
}

/// What is to be known of a model's probes.
pub fn note_of_probes(model: &Model) -> Option<String> {
    let near: Vec<String> = model.gauges.as_ref()?.near.iter().map(|name| format!("{name:?}")).collect();
    let names: Vec<&str> = near.iter().map(String::as_str).collect();
    let (word, read) = if names.len() == 1 { ("probe", "reads") } else { ("probes", "read") };
    let why = match model.theory {
        Theory::Kirchhoff => "where Kirchhoff's plate has a force at a point, under which moments have no limit",
        _ => "where this body carries the force on a wide disc: they may be off by some tenths",
    };
    (!names.is_empty()).then(|| {
        format!(
            "{word} {} {read} stresses near the hit, {why}. model = \"solid\" with reduction = \"none\" has the contact's own",
            listed(&names)
        )
    })
}

/// Part of a table that an impact is expected to use at least: less looks like units that differ by a thousand.
const LEAST_OF_TABLE: f64 = 0.01;

/// Diagonal of a body, m, and its ratio to the impactor's radius, above which its lengths look like millimetres.
const LONG: f64 = 20.0;
const LONG_FOR_RADIUS: f64 = 200.0;

/// What looks wrong with a body, or with what holds it.
pub fn of_geometry(scene: &Scene, measures: Option<&Measures>) -> Vec<String> {
    let mut warnings = Vec::new();
    let edges = match (&scene.body.geometry, measures) {
        (Geometry::Box { size, .. }, _) => *size,
        (_, Some(Measures { bounds: [least, largest], .. })) => [0, 1, 2].map(|i| largest[i] - least[i]),
        _ => [0.0; 3],
    };
    let diagonal = edges.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
    if diagonal > LONG && diagonal > LONG_FOR_RADIUS * scene.impactor.radius.unwrap_or_default() {
        warnings
            .push(format!("the body is {diagonal:.4} m long: lengths are in metres, and these look like millimetres"));
    }
    let Some(measures) = measures else { return warnings };
    if measures.parts > 1 {
        warnings.push(format!(
            "the mesh has {} parts that share no node: only the one that is hit feels the impact, and parts without supports float freely",
            measures.parts
        ));
    }
    let of_whole_surfaces = scene.supports.iter().enumerate().filter(|(_, support)| support.within.is_none());
    for (number, support) in of_whole_surfaces {
        let covered = measures.surfaces.iter().find(|surface| surface.name == support.surface);
        // To rounding of sums.
        if covered.is_some_and(|surface| surface.area > 0.999_999 * measures.area) {
            warnings.push(format!(
                "support.{number} holds the whole boundary, the impact point included: is {:?} the surface that was meant?",
                support.surface
            ));
        }
    }
    warnings
}

/// The notes on a scene, with its patch and its steps: nothing that is wrong, but much that a number may depend on.
pub fn notes(scene: &Scene, patch: Option<&Patch>, plan: Option<&Plan>) -> Vec<String> {
    let mut notes = Vec::new();
    let impactor = &scene.impactor;
    let finer = match scene.body.geometry {
        Geometry::Box { .. } => "body.grading",
        Geometry::Gmsh(_) => "a mesh that is finer there",
    };
    if let Some(patch) = patch {
        if patch.is_coarse() {
            notes.push(format!(
                "cells of {:.4} m do not resolve the patch: they should be {:.4} m or smaller at the impact point ({finer})",
                patch.cell,
                0.5 * patch.radius
            ));
        }
        if patch.error() > 0.5 * scene.tolerance {
            notes.push(format!(
                "the patch is large for a thickness of {:.4} m and leaves about {:.1e} of the peak open: finer cells at the impact \
                 point allow a smaller one ({finer})",
                patch.thickness,
                patch.error()
            ));
        }
        if patch.is_critical() {
            notes.push(format!(
                "on a half-space the contact would outgrow the patch, which takes {:.4e} m: the run stops if it does",
                patch.limit_radius
            ));
        }
    }
    if let Scheme::Newmark { beta, gamma } = scene.time.scheme
        && critical_frequency(beta, gamma) == 0.0
    {
        notes.push("with γ below 1/2 every vibration grows".to_owned());
    }
    let contact = impactor.contact_time();
    if plan.is_some_and(|plan| contact < 20.0 * plan.step()) {
        notes.push("fewer than 20 steps in a contact: expect its force to depend on the step".to_owned());
    }
    let indentation = impactor.peak_indentation();
    match &impactor.force_law {
        ForceLaw::Hertz(_) if impactor.radius.is_some_and(|radius| indentation > 0.1 * radius) => notes.push(format!(
            "on a half-space the impactor would sink in by {indentation:.2e} m: Hertz's law holds while that is small against its radius"
        )),
        ForceLaw::Table(table) if indentation > table.end() => notes.push(format!(
            "contact.table ends at an indentation of {} m, and a rigid wall would stop the impactor at about {indentation:.3e} m: the run \
             stops where the table does",
            table.end()
        )),
        ForceLaw::Table(table) if indentation < LEAST_OF_TABLE * table.end() => notes.push(format!(
            "a rigid wall would stop the impactor at an indentation of {indentation:.3e} m, and contact.table goes to {} m: is the \
             table in m and N?",
            table.end()
        )),
        _ => {}
    }
    if impactor.gap > impactor.speed * scene.time.end {
        notes.push("the gap is wider than the impactor's way to time.end".to_owned());
    }
    notes
}
