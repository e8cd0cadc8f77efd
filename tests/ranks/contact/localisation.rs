//! The localisation vector a (contact force vector): its entries, the displacement it measures, and its term in the
//! Newton matrix.

use crate::bricks;
use crate::field::{self, linear, quadratic};
use mpi_test::{Test, tests};
use std::path::Path;

use crate::start::{run, start};
use petsc_wrap::{Comm, Gather, Int, Session, options};
use ricochet::body::Body;
use ricochet::contact::Hertz;
use ricochet::element::Shape;
use ricochet::error::Error;
use ricochet::impact::SteppedImpact;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![entries_and_fields, points_and_directions_refused, newton_matrix];
/// Compares several ranks with one.
pub const ON_SEVERAL: &[Test<Session>] = tests![the_same_on_all_numbers_of_ranks];

const SIZE: [f64; 3] = [0.4, 0.3, 0.1];
const CELLS: [usize; 3] = [4, 3, 2];

/// Impact point, direction (of any length), and the numbers of nodes with a non-zero weight: for hexahedra of order 1
/// and 2, tetrahedra of order 1 and 2. Bricks are 0.1 × 0.1 × 0.05 m; the diagonals of their faces run from the
/// smallest to the largest corner.
type Hit = (&'static str, [f64; 3], [f64; 3], [usize; 4]);
const HITS: [Hit; 10] = [
    ("vertex", [0.0, 0.05, 0.05], [0.0, 0.0, -1.0], [1, 1, 1, 1]),
    ("edge", [0.1, 0.02, 0.05], [0.0, 0.0, -1.0], [2, 3, 2, 3]),
    ("middle of an edge", [0.1, 0.0, 0.05], [0.0, 0.0, -1.0], [2, 1, 2, 1]),
    ("diagonal of a face", [0.03, 0.08, 0.05], [0.0, 0.0, -1.0], [4, 9, 2, 3]),
    ("inside a facet", [0.07, 0.03, 0.05], [0.0, 0.0, -1.0], [4, 9, 3, 6]),
    ("inside a facet, oblique", [0.02, 0.03, 0.05], [0.3, -0.4, -1.0], [4, 9, 3, 6]),
    ("vertex, oblique", [0.1, -0.05, 0.05], [-0.2, 0.7, -0.5], [1, 1, 1, 1]),
    ("side face", [0.2, 0.03, 0.02], [-1.0, 0.0, 0.0], [4, 9, 3, 6]),
    ("edge of the body", [0.2, 0.02, 0.05], [-1.0, 0.0, -2.0], [2, 3, 2, 3]),
    ("corner", [0.2, 0.15, 0.05], [-1.0, -1.0, -1.0], [1, 1, 1, 1]),
];

/// One kind of element for the body: its number in [`HITS`], and the lines of the scene.
struct Kind {
    number: usize,
    geometry: String,
    order: usize,
}

fn kinds(folder: &Path) -> Vec<Kind> {
    let file = folder.join("tetrahedra.msh");
    std::fs::write(&file, bricks::bricks(Shape::Tetrahedron, SIZE, CELLS, 0.0)).unwrap();
    let geometries = [format!("size = {SIZE:?}\ncells = {CELLS:?}"), format!("mesh = {file:?}")];
    (0..4).map(|number| Kind { number, geometry: geometries[number / 2].clone(), order: number % 2 + 1 }).collect()
}

fn scene(kind: &Kind, point: [f64; 3], direction: [f64; 3], gap: f64) -> String {
    let Kind { geometry, order, .. } = kind;
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsymmetry = \"none\"\n{geometry}\norder = {order}\n\
         [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n\
         [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\ngap = {gap:e}\n\
         point = {point:?}\ndirection = {direction:?}\n[time]\nend = 4e-4\nstep = 2e-5\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\n"
    )
}

fn unit(direction: [f64; 3]) -> [f64; 3] {
    let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
    direction.map(|d| d / length)
}

