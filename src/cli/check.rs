//! `ricochet check`: what a scene asks for, and what it will cost.

use petsc_wrap::{Comm, FactorEstimate, Int, estimate_cholesky};

use crate::body::Body;
use crate::contact::{Patch, Reason, hertz};
use crate::error::Result;
use crate::impact::{Method, Plan, Setting, steps};
use crate::model::{Dynamics, Model};
use crate::scene::{Contact, Geometry, Scene, Scheme, Support, SupportKind, Symmetry, Vec3};
use crate::scheme::Implicit;
use crate::solve::Method as Solution;

use super::Check;
use super::load::{Loaded, load};
use super::notes::{Verdict, describe_model, note_of_probes, notes, verdict};
use super::say;

/// How the systems of a step are solved, and what that takes.
enum Linear {
    /// Not at all.
    None,
    /// By a factor, of which MUMPS alone tells what it will take.
    Cholesky(Option<FactorEstimate>),
    /// By iterations.
    Multigrid,
}

/// Memory of S with its multigrid while that is set up, over that of S, on one rank and on several; as measured on 3e5 and 1e6 unknowns.
const OF_MULTIGRID: [f64; 2] = [1.8, 2.9];

/// Checks a scene and prints what will be solved. Collective.
///
/// # Errors
/// All that is wrong with the scene; PETSc's.
pub fn check(comm: &Comm, arguments: &Check) -> Result<()> {
    let Loaded { scene, source, .. } = load(comm, &arguments.scene, &arguments.overrides)?;
    describe(comm, &scene).map_err(|error| error.in_scene(&source))
}

fn describe(comm: &Comm, scene: &Scene) -> Result<()> {
    let mut model = Model::new(comm, scene)?;
    let patch = model.dynamics.patch();
    let head = |model: &Model, mass: Option<f64>, plan: Option<&Plan>| {
        if comm.is_root() {
            if let Some(Verdict { message, .. }) = verdict(model, scene.tolerance) {
                say(format_args!("warning    {message}"));
            }
            print_scene(scene, model, mass);
            print_contact(scene, patch.as_ref());
            print_time(scene, plan);
            for note in notes(scene, patch.as_ref(), plan).into_iter().chain(note_of_probes(model)) {
                say(format_args!("note       {note}"));
            }
        }
    };
    let Dynamics::Stepped(body) = &mut model.dynamics else {
        let given = scene.time.step.map(|step| Plan::Equal { step });
        head(&model, box_mass(scene), given.as_ref());
        if comm.is_root() {
            say(format_args!("solver     modal coordinates: no equations to solve but two for the force, a step"));
        }
        return Ok(());
    };
    let setting = Setting::new(&scene.impactor, body);
    let plan = Plan::new(scene, body, &setting)?;
    // Asks all ranks where there are pads.
    let method = Method::of(scene.solver.newton, body);
    let is_iterative = matches!(body.method, Solution::Multigrid { .. }) && method != Method::Full;
    let linear = match Implicit::new(scene.time.scheme) {
        Some(_) if is_iterative => Linear::Multigrid,
        Some(scheme) => {
            let stage = scheme.stage(plan.step());
            Linear::Cholesky(estimate_cholesky(&body.operator(stage.c1, stage.c2)?)?)
        }
        None => Linear::None,
    };
    let entries = body.elastic.entries()?;
    let boundary: u64 = body.support.iter().chain(&body.damping).map(|m| m.entries()).sum::<petsc_wrap::Result<_>>()?;
    let mass = match box_mass(scene) {
        Some(mass) => Some(mass),
        None => Some(mass(body)?),
    };
    head(&model, mass, Some(&plan));
    if let (true, Dynamics::Stepped(body)) = (comm.is_root(), &model.dynamics) {
        print_cost(body, &method, &plan, (entries as f64, boundary as f64), linear);
        if scene.output.fields.is_some() {
            let bytes = OF_FIELDS * body.unknowns() as f64 / 3.0;
            say(format_args!("fields     about {:.0} MB more, on rank 0", 1e-6 * bytes));
        }
    }
    Ok(())
}

/// Mass of a box, kg.
fn box_mass(scene: &Scene) -> Option<f64> {
    match &scene.body.geometry {
        Geometry::Box { size, .. } => Some(scene.body.density * size.iter().product::<f64>()),
        Geometry::Gmsh(_) => None,
    }
}

/// Mass of a body of solid elements, kg: 1ᵀM1 counts it once for each component.
fn mass(body: &Body) -> Result<f64> {
    let mut ones = body.load.duplicate()?;
    let mut product = body.load.duplicate()?;
    ones.fill(1.0)?;
    body.mass.mult(&ones, &mut product)?;
    Ok(product.dot(&ones)? / 3.0)
}

fn print_scene(scene: &Scene, model: &Model, mass: Option<f64>) {
    if !scene.title.is_empty() {
        say(format_args!("{}", scene.title));
    }
    let geometry = match &scene.body.geometry {
        Geometry::Box { size: [x, y, z], .. } => format!("box {x} × {y} × {z} m"),
        Geometry::Gmsh(path) => path.display().to_string(),
    };
    let mass = mass.map_or(String::new(), |mass| format!(", {mass:.4} kg"));
    say(format_args!("body       {geometry}{mass}"));
    say(format_args!("model      {}", describe_model(model)));
    if let Some(reason) = &model.reason {
        say(format_args!("           {reason}"));
    }
    match &scene.body.symmetry {
        Symmetry::Quarter { .. } => say(format_args!("symmetry   a quarter stands for the whole")),
        Symmetry::None { reason: Some(reason) } => say(format_args!("symmetry   none: {reason}")),
        Symmetry::None { reason: None } => {}
    }
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
}

