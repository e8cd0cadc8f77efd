//! From typed values to a checked scene: ranges, defaults, and keys that depend on each other.

mod body;
mod composition;
mod contact;
mod grid;
mod impactor;
mod layers;
mod material;
mod modal;
mod numbers;
mod output;
mod plausible;
mod relaxation;
mod strength;
mod support;
mod symmetry;
mod table;
mod time;
mod within;

use std::path::Path;

use super::decode::decode;
use super::error::SceneError;
use super::values::Number;
use super::{Body, Geometry, Load, Newton, Scene, Solver, Source, Traction, Vec3, faces, raw, suggest};
use body::Outline;
use composition::Struck;
pub(super) use contact::table_in_file;
pub(super) use material::with_series;
pub(crate) use material::{HOT, in_celsius};
pub use numbers::one_digit;
pub(crate) use numbers::show;

/// Most supports of a scene.
const MOST_SUPPORTS: usize = 300;

/// Checks a source and returns its scene. Mesh files are relative to `folder`.
///
/// # Errors
/// The first fault found.
pub(super) fn scene(source: &Source, folder: &Path) -> Result<Scene, SceneError> {
    let raw = decode(source)?;
    // Messages hold the title in a line, and HDF5 ends texts at a NUL character.
    let title = raw.title.as_deref().unwrap_or_default().lines().collect::<Vec<_>>().join(" ");
    if title.contains('\0') {
        return Err(source.error("title", "the title holds a NUL character", "take it out"));
    }
    let materials = composition::materials(source, &raw)?;
    let order = body::order(source, &raw.body)?;
    let outline = body::outline(source, &raw.body, folder)?;
    let Struck { composition, stiffness_key, density_key } = materials.struck(source, &raw, &outline)?;
    if raw.support.0.len() > MOST_SUPPORTS {
        let message = format!("there are {} supports", raw.support.0.len());
        return Err(source.error("support", message, format!("at most {MOST_SUPPORTS}")));
    }
    let supports = raw
        .support
        .0
        .iter()
        .enumerate()
        .map(|(number, support)| support::check(source, number, support, &outline))
        .collect::<Result<Vec<_>, _>>()?;
    let load = load(source, &raw.load, &outline)?;
    // A free body is accelerated by its loads before the impactor reaches it.
    let of_body = composition.density().filter(|_| supports.is_empty());
    let of_body = of_body.map_or([0.0; 3], |density| load.force_on(density).map(|force| force / density));
    let mut impactor = impactor::check(source, (&raw.impactor, &raw.contact), &composition, &outline, of_body)?;
    let contact = contact::localization(source, &raw.contact, (&outline, &impactor))?;
    let output = output::check(source, &raw, &outline)?;
    let strength = strength::check(source, &raw, &outline, (&composition, &impactor))?;
    let geometry = match outline {
        Outline::Gmsh(path) => Geometry::Gmsh(path),
        Outline::Box(size) => {
            let hit = grid::Hit { size, composition: &composition, impactor: &impactor, contact, order };
            Geometry::Box {
                size,
                planes: grid::check(source, &raw.body, hit)?,
                is_given: raw.body.cells.is_some() || raw.body.grading.is_some() || raw.body.order.is_some(),
            }
        }
    };
    let parts = symmetry::Parts {
        geometry: &geometry,
        composition: &composition,
        impactor: &impactor,
        supports: &supports,
        load: &load,
    };
    let symmetry = symmetry::check(source, &raw.body, &parts)?;
    let (model, reduction) = body::theory(source, &raw.body)?;
    let stiffest = modal::stiffest(&geometry, composition.struck.density, &impactor);
    modal::basis(source, reduction, &supports, stiffest)?;
    let relaxing = relaxation::key(&raw);
    relaxation::check(source, &raw, relaxing.as_deref())?;
    let against = modal::against(&raw, (model, reduction), &supports, stiffest);
    let time = time::check(source, &raw.time, against)?;
    modal::only(source, &raw, (model, &supports), &time)?;
    time::equilibrium(source, &time, &load, &supports)?;
    let temperature = material::temperature(source, &raw)?;
    if let Geometry::Box { size, .. } = geometry {
        impactor.layer_effect = contact::layer_effect(size, &composition, &supports, &impactor, contact);
    }
    let body = Body { model, reduction, composition, temperature, geometry, order, symmetry };
    let keys = plausible::Keys { stiffness: &stiffness_key, density: &density_key };
    plausible::check(source, (&body, keys), (&impactor, raw.impactor.stiffness.is_some()), time.end)?;
    Ok(Scene {
        title,
        body,
        supports,
        impactor,
        contact,
        load,
        time,
        tolerance: tolerance(source, &raw.accuracy)?,
        cell_factor: cell_factor(source, &raw.accuracy)?,
        measure: strength::measure(source, &raw)?,
        strength,
        solver: solver(source, &raw.solver)?,
        output,
    })
}

