//! Bodies of several materials: layers of a box with meshes and with splines, and the physical volumes of a mesh file.

use crate::bricks::bricks;
use crate::modelled::{parse, run};
use crate::start::{run as run_steps, start};
use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::element::Shape;
use ricochet::model::watch::Unwatched;
use ricochet::model::{Built, ModelContext, build};
use ricochet::scene::Model;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![layers_of_one_stiffness, volumes_are_layers];
pub const ALONE: &[Test<Session>] =
    tests![splines_of_one_stiffness, splines_and_hexahedra_agree, weight_of_layers, auto_takes_the_solid];

/// A free laminate of three layers (m), whose middle one has another Young's modulus (Pa) and density (kg/m³), hit by a
/// small impactor.
fn laminate(layers: [f64; 3], [young, density]: [f64; 2], body: &str, time: &str, rest: &str) -> String {
    let layer = |(thickness, material): (f64, &str)| {
        format!("[[body.layer]]\nthickness = {thickness:e}\nmaterial = \"{material}\"\n")
    };
    let layers: String = layers.into_iter().zip(["glass", "core", "glass"]).map(layer).collect();
    format!(
        "[body]\nsize = [0.3, 0.24]\n{body}\n{layers}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.core]\nyoung = {young:e}\npoisson = 0.23\ndensity = {density}\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\n{time}\n{rest}"
    )
}

/// The same body as one box of glass.
fn plate(thickness: f64, body: &str, time: &str, rest: &str) -> String {
    format!(
        "[body]\nsize = [0.3, 0.24, {thickness:e}]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n{body}\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\n{time}\n{rest}"
    )
}

const PATCH: &str = "[contact]\npatch_radius = 0.006\n";
const STEPS: &str = "end = 4e-4\nstep = 5e-6\nscheme = \"newmark\"";

/// Largest difference of two acceleration series over the first one's peak.
fn difference(one: &[f64], other: &[f64]) -> f64 {
    let peak = one.iter().fold(0.0_f64, |m, a| m.max(*a));
    one.iter().zip(other).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / peak
}

fn accelerations(session: &Session, text: &str) -> Vec<f64> {
    let (_, mut impact) = start(&session.world(), text);
    run_steps(&mut impact).iter().map(|step| step.impactor.acceleration).collect()
}

/// Layers of glass equal a plate of glass on the same cells: five layers, and three of which one differs by less than
/// is visible.
fn layers_of_one_stiffness(session: &Session) {
    let body = "cells = [8, 8, 3]\nreduction = \"none\"";
    let whole = accelerations(session, &plate(0.018, body, STEPS, PATCH));
    for young in [70e9, 70e9 * (1.0 + 1e-12)] {
        let layered = accelerations(session, &laminate([0.006; 3], [young, 2500.0], body, STEPS, PATCH));
        let off = difference(&whole, &layered);
        // The change of the modulus, and rounding of the planes' coordinates.
        assert!(off < 1e-9, "{young}: {off:e}");
    }
    // A core that is much softer gives another result.
    let soft = accelerations(session, &laminate([0.006; 3], [7e9, 2500.0], body, STEPS, PATCH));
    assert!(difference(&whole, &soft) > 1e-2);
}

/// A mesh file with one physical volume for each layer equals a box with these layers.
fn volumes_are_layers(session: &Session) {
    let (cells, thickness) = ([6, 6, 3], 0.006);
    let text = bricks(Shape::Hexahedron, [0.3, 0.24, 3.0 * thickness], cells, 0.0);
    // Cells are listed layer by layer, each as an element of Gmsh's type 5 in group 4.
    let (mut found, each) = (0, cells[0] * cells[1]);
    let lines = text.lines().map(|line| {
        let is_cell = line.split(' ').nth(1) == Some("5") && line.split(' ').count() == 13;
        found += usize::from(is_cell);
        let is_core = is_cell && (each + 1..=2 * each).contains(&found);
        if is_core { line.replacen(" 5 2 4 4 ", " 5 2 5 5 ", 1) } else { line.to_owned() }
    });
    let text = lines.collect::<Vec<_>>().join("\n") + "\n";
    let named = text.replacen("$PhysicalNames\n4\n", "$PhysicalNames\n5\n", 1);
    let named = named.replacen("3 4 \"body\"\n", "3 4 \"glass\"\n3 5 \"core\"\n", 1);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layers.msh");
    std::fs::write(&path, &named).unwrap();
    let rest = format!("{PATCH}material = \"glass\"\n");
    let materials = laminate([thickness; 3], [7e9, 1300.0], "", STEPS, &rest);
    let materials = materials.split_once("[material.glass]").map(|(_, rest)| rest.to_owned()).unwrap();
    let impactor = "[impactor]\npoint = [0.0, 0.0, 0.009]\n";
    let body = |keys: &str| {
        let materials = materials.replacen("[impactor]\n", impactor, 1);
        format!("[body]\nmesh = {path:?}\nreduction = \"none\"\n{keys}[material.glass]{materials}")
    };
    let mesh = accelerations(session, &body(""));
    let cells = "cells = [6, 6, 3]\nsymmetry = \"none\"\nreduction = \"none\"";
    let layers = accelerations(session, &laminate([thickness; 3], [7e9, 1300.0], cells, STEPS, PATCH));
    // Rounding of another order of summation.
    assert!(difference(&layers, &mesh) < 1e-9, "{:e}", difference(&layers, &mesh));
    // A volume without a material, and a material without a volume.
    for (from, to, fragment) in [
        ("[material.core]", "[material.kernel]", "the mesh names \"glass\", \"core\""),
        ("[material.core]\nyoung = 7e9\npoisson = 0.23\ndensity = 1300\n", "", "36 cells are in no physical volume"),
    ] {
        let text = body("").replacen(from, to, 1);
        assert_ne!(text, body(""), "{from}");
        let scene = parse(&text);
        let error = ricochet::mesh::Mesh::new(&session.world(), &scene.body).err().expect(fragment);
        let error = match error {
            ricochet::Error::Fault(fault) => format!("{}; {}", fault.message, fault.help),
            other => other.to_string(),
        };
        assert!(error.contains(fragment), "{error}");
    }
}

