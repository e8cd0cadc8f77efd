//! Prints a report as lines of text.

use crate::contact::{Footprint, ForceLaw, Reason};
use crate::description::{Description, Part, Portion};
use crate::form;
use crate::impact::{Plan, steps};
use crate::material::Material;
use crate::mesh::{Measures, Surface};
use crate::model;
use crate::scene::{
    Contact, Geometry, Impactor, Layer, Parts, Scene, Scheme, Strength, Support, SupportKind, Symmetry, Vec3, Within,
};

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
    let geometry = match &scene.body.geometry {
        Geometry::Box { size, .. } => {
            // Rounded to a nanometre: a thickness may be a sum with rounding.
            let [x, y, z] = size.map(|edge| (1e9 * edge).round() / 1e9);
            format!("box {x} × {y} × {z} m")
        }
        Geometry::Gmsh(path) => path.display().to_string(),
    };
    let mass = mass.map_or(String::new(), |mass| format!(", {} kg", kilograms(mass)));
    say(format_args!("body       {geometry}{mass}"));
    if let Some(measures) = measures {
        print_measures(measures);
    }
    for line in materials(scene) {
        say(format_args!("material   {line}"));
    }
    if let Some(line) = strengths(&scene.strength) {
        say(format_args!("strength   {line}"));
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
    match &scene.body.symmetry {
        Symmetry::Quarter { .. } => say(format_args!("symmetry   quarter-symmetry model")),
        Symmetry::None { reason: Some(reason) } | Symmetry::Parts { reason, .. } => {
            say(format_args!("symmetry   none: {reason}"))
        }
        Symmetry::None { reason: None } => {}
    }
    if scene.supports.is_empty() {
        say(format_args!("supports   none: a free body"));
    }
    for support in &scene.supports {
        say(format_args!("support    {}", support_line(support)));
    }
    let load = &scene.load;
    for line in relaxations(scene) {
        say(format_args!("relaxation {line}"));
    }
    let struck = scene.body.struck();
    let force = load.force_on(scene.body.composition.density().unwrap_or(struck.density));
    if force != [0.0; 3] {
        say(format_args!("load       body force {force:?} N/m³"));
    }
    for traction in &load.traction {
        let place = place(&traction.surface, traction.within);
        say(format_args!("load       {place}: traction {:?} N/m²", traction.value));
    }
}

/// Descriptions of the materials: of the whole body, of the layers from the top down, or of the volumes of a mesh.
fn materials(scene: &Scene) -> Vec<String> {
    let at = scene.body.temperature.map_or(String::new(), |temperature| format!(" at {temperature} °C"));
    let words = |material: &Material| {
        let form::Material { young, poisson, density } = material.instantaneous;
        match &material.shear {
            None => format!("E = {}, ν = {}, ρ = {density} kg/m³", pascals(young), rounded(poisson)),
            Some(shear) => format!(
                "K = {}, G from {} down to {} (Maxwell chain, terms: {}){at}, ρ = {density} kg/m³",
                pascals(material.instantaneous.bulk()),
                pascals(shear.instantaneous()),
                pascals(shear.equilibrium),
                shear.terms.len()
            ),
        }
    };
    match &scene.body.composition.parts {
        Parts::Whole(material) => vec![words(material)],
        Parts::Layers(layers) => (1..)
            .zip(layers)
            .map(|(number, Layer { thickness, name, material })| {
                format!("layer {number}, {} mm of {name}: {}", rounded(1e3 * thickness), words(material))
            })
            .collect(),
        Parts::Volumes(volumes) => {
            volumes.iter().map(|(name, material)| format!("{name:?}: {}", words(material))).collect()
        }
    }
}

