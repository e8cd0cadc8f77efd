//! Linear elements lock on thin plates; quadratic elements do not.

use crate::bricks;
use mpi_test::{Test, tests};

use petsc_wrap::{Comm, Session};
use ricochet::body::Body;
use ricochet::element::Shape;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::solve::linear::{Method, solver};

/// On one rank: this is a static problem, whose assembly other tests compare on several ranks.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![thin_clamped_plate];

const YOUNG: f64 = 70e9;
const POISSON: f64 = 0.3;
/// Pressure on the top, N/m².
const PRESSURE: f64 = 1e3;

/// Deflection of the middle of a square plate, L = 1 m, clamped along its sides, over the deflection by Kirchhoff's
/// theory.
fn deflection(comm: &Comm, shape: Shape, order: usize, cells: usize, thickness: f64) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plate.msh");
    std::fs::write(&file, bricks::bricks(shape, [1.0, 1.0, thickness], [cells, cells, 1], 0.0)).unwrap();
    let text = format!(
        "[body]\nyoung = {YOUNG:e}\npoisson = {POISSON}\ndensity = 2500.0\nmesh = {file:?}\norder = {order}\n\
         [[support]]\nsurface = \"side\"\nkind = \"clamped\"\n\
         [[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, {:e}]\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e6\nspeed = 1.0\npoint = [0, 0, {:e}]\n\
         [contact]\nlocalization = \"point\"\n[time]\nend = 1.0\nstep = 1.0\n",
        -PRESSURE,
        0.5 * thickness
    );
    let (scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    let body = Body::solid(&scene, &mesh).unwrap();
    let operator = body.operator(0.0, 0.0).unwrap();
    let mut solver = solver(comm, "", &operator, Method::Cholesky).unwrap();
    let mut load = body.terms.load.duplicate().unwrap();
    load.copy_from(&body.terms.load).unwrap();
    body.clamps.zero(&mut load).unwrap();
    let mut u = load.duplicate().unwrap();
    solver.solve(&load, &mut u).unwrap();
    // The impactor's displacement average is along −z at the middle of the top, which is a vertex.
    let deflection = body.terms.contact.force.dot(&u).unwrap();
    let bending = YOUNG * thickness.powi(3) / (12.0 * (1.0 - POISSON * POISSON));
    // Timoshenko & Woinowsky-Krieger, Theory of Plates and Shells, 1959, table 35; more digits by G. I. Taylor & S.
    // Govindjee, Solution of clamped rectangular plate problems, Commun. Numer. Methods Eng. 20, 2004.
    deflection / (1.265_319_087e-3 * PRESSURE / bending)
}

/// Linear elements cannot bend without shear: their deflection falls like (h/L)². Quadratic hexahedra are accurate with
/// the same cells. Quadratic tetrahedra are accurate down to h/L = 1e-2; below that, they lock thirty to a thousand
/// times less than the linear ones.
fn thin_clamped_plate(session: &Session) {
    let world = session.world();
    let all = [(Shape::Tetrahedron, 1), (Shape::Hexahedron, 1), (Shape::Tetrahedron, 2), (Shape::Hexahedron, 2)].map(
        |(shape, order)| {
            [8, 16].map(|cells| {
                let found = [0.1, 0.01, 0.001].map(|thickness| deflection(&world, shape, order, cells, thickness));
                println!("{shape:?} {order}, {cells} cells: {found:.5?} of Kirchhoff's at h/L = 0.1, 0.01, 0.001");
                world.collect_garbage().unwrap();
                found
            })
        },
    );
    let [linear_tetrahedra, linear_hexahedra, tetrahedra, hexahedra] = all;
    for found in linear_tetrahedra.into_iter().chain(linear_hexahedra) {
        // Locked at 1e-2, and a hundred times more at 1e-3, apart from the part that bends nevertheless.
        assert!(found[1] < 0.1 && (80.0..105.0).contains(&(found[1] / found[2])), "{found:?}");
    }
    let [coarse, fine] = hexahedra;
    // Clamped sides have a boundary layer, which sixteen cells resolve to some per cent; with refinement the result
    // converges to Kirchhoff's plate.
    for thin in [1, 2] {
        assert!((fine[thin] - 1.0).abs() < 0.03 && (coarse[thin] - 1.0).abs() < 0.08, "{hexahedra:?}");
        assert!((fine[thin] - 1.0).abs() < 0.5 * (coarse[thin] - 1.0).abs(), "{hexahedra:?}");
    }
    let [coarse, fine] = tetrahedra;
    assert!(fine[1] > 0.9 && fine[1] > 30.0 * linear_tetrahedra[1][1], "{tetrahedra:?}");
    // They lock if the cells are sixty times as long as high, and refinement removes it faster than for the linear
    // ones.
    assert!(fine[2] > 500.0 * linear_tetrahedra[1][2] && fine[2] > 8.0 * coarse[2], "{tetrahedra:?}");
    // Shear makes the thick plate softer than Kirchhoff's, equally for both.
    let thick = [tetrahedra[1][0], hexahedra[1][0]];
    assert!(thick.iter().all(|found| *found > 1.1) && (thick[0] / thick[1] - 1.0).abs() < 0.03, "{thick:?}");
}
