//! Facts about a scene: body, supports, impactor, loads and time; and the section of a report with them and the full text.

use crate::contact::ForceLaw;
use crate::form;
use crate::impact::{Plan, steps};
use crate::material::Material;
use crate::scene::{
    Body, Geometry, Impactor, Initial, Layer, Measure, Parts, STANDARD_GRAVITY, Scene, Scheme, Support, SupportKind,
    Symmetry, Within,
};

use super::data::Data;
use super::number::{
    FORCE, LENGTH, MASS, MODULUS, SPEED, STRESS, TIME, by_component, computed, digits, given, plain, vector, with_unit,
};
use super::page::{Block, Fact, Section};
use super::relaxation;

/// Makes the section.
pub fn section(data: &Data) -> Section {
    let mut parts = Vec::new();
    match &data.scene {
        Ok(scene) => {
            parts.push(facts("Body and material", body(scene), ""));
            parts.extend(relaxation::tables(&scene.body));
            parts.push(facts("Supports", supports(scene), "none. The body is free"));
            parts.push(facts("Impactor and contact", impactor(scene), ""));
            parts.push(facts("Loads", loads(scene), "none but the impact"));
            parts.push(facts("Time", time(scene, None), ""));
        }
        Err(reason) => parts.push(Block::Text(format!(
            "This version of ricochet cannot read the scene ({reason}), so it is given by its text alone."
        ))),
    }
    let text = data.provenance.origin.scene.trim_end().to_owned();
    parts.push(Block::Fold { title: "Full text of the scene (TOML, SI units)", text });
    Section { id: "scene", title: "Scene", parts }
}

/// A table of facts; where there are none, a text that says so.
fn facts(caption: &'static str, rows: Vec<Fact>, none: &str) -> Block {
    if rows.is_empty() {
        return Block::Text(format!("{caption}: {none}."));
    }
    Block::Facts { caption, rows }
}

/// Shape and size of a body in a few words.
pub fn shape(body: &Body) -> String {
    match &body.geometry {
        Geometry::Box { size, .. } => {
            let [x, y, z] = size.map(plain);
            with_unit(format!("box of {x} × {y} × {z}"), "m")
        }
        Geometry::Gmsh(path) => {
            format!("body of the mesh {}", path.file_name().unwrap_or(path.as_os_str()).to_string_lossy())
        }
    }
}

/// Facts about the body.
pub fn body(Scene { body, strength, .. }: &Scene) -> Vec<Fact> {
    let mut rows = vec![Fact::new("Body", shape(body))];
    rows.extend(body.mass().map(|mass| Fact::new("Mass", computed(mass, MASS))));
    match &body.composition.parts {
        Parts::Whole(material) => rows.push(Fact::new("Material", constants(material))),
        Parts::Layers(layers) => rows.extend((1..).zip(layers).map(|(number, Layer { name, thickness, material })| {
            let thickness = given(*thickness, LENGTH);
            Fact::new(format!("Layer {number} ({name})"), format!("{thickness} thick, {}", constants(material)))
        })),
        Parts::Volumes(volumes) => {
            rows.extend(
                volumes.iter().map(|(name, material)| Fact::new(format!("Volume {name}"), constants(material))),
            );
        }
    }
    rows.extend(body.temperature.map(|at| Fact::new("Temperature", with_unit(plain(at), "°C"))));
    let of_all = strength.tension.map(|strength| given(strength, STRESS));
    let of_faces = strength.by_face.iter().map(|(face, of)| format!("{} on the face {face}", given(*of, STRESS)));
    let strengths: Vec<String> = of_all.into_iter().chain(of_faces).collect();
    if !strengths.is_empty() {
        rows.push(Fact::new("Strength", strengths.join(", ")));
    }
    match &body.symmetry {
        Symmetry::Quarter { .. } => {
            rows.push(Fact::new("Symmetry", "body, supports and impact are symmetric; a quarter may be solved"));
        }
        Symmetry::None { reason: Some(reason) } | Symmetry::Parts { reason, .. } => {
            rows.push(Fact::new("Symmetry", format!("none: {reason}")));
        }
        Symmetry::None { reason: None } => {}
    }
    rows
}

/// Elastic constants and density; the instantaneous constants (t → 0) and the range of the shear modulus if the material is
/// viscoelastic.
fn constants(material: &Material) -> String {
    let form::Material { young, poisson, density } = material.instantaneous;
    // The constants computed from the moduli of a chain would otherwise be written with all their digits.
    let (when, young, poisson) = match material.shear {
        None => ("", given(young, MODULUS), plain(poisson)),
        Some(_) => (" at t → 0", computed(young, MODULUS), digits(poisson, 4)),
    };
    let chain = material.shear.as_ref().map_or(String::new(), |shear| {
        format!(
            ", bulk modulus {}, shear modulus from {} at t → 0 down to {} (Maxwell chain, terms: {})",
            given(material.instantaneous.bulk(), MODULUS),
            computed(shear.instantaneous(), MODULUS),
            given(shear.equilibrium, MODULUS),
            shear.terms.len()
        )
    });
    let density = with_unit(plain(density), "kg/m³");
    format!("Young’s modulus{when} {young}, Poisson’s ratio{when} {poisson}, density {density}{chain}")
}