/// Description of the strengths; `None` if none is given.
fn strengths(strength: &Strength) -> Option<String> {
    let of_all = strength.tension.map(pascals);
    let of_faces = strength.by_face.iter().map(|(face, value)| format!("{} on {face:?}", pascals(*value)));
    let all: Vec<String> = of_all.into_iter().chain(of_faces).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

/// Formats a stress, Pa, in the unit that engineers write.
fn pascals(value: f64) -> String {
    let (unit, size) = [("GPa", 1e9), ("MPa", 1e6)].into_iter().find(|(_, size)| value >= *size).unwrap_or(("Pa", 1.0));
    format!("{} {unit}", rounded(value / size))
}

/// A number with at most four decimals.
fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}

/// Prints the bounds, the volume and the surfaces of a mesh, so that the user can compare them with the intended
/// geometry.
fn print_measures(measures: &Measures) {
    let [[x0, y0, z0], [x1, y1, z1]] = measures.bounds.map(|corner| corner.map(short));
    say(format_args!("           x {x0} to {x1} m, y {y0} to {y1} m, z {z0} to {z1} m; {} m³", short(measures.volume)));
    for Surface { name, area } in &measures.surfaces {
        say(format_args!("surface    {name:?}: {} m²", short(*area)));
    }
    say(format_args!("           whole boundary: {} m²", short(measures.area)));
}

/// Description of the contact law.
fn law(impactor: &Impactor) -> String {
    let law = match &impactor.force_law {
        ForceLaw::Hertz(law) => format!("k0 = {:.4e} N/m^1.5", law.stiffness),
        ForceLaw::Power(law) => format!("F = {:.4e} N/m^{e} · indentation^{e}", law.stiffness, e = law.exponent),
        ForceLaw::Table(table) => {
            format!("force by a table of {} points up to {} m", table.points().len(), short(table.end()))
        }
    };
    let law = match impactor.damping {
        0.0 => law,
        damping => format!("{law}, damping {damping} s/m"),
    };
    match impactor.layered_contact() {
        Some(_) => format!(
            "{law}; plates, and spline solids without contact.patch_radius, use the law of a sphere on the layers instead"
        ),
        None => law,
    }
}

