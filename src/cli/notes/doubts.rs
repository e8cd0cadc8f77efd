//! Finds values of a scene that are allowed but probably a mistake. Most look as if they were given in another unit.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::form::Lame;
use crate::form::elastic::COMPRESSIBLE;
use crate::material::{Material, Maxwell};
use crate::scene::{Geometry, HOT, Layer, Parts, Scene, Source, Vec3, in_celsius, one_digit, show};

use super::Remark;

/// Smallest plausible Young's modulus, Pa. Rubber is stiffer.
const SOFT: f64 = 1e6;
/// Largest plausible Young's modulus, Pa. Diamond is softer.
const STIFF: f64 = 1e13;
/// Smallest plausible shear or bulk modulus, Pa: the shear modulus of an incompressible material with [`SOFT`].
const SOFT_SHEAR: f64 = SOFT / 3.0;

/// Shear modulus beside which Maxwell terms below 1 Pa are probably relative ones, Pa.
const RELATIVE: f64 = 1e3;

/// Smallest plausible strength, Pa. Foam is stronger.
const WEAK: f64 = 1e4;

/// Largest plausible strength, Pa. Steel, glass and concrete are weaker.
const STRONG: f64 = 5e9;

/// Thickness above which a layer is doubtful in any case, m.
const THICK: f64 = 5.0;
/// Thickness above which a layer is doubtful if it is also thick beside the edges and the other layers, m.
const THICK_BESIDE_OTHERS: f64 = 0.1;
/// Largest plausible thickness of a layer over the shorter edge, and over the thinnest layer. A doubtful layer exceeds
/// both: layered bars and blocks exceed one of them.
const THICK_FOR_EDGE: f64 = 0.4;
const THICK_FOR_LAYERS: f64 = 40.0;

/// Smallest plausible stiffness of a support, N/m³. A mattress is stiffer.
const SOFT_SUPPORT: f64 = 1e3;

/// Smallest plausible density, kg/m³. Foam is heavier.
const LIGHT: f64 = 25.0;
/// Largest plausible density, kg/m³. All metals are lighter.
const HEAVY: f64 = 25e3;

/// Radius of the impactor above which its density is checked, m.
const LARGE: f64 = 1.0;
/// Smallest plausible density of the impactor, kg/m³: its mass over the volume of a ball with its radius.
const HOLLOW: f64 = 10.0;

/// Largest plausible acceleration of the body by its loads, m/s².
const FORCED: f64 = 1e5;
/// Largest plausible ratio of a traction to Young's modulus.
const STRAINED: f64 = 0.1;

/// Longest plausible run, in contact times on a half-space.
const LONGEST_RUN: f64 = 5e3;