fn print_contact(scene: &Scene, patch: Option<&Patch>) {
    let impactor = &scene.impactor;
    let [x, y, z] = impactor.direction.map(|d| (1e6 * d).round() / 1e6);
    say(format_args!(
        "impactor   {} kg at {} m/s, {} m away, k0 = {:.4e} N/m^1.5, at {:?} along [{x}, {y}, {z}]",
        impactor.mass, impactor.speed, impactor.gap, impactor.stiffness, impactor.point
    ));
    say(format_args!(
        "contact    on a half-space it would last {:.4} ms and peak at {:.0} N",
        1e3 * contact_time(scene),
        hertz::peak_force(impactor.stiffness, impactor.mass, impactor.speed)
    ));
    let Some(patch) = patch else {
        if scene.contact == Contact::Point {
            say(format_args!(
                "           at a point: the force depends on the mesh, and has no limit as it is refined"
            ));
        }
        return;
    };
    let reason = match patch.reason {
        Reason::Scene => "as the scene says".to_owned(),
        Reason::Thickness => format!("a quarter of the thickness of {:.4} m", patch.thickness),
        Reason::Cells => format!("two cells of {:.4} m", patch.cell),
        Reason::Contact => "what the contact needs".to_owned(),
        Reason::Surface => "what has room on the surface".to_owned(),
    };
    say(format_args!(
        "patch      radius {:.4e} m, {reason}; {}",
        patch.radius,
        if patch.is_coarse() {
            "the cells do not resolve it".to_owned()
        } else {
            format!("it leaves about {:.1e} of the peak open", patch.error())
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

/// Memory for the fields of a whole body, a node of the modelled quarter, bytes: measured. Of it most is what recovers the stresses there.
const OF_FIELDS: f64 = 4.5e3;

/// Memory of an entry of a matrix: its value and its column, bytes.
const ENTRY: f64 = (size_of::<f64>() + size_of::<Int>()) as f64;

fn print_cost(body: &Body, method: &Method, plan: &Plan, (entries, boundary): (f64, f64), linear: Linear) {
    // Those of one motion, or of two with what is kept to go back to.
    let vectors = if matches!(plan, Plan::Equal { .. }) { 30.0 } else { 100.0 } * 8.0 * body.unknowns() as f64;
    // For products: one triangle of K, and M by node.
    let products = 0.6 * entries;
    // K, M and S; in the full method also Ŝ and the Newton matrix; three dense ones for pads.
    let (name, matrices, dense) = match method {
        Method::Condensed => ("condensed Newton: one solve and a scalar equation a step".to_owned(), 3.0, 0.0),
        Method::CondensedOnPads(pushed) => {
            let n = pushed.len();
            (
                format!("condensed Newton: two solves and {n} equations of the pads a step"),
                3.0,
                24.0 * (n as f64).powi(2),
            )
        }
        Method::Full => ("full Newton (SNES) with the block aaᵀ".to_owned(), 5.0, 0.0),
    };
    let factor = match linear {
        Linear::Cholesky(factor) => factor,
        Linear::None => {
            let matrices = ENTRY * (2.0 * entries + products + boundary) + vectors;
            say(format_args!("solver     none: every unknown by itself"));
            return say(format_args!("memory     about {:.0} MB over all ranks", 1e-6 * matrices));
        }
        Linear::Multigrid => {
            let sizes = if matches!(plan, Plan::Equal { .. }) { 1.0 } else { 5.0 };
            let operators = sizes * OF_MULTIGRID[usize::from(body.comm().size() > 1)] * entries;
            let matrices = ENTRY * (2.0 * entries + products + boundary + operators) + sizes * dense + vectors;
            say(format_args!(
                "solver     {name}; conjugate gradients with multigrid (GAMG), since a factor would take more: {entries:.2e} entries in K"
            ));
            return say(format_args!("memory     about {:.0} MB over all ranks", 1e-6 * matrices));
        }
    };
    // In chosen steps those in contact, those of the error estimate, and the larger ones out of contact.
    let (factors, note) = match plan {
        Plan::Equal { .. } => (1.0, ""),
        Plan::Controlled { .. } => (5.0, ", in up to five step sizes"),
    };
    let matrices = ENTRY * ((2.0 + factors * (matrices - 2.0)) * entries + boundary) + factors * dense + vectors;
    let Some(factor) = factor else {
        say(format_args!("solver     {name}; Cholesky{note}: {entries:.2e} entries in K"));
        return say(format_args!(
            "memory     about {:.0} MB for matrices, over all ranks, and the factorisations, of which MUMPS would tell: this PETSc is without it",
            1e-6 * matrices
        ));
    };
    say(format_args!(
        "solver     {name}; Cholesky{note}: {entries:.2e} entries in K, {:.2e} in a factor, {:.2e} operations",
        factor.entries, factor.operations
    ));
    let factors = factors * factor.memory;
    say(format_args!(
        "memory     about {:.0} MB: matrices {:.0} MB, factorisations {:.0} MB, over all ranks",
        1e-6 * (matrices + factors),
        1e-6 * matrices,
        1e-6 * factors
    ));
}

/// Contact time on a half-space, s.
fn contact_time(scene: &Scene) -> f64 {
    hertz::contact_time(scene.impactor.stiffness, scene.impactor.mass, scene.impactor.speed)
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