fn print_contact(scene: &Scene, footprint: Option<Footprint>) {
    let impactor = &scene.impactor;
    let [x, y, z] = impactor.direction.map(|d| (1e6 * d).round() / 1e6);
    say(format_args!(
        "impactor   {} kg at {} m/s{}{}, {}, at [{}] along [{x}, {y}, {z}]",
        impactor.mass,
        short(impactor.speed),
        if impactor.gap == 0.0 { String::new() } else { format!(", {} m away", plain(impactor.gap)) },
        if impactor.gravity == 0.0 { "" } else { ", with its weight" },
        law(impactor),
        impactor.point.map(plain).join(", ")
    ));
    say(format_args!(
        "contact    for comparison, on a half-space: {:.4} ms, peak {:.0} N; a body that bends has a lower peak",
        1e3 * contact_time(scene),
        impactor.peak_force()
    ));
    match &scene.contact {
        Contact::Point => say(format_args!("           at a point")),
        Contact::Area(area) => say(format_args!("           presses {area}")),
        Contact::Patch { .. } => {}
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
    let scheme = match scene.time.scheme {
        _ if scene.time.modal => "modal coordinates, the linear part exact".to_owned(),
        scheme => described(scheme),
    };
    let (end, contact) = (scene.time.end, contact_time(scene));
    match plan {
        Some(Plan::Equal { step }) => say(format_args!(
            "time       {scheme}: {} steps of {step:.4e} s to {end:e} s, {:.0} in that contact",
            steps(end, *step),
            contact / step
        )),
        Some(Plan::Controlled { first, tolerance }) => say(format_args!(
            "time       {scheme}, to {end:e} s in steps chosen for an error of {tolerance:e} of the peak, {first:.2e} s at first in contact"
        )),
        None => say(format_args!(
            "time       {scheme}, to {end:e} s in steps chosen for an error of {:e} of the peak",
            scene.tolerance
        )),
    }
}

fn described(scheme: Scheme) -> String {
    match scheme {
        Scheme::Newmark { beta, gamma } => format!("Newmark β = {beta}, γ = {gamma}"),
        Scheme::GeneralizedAlpha { rho_inf } => format!("generalised-α with ρ∞ = {rho_inf}"),
        Scheme::Energy => "energy-conserving midpoint rule".to_owned(),
        Scheme::CentralDifference { .. } => "central difference with lumped mass".to_owned(),
    }
}

/// A number of the scene without rounding errors.
fn plain(value: f64) -> String {
    let rounded = format!("{value:.9e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e6).contains(&f64::abs(rounded)) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}

/// Formats a mass, kg: to a tenth of a gram, with a power of ten if it is very small or large.
fn kilograms(mass: f64) -> String {
    if (1e-2..1e6).contains(&mass) { format!("{mass:.4}") } else { short(mass) }
}

/// Duration of a contact on a half-space, s.
pub(super) fn contact_time(scene: &Scene) -> f64 {
    scene.impactor.contact_time()
}

/// Description of a surface or of a part of it.
fn place(surface: &str, within: Option<Within>) -> String {
    match within {
        None => surface.to_owned(),
        Some(Within::Rim(width)) => format!("{surface}, along its edges {width} m wide"),
        Some(Within::Box([low, high])) => format!("{surface}, from {low:?} to {high:?} m"),
        Some(Within::Ball { centre, radius }) => format!("{surface}, within {radius} m of {centre:?}"),
    }
}

pub(super) fn support_line(support: &Support) -> String {
    let Support { surface, within, kind, damping, displacement } = support;
    let surface = place(surface, *within);
    let mut line = match kind {
        SupportKind::Elastic { stiffness } => format!("{surface}: elastic, k = {} N/m³", by_component(*stiffness)),
        SupportKind::Pad { stiffness, normal } => {
            format!("{surface}: pad towards {normal:?}, k = {} N/m³", by_component(*stiffness))
        }
        SupportKind::Clamped { components } => {
            let held: Vec<&str> =
                ["x", "y", "z"].into_iter().zip(components).filter(|(_, h)| **h).map(|(c, _)| c).collect();
            format!("{surface}: clamped in {}", held.join(", "))
        }
    };
    if *damping != [0.0; 3] {
        line += &format!(", c = {} N s/m³", by_component(*damping));
    }
    if *displacement != [0.0; 3] {
        line += &format!(", ū = {displacement:?} m");
    }
    line
}

/// One number if all components are equal, otherwise all three.
fn by_component(values: Vec3) -> String {
    if values.iter().all(|value| *value == values[0]) {
        format!("{:e}", values[0])
    } else {
        format!("[{}]", values.map(plain).join(", "))
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_has_few_digits() {
        let shown = [12.5, 16.2e9, 3e-6].map(kilograms);
        assert_eq!(shown, ["12.5000", "1.6200e10", "3.0000e-6"]);
    }

    /// Wrong units are seen from the materials of layers and from the strengths.
    #[test]
    fn materials_and_strengths_are_shown_with_their_units() {
        let text = "[body]\nsize = [0.5, 0.5]\n[[body.layer]]\nthickness = 0.01\nmaterial = \"glass\"\n\
             [[body.layer]]\nthickness = 0.00076\nmaterial = \"soft\"\n\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\n\
             [material.soft]\ndensity = 1100\nbulk = 2e9\nshear = 1e6\nprony = [{ modulus = 4e7, time = 1e-4 }]\n\
             [strength]\ntension = 45e6\nface = { 1-upper = 9e5 }\n\
             [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e8\nspeed = 1.0\n[time]\nend = 1e-3\n";
        let scene = Scene::parse("scene", text, &[]).expect("a scene").0;
        let glass = "layer 1, 10 mm of glass: E = 70 GPa, ν = 0.23, ρ = 2500 kg/m³";
        let soft = "layer 2, 0.76 mm of soft: K = 2 GPa, G from 41 MPa down to 1 MPa (Maxwell chain, terms: 1), ρ = 1100 kg/m³";
        assert_eq!(materials(&scene), [glass, soft]);
        assert_eq!(strengths(&scene.strength).as_deref(), Some("45 MPa, 900000 Pa on \"1-upper\""));
    }
}