/// Remarks on the doubtful values of the scene of a source.
pub fn of_values(scene: &Scene, source: &Source) -> Vec<Remark> {
    let impactor = &scene.impactor;
    let contact = impactor.contact_time();
    let mut all = Vec::new();
    let mut doubt = |key: &str, excess: f64, what: String, help: String| {
        if excess > 1.0 {
            let error = source.error(key, what, help);
            all.push(Remark::new(key, excess, format!("{error}; {}", error.advice())));
        }
    };
    let materials = named(scene);
    let given = |name: &str, key: &str| source.number(&format!("material.{name}.{key}"));
    let parts = &scene.body.composition.parts;
    let whole = if let Parts::Whole(material) = parts { Some(material) } else { None };
    let of_young = || "Young's modulus is in Pa: 70 GPa are 70e9".to_owned();
    let of_body = whole.map(|material| material.instantaneous.young);
    let mut moduli =
        vec![("body.young".to_owned(), of_body), ("impactor.young".to_owned(), source.number("impactor.young"))];
    moduli.extend(materials.keys().map(|name| (format!("material.{name}.young"), given(name, "young"))));
    for (key, young) in moduli {
        let Some(young) = young else { continue };
        doubt(&key, SOFT / young, format!("{} Pa is softer than rubber", show(young)), of_young());
        if key != "impactor.young" {
            doubt(&key, young / STIFF, format!("{} Pa is stiffer than diamond", show(young)), of_young());
        }
    }
    for (name, material) in &materials {
        let Some(Maxwell { equilibrium, terms }) = &material.shear else { continue };
        let sum: f64 = terms.iter().map(|term| term.modulus).sum();
        let is_relative = !terms.is_empty() && sum <= 1.0;
        let what = format!(
            "the terms add up to {} Pa, and `shear` is {} Pa: are they relative?",
            show(sum),
            show(*equilibrium)
        );
        let help =
            "terms are moduli in Pa: multiply each relative one by the modulus at t = 0, and let `shear` be the rest"
                .to_owned();
        doubt(&format!("material.{name}.prony"), if is_relative { equilibrium / RELATIVE } else { 0.0 }, what, help);
        let reference = material.shift.map_or(0.0, |shift| shift.reference);
        let what = format!("{} °C is hotter than any interlayer bears", show(reference));
        doubt(&format!("material.{name}.wlf.reference"), reference / HOT, what, in_celsius(reference));
    }
    for (name, material) in &materials {
        let Some(shear) = given(name, "shear") else { continue };
        // The given shear modulus of a viscoelastic material is what relaxation leaves, and may be small.
        let instantaneous = material.shear.as_ref().map(Maxwell::instantaneous);
        let of_shear = match instantaneous {
            Some(shear) => format!("the shear modulus of {shear:.3e} Pa at t = 0, with all terms of `prony`,"),
            None => format!("{} Pa", show(shear)),
        };
        let given_bulk = given(name, "bulk").map(|bulk| ("bulk", bulk, format!("{} Pa", show(bulk))));
        let of_shear = ("shear", instantaneous.unwrap_or(shear), of_shear);
        for (key, modulus, words) in [of_shear].into_iter().chain(given_bulk) {
            let (key, help) = (format!("material.{name}.{key}"), || "moduli are in Pa: 2 GPa are 2e9".to_owned());
            doubt(&key, SOFT_SHEAR / modulus, format!("{words} is softer than rubber"), help());
            doubt(&key, modulus / STIFF, format!("{words} is stiffer than diamond"), help());
        }
    }
    let of_density = || "the density is in kg/m3: 2.5 g/cm3 are 2500".to_owned();
    let of_materials = materials.iter().map(|(name, material)| (format!("material.{name}.density"), *material));
    for (key, material) in whole.map(|material| ("body.density".to_owned(), material)).into_iter().chain(of_materials) {
        let density = material.instantaneous.density;
        doubt(&key, LIGHT / density, format!("{} kg/m3 is lighter than foam", show(density)), of_density());
        doubt(&key, density / HEAVY, format!("{} kg/m3 is heavier than any metal", show(density)), of_density());
    }
    let has_cells = match scene.body.geometry {
        Geometry::Box { is_given, .. } => is_given,
        Geometry::Gmsh(_) => true,
    };
    let moduli = scene.body.composition.materials().into_iter().map(|material| material.instantaneous.lame());
    let ratio = moduli.map(|Lame { lambda, mu }| lambda / mu).fold(0.0, f64::max);
    if has_cells && scene.body.order == 1 {
        let what = format!("elements of order 1 lock in a material with λ = {} μ", one_digit(ratio));
        let help = "order = 2, or a box without `cells` and `order`, for splines".to_owned();
        doubt("body.order", ratio / COMPRESSIBLE, what, help);
    }
    let of_faces = scene.strength.by_face.iter().map(|(face, strength)| (format!("strength.face.{face}"), *strength));
    let of_all = scene.strength.tension.map(|strength| ("strength.tension".to_owned(), strength));
    for (key, strength) in of_all.into_iter().chain(of_faces) {
        let help = format!("a strength is in Pa: {} MPa are {}", show(strength), show(1e6 * strength));
        doubt(&key, WEAK / strength, format!("{} Pa is weaker than foam", show(strength)), help);
        let help = "a strength is in Pa: 45 MPa are 45e6".to_owned();
        doubt(&key, strength / STRONG, format!("{} Pa is stronger than any steel or glass", show(strength)), help);
    }
    if let (Geometry::Box { size: [x, y, _], .. }, Parts::Layers(layers)) = (&scene.body.geometry, parts) {
        let (edge, thinnest) = (x.min(*y), layers.iter().map(|layer| layer.thickness).fold(f64::INFINITY, f64::min));
        for (number, Layer { thickness, .. }) in layers.iter().enumerate() {
            let beside = [THICK_BESIDE_OTHERS, THICK_FOR_EDGE * edge, THICK_FOR_LAYERS * thinnest]
                .map(|usual| thickness / usual);
            let excess = beside.into_iter().fold(f64::INFINITY, f64::min).max(thickness / THICK);
            let what =
                format!("a layer of {} m is thick beside edges of {} and {} m", show(*thickness), show(*x), show(*y));
            let help = format!("a thickness is in m: {} mm are {}", show(*thickness), show(1e-3 * thickness));
            doubt(&format!("body.layer.{number}.thickness"), excess, what, help);
        }
    }
    for (number, support) in scene.supports.iter().enumerate() {
        let stiffness = (0..3).map(|axis| support.stiffness_along(axis)).fold(0.0, f64::max);
        // Zero is a support without springs.
        if support.is_rigid() || stiffness == 0.0 {
            continue;
        }
        let what = format!("{} N/m3 is softer than a mattress", show(stiffness));
        let help = "a stiffness is in N/m3, for each m2 of the surface: 1 N/mm3 is 1e9".to_owned();
        doubt(&format!("support.{number}.stiffness"), SOFT_SUPPORT / stiffness, what, help);
    }
    if let Some(temperature) = scene.body.temperature {
        doubt(
            "body.temperature",
            temperature / HOT,
            format!("{} °C is hotter than any interlayer bears", show(temperature)),
            in_celsius(temperature),
        );
    }
    if let Some(radius) = impactor.radius.filter(|radius| *radius > LARGE) {
        let of_ball = impactor.mass / (4.0 / 3.0 * PI * radius.powi(3));
        let what =
            format!("a ball of {} m and {} kg would be lighter than air or foam", show(radius), show(impactor.mass));
        let help = format!("the radius is in m: {} mm are {}", show(radius), show(1e-3 * radius));
        doubt("impactor.radius", HOLLOW / of_ball, what, help);
    }
    let struck = scene.body.struck();
    let force = largest(scene.load.force_on(struck.density)) / struck.density;
    let key = if scene.load.body_force != [0.0; 3] { "load.body_force" } else { "load.gravity" };
    let what = format!("the loads accelerate the body by {force:.1e} m/s2, ten thousand times its weight and more");
    doubt(key, force / FORCED, what, "body_force is in N/m3, and gravity in m/s2".to_owned());
    for (number, traction) in scene.load.traction.iter().enumerate() {
        let pressure = largest(traction.value) / struck.young;
        let what = format!(
            "a traction of {pressure:.1e} of Young's modulus strains the body beyond what a linear model describes"
        );
        doubt(&format!("load.traction.{number}.value"), pressure / STRAINED, what, "a traction is in Pa".to_owned());
    }
    let end = scene.time.end;
    let contacts = (end - impactor.flight_time()) / contact;
    let what = format!(
        "a run of {} s is {contacts:.1e} times as long as a contact on a half-space, {contact:.1e} s",
        show(end)
    );
    doubt(
        "time.end",
        contacts / LONGEST_RUN,
        what,
        format!("the time is in s: {} ms are {}", show(end), show(1e-3 * end)),
    );
    if let Some(step) = scene.time.step {
        let what = format!(
            "a step of {} s is longer than a contact on a half-space, {contact:.1e} s, which it leaps over",
            show(step)
        );
        let help = format!("a step of at most {} s, or none: then it is chosen", one_digit(0.05 * contact));
        doubt("time.step", step / contact, what, help);
    }
    all
}

/// Materials of the layers or of the volumes, by name.
fn named(scene: &Scene) -> BTreeMap<&str, &Material> {
    match &scene.body.composition.parts {
        Parts::Whole(_) => BTreeMap::new(),
        Parts::Layers(layers) => layers.iter().map(|layer| (layer.name.as_str(), &layer.material)).collect(),
        Parts::Volumes(volumes) => volumes.iter().map(|(name, material)| (name.as_str(), material)).collect(),
    }
}

fn largest(vector: Vec3) -> f64 {
    vector.into_iter().fold(0.0, |most, x| most.max(x.abs()))
}