/// Facts about the supports, by surface.
pub fn supports(scene: &Scene) -> Vec<Fact> {
    let described = |Support { surface, within, kind, damping, displacement }: &Support| {
        let mut value = match kind {
            SupportKind::Elastic { stiffness } => format!("springs of {}", by_component(*stiffness, "N/m³")),
            SupportKind::Pad { stiffness, normal } => {
                let stiffness = by_component(*stiffness, "N/m³");
                format!("pad of {stiffness}, compression only, towards {}", vector(*normal, ""))
            }
            SupportKind::Clamped { components } => {
                let all = ["x", "y", "z"].into_iter().zip(components);
                format!(
                    "held in {}",
                    all.filter(|(_, held)| **held).map(|(name, _)| name).collect::<Vec<_>>().join(", ")
                )
            }
        };
        if *damping != [0.0; 3] {
            value += &format!(", damping {}", by_component(*damping, "N s/m³"));
        }
        if *displacement != [0.0; 3] {
            value += &format!(", displaced by {}", vector(*displacement, "m"));
        }
        Fact::new(place(surface, *within), value)
    };
    scene.supports.iter().map(described).collect()
}

/// Name of a surface, or description of a part of it.
fn place(surface: &str, within: Option<Within>) -> String {
    match within {
        None => surface.to_owned(),
        Some(Within::Rim(width)) => format!("{surface}, a strip of {} along its edges", given(width, LENGTH)),
        Some(Within::Box([low, high])) => {
            format!("{surface}, from {} to {}", vector(low, "m"), vector(high, "m"))
        }
        Some(Within::Ball { centre, radius }) => {
            format!("{surface}, within {} of {}", given(radius, LENGTH), vector(centre, "m"))
        }
    }
}

/// Facts about the impactor and its contact.
pub fn impactor(Scene { impactor, contact, .. }: &Scene) -> Vec<Fact> {
    let mut rows = vec![Fact::new("Mass", given(impactor.mass, MASS))];
    if let Some(radius) = impactor.radius {
        rows.push(Fact::new("Radius of its surface", given(radius, LENGTH)));
    }
    rows.push(Fact::new("Speed", drop(impactor.speed)));
    rows.push(Fact::new("Impact point", vector(impactor.point, "m")));
    // Rounded to remove digits that come from normalising the vector.
    rows.push(Fact::new("Direction", vector(impactor.direction.map(|d| (1e6 * d).round() / 1e6), "")));
    if impactor.gap != 0.0 {
        rows.push(Fact::new("Gap at the start", given(impactor.gap, LENGTH)));
    }
    if impactor.gravity != 0.0 {
        rows.push(Fact::new("Weight", "acts during the run"));
    }
    rows.push(Fact::new("Contact law", law(impactor)));
    if let Some(area) = contact.area() {
        rows.push(Fact::new("Contact", format!("presses {area}")));
    }
    if impactor.damping != 0.0 {
        rows.push(Fact::new("Contact damping (Hunt & Crossley)", with_unit(plain(impactor.damping), "s/m")));
    }
    rows
}

/// A speed (m/s) with up to four digits: one that follows from a drop height has many.
fn short_speed(speed: f64) -> String {
    given(format!("{speed:.3e}").parse().unwrap_or(speed), SPEED)
}

/// A speed, with the height of the free fall that leads to it.
fn drop(speed: f64) -> String {
    let height = speed * speed / (2.0 * STANDARD_GRAVITY);
    format!("{} (as after a fall of {})", short_speed(speed), computed(height, LENGTH))
}

fn law(impactor: &Impactor) -> String {
    match &impactor.force_law {
        ForceLaw::Hertz(law) => {
            // Rounded, because most scenes let the program compute the stiffness from the materials.
            let stiffness = with_unit(digits(law.stiffness, 4), "N/m^1.5");
            let layered = match impactor.layered_contact() {
                Some(_) => {
                    "; plates, and spline solids without contact.patch_radius, use the law of a sphere on the layers instead"
                }
                None => "",
            };
            format!("Hertz, F = k₀ α^1.5 with k₀ = {stiffness}{layered}")
        }
        ForceLaw::Power(law) => {
            let exponent = plain(law.exponent);
            format!("F = k α^{exponent} with k = {}", with_unit(plain(law.stiffness), &format!("N/m^{exponent}")))
        }
        ForceLaw::Table(table) => {
            let points = table.points();
            let force = points.last().map_or(0.0, |point| point[1]);
            format!("table of {} points, up to {} at {}", points.len(), given(force, FORCE), given(table.end(), LENGTH))
        }
    }
}

