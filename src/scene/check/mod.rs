//! From typed values to a checked scene: ranges, defaults, and what keys mean together.

mod body;
mod contact;
mod grid;
mod impactor;
mod modal;
mod numbers;
mod output;
mod plausible;
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
use body::{Material, Outline};
pub(super) use contact::table_in_file;
pub(super) use numbers::show;

/// The scene of a source, with mesh files relative to `folder`.
///
/// # Errors
/// The first fault found.
pub(super) fn scene(source: &Source, folder: &Path) -> Result<Scene, SceneError> {
    let raw = decode(source)?;
    let material = body::material(source, &raw.body)?;
    let outline = body::outline(source, &raw.body, folder)?;
    let supports = raw
        .support
        .0
        .iter()
        .enumerate()
        .map(|(number, support)| support::check(source, number, support, &outline))
        .collect::<Result<Vec<_>, _>>()?;
    let load = load(source, &raw.load, &outline, material.density)?;
    let impactor = impactor::check(source, (&raw.impactor, &raw.contact), &material, &outline)?;
    let contact = contact::localization(source, &raw.contact)?;
    let output = output::check(source, &raw, &outline)?;
    let strength = strength::check(source, &raw, &outline)?;
    let Material { young, poisson, density, order } = material;
    let geometry = match outline {
        Outline::Gmsh(path) => Geometry::Gmsh(path),
        Outline::Box(size) => {
            let hit = grid::Hit { size, impactor: &impactor, contact, order };
            Geometry::Box {
                size,
                planes: grid::check(source, &raw.body, hit)?,
                is_given: raw.body.cells.is_some() || raw.body.grading.is_some() || raw.body.order.is_some(),
            }
        }
    };
    let parts = symmetry::Parts { geometry: &geometry, impactor: &impactor, supports: &supports, load: &load };
    let symmetry = symmetry::check(source, &raw.body, &parts)?;
    let (model, reduction) = body::theory(source, &raw.body)?;
    let stiffest = modal::stiffest(&geometry, density, &impactor);
    modal::basis(source, reduction, &supports, stiffest)?;
    let against = modal::against(&raw, (model, reduction), &supports, stiffest);
    let time = time::check(source, &raw.time, against)?;
    modal::only(source, &raw, (model, &supports), &time)?;
    time::equilibrium(source, &time, &load, &supports)?;
    let body = Body { model, reduction, young, poisson, density, geometry, order, symmetry };
    plausible::check(source, &body, (&impactor, raw.impactor.stiffness.is_some()), time.end)?;
    Ok(Scene {
        title: raw.title.clone().unwrap_or_default(),
        body,
        supports,
        impactor,
        contact,
        load,
        time,
        tolerance: tolerance(source, &raw.accuracy)?,
        measure: strength::measure(source, &raw)?,
        strength,
        solver: solver(source, &raw.solver)?,
        output,
    })
}

fn tolerance(source: &Source, raw: &raw::Accuracy) -> Result<f64, SceneError> {
    let path = "accuracy.tolerance";
    let Number(tolerance) = raw.tolerance.unwrap_or(Number(1e-2));
    source.finite(path, &[tolerance])?;
    if (1e-6..=0.5).contains(&tolerance) {
        return Ok(tolerance);
    }
    let help = "from 1e-6 to 0.5: the error of the acceleration history over its peak";
    Err(source.error(path, format!("{} is out of range", numbers::show(tolerance)), help))
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

fn load(source: &Source, raw: &raw::Load, outline: &Outline, density: f64) -> Result<Load, SceneError> {
    let [force, gravity] = [raw.body_force, raw.gravity].map(|vector| vector.map_or([0.0; 3], |v| v.numbers()));
    source.finite("load.body_force", &force)?;
    source.finite("load.gravity", &gravity)?;
    let body_force = [0, 1, 2].map(|i| force[i] + density * gravity[i]);
    let mut traction = Vec::new();
    for (number, entry) in raw.traction.0.iter().enumerate() {
        surface(source, &format!("load.traction.{number}.surface"), &entry.surface, outline)?;
        let path = format!("load.traction.{number}.within");
        let within = within::check(source, &path, &entry.within, &entry.surface, outline)?;
        let value: Vec3 = entry.value.numbers();
        source.finite(&format!("load.traction.{number}.value"), &value)?;
        traction.push(Traction { surface: entry.surface.clone(), within, value });
    }
    Ok(Load { body_force, traction })
}

/// The one of `words` that was given, or the first of them where nothing was.
fn word<'a>(source: &Source, path: &str, given: &Option<String>, words: &[&'a str]) -> Result<&'a str, SceneError> {
    let Some(given) = given else {
        return Ok(words[0]);
    };
    words.iter().copied().find(|word| word == given).ok_or_else(|| {
        let message = format!("\"{given}\" is not one of its values");
        source.error(path, message, suggest::help(given, words, '"'))
    })
}

/// A surface's name is checked for a box; the names of a mesh file are known once it is read.
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
