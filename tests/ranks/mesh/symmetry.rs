//! Graded boxes, and quarters that represent the whole: measures, and responses to forces.

use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Insert, Int, Matrix, Session, Vector};
use ricochet::body::Body;
use ricochet::mesh::Mesh;
use ricochet::scene::{Geometry, Scene, Support, SupportKind, Symmetry};
use ricochet::solve::linear::{Method, solver};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] =
    tests![measures_of_graded_boxes_and_quarters, vertices_are_those_of_the_grid, a_quarter_answers_as_the_whole];

fn parse(body: &str, rest: &str, overrides: &[String]) -> Scene {
    let text = format!(
        "{rest}\n[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n{body}\n[time]\nend = 1e-3\n[impactor]\nmass = 52.0\n\
         radius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n"
    );
    Scene::parse("test", &text, overrides).unwrap_or_else(|error| panic!("{error}")).0
}

/// Boxes hit off the centre and in the centre, on a face and on an edge, as wholes and as quarters: lines of the body,
/// overrides, and symmetry multiplicity.
const BOXES: [(&str, &[&str], usize); 5] = [
    ("size = [1.5, 0.9, 0.1]\ncells = [7, 6, 3]\ngrading = [8, 5, 2]", &["impactor.point=[0.31,-0.12,0.05]"], 1),
    ("size = [1.5, 0.9, 0.1]\ncells = [6, 4, 2]\ngrading = 100\nsymmetry = \"none\"", &[], 1),
    ("size = [1.5, 0.9, 0.1]\ncells = [6, 4, 2]\ngrading = 8", &[], 4),
    ("size = [1.5, 0.9, 0.1]\ncells = [3, 4, 2]\ngrading = [3, 8, 1]", &["impactor.direction=[1,0,0]"], 4),
    ("size = [0.3, 0.2, 0.1]", &["impactor.direction=[0,-1,0]"], 4),
];

fn owned(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|text| (*text).to_owned()).collect()
}

/// Sum of all entries over 3: the mass for M, the area for unit springs.
fn third_of_sum(matrix: &Matrix, like: &Vector) -> f64 {
    let (mut ones, mut product) = (like.duplicate().unwrap(), like.duplicate().unwrap());
    ones.fill(1.0).unwrap();
    matrix.mult(&ones, &mut product).unwrap();
    product.dot(&ones).unwrap() / 3.0
}

/// Volumes and areas agree with the box; a quarter's are counted four times. A face outside the quarter is represented
/// by its mirror image, so the two faces of a pair are tested together.
fn measures_of_graded_boxes_and_quarters(session: &Session) {
    let world = session.world();
    for (body, overrides, multiplicity) in BOXES {
        let mut scene = parse(body, "", &owned(overrides));
        let Geometry::Box { size: [x, y, z], .. } = scene.body.geometry else { panic!("no box") };
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        assert_eq!(mesh.multiplicity, multiplicity, "{body}");
        let pairs: [(&[&str], f64); 4] = [
            (&["side"], 2.0 * (x + y) * z),
            (&["x-min", "x-max"], 2.0 * y * z),
            (&["y-min", "y-max"], 2.0 * x * z),
            (&["top", "z-min"], 2.0 * x * y),
        ];
        let single: [(&[&str], f64); 4] =
            [(&["top"], x * y), (&["bottom"], x * y), (&["x-max"], y * z), (&["y-min"], x * z)];
        for (surfaces, area) in pairs.iter().chain(single.iter().filter(|_| multiplicity == 1)) {
            let unit = |surface: &&str| Support {
                surface: (*surface).to_owned(),
                within: None,
                kind: SupportKind::Elastic { stiffness: [1.0; 3] },
                damping: [0.0; 3],
                displacement: [0.0; 3],
            };
            scene.supports = surfaces.iter().map(unit).collect();
            let solid = Body::solid(&scene, &mesh).unwrap();
            let volume = solid.terms.multiplicity * third_of_sum(&solid.mass, &solid.terms.load) / 2500.0;
            let springs = solid.terms.multiplicity
                * third_of_sum(solid.terms.support.as_ref().expect("unit springs"), &solid.terms.load);
            // Rounding of sums of some thousand entries.
            assert!((volume / (x * y * z) - 1.0).abs() < 1e-12, "{body}: volume {volume}");
            assert!((springs / area - 1.0).abs() < 1e-12, "{body}: {surfaces:?} {springs}");
        }
        world.collect_garbage().unwrap();
    }
}

