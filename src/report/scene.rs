//! Section of a report with the scene: body, supports, impactor, loads, time, and the full text.

use crate::contact::ForceLaw;
use crate::form;
use crate::material::Material;
use crate::scene::{
    Body, Geometry, Impactor, Initial, Parts, STANDARD_GRAVITY, Scene, Scheme, Support, SupportKind, Symmetry, Vec3,
    Within,
};

use super::data::Data;
use super::number::{
    FORCE, LENGTH, MASS, MODULUS, SPEED, TIME, by_component, computed, digits, given, percent, plain, vector, with_unit,
};
use super::page::{Block, Column, Fact, Facts, Fold, Section, Table};
use super::relaxation;

/// Makes the section.
pub fn section(data: &Data) -> Section {
    let mut parts = Vec::new();
    match &data.scene {
        Ok(scene) => {
            parts.push(facts("Body and material", body(&scene.body)));
            parts.extend(relaxation::tables(&scene.body));
            parts.push(supports(&scene.supports));
            parts.push(facts("Impactor and contact", impactor(scene)));
            parts.push(loads(scene));
            parts.push(facts("Time", time(scene)));
        }
        Err(reason) => parts.push(Block::Text(format!(
            "This version of ricochet cannot read the scene ({reason}), so it is given by its text alone."
        ))),
    }
    let text = data.provenance.origin.scene.trim_end().to_owned();
    parts.push(Block::Fold(Fold { title: "Full text of the scene (TOML, SI units)".to_owned(), text }));
    Section { id: "scene", title: "Scene", parts }
}

