//! `ricochet check`: what a scene asks for, and what it will cost.

use petsc_wrap::{Comm, FactorEstimate, estimate_cholesky};

use crate::body::Solid;
use crate::contact::hertz;
use crate::error::Result;
use crate::impact::steps;
use crate::mesh::Mesh;
use crate::scene::{Geometry, Scene, Scheme, Support, SupportKind, Vec3};
use crate::scheme::Implicit;

use super::Check;
use super::load::load;
use super::say;

/// Checks a scene and prints what will be solved. Collective.
///
/// # Errors
/// All that is wrong with the scene; PETSc's.
pub fn check(comm: &Comm, arguments: &Check) -> Result<()> {
    let (scene, source) = load(comm, &arguments.scene, &arguments.overrides)?;
    describe(comm, &scene).map_err(|error| error.in_scene(&source))
}

fn describe(comm: &Comm, scene: &Scene) -> Result<()> {
    let mesh = Mesh::new(comm, &scene.body)?;
    let body = Solid::new(scene, &mesh)?;
    let update = Implicit::new(scene.time.scheme).expect("implicit").stage(scene.time.step.unwrap_or(1e-5));
    let mut matrix = body.combination(update.c1, update.c2)?;
    matrix.declare_positive_definite()?;
    let factor = estimate_cholesky(&matrix)?;
    let entries = matrix.entries()?;
    let boundary: u64 = body.support.iter().chain(&body.damping).map(|m| m.entries()).sum::<petsc_wrap::Result<_>>()?;
    let mass = mass(&body)?;
    if comm.is_root() {
        print(scene, &mesh, (body.unknowns(), mass), entries as f64, boundary as f64, factor);
    }
    Ok(())
}

/// Mass of the body, kg: 1ᵀM1 counts it once for each component.
fn mass(body: &Solid) -> Result<f64> {
    let mut ones = body.load.duplicate()?;
    let mut product = body.load.duplicate()?;
    ones.fill(1.0)?;
    body.mass.mult(&ones, &mut product)?;
    Ok(product.dot(&ones)? / 3.0)
}

fn print(
    scene: &Scene,
    mesh: &Mesh,
    (unknowns, mass): (usize, f64),
    entries: f64,
    boundary: f64,
    factor: FactorEstimate,
) {
    let (impactor, time) = (&scene.impactor, &scene.time);
    if !scene.title.is_empty() {
        say(format_args!("{}", scene.title));
    }
    let geometry = match &scene.body.geometry {
        Geometry::Box { size: [x, y, z], .. } => format!("box {x} × {y} × {z} m"),
        Geometry::Gmsh(path) => path.display().to_string(),
    };
    say(format_args!(
        "body       solid: {geometry}, {mass:.4} kg, {} {} of order {}, {} nodes, {unknowns} unknowns",
        mesh.total_cells,
        if mesh.cells.shape == crate::element::Shape::Tetrahedron { "tetrahedra" } else { "hexahedra" },
        scene.body.order,
        mesh.nodes,
    ));
    if scene.supports.is_empty() {
        say(format_args!("supports   none: a free body"));
    }
    for support in &scene.supports {
        say(format_args!("support    {}", support_line(support)));
    }
    let load = &scene.load;
    if load.body_force != [0.0; 3] {
        say(format_args!("load       body force {:?} N/m³", load.body_force));
    }
    for traction in &load.traction {
        say(format_args!("load       {}: traction {:?} N/m²", traction.surface, traction.value));
    }
    let contact = hertz::contact_time(impactor.stiffness, impactor.mass, impactor.speed);
    say(format_args!(
        "impactor   {} kg at {} m/s, {} m away, k0 = {:.4e} N/m^1.5, at {:?} along {:?}",
        impactor.mass, impactor.speed, impactor.gap, impactor.stiffness, impactor.point, impactor.direction
    ));
    say(format_args!(
        "contact    at a point; on a half-space it would last {:.3} ms and peak at {:.0} N",
        1e3 * contact,
        hertz::peak_force(impactor.stiffness, impactor.mass, impactor.speed)
    ));
    let Scheme::Newmark { beta, gamma } = time.scheme else { unimplemented!() };
    say(format_args!(
        "time       Newmark β = {beta}, γ = {gamma}: {} steps of {:e} s to {:e} s, {:.0} in that contact",
        steps(time.end, time.step.unwrap_or(1e-5)),
        time.step.unwrap_or(1e-5),
        time.end,
        contact / time.step.unwrap_or(1e-5)
    ));
    if contact < 20.0 * time.step.unwrap_or(1e-5) {
        say(format_args!("           fewer than 20 steps in a contact: expect its force to depend on the step"));
    }
    say(format_args!(
        "solver     full Newton (SNES), Cholesky by MUMPS: {:.2e} entries in K, {:.2e} in the factor, {:.2e} operations",
        entries, factor.entries, factor.operations
    ));
    // K, M, Ŝ and the Newton matrix, each with an index and a value an entry; a dozen vectors.
    let matrices = 12.0 * (4.0 * entries + boundary) + 8.0 * 12.0 * unknowns as f64;
    say(format_args!(
        "memory     about {:.0} MB: matrices {:.0} MB, factorisation {:.0} MB, over all ranks",
        1e-6 * (matrices + factor.memory),
        1e-6 * matrices,
        1e-6 * factor.memory
    ));
}

fn support_line(support: &Support) -> String {
    let Support { surface, kind, damping, displacement } = support;
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

/// One number where all components are alike.
fn by_component(values: Vec3) -> String {
    if values.iter().all(|value| *value == values[0]) { format!("{:e}", values[0]) } else { format!("{values:?}") }
}