/// The same body with a quarter of the area: the layers, and the cells across them, stay.
fn small(text: String) -> String {
    text.replace("[0.3, 0.24", "[0.15, 0.12")
}

/// The spline space with lines at interfaces contains the space without: layers that differ negligibly give the result
/// of the plate.
fn splines_of_one_stiffness(session: &Session) {
    let rest = format!("{PATCH}[accuracy]\ntolerance = 1e-3\n");
    let whole = run(&session.world(), &small(plate(0.018, "model = \"solid\"", "end = 3e-4", &rest)));
    let core = [70e9 * (1.0 + 1e-9), 2500.0];
    let layered = laminate([0.008, 0.002, 0.008], core, "model = \"solid\"", "end = 3e-4", &rest);
    let layered = run(&session.world(), &small(layered));
    let (first, _) = whole.difference(&layered);
    assert!(whole.vectors.is_some() && layered.vectors.is_some());
    // Both have a tolerance of 1e-3, with other discs and cells.
    assert!(first < 1e-3, "{first:e}");
}

/// Splines and hexahedra of the same laminate.
fn splines_and_hexahedra_agree(session: &Session) {
    let core = [1e9, 1100.0];
    let layers = [0.008, 0.002, 0.008];
    let rest = format!("{PATCH}[accuracy]\ntolerance = 3e-3\n");
    let splines = run(&session.world(), &small(laminate(layers, core, "", "end = 3e-4", &rest)));
    assert!(splines.theory == Model::Solid && splines.vectors.is_some());
    let time = "end = 3e-4\nstep = 2e-6\nscheme = \"newmark\"";
    let meshed = run(&session.world(), &small(laminate(layers, core, "reduction = \"none\"", time, &rest)));
    assert!(meshed.vectors.is_none());
    let (first, _) = splines.difference(&meshed);
    println!("splines and hexahedra differ by {first:e}");
    // The error of the default mesh is about 1% of the peak, as for plates of one material.
    assert!(first < 1.5e-2, "{first:e}");
}

/// Gravity uses the density of each layer: the sum of the load is the weight, for every discretisation.
fn weight_of_layers(session: &Session) {
    let weight = 0.3 * 0.24 * 9.8 * (2500.0 * 0.016 + 1100.0 * 0.002);
    let gravity = "[load]\ngravity = [0.0, 0.0, -9.8]\n";
    for body in ["model = \"solid\"", "model = \"solid\"\ncells = [6, 6, 3]"] {
        let scene = parse(&laminate([0.008, 0.002, 0.008], [1e9, 1100.0], body, "end = 1e-4", gravity));
        let comm = session.world();
        let loaded = match build(&ModelContext::new(&comm, &Unwatched(&comm)), &scene, Model::Solid, 1.0).unwrap() {
            Built::Operators(built) => built.body.in_petsc(&session.alone()).unwrap(),
            Built::Given(_) => panic!("operators"),
        };
        let found = loaded.terms.multiplicity * loaded.terms.load.dot(&loaded.terms.translation).unwrap();
        let mut momentum = loaded.terms.load.duplicate().unwrap();
        loaded.apply_mass(&loaded.terms.translation, &mut momentum).unwrap();
        let mass = loaded.terms.multiplicity * momentum.dot(&loaded.terms.translation).unwrap();
        // Rounding of some thousand cells.
        assert!((found / weight - 1.0).abs() < 1e-9 && (mass * 9.8 / weight - 1.0).abs() < 1e-9, "{found} {mass}");
    }
}

/// Plate theories of one material are refused for this body, and `auto` states why it uses the solid.
fn auto_takes_the_solid(session: &Session) {
    let text =
        |model: &str| laminate([0.003, 0.001, 0.003], [1e9, 1100.0], &format!("model = \"{model}\""), "end = 1e-4", "");
    for model in ["mindlin", "kirchhoff", "infinite-plate"] {
        let error = ricochet::model::Model::new(&session.world(), &parse(&text(model))).err().expect(model).to_string();
        assert!(error.contains("layers are of different materials"), "{error}");
    }
    let scene = parse(&laminate([0.03, 0.01, 0.03], [1e9, 1100.0], "", "end = 1e-5", "[accuracy]\ntolerance = 0.5"));
    let model = ricochet::model::Model::new(&session.world(), &scene).unwrap();
    assert_eq!(model.theory, Model::Solid);
    assert!(model.reason.expect("a reason").contains("less than 4 times its thickness"));
}