fn facts(caption: &str, rows: Vec<Fact>) -> Block {
    Block::Facts(Facts { caption: caption.to_owned(), rows })
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

fn body(body: &Body) -> Vec<Fact> {
    let mut rows = vec![Fact::new("Body", shape(body))];
    if let Some(mass) = body.mass() {
        rows.push(Fact::new("Mass", computed(mass, MASS)));
    }
    match &body.composition.parts {
        Parts::Whole(material) => rows.extend(constants("", material)),
        Parts::Layers(layers) => {
            for (number, layer) in layers.iter().enumerate() {
                let prefix = format!("Layer {} ({}): ", number + 1, layer.name);
                rows.push(Fact::new(format!("{prefix}thickness"), given(layer.thickness, LENGTH)));
                rows.extend(constants(&prefix, &layer.material));
            }
        }
        Parts::Volumes(volumes) => {
            for (name, material) in volumes {
                rows.extend(constants(&format!("{name}: "), material));
            }
        }
    }
    if let Symmetry::Quarter { .. } = body.symmetry {
        rows.push(Fact::new("Symmetry", "body, supports and impact are symmetric; a quarter may be solved"));
    }
    rows
}

/// Elastic constants and density of a part of the body; the instantaneous constants (t → 0) if it is viscoelastic.
fn constants(part: &str, material: &Material) -> [Fact; 3] {
    let form::Material { young, poisson, density } = material.instantaneous;
    // The constants computed from the moduli of a chain would otherwise be written with all their digits.
    let (when, young, poisson) = match material.shear {
        None => ("", given(young, MODULUS), plain(poisson)),
        Some(_) => (" at t → 0", computed(young, MODULUS), digits(poisson, 4)),
    };
    [
        Fact::new(format!("{part}Young’s modulus{when}"), young),
        Fact::new(format!("{part}Poisson’s ratio{when}"), poisson),
        Fact::new(format!("{part}Density"), with_unit(plain(density), "kg/m³")),
    ]
}

fn supports(supports: &[Support]) -> Block {
    if supports.is_empty() {
        return Block::Text("Supports: none. The body is free.".to_owned());
    }
    let is_damped = supports.iter().any(|support| support.damping != [0.0; 3]);
    let is_moved = supports.iter().any(|support| support.displacement != [0.0; 3]);
    let mut columns = vec![Column::text("Surface"), Column::text("Kind"), Column::text("Stiffness")];
    columns.extend(is_damped.then(|| Column::text("Damping")));
    columns.extend(is_moved.then(|| Column::text("Displacement")));
    let rows = supports.iter().map(|support| {
        let (kind, stiffness) = match &support.kind {
            SupportKind::Elastic { stiffness } => ("springs".to_owned(), by_component(*stiffness, "N/m³")),
            SupportKind::Pad { stiffness, normal } => {
                (format!("pad, compression only, towards {}", vector(*normal, "")), by_component(*stiffness, "N/m³"))
            }
            SupportKind::Clamped { components } => (format!("held in {}", held(*components)), "rigid".to_owned()),
        };
        let mut row = vec![place(&support.surface, support.within), kind, stiffness];
        let some = |values: Vec3, text: String| if values == [0.0; 3] { "none".to_owned() } else { text };
        row.extend(is_damped.then(|| some(support.damping, by_component(support.damping, "N s/m³"))));
        row.extend(is_moved.then(|| some(support.displacement, vector(support.displacement, "m"))));
        row
    });
    Block::Table(Table { caption: "Supports".to_owned(), columns, rows: rows.collect() })
}

fn held(components: [bool; 3]) -> String {
    let names: Vec<&str> =
        ["x", "y", "z"].into_iter().zip(components).filter(|(_, held)| *held).map(|(name, _)| name).collect();
    names.join(", ")
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

fn impactor(Scene { impactor, contact, .. }: &Scene) -> Vec<Fact> {
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
    rows.push(Fact::new("Contact law", law(&impactor.force_law)));
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

fn law(law: &ForceLaw) -> String {
    match law {
        ForceLaw::Hertz(law) => {
            // Rounded, because most scenes let the program compute the stiffness from the materials.
            let stiffness = digits(law.stiffness, 4);
            format!("Hertz, F = k₀ α^1.5 with k₀ = {}", with_unit(stiffness, "N/m^1.5"))
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

fn loads(scene: &Scene) -> Block {
    let load = &scene.load;
    let mut rows = Vec::new();
    if load.body_force != [0.0; 3] {
        rows.push(Fact::new("Whole body", vector(load.body_force, "N/m³")));
    }
    if load.gravity != [0.0; 3] {
        rows.push(Fact::new("Gravity", vector(load.gravity, "m/s²")));
    }
    for traction in &load.traction {
        rows.push(Fact::new(place(&traction.surface, traction.within), vector(traction.value, "N/m²")));
    }
    if rows.is_empty() {
        return Block::Text("Loads: none but the impact.".to_owned());
    }
    facts("Loads beside the impact", rows)
}

fn time(scene: &Scene) -> Vec<Fact> {
    let time = &scene.time;
    let initial = match time.initial {
        Initial::Rest => "at rest, undeformed",
        Initial::Equilibrium => "at rest, deformed by its loads and supports",
    };
    let scheme = match time.scheme {
        _ if time.modal => "modal coordinates; the linear part is exact".to_owned(),
        Scheme::Newmark { beta, gamma } => format!("Newmark, β = {}, γ = {}", plain(beta), plain(gamma)),
        Scheme::GeneralizedAlpha { rho_inf } => format!("generalised-α, ρ∞ = {}", plain(rho_inf)),
        Scheme::Energy => "energy-conserving midpoint rule".to_owned(),
        Scheme::CentralDifference { .. } => "central difference, lumped mass".to_owned(),
    };
    let steps = match time.step {
        Some(step) => format!("{} each", given(step, TIME)),
        None => {
            format!("chosen for an error of {} of the peak acceleration in the first contact", percent(scene.tolerance))
        }
    };
    vec![
        Fact::new("Duration", given(time.end, TIME)),
        Fact::new("Body at the start", initial),
        Fact::new("Integration", scheme),
        Fact::new("Steps", steps),
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
        where_hit(*point)
    )
}

fn where_hit(point: Vec3) -> String {
    vector(point, "m")
}
