//! Boxes of splines: exact vibrations, symmetries, sums, comparison with hexahedra, the thin limit, and scenes they
//! cannot model.

mod bending;

use crate::glass;
use bending::{bending_is_all_but_a_constant, bending_on_more_supports};
use mpi_test::{Test, tests};
use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use nalgebra_sparse::CsrMatrix;
use petsc_wrap::{Session, Vector};
use ricochet::body::{Body, Krylov, ModalBody, System};
use ricochet::contact::hertz;
use ricochet::impact::{Errors, ModalImpact, Trace};
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::solve::linear::{Method, solver};
use ricochet::space::spline::{Settings, SplineSolid, admits};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    vibrations_between_sliding_walls,
    a_free_box_has_six_rigid_motions,
    a_quarter_answers_as_the_whole,
    images_and_turned_boxes_answer_alike,
    resultants,
    displaced_clamps_carry_the_box,
    a_bar_hit_on_its_end_as_a_mesh,
    a_loaded_bar_as_a_mesh,
    thin_plates_do_not_lock,
    impacts_as_on_a_mesh,
    bending_is_all_but_a_constant,
    scenes_that_are_no_blocks
];
pub const LONG: &[Test<Session>] = tests![loaded_boxes_as_meshes, bending_on_more_supports];

/// Every rank has the whole spline body, so the tests run on one rank only.
fn parse(text: &str) -> Scene {
    Scene::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// A scene with the paper's glass and impactor.
fn scene(body: &str, impactor: &str, rest: &str) -> Scene {
    let impactor = format!("mass = {}\nspeed = 1.0\n{impactor}", glass::MASS);
    parse(&glass::scene(body, &impactor, "end = 1e-3", rest))
}

fn block(scene: &Scene, cell_size_factor: f64) -> SplineSolid {
    SplineSolid::new(scene, &Settings { cell_size_factor, part_cell_factor: 1.0 })
        .unwrap_or_else(|error| panic!("{error}"))
}

fn body(session: &Session, scene: &Scene, cell_size_factor: f64) -> Body {
    Body::of(&session.alone(), &block(scene, cell_size_factor).system).unwrap()
}

fn meshed(session: &Session, scene: &Scene) -> Body {
    let comm = session.world();
    Body::solid(scene, &Mesh::new(&comm, &scene.body).unwrap()).unwrap()
}

/// The displacement under a load at the Laplace parameter s (1/s), S = K + sC + s²M, with the constrained unknowns at
/// their values.
fn solve(body: &Body, rate: f64, load: &Vector) -> Vector {
    let (mut right, mut u) = (load.duplicate().unwrap(), load.duplicate().unwrap());
    body.combination(rate, rate * rate).unwrap().mult(&body.clamps.displacement, &mut right).unwrap();
    right.aypx(-1.0, load).unwrap();
    body.clamps.zero(&mut right).unwrap();
    solver(body.comm(), "", &body.operator(rate, rate * rate).unwrap(), Method::Cholesky)
        .unwrap()
        .solve(&right, &mut u)
        .unwrap();
    u.axpy(1.0, &body.clamps.displacement).unwrap();
    u
}

/// Displacement average under a unit force on the whole body, minus the part of it that is in the contact law.
fn answer(body: &Body, rate: f64) -> f64 {
    let a = &body.terms.contact;
    (a.force.dot(&solve(body, rate, &a.force)).unwrap() - a.compliance) / body.terms.multiplicity
}

/// Displacement average under the scene's loads.
fn deflection(body: &Body) -> f64 {
    let mut load = body.terms.load.duplicate().unwrap();
    load.copy_from(&body.terms.load).unwrap();
    load.axpy(1.0, &body.terms.support_load).unwrap();
    body.terms.contact.force.dot(&solve(body, 0.0, &load)).unwrap()
}

/// Compliance of a half-space under Hertz's pressure over a radius of 0.025 m, m/N.
fn dent() -> f64 {
    let (young, nu, _) = glass::GLASS;
    0.6 * (1.0 - nu * nu) / (young * 0.025)
}

fn clamped(surface: &str, components: &str, rest: &str) -> String {
    format!("[[support]]\nsurface = \"{surface}\"\nkind = \"clamped\"\ncomponents = {components}\n{rest}\n")
}

/// The vibrations of a box that slides between walls are products of sines and cosines. There are two shear waves for
/// each (l, m, n) without zeros, one with a single zero, and one longitudinal wave for each except (0, 0, 0).
fn vibrations_between_sliding_walls(session: &Session) {
    let edges = [0.3, 0.23, 0.17];
    let (young, nu, density) = glass::GLASS;
    let (shear, lambda) = (young / (2.0 + 2.0 * nu), young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    let mut exact = Vec::new();
    for number in 1..125 {
        let waves = [number % 5, number / 5 % 5, number / 25];
        let square: f64 = waves.iter().zip(edges).map(|(&n, edge)| (PI * n as f64 / edge).powi(2)).sum();
        exact.push((lambda + 2.0 * shear) / density * square);
        let zeros = waves.iter().filter(|n| **n == 0).count();
        exact.extend(vec![shear / density * square; 2_usize.saturating_sub(zeros).min(2)]);
    }
    exact.sort_by(f64::total_cmp);
    // The force excites one of the vibrations that share a frequency.
    exact.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-12);
    let walls = ["x", "y", "z"].map(|axis| {
        let side = |end: &str| clamped(&format!("{axis}-{end}"), &format!("[\"{axis}\"]"), "");
        side("min") + &side("max")
    });
    let direction = "point = [0.04, 0.03, 0.085]\ndirection = [0.48, 0.6, -0.64]";
    let scene = scene(&format!("size = {edges:?}"), direction, &walls.concat());
    let errors = [1.6, 0.8].map(|cell_size_factor| {
        let body = body(session, &scene, cell_size_factor);
        let mut krylov = Krylov::new(&body, 3e4).unwrap();
        krylov.grow(&body, 80).unwrap();
        let mut squares =
            SymmetricEigen::new(krylov.projection(&body).unwrap().terms.elastic).eigenvalues.as_slice().to_vec();
        squares.sort_by(f64::total_cmp);
        let error = squares.iter().zip(&exact).take(6).map(|(found, exact)| found / exact - 1.0).fold(0.0, f64::max);
        println!(
            "cell_size_factor {cell_size_factor}: {} unknowns, error {error:.2e} of squared frequencies",
            body.unknowns()
        );
        error
    });
    // The resolution is from about 3 cells to about 5 cells in half a wavelength. The observed order corresponds to
    // splines with uniform cells.
    assert!(errors[1] < 5e-4 && errors[1] < 0.2 * errors[0], "{errors:?}");
}

fn a_free_box_has_six_rigid_motions(_: &Session) {
    let scene = scene("size = [0.13, 0.12, 0.1]", "point = [0.01, 0.02, 0.05]", "[contact]\npatch_radius = 0.02\n");
    let system = block(&scene, 2.0).system;
    let eigen = SymmetricEigen::new(DMatrix::from(&system.terms.elastic)).eigenvalues;
    let mut values = eigen.as_slice().to_vec();
    values.sort_by(f64::total_cmp);
    let most = values[values.len() - 1];
    // Rounding of the eigenvalues, compared with the lowest elastic one.
    assert!(values[..6].iter().all(|value| value.abs() < 1e-12 * most), "{:?}", &values[..8]);
    assert!(values[6] > 1e-7 * most, "{:?}", &values[..8]);
}

/// A quarter gives the result of the whole. At the symmetry planes the splines of the whole have one derivative less
/// than the exact smoothness.
fn a_quarter_answers_as_the_whole(session: &Session) {
    for rest in [glass::sides(1e9, 2e5), clamped("bottom", "[\"z\"]", "") + &glass::sides(1e8, 0.0)] {
        for rate in [0.0, 3e3] {
            let [quarter, whole] = ["quarter", "none"].map(|symmetry| {
                let body = format!("size = [0.5, 0.4, 0.1]\nsymmetry = \"{symmetry}\"");
                answer(&self::body(session, &scene(&body, "", &rest), 1.3), rate)
            });
            println!("{rate}: {quarter:e} {whole:e}, {:.1e} of the dent", (quarter - whole) / dent());
            // A fraction of the error of either, which is a fraction of the dent.
            assert!((quarter - whole).abs() < 3e-3 * dent(), "{rate}: {quarter:e} {whole:e}");
        }
    }
}

/// Mirror images of an impact off the centre, and boxes with exchanged axes (directions and supports too), give the
/// same result.
fn images_and_turned_boxes_answer_alike(session: &Session) {
    let (size, point, direction, springs) =
        ([0.31, 0.2, 0.07], [0.04, -0.03, 0.035], [0.36, 0.48, -0.8], [1e9, 3e9, 2e9]);
    let case = |axes: [usize; 3], signs: [f64; 3]| {
        let turn = |v: [f64; 3]| axes.map(|i| v[i]);
        let image = |v: [f64; 3]| turn([0, 1, 2].map(|i| signs[i] * v[i]));
        let name = ["x", "y", "z"][axes.iter().position(|i| *i == 0).unwrap()];
        let support = |end: &str, factor: f64| {
            let stiffness = turn(springs.map(|k| factor * k));
            let damping = turn([1e5, 2e5, 4e5]);
            format!(
                "[[support]]\nsurface = \"{name}-{end}\"\nkind = \"elastic\"\nstiffness = {stiffness:?}\ndamping = {damping:?}\n"
            )
        };
        let [low, high] = if signs[0] > 0.0 { ["min", "max"] } else { ["max", "min"] };
        let impactor = format!("point = {:?}\ndirection = {:?}", image(point), image(direction));
        let scene = scene(&format!("size = {:?}", turn(size)), &impactor, &(support(low, 1.0) + &support(high, 2.0)));
        answer(&body(session, &scene, 2.0), 2e4)
    };
    let first = case([0, 1, 2], [1.0; 3]);
    for (axes, signs) in [
        ([0, 1, 2], [-1.0, 1.0, 1.0]),
        ([0, 1, 2], [1.0, -1.0, -1.0]),
        ([1, 0, 2], [1.0; 3]),
        ([2, 0, 1], [-1.0, 1.0, -1.0]),
        ([2, 1, 0], [1.0; 3]),
    ] {
        let other = case(axes, signs);
        // Rounding times the condition number of the system.
        assert!((other / first - 1.0).abs() < 1e-8, "{axes:?} {signs:?}: {other:e} {first:e}");
    }
}

fn product(matrix: &Option<CsrMatrix<f64>>, u: &DVector<f64>, v: &DVector<f64>) -> f64 {
    let matrix = matrix.as_ref().expect("a matrix");
    matrix.triplet_iter().map(|(i, j, value)| u[i] * value * v[j]).sum()
}

/// Resultants over the body and over faces, of quarters and of wholes.
fn resultants(_: &Session) {
    let rest = "[load]\nbody_force = [0, 0, -2e4]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -3e3]\n\
        [[load.traction]]\nsurface = \"side\"\nvalue = [0, 0, 5e3]\n\
        [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e8, 1e8, 1e9]\ndisplacement = [0, 0, -1e-3]\n\
        [[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e7]\ndamping = [3e5, 3e5, 4e5]\n";
    for symmetry in ["quarter", "none"] {
        let scene = scene(&format!("size = [0.6, 0.4, 0.1]\nsymmetry = \"{symmetry}\""), "", rest);
        let system: System = block(&scene, 2.0).system;
        let (sides, area, volume) = (2.0 * 0.1, 0.24, 0.024);
        let one = DVector::from_column_slice(&system.terms.translation);
        let along = |v: &[f64]| system.terms.multiplicity * one.dot(&DVector::from_column_slice(v));
        let mass = Some(system.mass.clone());
        for (found, exact) in [
            (system.terms.multiplicity * product(&mass, &one, &one), 2500.0 * volume),
            (along(&system.terms.load), 2e4 * volume + 3e3 * area - 5e3 * sides),
            (along(&system.terms.support_load), 1e9 * 1e-3 * sides),
            (system.terms.multiplicity * system.terms.support_offset, 0.5 * 1e9 * 1e-6 * sides),
            (system.terms.multiplicity * product(&system.terms.support, &one, &one), 1e9 * sides + 1e7 * area),
            (system.terms.multiplicity * product(&system.terms.damping, &one, &one), 4e5 * area),
            (one.dot(&DVector::from_column_slice(&system.terms.contact.force)), 1.0),
        ] {
            // Rounding of some thousand terms.
            assert!((found / exact - 1.0).abs() < 1e-10, "{symmetry}: {found} {exact}");
        }
    }
}

/// If all clamps have the same prescribed displacement, the whole body moves by it.
fn displaced_clamps_carry_the_box(session: &Session) {
    let rest = clamped("x-min", r#"["x", "y", "z"]"#, "displacement = [1e-3, -2e-3, 3e-3]")
        + &clamped("y-max", r#"["x", "y", "z"]"#, "displacement = [1e-3, -2e-3, 3e-3]");
    let scene = scene("size = [0.3, 0.2, 0.05]", "direction = [0.0, 0.6, -0.8]", &rest);
    let found = deflection(&body(session, &scene, 1.6));
    assert!((found / (-0.6 * 2e-3 - 0.8 * 3e-3) - 1.0).abs() < 1e-9, "{found}");
}

fn a_loaded_bar_as_a_mesh(session: &Session) {
    check_boxes_as_meshes(session, 2..3);
}

fn a_bar_hit_on_its_end_as_a_mesh(session: &Session) {
    check_boxes_as_meshes(session, 3..4);
}

fn loaded_boxes_as_meshes(session: &Session) {
    check_boxes_as_meshes(session, 0..4);
}

/// Static and dynamic results are compared with quadratic hexahedra: loads, impacts off the centre and oblique ones, a
/// bar hit on its side and on its end. The part of the dent that is in the contact law is removed, since the spline
/// body uses a smoother pressure.
fn check_boxes_as_meshes(session: &Session, chosen: Range<usize>) {
    let side = clamped("x-min", r#"["x", "y", "z"]"#, "");
    let cantilever = format!(
        "[load]\nbody_force = [1e4, 2e4, -3e4]\n[[load.traction]]\nsurface = \"x-max\"\nvalue = [0, 1e4, -4e4]\n{side}"
    );
    let springs = glass::sides(5e9, 3e5);
    let boxes = [
        (
            "size = [0.3, 0.2, 0.06]",
            "cells = [14, 12, 6]\ngrading = [5, 4, 3]",
            "point = [0.05, 0.02, 0.03]",
            &cantilever,
        ),
        (
            "size = [0.3, 0.2, 0.06]",
            "cells = [14, 12, 6]\ngrading = [5, 4, 3]",
            "point = [0.05, 0.02, 0.03]\ndirection = [0.6, 0.0, -0.8]",
            &springs,
        ),
        ("size = [0.3, 0.06, 0.06]", "cells = [20, 8, 6]\ngrading = [10, 1.5, 3]", "", &cantilever),
        (
            "size = [0.3, 0.06, 0.06]",
            "cells = [16, 8, 8]\ngrading = [10, 1.5, 1.5]",
            "point = [0.15, 0.0, 0.0]\ndirection = [-1.0, 0.0, 0.0]\nmass = 1",
            &side,
        ),
    ];
    for (body, cells, impactor, rest) in boxes[chosen].iter().copied() {
        let (mass, impactor) = match impactor.split_once("\nmass = ") {
            Some((rest, mass)) => (mass.parse().unwrap(), rest),
            None => (glass::MASS, impactor),
        };
        let radius = 0.015;
        let text = |body: &str| {
            let impactor = format!("mass = {mass}\nspeed = 0.5\n{impactor}");
            let rest = format!("[contact]\npatch_radius = {radius}\n{rest}");
            parse(&glass::scene(body, &impactor, "end = 1e-3", &rest))
        };
        let [mesh, splines] =
            [meshed(session, &text(&format!("{body}\n{cells}"))), self::body(session, &text(body), 1.0)];
        for rate in [0.0, 2e4] {
            let [meshed, found] = [&mesh, &splines].map(|body| answer(body, rate));
            println!("{body}, {rate}: {found:e} and {meshed:e} of a mesh: {:.1e}", found / meshed - 1.0);
            // The error of the dent with cells of half the patch radius is larger than the rest.
            assert!((found / meshed - 1.0).abs() < 5e-3, "{body}, {rate}: {found:e} {meshed:e}");
        }
        let [meshed, found] = [&mesh, &splines].map(deflection);
        if meshed != 0.0 {
            println!("{body}: {found:e} and {meshed:e} of a mesh under loads: {:.1e}", found / meshed - 1.0);
            assert!((found / meshed - 1.0).abs() < 2e-3, "{body}: {found:e} {meshed:e}");
        }
        session.world().collect_garbage().unwrap();
    }
}

/// A square plate under pressure, with its edges supported against deflection and against motion along the edge:
/// Navier's w = 0.00406235 q L⁴/D, plus the shear deflection, 0.0736714 q L²/(5/6 μh) (Timoshenko & Woinowsky-Krieger,
/// Theory of Plates and Shells, 1959).
fn thin_plates_do_not_lock(session: &Session) {
    let (young, nu, _) = glass::GLASS;
    let sides = [("x", "y"), ("y", "x")].map(|(across, along)| {
        let side = |end: &str| clamped(&format!("{across}-{end}"), &format!("[\"{along}\", \"z\"]"), "");
        side("min") + &side("max")
    });
    let rest = sides.concat() + "[load]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1.0]\n";
    for thickness in [1e-2, 1e-3] {
        let scene = scene(&format!("size = [1.0, 1.0, {thickness:e}]"), "stiffness = 1e3", &rest);
        let found = deflection(&body(session, &scene, 1.3));
        let rigidity = young * f64::powi(thickness, 3) / (12.0 * (1.0 - nu * nu));
        let shear = 0.5 * young / (1.0 + nu) * thickness;
        let exact = 0.004_062_353 / rigidity + 0.073_671_4 / (5.0 / 6.0 * shear);
        println!("h/L = {thickness:e}: {:.2e}", found / exact - 1.0);
        // The discretisation error of a dozen cells; a plate that locks has an error of 100%.
        assert!((found / exact - 1.0).abs() < 2e-4, "{thickness:e}: {:e}", found / exact - 1.0);
    }
}

/// Time history of the force in modal coordinates.
fn trace(scene: &Scene, body: &Body) -> Trace {
    let impactor = &scene.impactor;
    let rate = 15.0 / hertz::contact_time(impactor.stiffness, impactor.mass, impactor.speed);
    let mut krylov = Krylov::new(body, rate).unwrap();
    krylov.grow(body, 50).unwrap();
    let modes = ModalBody::of(&krylov.projection(body).unwrap());
    ModalImpact::new(scene, &modes).trace(None).unwrap().0
}

/// Compares the time history of the force with hexahedra.
fn impacts_as_on_a_mesh(session: &Session) {
    for rest in [glass::sides(1e10, 0.0), glass::sides(2e9, 3e5)] {
        let scene = |cells: &str| {
            let body = format!("model = \"solid\"\nsize = [0.3, 0.3, 0.03]\n{cells}");
            let rest = format!("[contact]\npatch_radius = 7.5e-3\n[accuracy]\ntolerance = 1e-3\n{rest}");
            parse(&glass::scene(&body, "mass = 5.0\nspeed = 1.0", "end = 2e-3\nscheme = \"modal\"", &rest))
        };
        let mesh = scene("cells = [24, 24, 5]\ngrading = [5, 5, 3]");
        let meshed = trace(&mesh, &meshed(session, &mesh));
        let splines = scene("");
        let found = trace(&splines, &body(session, &splines, 1.0));
        let Errors { first_contact: first, .. } = found.difference(&meshed);
        println!("{first:.2e} in the first contact");
        // Twice the discretisation error of the mesh with cells of half the patch radius.
        assert!(first < 3e-3, "{first}");
        session.world().collect_garbage().unwrap();
    }
}

fn scenes_that_are_no_blocks(_: &Session) {
    let size = "size = [0.5, 0.4, 0.1]";
    for (body, rest, clause) in [
        (size, "[contact]\nlocalization = \"point\"\n", "without limit"),
        ("size = [50, 50, 0.03]", "", "unknowns"),
        ("size = [50, 50, 0.01]", "", "rounding"),
    ] {
        let scene = scene(body, "", rest);
        let reason = admits(&scene).expect_err(clause);
        assert!(reason.contains(clause), "{reason}");
        let error = SplineSolid::new(&scene, &Settings::new(scene.tolerance)).expect_err(clause).to_string();
        assert!(error.contains("body.model") && error.contains(&reason), "{error}");
    }
    let contact = |radius: f64| format!("[contact]\npatch_radius = {radius}\n");
    for (impactor, rest, clause) in [
        ("", contact(0.3), "has no room"),
        ("point = [0.25, 0.0, 0.05]", String::new(), "no room"),
        ("point = [0.2499, 0.0, 0.05]", String::new(), "negative stiffness"),
    ] {
        let scene = scene(size, impactor, &rest);
        let error = SplineSolid::new(&scene, &Settings { cell_size_factor: 1.0, part_cell_factor: 1.0 })
            .expect_err(clause)
            .to_string();
        let key = if rest.is_empty() { "impactor.point" } else { "contact.patch_radius" };
        assert!(error.contains(key) && error.contains(clause), "{error}");
    }
    assert_eq!(admits(&scene(size, "direction = [0.6, 0.0, -0.8]", "")), Ok(()));
    // However coarse the cells, there is at least one along each axis.
    for size in ["size = [0.5, 0.4, 0.1]", "size = [0.5, 0.4, 0.01]", "size = [0.1, 0.1, 0.5]"] {
        let block = SplineSolid::new(
            &scene(size, "stiffness = 1e3", ""),
            &Settings { cell_size_factor: 8.0, part_cell_factor: 1.0 },
        )
        .unwrap();
        assert!(block.cells.iter().all(|cells| *cells > 0), "{size}: {:?}", block.cells);
    }
}