/// Every vertex is a point of the scene's grid to the last bit, also for a quarter.
fn vertices_are_those_of_the_grid(session: &Session) {
    for (body, overrides, multiplicity) in BOXES {
        let scene = parse(body, "", &owned(overrides));
        let Geometry::Box { planes, .. } = &scene.body.geometry else { panic!("no box") };
        let mesh = Mesh::new(&session.world(), &scene.body).unwrap();
        let axes = match scene.body.symmetry {
            Symmetry::Quarter { axes } => axes.to_vec(),
            Symmetry::None { .. } | Symmetry::Parts { .. } => Vec::new(),
        };
        for x in (0..mesh.cells.len()).flat_map(|i| mesh.cells.x(i)) {
            for axis in 0..3 {
                assert!(planes[axis].contains(&x[axis]), "{body}: {x:?}");
                assert!(x[axis] >= 0.0 || !axes.contains(&axis), "{body}: {x:?}");
            }
        }
        let cells: usize = planes.iter().map(|planes| planes.len() - 1).product();
        assert_eq!(mesh.total_cells * multiplicity, cells, "{body}");
    }
}

/// A symmetric scene, and the matrix of the system: S = K + c1 C + c2 M.
struct Case {
    name: &'static str,
    body: &'static str,
    rest: &'static str,
    overrides: &'static [&'static str],
    operator: [f64; 2],
    /// Points on the surface of the part that is solved, in units of half the edges.
    probes: [[f64; 3]; 3],
}

const STATIC: [f64; 2] = [0.0, 0.0];

/// c1 and c2 of the average acceleration method with a time step of 10 μs.
const STEP: [f64; 2] = [2e5, 4e10];

const TOP: [[f64; 3]; 3] = [[0.3, 0.7, 1.0], [1.0, 1.0, -1.0], [0.0, 1.0, 0.2]];

const CASES: [Case; 6] = [
    Case {
        name: "springs by component, dampers, weight and pressure",
        body: "size = [1.5, 0.9, 0.1]\ncells = [6, 4, 2]\ngrading = 8",
        rest: "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e9, 2e9, 3e9]\ndamping = [1e5, 2e5, 3e5]\n\
               displacement = [0, 0, 1e-5]\n\
               [load]\nbody_force = [0, 0, -24525]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1e6]\n",
        overrides: &[],
        operator: STATIC,
        probes: TOP,
    },
    Case {
        name: "the same in a step",
        body: "size = [1.5, 0.9, 0.1]\ncells = [6, 4, 2]\ngrading = 8",
        rest: "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e9, 2e9, 3e9]\ndamping = [1e5, 2e5, 3e5]\n",
        overrides: &[],
        operator: STEP,
        probes: TOP,
    },
    Case {
        name: "a free body in a step, cells left out, elements of order 1",
        body: "size = [0.5, 0.5, 0.04]\norder = 1",
        rest: "",
        overrides: &[],
        operator: STEP,
        probes: TOP,
    },
    Case {
        name: "stretched by tractions and held by clamps, hit along x",
        body: "size = [0.3, 0.2, 0.2]\ncells = [3, 4, 2]\ngrading = [4, 3, 2]",
        rest: "[[support]]\nsurface = \"x-max\"\nkind = \"clamped\"\ndisplacement = [1e-5, 0, 0]\n\
               [[support]]\nsurface = \"z-min\"\nkind = \"elastic\"\nstiffness = [0, 1e9, 4e9]\ndisplacement = [1e-5, 0, -2e-5]\n\
               [[support]]\nsurface = \"top\"\nkind = \"elastic\"\nstiffness = [0, 1e9, 4e9]\ndisplacement = [1e-5, 0, 2e-5]\n\
               [[load.traction]]\nsurface = \"y-min\"\nvalue = [2e6, -3e6, 0]\n\
               [[load.traction]]\nsurface = \"y-max\"\nvalue = [2e6, 3e6, 0]\n",
        overrides: &["impactor.direction=[1,0,0]"],
        operator: STATIC,
        probes: [[-1.0, 0.4, 0.8], [0.5, 1.0, 1.0], [0.1, 0.3, 1.0]],
    },
    Case {
        name: "clamped by components, hit against y",
        body: "size = [0.3, 0.2, 0.1]\ncells = [4, 3, 2]",
        rest: "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\ncomponents = [\"z\", \"y\"]\ndisplacement = [0, 1e-6, 0]\n\
               [[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = [1e9, 0, 0]\n\
               [[support]]\nsurface = \"x-max\"\nkind = \"clamped\"\ncomponents = [\"z\", \"y\"]\ndisplacement = [0, 1e-6, 0]\n\
               [[support]]\nsurface = \"z-max\"\nkind = \"elastic\"\nstiffness = [1e9, 0, 0]\n",
        overrides: &["impactor.direction=[0,-1,0]"],
        operator: STATIC,
        probes: [[0.4, 1.0, 0.8], [0.5, -1.0, 0.2], [1.0, 0.3, 1.0]],
    },
    Case {
        name: "springs below and a pad",
        body: "size = [0.5, 0.5, 0.02]\ncells = [6, 6, 2]\ngrading = [6, 6, 1.5]",
        rest: "[[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = 1e10\n\
               [[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nstiffness = [0, 0, 1e10]\nnormal = [0, 0, -1]\n",
        overrides: &[],
        operator: STATIC,
        probes: TOP,
    },
];

