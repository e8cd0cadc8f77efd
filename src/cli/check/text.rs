//! Prints a report as lines of text.

use crate::contact::{Footprint, Reason};
use crate::description::{Description, Part, Portion};
use crate::impact::Plan;
use crate::mesh::{Measures, Surface};
use crate::model;
use crate::report::{Fact, scene as facts};
use crate::scene::{Contact, Scene};

use super::super::notes::describe_model;
use super::super::{say, short};
use super::Report;
use super::cost::Cost;

/// Prints a report.
pub(super) fn print(report: &Report) {
    let Report { scene, model, plan, warnings, notes, cost, .. } = report;
    for warning in warnings {
        say(format_args!("warning    {warning}"));
    }
    print_scene(report);
    print_contact(scene, model.as_ref().ok().map(|model| model.dynamics.footprint()));
    print_time(scene, plan.as_ref());
    for note in notes {
        say(format_args!("note       {note}"));
    }
    if let Some(Cost { solver, memory, fields }) = cost {
        say(format_args!("solver     {solver}"));
        if let Some(memory) = memory {
            say(format_args!("memory     {memory}"));
        }
        if let Some(bytes) = fields {
            say(format_args!("fields     about {:.0} MB more, on rank 0", 1e-6 * bytes));
        }
    }
}

fn print_scene(report: &Report) {
    let Report { scene, model, mass, measures, .. } = report;
    if !scene.title.is_empty() {
        say(format_args!("{}", scene.title));
    }
    for Fact { name, value, .. } in facts::body(scene) {
        say(format_args!("{:<10} {}", in_sentence(&name), in_terminal(&value)));
    }
    if let Some(mass) = mass.filter(|_| scene.body.mass().is_none()) {
        say(format_args!("mass       {} kg", short(mass)));
    }
    if let Some(measures) = measures {
        print_measures(measures);
    }
    match model {
        Ok(model) => {
            say(format_args!("model      {}", describe_model(model, scene)));
            if let Some(reason) = &model.reason {
                say(format_args!("           {reason}"));
            }
        }
        Err(reason) => say(format_args!("model      {}: {reason}", model::name(scene.body.model))),
    }
    if scene.supports.is_empty() {
        say(format_args!("supports   none: a free body"));
    }
    for line in support_lines(scene) {
        say(format_args!("support    {line}"));
    }
    for line in relaxations(scene) {
        say(format_args!("relaxation {line}"));
    }
    for Fact { name, value, .. } in facts::loads(scene) {
        say(format_args!("load       {}", in_terminal(&format!("{name}: {value}"))));
    }
}

/// Descriptions of the supports.
pub(super) fn support_lines(scene: &Scene) -> Vec<String> {
    facts::supports(scene).iter().map(|Fact { name, value, .. }| in_terminal(&format!("{name}: {value}"))).collect()
}

/// Facts in one line.
fn joined(facts: Vec<Fact>) -> String {
    let all = facts.iter().map(|Fact { name, value, .. }| format!("{} {value}", in_sentence(name)));
    in_terminal(&all.collect::<Vec<_>>().join("; "))
}

/// Name of a fact without a capital at its beginning.
fn in_sentence(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

/// Text without the characters that a page has for the sake of its typography.
fn in_terminal(text: &str) -> String {
    text.replace('\u{a0}', " ").replace('\u{2212}', "-").replace('’', "'")
}

/// Prints the bounds, the volume and the surfaces of a mesh, so that the user can compare them with the intended
/// geometry.
fn print_measures(measures: &Measures) {
    let [[x0, y0, z0], [x1, y1, z1]] = measures.bounds.map(|corner| corner.map(short));
    say(format_args!("bounds     x {x0} to {x1} m, y {y0} to {y1} m, z {z0} to {z1} m; {} m³", short(measures.volume)));
    for Surface { name, area } in &measures.surfaces {
        say(format_args!("surface    {name:?}: {} m²", short(*area)));
    }
    say(format_args!("           whole boundary: {} m²", short(measures.area)));
}

fn print_contact(scene: &Scene, footprint: Option<Footprint>) {
    let impactor = &scene.impactor;
    say(format_args!("impactor   {}", joined(facts::impactor(scene))));
    say(format_args!(
        "contact    for comparison, on a half-space: {:.4} ms, peak {:.0} N; a body that bends has a lower peak",
        1e3 * impactor.contact_time(),
        impactor.peak_force()
    ));
    if scene.contact == Contact::Point {
        say(format_args!("           at a point"));
    }
    let patch = footprint.and_then(Footprint::patch);
    let area = scene.contact.area().map(|area| area.half_width);
    let is_patch = |radius: f64| patch.is_some_and(|patch| patch.radius == radius) || area == Some(radius);
    if let Some(radius) = footprint.and_then(Footprint::disc).filter(|radius| !is_patch(*radius)) {
        say(format_args!("           force applied to the body over a disc of radius {} m", short(radius)));
    }
    let Some(patch) = patch.filter(|patch| patch.reason != Reason::Area) else { return };
    let reason = match patch.reason {
        Reason::Scene | Reason::Area => "as the scene says".to_owned(),
        Reason::Thickness => format!("a quarter of the thickness of {:.4} m", patch.thickness),
        Reason::Cells => format!("two cells of {:.4} m", patch.cell),
        Reason::Contact => "what the contact needs".to_owned(),
        Reason::Surface => "what has room on the surface".to_owned(),
    };
    say(format_args!(
        "patch      radius {:.4e} m, {reason}{}",
        patch.radius,
        match patch.error() {
            _ if patch.is_coarse() => "; the cells do not resolve it".to_owned(),
            Some(error) => format!("; it changes the force by about {error:.1e} of its peak"),
            None => String::new(),
        }
    ));
}

fn print_time(scene: &Scene, plan: Option<&Plan>) {
    let in_contact = match plan {
        Some(Plan::Equal { step }) => format!("; {:.0} steps in that contact", scene.impactor.contact_time() / step),
        Some(Plan::Controlled { first }) => format!("; {first:.2e} s at first in contact"),
        None => String::new(),
    };
    say(format_args!("time       {}{in_contact}", joined(facts::time(scene, plan))));
}

/// Description of the relaxation terms used for each viscoelastic part.
fn relaxations(scene: &Scene) -> Vec<String> {
    let words = |part: &Part| {
        let place = match &part.portion {
            Portion::All => "body".to_owned(),
            Portion::Layer([low, high]) => format!("layer from z = {low:.6} to {high:.6} m"),
            Portion::Volume(name) => format!("volume {name:?}"),
        };
        part.pruned.as_ref().map(|pruned| format!("{place}: {pruned}"))
    };
    Description::new(scene).parts.iter().filter_map(words).collect()
}
