//! Finds values of a scene that are allowed but probably a mistake. Most look as if they were given in another unit.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::check::{one_digit, show};
use super::decode::decode;
use super::values::Number;
use super::{Geometry, Parts, Scene, SceneError, Source, Vec3, raw};
use crate::form::Lame;
use crate::form::elastic::COMPRESSIBLE;
use crate::material::{Material, Maxwell};

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

/// Highest plausible temperature of a body whose relaxation depends on it, °C. Interlayers of glass are laminated at 140.
pub(super) const HOT: f64 = 150.0;
/// 0 °C, K.
const ZERO_CELSIUS: f64 = 273.15;

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

/// A value that is probably a mistake.
#[derive(Debug)]
pub struct Doubt {
    /// Place of the value in the scene, and why it is doubtful.
    pub error: SceneError,
    /// Factor by which the value exceeds the usual range.
    pub excess: f64,
}

/// Advice for a temperature that may be meant in K.
pub(super) fn in_celsius(kelvin: f64) -> String {
    let celsius = (1e6 * (kelvin - ZERO_CELSIUS)).round() / 1e6;
    format!("temperatures are in °C: {} K are {} °C", show(kelvin), show(celsius))
}

/// All doubtful values of the scene of a source.
pub fn doubts(scene: &Scene, source: &Source) -> Vec<Doubt> {
    let Ok(raw) = decode(source) else { return Vec::new() };
    let impactor = &scene.impactor;
    let contact = impactor.contact_time();
    let mut all = Vec::new();
    let mut doubt = |key: &str, excess: f64, what: String, help: String| {
        if excess > 1.0 {
            all.push(Doubt { error: source.error(key, what, help), excess });
        }
    };
    let of_young = || "Young's modulus is in Pa: 70 GPa are 70e9".to_owned();
    let mut moduli = vec![("body.young".to_owned(), raw.body.young), ("impactor.young".to_owned(), raw.impactor.young)];
    moduli.extend(raw.material.iter().map(|(name, material)| (format!("material.{name}.young"), material.young)));
    for (key, young) in moduli {
        let Some(Number(young)) = young else { continue };
        doubt(&key, SOFT / young, format!("{} Pa is softer than rubber", show(young)), of_young());
        if key != "impactor.young" {
            doubt(&key, young / STIFF, format!("{} Pa is stiffer than diamond", show(young)), of_young());
        }
    }
    for (name, material) in named(scene, &raw) {
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
        let reference = raw.material.get(name).and_then(|raw| raw.wlf.as_ref()).map_or(0.0, |wlf| wlf.reference.0);
        let what = format!("{} °C is hotter than any interlayer bears", show(reference));
        doubt(&format!("material.{name}.wlf.reference"), reference / HOT, what, in_celsius(reference));
    }
    for (name, material) in named(scene, &raw) {
        let Some(raw::Material { shear: Some(Number(shear)), bulk, .. }) = raw.material.get(name) else { continue };
        // The given shear modulus of a viscoelastic material is what relaxation leaves, and may be small.
        let instantaneous = material.shear.as_ref().map(Maxwell::instantaneous);
        let of_shear = match instantaneous {
            Some(shear) => format!("the shear modulus of {shear:.3e} Pa at t = 0, with all terms of `prony`,"),
            None => format!("{} Pa", show(*shear)),
        };
        let given_bulk = bulk.map(|Number(bulk)| ("bulk", bulk, format!("{} Pa", show(bulk))));
        let of_shear = ("shear", instantaneous.unwrap_or(*shear), of_shear);
        for (key, modulus, words) in [of_shear].into_iter().chain(given_bulk) {
            let (key, help) = (format!("material.{name}.{key}"), || "moduli are in Pa: 2 GPa are 2e9".to_owned());
            doubt(&key, SOFT_SHEAR / modulus, format!("{words} is softer than rubber"), help());
            doubt(&key, modulus / STIFF, format!("{words} is stiffer than diamond"), help());
        }
    }
    let of_density = || "the density is in kg/m3: 2.5 g/cm3 are 2500".to_owned();
    let mut densities = vec![("body.density".to_owned(), raw.body.density)];
    densities.extend(raw.material.iter().map(|(name, of)| (format!("material.{name}.density"), Some(of.density))));
    for (key, density) in densities {
        let Some(Number(density)) = density else { continue };
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
    let thicknesses: Vec<f64> = raw.body.layer.0.iter().map(|layer| layer.thickness.0).collect();
    if let Geometry::Box { size: [x, y, _], .. } = scene.body.geometry {
        let (edge, thinnest) = (x.min(y), thicknesses.iter().copied().fold(f64::INFINITY, f64::min));
        for (number, thickness) in thicknesses.iter().enumerate() {
            let beside = [THICK_BESIDE_OTHERS, THICK_FOR_EDGE * edge, THICK_FOR_LAYERS * thinnest]
                .map(|usual| thickness / usual);
            let excess = beside.into_iter().fold(f64::INFINITY, f64::min).max(thickness / THICK);
            let what =
                format!("a layer of {} m is thick beside edges of {} and {} m", show(*thickness), show(x), show(y));
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
    if let Some(Number(temperature)) = raw.body.temperature {
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
    let key = if raw.load.body_force.is_some() { "load.body_force" } else { "load.gravity" };
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
fn named<'a>(scene: &'a Scene, raw: &'a raw::Scene) -> BTreeMap<&'a str, &'a Material> {
    match &scene.body.composition.parts {
        Parts::Whole(_) => BTreeMap::new(),
        Parts::Layers(layers) => {
            let names = raw.body.layer.0.iter().map(|layer| layer.material.as_str());
            names.zip(layers.iter().map(|layer| &layer.material)).collect()
        }
        Parts::Volumes(volumes) => volumes.iter().map(|(name, material)| (name.as_str(), material)).collect(),
    }
}

fn largest(vector: Vec3) -> f64 {
    vector.into_iter().fold(0.0, |most, x| most.max(x.abs()))
}
