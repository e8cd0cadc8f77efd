//! Supports and loads on parts of surfaces, for every discretisation.

use std::f64::consts::PI;
use std::path::Path;

use crate::glass;
use mpi_test::{Test, tests};

use petsc_wrap::Session;
use ricochet::body::Body;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::space::plate::{self, Plate, PlateTheory};
use ricochet::space::spline::{Settings, SplineSolid};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![
    areas_of_parts_on_every_space,
    areas_of_parts_of_a_mesh,
    a_strip_that_cuts_cells_is_that_of_a_mesh_with_its_edge
];

const SIZE: [f64; 3] = [0.6, 0.5, 0.02];
const K: f64 = 3e8;
const C: f64 = 2e3;
const PRESSURE: f64 = 7e4;

/// A scene with a support, a damper and a traction on a part of a surface.
fn scene(surface: &str, within: &str, rest: &str) -> Scene {
    let [x, y, z] = SIZE;
    let (young, poisson, density) = glass::GLASS;
    let text = format!(
        "[body]\nyoung = {young:e}\npoisson = {poisson}\ndensity = {density}\nsize = [{x}, {y}, {z}]\n{rest}\n\
         [[support]]\nsurface = \"{surface}\"\nwithin = {within}\nkind = \"elastic\"\n\
         stiffness = [0, 0, {K:e}]\ndamping = [0, 0, {C:e}]\n\
         [[load.traction]]\nsurface = \"{surface}\"\nwithin = {within}\nvalue = [0, 0, {PRESSURE:e}]\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 1e-3\n"
    );
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}")).0
}

/// The scene's body for each discretisation, with a name; on several ranks only those that ranks share.
fn bodies(session: &Session, surface: &str, within: &str) -> Vec<(String, Body)> {
    let mut bodies = Vec::new();
    for symmetry in ["quarter", "none"] {
        if session.world().size() == 1 {
            let scene = scene(surface, within, &format!("symmetry = \"{symmetry}\""));
            let splines =
                SplineSolid::new(&scene, &Settings { cell_size_factor: 3.0, part_cell_factor: 1.0 }).unwrap().system;
            bodies.push((format!("splines, {symmetry}"), Body::of(&session.alone(), &splines).unwrap()));
            for theory in [PlateTheory::Kirchhoff, PlateTheory::Layerwise] {
                let plate = Plate::new(&scene, theory, &plate::Settings::default()).unwrap().system;
                bodies.push((format!("plate of {theory:?}, {symmetry}"), Body::of(&session.alone(), &plate).unwrap()));
            }
        }
        let meshed = format!("symmetry = \"{symmetry}\"\ncells = [8, 6, 2]\norder = 2");
        let scene = self::scene(surface, within, &meshed);
        let mesh = Mesh::new(&session.world(), &scene.body).unwrap();
        bodies.push((format!("hexahedra, {symmetry}"), Body::solid(&scene, &mesh).unwrap()));
    }
    bodies
}

/// The resultants of springs, dampers and tractions for a unit displacement are k A, c A and p A, whatever cells the
/// part's boundary cuts.
fn areas_of_parts_on_every_space(session: &Session) {
    let [x, y, z] = SIZE;
    let (rim, disc): (f64, f64) = (0.017, 0.083);
    // Area of the sides.
    let edge = 2.0 * (x + y) * z;
    for (surface, within, area) in [
        ("bottom", format!("{{ rim = {rim} }}"), x * y - (x - 2.0 * rim) * (y - 2.0 * rim)),
        ("side", "{ box = [[-1, -1, -0.004], [1, 1, 0.005]] }".to_owned(), edge * 0.009 / z),
        ("top", "{ box = [[-0.11, -0.23, 0], [0.11, 0.23, 1]] }".to_owned(), 0.22 * 0.46),
        ("bottom", format!("{{ disc = {{ centre = [0, 0, -0.01], radius = {disc} }} }}"), PI * disc * disc),
        ("side", "{ rim = 0.004 }".to_owned(), edge - 2.0 * (x + y - 0.016) * (z - 0.008)),
        ("bottom", "{ rim = 1.0 }".to_owned(), x * y),
    ] {
        for (name, body) in bodies(session, surface, &within) {
            let (translation, multiplicity) = (&body.terms.translation, body.terms.multiplicity);
            let mut product = translation.duplicate().unwrap();
            let mut along = |matrix: &Option<petsc_wrap::Matrix>| {
                matrix.as_ref().unwrap().mult(translation, &mut product).unwrap();
                multiplicity * product.dot(translation).unwrap()
            };
            let found = [along(&body.terms.support) / K, along(&body.terms.damping) / C, {
                // Opposite to the direction of travel.
                -multiplicity * body.terms.load.dot(translation).unwrap() / PRESSURE
            }];
            // The compression of half of the thickness is in series with springs on the face of a plate.
            let is_on_face = name.contains("plate") && surface != "side";
            let softer = if is_on_face { 1.0 / (1.0 + K * 0.5 * z / glass::GLASS.0) } else { 1.0 };
            for (found, area) in found.into_iter().zip([softer * area, area, area]) {
                // Quadrature along the rim of a disc: 1e-10 of each facet.
                assert!((found / area - 1.0).abs() < 1e-9, "{surface} within {within}, {name}: {found} {area}");
            }
        }
    }
}