/// a sums to d over the nodes, is non-zero only on the facet, edge or vertex of the impact point, and gives the exact
/// value of fields of its degree.
fn entries_and_fields(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    for kind in kinds(folder.path()) {
        for (name, point, direction, nodes) in HITS {
            let name = format!("{name}, element {}", kind.number);
            let (mesh, impact) = start(&world, &scene(&kind, point, direction, 0.0));
            let a = &impact.body().terms.contact.force;
            let d = unit(direction);
            let mut field = a.duplicate().unwrap();
            let mut reading = |of: fn([f64; 3]) -> [f64; 3]| {
                field::interpolate(&mesh, &mut field, of);
                a.dot(&field).unwrap()
            };
            let along = |u: [f64; 3]| u.iter().zip(d).map(|(u, d)| u * d).sum::<f64>();
            // Fields are of size one, and a has at most 27 entries: rounding is some 1e-16 each.
            for (field, expected) in [
                (reading(|_| [1.0, 0.0, 0.0]), d[0]),
                (reading(|_| [0.0, 1.0, 0.0]), d[1]),
                (reading(|_| [0.0, 0.0, 1.0]), d[2]),
                (reading(linear), along(linear(point))),
            ] {
                assert!((field - expected).abs() < 1e-14, "{name}: {field} instead of {expected}");
            }
            let (read, expected) = (reading(quadratic), along(quadratic(point)));
            if kind.order == 2 {
                assert!((read - expected).abs() < 1e-14, "{name}: {read} instead of {expected}");
            }
            // A weight that should be zero is so up to the rounding of the point's position in the facet.
            let entries = impact.body().contact_entries.iter().filter(|(_, value)| value.abs() > 1e-14).count();
            let components = d.iter().filter(|d| **d != 0.0).count();
            // All ranks have all entries.
            assert_eq!(entries, nodes[kind.number] * components, "{name}: entries");
            let large = {
                let values = a.read().unwrap();
                values.iter().filter(|value| value.abs() > 1e-14).count()
            };
            assert_eq!(sum(&world, large), nodes[kind.number] * components, "{name}: nodes");
        }
        world.collect_garbage().unwrap();
    }
}

fn sum(comm: &Comm, value: usize) -> usize {
    use petsc_wrap::mpi::{collective::SystemOperation, traits::CommunicatorCollectives};
    let mut all = 0;
    comm.mpi().all_reduce_into(&value, &mut all, SystemOperation::sum());
    all
}

/// |a| and the series are compared with those that each rank computes alone.
fn the_same_on_all_numbers_of_ranks(session: &Session) {
    let folder = tempfile::tempdir().unwrap();
    let answer = |comm: &Comm, text: &str| {
        let (_, mut impact) = start(comm, text);
        let norm = impact.body().terms.contact.force.norm().unwrap();
        let series: Vec<[f64; 3]> = run(&mut impact)
            .iter()
            .map(|step| [step.contact.force, step.contact.surface_displacement, step.impactor.position])
            .collect();
        (norm, series)
    };
    let mut worst: f64 = 0.0;
    for kind in kinds(folder.path()) {
        for (name, point, direction, _) in HITS {
            let text = scene(&kind, point, direction, 0.0).replace("end = 4e-4", "end = 2e-4");
            let (norm, series) = answer(&session.world(), &text);
            let (norm_alone, alone) = answer(&session.alone(), &text);
            session.world().collect_garbage().unwrap();
            assert!((norm - norm_alone).abs() < 1e-14, "{name}, element {}: |a| {norm} and {norm_alone}", kind.number);
            assert_eq!(series.len(), alone.len());
            for column in 0..3 {
                let peak = alone.iter().fold(0.0, |max: f64, row| max.max(row[column].abs()));
                assert!(peak > 0.0);
                let difference = |(one, other): (&[f64; 3], &[f64; 3])| (one[column] - other[column]).abs() / peak;
                let error = series.iter().zip(&alone).map(difference).fold(0.0, f64::max);
                worst = worst.max(error);
                // Sums in another order, amplified by bending: for the reference solutions this is up to 6e-9.
                assert!(error < 1e-7, "{name}, element {}, column {column}: {error:e}", kind.number);
            }
        }
    }
    if session.world().is_root() {
        println!("largest difference of a series from that of one rank: {worst:.1e}");
    }
}