fn tolerance(source: &Source, raw: &raw::Accuracy) -> Result<f64, SceneError> {
    let Number(tolerance) = raw.tolerance.unwrap_or(Number(1e-2));
    let help = "from 1e-6 to 0.5: the error of the acceleration history over its peak";
    source.in_range("accuracy.tolerance", tolerance, 1e-6..=0.5, help)
}

fn cell_factor(source: &Source, raw: &raw::Accuracy) -> Result<f64, SceneError> {
    let Number(factor) = raw.cell_factor.unwrap_or(Number(1.0));
    let help = "from 0.1 to 10: 0.5 halves the size of all cells that are chosen automatically";
    source.in_range("accuracy.cell_factor", factor, 0.1..=10.0, help)
}

fn solver(source: &Source, raw: &raw::Solver) -> Result<Solver, SceneError> {
    let newton = match word(source, "solver.newton", &raw.newton, &raw::NEWTONS)? {
        "condensed" => Newton::Condensed,
        _ => Newton::Full,
    };
    let help = "the part of the initial energy that may be gained or lost, as 1e-2";
    let gate = |Number(gate): Number| source.positive("solver.energy_gate", gate, help);
    Ok(Solver { newton, energy_gate: raw.energy_gate.map(gate).transpose()? })
}

fn load(source: &Source, raw: &raw::Load, outline: &Outline) -> Result<Load, SceneError> {
    let [body_force, gravity] = [raw.body_force, raw.gravity].map(|vector| vector.map_or([0.0; 3], |v| v.numbers()));
    source.finite("load.body_force", &body_force)?;
    source.finite("load.gravity", &gravity)?;
    let mut traction = Vec::new();
    for (number, entry) in raw.traction.0.iter().enumerate() {
        surface(source, &format!("load.traction.{number}.surface"), &entry.surface, outline)?;
        let path = format!("load.traction.{number}.within");
        let within = within::check(source, &path, &entry.within, &entry.surface, outline)?;
        let value: Vec3 = entry.value.numbers();
        source.finite(&format!("load.traction.{number}.value"), &value)?;
        traction.push(Traction { surface: entry.surface.clone(), within, value });
    }
    Ok(Load { body_force, gravity, traction })
}

/// The given word if it is one of `words`; the first of `words` if none was given.
fn word<'a>(source: &Source, path: &str, given: &Option<String>, words: &[&'a str]) -> Result<&'a str, SceneError> {
    let Some(given) = given else {
        return Ok(words[0]);
    };
    words.iter().copied().find(|word| word == given).ok_or_else(|| {
        let message = format!("\"{given}\" is not one of its values");
        source.error(path, message, suggest::help(given, words, '"'))
    })
}

/// Checks the name of a surface of a box. The names in a mesh file are known only after it has been read.
fn surface(source: &Source, path: &str, name: &str, outline: &Outline) -> Result<(), SceneError> {
    match outline {
        Outline::Box(_) if !faces::SURFACES.contains(&name) => Err(source.error(
            path,
            format!("a box has no surface \"{name}\""),
            suggest::help(name, &faces::SURFACES, '"'),
        )),
        Outline::Gmsh(_) if name.is_empty() => {
            Err(source.error(path, "the name is empty", "the physical name of a surface in the mesh file"))
        }
        _ => Ok(()),
    }
}
