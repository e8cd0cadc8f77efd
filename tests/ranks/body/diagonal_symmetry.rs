//! Square bodies with the diagonal symmetry use half of their unknowns: the results equal the results for the whole.

use crate::glass;
use mpi_test::{Test, tests};

use nalgebra::{DMatrix, DVector};
use petsc_wrap::{Session, Vector};
use ricochet::body::{Body, DiagonalSymmetry, System};
use ricochet::scene::Scene;
use ricochet::solve::linear::{Method, solver};
use ricochet::space::plate::{self, Plate, PlateTheory};
use ricochet::space::spline::{Settings, SplineSolid};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    half_of_a_square_box_moves_as_the_whole,
    half_of_a_square_plate_moves_as_the_whole,
    boxes_without_a_diagonal
];

fn scene(body: &str, rest: &str) -> Scene {
    let impactor = format!("mass = {}\nspeed = 1.0", glass::MASS);
    let text = glass::scene(body, &impactor, "end = 1e-3", rest);
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

fn solid(scene: &Scene) -> SplineSolid {
    SplineSolid::new(scene, &Settings { cell_size_factor: 1.3, part_cell_factor: 1.0 })
        .unwrap_or_else(|error| panic!("{error}"))
}

/// u for the loads and a contact force of 1 kN at s = 3e3 1/s, with the constrained unknowns at their values.
fn moved(session: &Session, system: &System) -> Vec<f64> {
    let body = Body::of(&session.alone(), system).unwrap();
    let rate = 3e3;
    let mut right = body.terms.load.duplicate().unwrap();
    body.combination(rate, rate * rate).unwrap().mult(&body.clamps.displacement, &mut right).unwrap();
    right.aypx(-1.0, &body.terms.load).unwrap();
    right.axpy(1.0, &body.terms.support_load).unwrap();
    right.axpy(1e3, &body.terms.contact.force).unwrap();
    body.clamps.zero(&mut right).unwrap();
    let mut u: Vector = right.duplicate().unwrap();
    let operator = body.operator(rate, rate * rate).unwrap();
    solver(body.comm(), "", &operator, Method::Cholesky).unwrap().solve(&right, &mut u).unwrap();
    u.axpy(1.0, &body.clamps.displacement).unwrap();
    u.read().unwrap().to_vec()
}

fn half_of_a_square_box_moves_as_the_whole(session: &Session) {
    let clamped = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n".to_owned();
    for (size, rest) in [
        ("[0.5, 0.5, 0.1]", glass::sides(1e9, 2e5) + "[load]\nbody_force = [0.0, 0.0, -9.81]\n"),
        ("[0.5, 0.5, 0.1]", clamped),
        ("[0.2, 0.2, 0.2]", glass::sides(1e8, 0.0)),
    ] {
        let system = solid(&scene(&format!("size = {size}\nsymmetry = \"quarter\""), &rest)).system;
        moves_as_the_whole(&system, |system| moved(session, system));
    }
}

/// The same for a system with few unknowns, none of them constrained, with dense matrices.
fn moved_of_few(system: &System) -> Vec<f64> {
    let rate = 3e3;
    let mut operator = DMatrix::from(&system.mass) * (rate * rate) + DMatrix::from(&system.terms.elastic);
    system.terms.support.iter().for_each(|support| operator += DMatrix::from(support));
    system.terms.damping.iter().for_each(|damping| operator += DMatrix::from(damping) * rate);
    let force = |entries: &[f64]| DVector::from_column_slice(entries);
    let force =
        force(&system.terms.load) + force(&system.terms.support_load) + force(&system.terms.contact.force) * 1e3;
    operator.cholesky().unwrap().solve(&force).as_slice().to_vec()
}

fn half_of_a_square_plate_moves_as_the_whole(_: &Session) {
    let layers =
        "[[body.layer]]\nthickness = 0.01\nmaterial = \"a\"\n[[body.layer]]\nthickness = 0.02\nmaterial = \"b\"\n";
    let material =
        |name: &str, young: f64| format!("[material.{name}]\nyoung = {young:e}\npoisson = 0.23\ndensity = 2500.0\n");
    let laminate = format!(
        "[body]\nsize = [0.5, 0.5]\nsymmetry = \"quarter\"\n{layers}{}{}[impactor]\nmass = 5.0\nspeed = 1.0\nradius = 0.05\nyoung = 210e9\n\
         poisson = 0.3\n[time]\nend = 1e-3\n{}",
        material("a", 70e9),
        material("b", 7e9),
        glass::sides(1e9, 2e5)
    );
    let laminate = Scene::parse("test", &laminate, &[]).unwrap_or_else(|error| panic!("{error}\n{laminate}")).0;
    let one = scene("size = [0.5, 0.5, 0.03]\nsymmetry = \"quarter\"", &glass::sides(1e9, 2e5));
    for (scene, theory) in
        [(&one, PlateTheory::Kirchhoff), (&one, PlateTheory::Layerwise), (&laminate, PlateTheory::Layerwise)]
    {
        let settings = plate::Settings { cell_size_factor: 2.0, ..Default::default() };
        let plate = Plate::new(scene, theory, &settings).unwrap_or_else(|error| panic!("{error}"));
        moves_as_the_whole(&plate.system, moved_of_few);
    }
}

fn moves_as_the_whole(system: &System, moved: impl Fn(&System) -> Vec<f64>) {
    let (exchange, half) = DiagonalSymmetry::of(system).expect("its own image");
    // Unknowns on the diagonal are their own images. Their number is about that along an edge, times the thickness of a
    // box.
    let (left, all) = (half.terms.load.len(), system.terms.load.len());
    assert!(left <= all / 2 + 2 * all.isqrt(), "{left} of {all} unknowns");
    let [u, of_half] = [system, &half].map(&moved);
    let largest = u.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let off = u.iter().zip(exchange.whole(&of_half)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    // Rounding for a condition number of some 1e5.
    assert!(off < 1e-9, "{off:e} of {largest:e}");
}

/// Boxes with different edges, or with supports that the diagonal does not map onto each other, do not use this
/// symmetry.
fn boxes_without_a_diagonal(_: &Session) {
    let oblong = scene("size = [0.5, 0.4, 0.1]\nsymmetry = \"quarter\"", &glass::sides(1e9, 0.0));
    assert!(solid(&oblong).system.exchange.is_none());
    let sides = |surface: &str, rest: &str| format!("[[support]]\nsurface = \"{surface}\"\n{rest}\n");
    let springs =
        |surface: &str, stiffness: &str| sides(surface, &format!("kind = \"elastic\"\nstiffness = {stiffness}"));
    let both = |of_x: &str, of_y: &str| {
        ["x-min", "x-max"].map(|surface| springs(surface, of_x)).concat()
            + &["y-min", "y-max"].map(|surface| springs(surface, of_y)).concat()
    };
    let is_halved = |rest: &str| {
        DiagonalSymmetry::of(&solid(&scene("size = [0.5, 0.5, 0.1]\nsymmetry = \"quarter\"", rest)).system).is_some()
    };
    assert!(is_halved(&both("1e9", "1e9")));
    assert!(is_halved(&both("[1e8, 2e8, 3e8]", "[2e8, 1e8, 3e8]")));
    assert!(!is_halved(&both("1e9", "1.001e9")));
    assert!(!is_halved(&both("[1e8, 2e8, 3e8]", "[1e8, 2e8, 3e8]")));
    let clamped = ["x-min", "x-max"].map(|surface| sides(surface, "kind = \"clamped\"\ncomponents = [\"z\"]")).concat();
    assert!(!is_halved(&clamped));
}