/// The fault of a scene that is found with its mesh.
fn fault(comm: &Comm, text: &str) -> ricochet::scene::Fault {
    let (scene, _) = Scene::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    match Body::solid(&scene, &mesh) {
        Err(Error::Fault(fault)) => *fault,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted"),
    }
}

fn points_and_directions_refused(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    let down = [0.0, 0.0, -1.0];
    for shape in [Shape::Hexahedron, Shape::Tetrahedron] {
        let file = folder.path().join("body.msh");
        std::fs::write(&file, bricks::bricks(shape, SIZE, CELLS, 0.1)).unwrap();
        let kind = Kind { number: 0, geometry: format!("mesh = {file:?}"), order: 2 };
        // Above a face, beyond an edge, beyond a corner, and inside the body.
        for (point, nearest) in [
            ([0.03, 0.02, 0.0623], [0.03, 0.02, 0.05]),
            ([0.23, 0.02, 0.09], [0.2, 0.02, 0.05]),
            ([-0.21, -0.17, -0.07], [-0.2, -0.15, -0.05]),
            ([0.01, -0.02, 0.03], [0.01, -0.02, 0.05]),
        ] {
            let fault = fault(&world, &scene(&kind, point, down, 0.0));
            assert_eq!(fault.key, "impactor.point");
            assert!(fault.everywhere);
            let distance = (0..3).map(|i| (point[i] - nearest[i]).powi(2)).sum::<f64>().sqrt();
            let told: f64 = number_after(&fault.message, "point is ");
            // The message promises three digits.
            assert!((told / distance - 1.0).abs() < 1e-3, "{point:?}: {told} instead of {distance}: {fault}");
            let [x, y, z] = nearest;
            let shown = format!("[{x:.9}, {y:.9}, {z:.9}]");
            // Rounding may put a sign before a zero.
            assert!(fault.help.replace("-0.000000000", "0.000000000").contains(&shown), "{}: {shown}", fault.help);
        }
        // Directions out of the body, and along its surface.
        for direction in [[0.0, 0.0, 1.0], [0.3, 0.0, 0.1], [1.0, 0.0, 0.0]] {
            let fault = fault(&world, &scene(&kind, [0.03, 0.02, 0.05], direction, 0.0));
            assert_eq!(fault.key, "impactor.direction", "{direction:?}");
            assert!(fault.help.contains("-1.000000"), "the inward normal is told: {}", fault.help);
        }
    }
    // A box is checked before it is meshed.
    let boxed = &kinds(folder.path())[0];
    for (point, direction, key) in [
        ([0.0, 0.0, 0.06], down, "impact point is 1.00e-2 m away"),
        ([0.0, 0.0, 0.05], [0.0, 0.0, 1.0], "into the body"),
    ] {
        let error = Scene::parse("test", &scene(boxed, point, direction, 0.0), &[]).unwrap_err().to_string();
        assert!(error.contains(key), "{error}");
    }
}

fn number_after(text: &str, mark: &str) -> f64 {
    let (_, rest) = text.split_once(mark).unwrap_or_else(|| panic!("{text}"));
    rest.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{text}"))
}