/// Response of a body to a force of 1 MN on the localisation vector a (a quarter of it on a quarter), and to its loads.
struct Answer {
    /// aᵀu and the displacements of the probes, m.
    displacements: Vec<f64>,
    /// ½ uᵀ S u, and the potential of the pads, J.
    energies: [f64; 2],
}

fn answer(comm: &Comm, case: &Case, symmetry: &str) -> Answer {
    let mut overrides = owned(case.overrides);
    overrides.push(format!("body.symmetry={symmetry}"));
    let scene = parse(case.body, case.rest, &overrides);
    let Geometry::Box { size, .. } = scene.body.geometry else { panic!("no box") };
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    assert_eq!(mesh.multiplicity, if symmetry == "none" { 1 } else { 4 });
    let mut body = Body::solid(&scene, &mesh).unwrap();
    let mut matrix = body.combination(case.operator[0], case.operator[1]).unwrap();
    let held = &body.clamps.displacement;
    let mut product = held.duplicate().unwrap();
    matrix.mult(held, &mut product).unwrap();
    let mut force = held.duplicate().unwrap();
    force.axpy(1e6 / body.terms.multiplicity, &body.terms.contact.force).unwrap();
    for (factor, part) in [(1.0, &body.terms.load), (1.0, &body.terms.support_load), (-1.0, &product)] {
        force.axpy(factor, part).unwrap();
    }
    body.clamps.zero(&mut force).unwrap();
    let whole = matrix.duplicate().unwrap();
    matrix.zero_rows_columns(&body.clamps.rows, 1.0).unwrap();
    matrix.declare_positive_definite().unwrap();
    let mut ksp = solver(comm, "", &matrix, Method::Cholesky).unwrap();
    let mut u = force.duplicate().unwrap();
    ksp.solve(&force, &mut u).unwrap();
    u.axpy(1.0, held).unwrap();
    let mut displacements = vec![body.terms.contact.force.dot(&u).unwrap()];
    for probe in case.probes {
        let place = [0, 1, 2].map(|i| 0.5 * size[i] * probe[i]);
        let site = mesh.locate(place, scene.impactor.direction);
        assert!(site.distance < 1e-12, "{}: {place:?} is {} off", case.name, site.distance);
        for component in 0..3 {
            let mut reading = u.duplicate().unwrap();
            for (node, weight) in site.nodes.iter().zip(&site.weights) {
                reading.set_values(&[3 * node + component as Int], &[*weight], Insert::Replace).unwrap();
            }
            reading.assemble().unwrap();
            displacements.push(reading.dot(&u).unwrap());
        }
    }
    whole.mult(&u, &mut product).unwrap();
    let pad = body.pads.as_mut().map_or(0.0, |pads| pads.potential(&u).unwrap());
    Answer {
        displacements,
        energies: [0.5 * u.dot(&product).unwrap(), pad].map(|energy| body.terms.multiplicity * energy),
    }
}

/// A quarter gives the displacements and energies of the whole, statically and in a time step, on any number of ranks.
fn a_quarter_answers_as_the_whole(session: &Session) {
    let world = session.world();
    for case in CASES {
        let [whole, quarter] = ["none", "quarter"].map(|symmetry| answer(&world, &case, symmetry));
        let largest = whole.displacements.iter().fold(0.0, |m, u| f64::max(m, u.abs()));
        let worst = (whole.displacements.iter().zip(&quarter.displacements))
            .fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs() / largest));
        let energy =
            (0..2).fold(0.0, |m, i| f64::max(m, (whole.energies[i] - quarter.energies[i]).abs() / whole.energies[0]));
        println!("{}: displacements {worst:.1e}, energies {energy:.1e}", case.name);
        assert!(case.rest.contains("pad") == (whole.energies[1] > 0.0), "{}", case.name);
        // The condition number of K, at most 1e6 here, times rounding.
        assert!(worst < 1e-9 && energy < 1e-9, "{}: {worst:e}, {energy:e}", case.name);
        world.collect_garbage().unwrap();
    }
}