/// Facts about the loads beside the impact.
pub fn loads(Scene { load, .. }: &Scene) -> Vec<Fact> {
    let of_body = [("Body force", load.body_force, "N/m³"), ("Gravity", load.gravity, "m/s²")];
    let of_body = of_body.into_iter().filter(|(_, value, _)| *value != [0.0; 3]);
    let of_body = of_body.map(|(name, value, unit)| Fact::new(name, vector(value, unit)));
    let tractions = load.traction.iter();
    let tractions = tractions
        .map(|of| Fact::new(format!("Traction on {}", place(&of.surface, of.within)), vector(of.value, "N/m²")));
    of_body.chain(tractions).collect()
}

/// Facts about the time and its steps: those of a plan, or, without one, those that the scene asks for.
pub fn time(scene: &Scene, plan: Option<&Plan>) -> Vec<Fact> {
    let time = &scene.time;
    let initial = match time.initial {
        Initial::Rest => "at rest, undeformed",
        Initial::Equilibrium => "at rest, deformed by its loads and supports",
    };
    let scheme = match time.scheme {
        _ if time.modal => "modal coordinates, exact in the linear part".to_owned(),
        Scheme::Newmark { beta, gamma } => format!("Newmark, β = {}, γ = {}", plain(beta), plain(gamma)),
        Scheme::GeneralizedAlpha { rho_inf } => format!("generalised-α, ρ∞ = {}", plain(rho_inf)),
        Scheme::Energy => "energy-conserving midpoint rule".to_owned(),
        Scheme::CentralDifference { .. } => "central difference, lumped mass".to_owned(),
    };
    let of_peak = match scene.measure {
        Measure::Acceleration => "the peak acceleration",
        Measure::Stress => "the largest tension",
        Measure::Deflection => "the largest deflection",
    };
    let of_time = match (plan, time.step) {
        (Some(Plan::Equal { step }), _) => format!("{} of {}", steps(time.end, *step), given(*step, TIME)),
        (None, Some(step)) => format!("{} each", given(step, TIME)),
        _ => format!("chosen for an error of {} of {of_peak}", plain(scene.tolerance)),
    };
    vec![
        Fact::new("Duration", given(time.end, TIME)),
        Fact::new("Body at the start", initial),
        Fact::new("Integration", scheme),
        Fact::new("Steps", of_time),
    ]
}

/// Describes the impact in a sentence.
pub fn sentence(scene: &Scene) -> String {
    let Impactor { mass, radius, speed, point, .. } = &scene.impactor;
    let surface = radius.map_or(String::new(), |radius| format!(" with a surface radius of {}", given(radius, LENGTH)));
    let supports = match scene.supports.len() {
        0 => "The body is free.".to_owned(),
        1 => "The body has one support.".to_owned(),
        count => format!("The body has {count} supports."),
    };
    format!(
        "A rigid impactor of {}{surface} hits a {} at {}, at the point {}. {supports}",
        given(*mass, MASS),
        shape(&scene.body),
        short_speed(*speed),
        vector(*point, "m")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wrong units are seen from the facts about layers, strengths, loads and steps.
    #[test]
    fn facts_have_their_units() {
        let text = "[body]\nsize = [0.5, 0.5]\ntemperature = 20.0\n[[body.layer]]\nthickness = 0.01\nmaterial = \"soft\"\n\
             [material.soft]\ndensity = 1100\nbulk = 2e9\nshear = 1e6\nprony = [{ modulus = 4e7, time = 1e-4 }]\n\
             wlf = { c1 = 20.0, c2 = 90.0, reference = 20.0 }\n[strength]\ntension = 45e6\nface = { upper = 9e4 }\n\
             [load]\ngravity = [0, 0, -9.81]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1e3]\n\
             [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e8\nspeed = 1.0\n[time]\nend = 1e-3\n";
        let scene = Scene::parse("scene", text, &[]).unwrap_or_else(|error| panic!("{error}")).0;
        let plan = Plan::Equal { step: 2e-6 };
        let facts: Vec<Fact> = [body(&scene), loads(&scene), time(&scene, Some(&plan))].into_iter().flatten().collect();
        let value = |name: &str| {
            let fact = facts.iter().find(|fact| fact.name == name).unwrap_or_else(|| panic!("{name}: {facts:?}"));
            fact.value.replace('\u{a0}', " ").replace('\u{2212}', "-")
        };
        assert!(
            value("Layer 1 (soft)")
                .ends_with("shear modulus from 41.00 MPa at t → 0 down to 1 MPa (Maxwell chain, terms: 1)")
        );
        let others = ["Temperature", "Strength", "Gravity", "Traction on top", "Steps"].map(value);
        let wanted =
            ["20 °C", "45 MPa, 90 kPa on the face upper", "(0, 0, -9.81) m/s²", "(0, 0, -1000) N/m²", "500 of 2 µs"];
        assert_eq!(others, wanted);
    }
}