/// The Newton matrix that PETSc solves with: its difference from the matrix of a step without contact is F′ââᵀ, entry
/// by entry.
fn newton_matrix(session: &Session) {
    const VIEW: &str = "-ksp_view_mat";
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    for kind in kinds(folder.path()) {
        let file = folder.path().join(format!("jacobian-{}", kind.number));
        options::set(session, VIEW, &format!("binary:{}", file.display())).unwrap();
        // The gap closes in the third time step. A body force ensures that every step needs a solve.
        let text = scene(&kind, [0.07, 0.03, 0.05], [0.3, -0.4, -1.0], 2.5e-5)
            .replace("end = 4e-4\nstep = 2e-5", "end = 1e-5\nstep = 1e-5");
        let (_, mut impact) = start(&world, &(text.clone() + "[load]\nbody_force = [0.0, 0.0, -1e5]\n"));
        options::clear(session, VIEW).unwrap();
        // For each time step: the number of matrices before it, and δ at Newton's first guess.
        let firsts: Vec<(usize, f64)> = (0..8)
            .map(|_| {
                let first = (impact.count.iterations, guessed_approach(&impact, 2.5e-5, 1e-5));
                assert_eq!(run(&mut impact).len(), 2, "a run of one step");
                assert!(impact.count.iterations > first.0);
                first
            })
            .collect();
        let a = whole(&impact);
        drop(impact);
        world.collect_garbage().unwrap();
        if !world.is_root() {
            continue;
        }
        let stiffness = Scene::parse("test", &text, &[]).unwrap().0.impactor.stiffness;
        let matrices = stored(&file);
        let apart = &matrices[0];
        let largest = apart.iter().fold(0.0, |max: f64, (_, value)| max.max(value.abs()));
        let hat: Vec<f64> = a.iter().map(|a| -a).chain([1.0]).collect();
        let coupled = hat.iter().filter(|entry| **entry != 0.0).count();
        let mut in_contact = 0;
        for (number, approach) in firsts {
            let tangent = Hertz { stiffness }.tangent(approach);
            in_contact += usize::from(tangent > 0.0);
            let mut met = 0;
            for ((place, value), (same, without)) in matrices[number].iter().zip(apart) {
                assert_eq!(place, same, "one pattern");
                let expected = tangent * hat[place.0] * hat[place.1];
                met += usize::from(hat[place.0] * hat[place.1] != 0.0);
                let error = (value - without - expected).abs();
                // F′ has the rounding of δ, and the difference has the rounding of the entries.
                assert!(error <= 1e-9 * expected.abs() + 1e-15 * largest, "{place:?}: {error:e} from {expected:e}");
            }
            assert_eq!(met, coupled * coupled, "the whole of the block");
        }
        assert!(in_contact >= 4, "{in_contact} steps begin in contact");
    }
}

/// Approach δ with u and q advanced by one time step at constant acceleration, the starting point of Newton's method.
/// Collective.
fn guessed_approach(impact: &SteppedImpact, gap: f64, step: f64) -> f64 {
    let state = impact.state();
    let a = &impact.body().terms.contact.force;
    let half = 0.5 * step * step;
    let moved = |x: f64, v: f64, a: f64| x + step * v + half * a;
    let [u, v, acceleration] = [&state.u, &state.v, &state.a].map(|field| a.dot(field).unwrap());
    moved(state.q.position, state.q.velocity, state.q.acceleration) - gap - moved(u, v, acceleration)
}

/// The whole vector a on rank 0, nothing on the others. Collective.
fn whole(impact: &SteppedImpact) -> Vec<f64> {
    let a = &impact.body().terms.contact.force;
    let indices: Vec<Int> = if a.comm().is_root() { (0..a.len() as Int).collect() } else { Vec::new() };
    Gather::new(a, &indices).unwrap().fetch(a).unwrap().to_vec()
}

/// Positions (row, column) and values of a matrix.
type Entries = Vec<((usize, usize), f64)>;

/// The matrices in a file of PETSc's binary format, which has: a mark, numbers of rows, of columns and of entries;
/// number of entries in each row, columns, values; big-endian.
fn stored(file: &Path) -> Vec<Entries> {
    const MARK: usize = 1_211_216;
    let bytes = std::fs::read(file).unwrap();
    let mut rest = &bytes[..];
    let mut matrices = Vec::new();
    while !rest.is_empty() {
        let mut int = || {
            let (int, after) = rest.split_at(size_of::<Int>());
            rest = after;
            int.iter().fold(0, |value, byte| value << 8 | usize::from(*byte))
        };
        assert_eq!(int(), MARK);
        let [rows, _, total] = [int(), int(), int()];
        let counts: Vec<usize> = (0..rows).map(|_| int()).collect();
        let columns: Vec<usize> = (0..total).map(|_| int()).collect();
        let rows = counts.iter().enumerate().flat_map(|(row, count)| std::iter::repeat_n(row, *count));
        let (values, after) = rest.split_at(8 * total);
        rest = after;
        let values = values.chunks_exact(8).map(|value| f64::from_be_bytes(value.try_into().unwrap()));
        matrices.push(rows.zip(columns).zip(values).collect());
    }
    matrices
}