/// A part that cuts triangles of a Gmsh file. A part that contains nothing of its surface is refused.
fn areas_of_parts_of_a_mesh(session: &Session) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes/plate20.msh");
    let body = |within: &str| {
        let rest = format!(
            "[[support]]\nsurface = \"bottom\"\nwithin = {within}\nkind = \"elastic\"\nstiffness = [0, 0, {K:e}]\n"
        );
        let impactor = "mass = 1.0\nspeed = 1.0\npoint = [0.0, 0.0, 0.01]";
        let text = glass::scene(&format!("mesh = {file:?}"), impactor, "end = 1e-3", &rest);
        let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}")).0;
        Body::solid(&scene, &Mesh::new(&session.world(), &scene.body).unwrap())
    };
    let radius: f64 = 0.11;
    for (within, area, square) in [
        (
            "{ box = [[-0.2, -0.13, -1], [0.17, 0.22, 0]] }",
            0.37 * 0.35,
            0.35 * (0.17_f64.powi(3) + 0.2_f64.powi(3)) / 3.0,
        ),
        (
            "{ disc = { centre = [0.03, -0.05, -0.01], radius = 0.11 } }",
            PI * radius * radius,
            PI * radius * radius * (0.25 * radius * radius + 0.03 * 0.03),
        ),
    ] {
        let body = body(within).unwrap();
        let mut product = body.terms.translation.duplicate().unwrap();
        body.terms.support.as_ref().unwrap().mult(&body.terms.translation, &mut product).unwrap();
        let found = product.dot(&body.terms.translation).unwrap() / K;
        assert!((found / area - 1.0).abs() < 1e-9, "{within}: {found} {area}");
        // ∫ x² dA with the field u_z = x; it would be wrong if shape functions were evaluated at the wrong place.
        let mut tilted = body.terms.translation.duplicate().unwrap();
        let nodes = body.nodes.as_ref().unwrap();
        tilted.write().unwrap().chunks_exact_mut(3).zip(nodes).for_each(|(u, x)| u.copy_from_slice(&[0.0, 0.0, x[0]]));
        body.terms.support.as_ref().unwrap().mult(&tilted, &mut product).unwrap();
        let found = product.dot(&tilted).unwrap() / K;
        assert!((found / square - 1.0).abs() < 1e-9, "{within}: {found} {square}");
    }
    let error = body("{ box = [[-0.2, -0.13, 0], [0.17, 0.22, 1]] }").err().expect("nothing is there").to_string();
    assert!(error.contains("support.0.within") && error.contains("lies within"), "{error}");
}

/// Work of a pressure on plates supported on a strip: one plate has a cell boundary at the strip's edge, the others do
/// not.
fn a_strip_that_cuts_cells_is_that_of_a_mesh_with_its_edge(session: &Session) {
    let work = |cells: [usize; 2]| {
        let rest = "[[support]]\nsurface = \"bottom\"\nwithin = { rim = 0.06 }\nkind = \"elastic\"\nstiffness = 1e9\n\
                    [[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1e3]\n";
        let body = format!("size = [0.6, 0.48, 0.02]\ncells = [{}, {}, 2]\nmodel = \"solid\"", cells[0], cells[1]);
        let text = glass::scene(&body, "mass = 1.0\nspeed = 1.0", "end = 1e-3", rest);
        let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}")).0;
        let mesh = Mesh::new(&session.world(), &scene.body).unwrap();
        let body = Body::solid(&scene, &mesh).unwrap();
        let operator = body.operator(0.0, 0.0).unwrap();
        let mut moved = body.terms.load.duplicate().unwrap();
        body.solver(&operator).unwrap().solve(&body.terms.load, &mut moved).unwrap();
        body.terms.multiplicity * body.terms.load.dot(&moved).unwrap()
    };
    // Cells of 30 mm, and of 27 and 25 mm.
    let [with_edge, cut, cut_elsewhere] = [[20, 16], [22, 18], [24, 20]].map(work);
    println!("{with_edge:e}: {:.1e} {:.1e}", cut / with_edge - 1.0, cut_elsewhere / with_edge - 1.0);
    for found in [cut, cut_elsewhere] {
        // The meshes differ as much without a strip.
        assert!((found / with_edge - 1.0).abs() < 1e-3, "{found:e} {with_edge:e}");
    }
}
