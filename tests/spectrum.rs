//! Lumped mass, the largest frequency, and the step that the central difference bears.

#[path = "common/bricks.rs"]
mod bricks;

use std::path::Path;
use std::process::ExitCode;

use nalgebra::DMatrix;
use petsc_wrap::{Comm, Ksp, Matrix, Session, Vector};
use ricochet::body::{Inertia, LargestFrequency, LinearContact, Lumped, Solid, largest_frequency};
use ricochet::contact::{Hertz, hertz};
use ricochet::element::Shape;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::scheme::{CentralDifference, critical_frequency};

fn session() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        session,
        &[
            ("lumped_sums", lumped_sums),
            ("largest_frequency_against_dense", largest_frequency_against_dense),
            ("measured_limit", measured_limit),
            ("nothing_free", nothing_free),
            ("lowest_frequency_converges", lowest_frequency_converges),
        ],
    )
}

const DENSITY: f64 = 2500.0;
const YOUNG: f64 = 70e9;
const POISSON: f64 = 0.23;
const MASS: f64 = 2.0;

/// One kind of element, and the bricks that the body is cut into.
#[derive(Debug, Clone, Copy)]
struct Kind {
    shape: Shape,
    order: usize,
    cells: [usize; 3],
}

const KINDS: [Kind; 4] = [
    Kind { shape: Shape::Hexahedron, order: 1, cells: [3, 2, 2] },
    Kind { shape: Shape::Hexahedron, order: 2, cells: [2, 2, 1] },
    Kind { shape: Shape::Tetrahedron, order: 1, cells: [3, 2, 2] },
    Kind { shape: Shape::Tetrahedron, order: 2, cells: [2, 2, 1] },
];

const SIZE: [f64; 3] = [0.3, 0.2, 0.1];

const FREE: &str = "";
/// Springs so stiff that the largest frequency is theirs in part.
const HELD: &str = "[[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\ncomponents = [\"y\", \"z\"]\n\
    [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [5e13, 1e13, 2e13]\n";
const ON_PAD: &str = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = 5e13\n\
    [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\ndamping = [1e6, 0.0, 2e7]\n";

/// A body on all ranks of a communicator.
struct Parts {
    mesh: Mesh,
    body: Solid,
    lumped: Lumped,
    scene: Scene,
}

/// The scene's mesh, of bricks whose vertices are moved by a part of their edges. Collective.
fn parts(comm: &Comm, kind: Kind, size: [f64; 3], distortion: f64, supports: &str) -> Parts {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("body.msh");
    std::fs::write(&file, bricks::bricks(kind.shape, size, kind.cells, distortion)).unwrap();
    let (scene, _) = Scene::parse("test", &text(&file, kind.order, size, supports), &[]).unwrap();
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    let body = Solid::new(&scene, &mesh).unwrap();
    let lumped = Lumped::new(&scene, &mesh).unwrap();
    Parts { mesh, body, lumped, scene }
}

fn text(file: &Path, order: usize, size: [f64; 3], supports: &str) -> String {
    let top = 0.5 * size[2];
    format!(
        "[body]\nyoung = {YOUNG:e}\npoisson = {POISSON}\ndensity = {DENSITY}\nmesh = {file:?}\norder = {order}\n{supports}\
         [impactor]\nmass = {MASS}\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         point = [0.01, 0.02, {top}]\ndirection = [0.2, 0.0, -1.0]\n[time]\nend = 1e-3\nstep = 1e-5\n"
    )
}

/// F′ at the peak of the impact on a half-space, which no impact on a body exceeds by much.
fn peak_contact(scene: &Scene) -> LinearContact {
    let impactor = &scene.impactor;
    let peak = hertz::peak_indentation(impactor.stiffness, impactor.mass, impactor.speed);
    LinearContact { tangent: Hertz { stiffness: impactor.stiffness }.tangent(peak), mass: impactor.mass }
}

/// Masses are positive, and each component sums to ρV; the dampers' to c times the area.
fn lumped_sums(session: &Session) {
    for kind in KINDS {
        let Parts { lumped, .. } = parts(&session.world(), kind, SIZE, 0.15, ON_PAD);
        let damping = lumped.damping.as_ref().unwrap();
        assert!(lumped.mass.read().unwrap().iter().all(|mass| *mass > 0.0), "{kind:?}");
        assert!(damping.read().unwrap().iter().all(|damping| *damping >= 0.0), "{kind:?}");
        let volume: f64 = SIZE.iter().product();
        let side = 2.0 * (SIZE[0] + SIZE[1]) * SIZE[2];
        let mut ones = lumped.mass.duplicate().unwrap();
        for (component, c) in [1e6, 0.0, 2e7].into_iter().enumerate() {
            let first = ones.range().start as usize;
            for (i, value) in ones.write().unwrap().iter_mut().enumerate() {
                *value = f64::from(u8::from((first + i) % 3 == component));
            }
            // Rounding of some hundred terms.
            let mass = lumped.mass.dot(&ones).unwrap() / (DENSITY * volume);
            assert!((mass - 1.0).abs() < 1e-13, "{kind:?}: {mass}");
            let all = damping.dot(&ones).unwrap();
            assert!((all - c * side).abs() <= 1e-13 * c * side, "{kind:?}: {all}");
        }
    }
}

/// The matrices of a body that one rank has, free unknowns only, the impactor's as the last one.
struct Dense {
    stiffness: DMatrix<f64>,
    mass: DMatrix<f64>,
}

impl Dense {
    fn new(parts: &mut Parts, consistent: bool, contact: Option<LinearContact>) -> Self {
        let Parts { body, lumped, .. } = parts;
        let mut stiffness = body.combination(0.0, 0.0).unwrap();
        if let Some(pads) = &mut body.pads {
            let mut pressed = body.load.duplicate().unwrap();
            pressed.fill(-1.0).unwrap();
            pads.add_tangent(&pressed, &mut stiffness).unwrap();
            stiffness.assemble().unwrap();
        }
        let free: Vec<usize> = (0..body.unknowns()).filter(|i| !body.clamps.rows.contains(&(*i as _))).collect();
        let choose = |matrix: DMatrix<f64>| matrix.select_rows(&free).select_columns(&free);
        let mut stiffness = choose(dense(&stiffness));
        let mut mass = choose(if consistent {
            dense(&body.mass)
        } else {
            DMatrix::from_diagonal(&lumped.mass.read().unwrap().to_vec().into())
        });
        if let Some(contact) = contact {
            let a = body.localization.vector.read().unwrap();
            let last = free.len();
            let hat: Vec<f64> = free.iter().map(|i| -a[*i]).chain([1.0]).collect();
            stiffness = stiffness.resize(last + 1, last + 1, 0.0);
            for (i, row) in hat.iter().enumerate() {
                for (j, column) in hat.iter().enumerate() {
                    stiffness[(i, j)] += contact.tangent * row * column;
                }
            }
            mass = mass.resize(last + 1, last + 1, 0.0);
            mass[(last, last)] = contact.mass;
        }
        Self { stiffness, mass }
    }

    /// ω_max of K x = ω² M x.
    fn largest_frequency(self) -> f64 {
        let factor = self.mass.cholesky().expect("M is positive definite").unpack();
        let half = factor.solve_lower_triangular(&self.stiffness).unwrap();
        let reduced = factor.solve_lower_triangular(&half.transpose()).unwrap();
        reduced.symmetric_eigenvalues().max().sqrt()
    }
}

/// A matrix that one rank has.
fn dense(matrix: &Matrix) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.size().0, matrix.size().1);
    for row in matrix.row_range() {
        let entries = matrix.row(row).unwrap();
        for (column, value) in entries.columns().iter().zip(entries.values()) {
            dense[(row as usize, *column as usize)] = *value;
        }
    }
    dense
}

/// ω_max of the parts, with lumped or consistent mass. Collective.
fn largest(parts: &mut Parts, consistent: bool, contact: Option<LinearContact>) -> LargestFrequency {
    let inertia = if consistent { Inertia::Consistent } else { Inertia::Lumped(&parts.lumped.mass) };
    largest_frequency(&parts.mesh, &mut parts.body, inertia, contact).unwrap()
}

/// ω_max lies between the two numbers, which are close and the same on any number of ranks; contact raises it.
fn largest_frequency_against_dense(session: &Session) {
    let (world, alone) = (session.world(), session.alone());
    let [mut error, mut width, mut difference] = [0.0_f64; 3];
    for kind in KINDS {
        for supports in [FREE, HELD, ON_PAD] {
            let mut here = parts(&alone, kind, SIZE, 0.15, supports);
            let mut shared = parts(&world, kind, SIZE, 0.15, supports);
            // Stiff enough to be felt on these coarse meshes.
            let contact = LinearContact { tangent: 1e3 * peak_contact(&here.scene).tangent, mass: MASS };
            for consistent in [false, true] {
                let [apart, touching] = [None, Some(contact)].map(|contact| {
                    let name = format!("{kind:?}, {supports:?}, consistent {consistent}, {contact:?}");
                    let expected = Dense::new(&mut here, consistent, contact).largest_frequency();
                    let found = largest(&mut shared, consistent, contact);
                    // Dense rounding is 1e-16 times the ratio of the largest to the least mass.
                    assert!(found.ritz <= expected * (1.0 + 1e-12), "{name}: {found:?} instead of {expected}");
                    assert!(found.bound >= expected * (1.0 - 1e-12), "{name}: {found:?} instead of {expected}");
                    assert!(found.ritz > expected * (1.0 - 1e-3), "{name}: {found:?} instead of {expected}");
                    assert!(found.bound < expected * (1.0 + 5e-3), "{name}: {found:?} instead of {expected}");
                    error = error.max(1.0 - found.ritz / expected);
                    width = width.max(found.bound / expected - 1.0);
                    let by_one = largest(&mut here, consistent, contact);
                    assert_eq!(by_one.vectors, found.vectors, "{name}");
                    difference = difference.max((by_one.ritz / found.ritz - 1.0).abs());
                    difference = difference.max((by_one.bound / found.bound - 1.0).abs());
                    expected
                });
                // Where springs of the support make ω_max, contact elsewhere adds next to nothing.
                assert!(
                    touching > if supports == FREE { 1.01 * apart } else { apart },
                    "{kind:?}: {apart}, {touching}"
                );
            }
            drop((here, shared));
            world.collect_garbage().unwrap();
        }
    }
    // The order of sums, which full orthogonalisation keeps from growing.
    assert!(difference < 1e-6, "{difference:e}");
    if world.is_root() {
        println!("ω_max: Ritz value low by {error:.1e}, bound high by {width:.1e}, ranks differ by {difference:.1e}");
    }
}

/// Bisects for the largest Δt at which the central difference does not grow from a random start.
///
/// All ranks but one wait: the step is the same on each, and the test is of its limit.
fn measured_limit(session: &Session) {
    if !session.world().is_root() {
        return;
    }
    for kind in KINDS {
        for (supports, touching) in [(HELD, false), (ON_PAD, false), (FREE, true)] {
            let mut parts = parts(&session.alone(), kind, SIZE, 0.15, supports);
            let contact =
                touching.then(|| LinearContact { tangent: 1e3 * peak_contact(&parts.scene).tangent, mass: MASS });
            let found = largest(&mut parts, false, contact);
            let critical = critical_frequency(0.0, 0.5);
            let (mut holds, mut fails) = (0.9 * critical / found.ritz, 1.1 * critical / found.ritz);
            let mut vibration = Vibration::new(&mut parts, contact);
            assert!(!vibration.grows(holds) && vibration.grows(fails), "{kind:?}, {supports:?}");
            while fails > holds * (1.0 + 1e-4) {
                let middle = 0.5 * (holds + fails);
                if vibration.grows(middle) { fails = middle } else { holds = middle }
            }
            let limit = 0.5 * (holds + fails);
            println!(
                "{:?} {}, {}: limit {limit:.5e} s, {:.5} of 2/Ritz, {:.5} of 2/bound",
                kind.shape,
                kind.order,
                if touching {
                    "in contact"
                } else if supports == HELD {
                    "held"
                } else {
                    "on a pad, damped"
                },
                limit * found.ritz / critical,
                limit * found.bound / critical
            );
            // The bisection's width, and a Ritz value that is low by less than 1e-3.
            assert!(limit > critical / found.bound * (1.0 - 1e-4));
            assert!((limit * found.ritz / critical - 1.0).abs() < 1e-3);
            if touching {
                let apart = largest(&mut parts, false, None);
                assert!(limit < 0.99 * critical / apart.bound, "the limit in contact is below that without");
            }
        }
    }
}

/// A body on one rank that vibrates freely, pads pressed, the impactor on it as a linear spring.
struct Vibration<'a> {
    parts: &'a mut Parts,
    contact: Option<LinearContact>,
    u: Vector,
    force: Vector,
    product: Vector,
}

impl<'a> Vibration<'a> {
    const STEPS: usize = 2000;

    fn new(parts: &'a mut Parts, contact: Option<LinearContact>) -> Self {
        let [u, force, product] = [(); 3].map(|()| parts.body.load.duplicate().unwrap());
        Self { parts, contact, u, force, product }
    }

    /// −K u, and the impactor's force.
    fn forces(&mut self, q: f64) -> f64 {
        let body = &mut self.parts.body;
        body.elastic.mult(&self.u, &mut self.force).unwrap();
        if let Some(support) = &body.support {
            support.mult(&self.u, &mut self.product).unwrap();
            self.force.axpy(1.0, &self.product).unwrap();
        }
        if let Some(pads) = &mut body.pads {
            pads.add_pressed(&self.u, &mut self.force).unwrap();
        }
        let a = &body.localization.vector;
        let contact = self.contact.map_or(0.0, |contact| contact.tangent * (q - a.dot(&self.u).unwrap()));
        self.force.axpy(-contact, a).unwrap();
        self.force.scale(-1.0).unwrap();
        body.clamps.zero(&mut self.force).unwrap();
        -contact
    }

    /// Whether |u| becomes a million times that of the start, which is at rest with u at random: just below the limit it becomes
    /// a hundred times at most, and 1e-5 above the limit e^18.
    fn grows(&mut self, step: f64) -> bool {
        let scheme = CentralDifference { step };
        let n = self.u.len();
        let (mut v, mut a) = (vec![0.0; n], vec![0.0; n]);
        let (mut q, mut q_v, mut q_a) = (0.0, 0.0, 0.0);
        let mut seed = 1_u64;
        self.u.write().unwrap().iter_mut().for_each(|u| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *u = (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0;
        });
        self.parts.body.clamps.zero(&mut self.u).unwrap();
        let initial = self.u.norm().unwrap();
        for number in 0..=Self::STEPS {
            // The first pass finds the accelerations of the start.
            if number > 0 {
                for ((u, v), a) in self.u.write().unwrap().iter_mut().zip(&mut v).zip(&a) {
                    (*u, *v) = scheme.predict(*u, *v, *a);
                }
                (q, q_v) = scheme.predict(q, q_v, q_a);
            }
            let on_impactor = self.forces(q);
            let scheme = CentralDifference { step: if number > 0 { step } else { 0.0 } };
            let Lumped { mass, damping } = &self.parts.lumped;
            let (force, mass) = (self.force.read().unwrap(), mass.read().unwrap());
            let damping = damping.as_ref().map(|damping| damping.read().unwrap());
            for i in 0..n {
                let c = damping.as_ref().map_or(0.0, |damping| damping[i]);
                (v[i], a[i]) = scheme.correct(v[i], force[i], mass[i], c);
            }
            if let Some(contact) = self.contact {
                (q_v, q_a) = scheme.correct(q_v, on_impactor, contact.mass, 0.0);
            }
            drop(force);
            if self.u.norm().unwrap() > 1e6 * initial {
                return true;
            }
        }
        false
    }
}

/// A body that is held everywhere has no frequency, but for the impactor's on it.
fn nothing_free(session: &Session) {
    let surfaces = ["side", "top", "bottom"];
    let held = surfaces.map(|name| format!("[[support]]\nsurface = \"{name}\"\nkind = \"clamped\"\n")).concat();
    let kind = Kind { cells: [1, 1, 1], ..KINDS[0] };
    let mut parts = parts(&session.world(), kind, SIZE, 0.0, &held);
    for consistent in [false, true] {
        let none = largest(&mut parts, consistent, None);
        assert_eq!(none, LargestFrequency { ritz: 0.0, bound: 0.0, vectors: 0 });
        let contact = LinearContact { tangent: 8.0, mass: 2.0 };
        let one = largest(&mut parts, consistent, Some(contact));
        assert!((one.ritz - 2.0).abs() < 1e-14 && (one.bound - 2.0).abs() < 1e-7 && one.vectors == 1, "{one:?}");
    }
}

/// A column that moves along its length only: held sideways at its sides, along its length at the bottom, free at the top. Its
/// lowest frequency is c_p π/(2L), c_p² = (λ + 2μ)/ρ. With lumped mass it converges at order two; hexahedra of order 2, whose
/// lumped mass is a quadrature by Simpson's rule, keep order four.
fn lowest_frequency_converges(session: &Session) {
    let supports = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"x\", \"y\"]\n\
        [[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n";
    let size = [0.1, 0.1, 0.3];
    let modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let exact = (modulus / DENSITY).sqrt() * std::f64::consts::PI / (2.0 * size[2]);
    for (kind, expected) in KINDS.into_iter().zip([2.0, 4.0, 2.0, 2.0]) {
        for distortion in [0.0, 0.15] {
            let errors = [1, 2, 4].map(|n| {
                let n = if kind.order == 1 { 2 * n } else { n };
                let parts = parts(&session.world(), Kind { cells: [n, n, 3 * n], ..kind }, size, distortion, supports);
                let found = lowest_frequency(&parts);
                session.world().collect_garbage().unwrap();
                found / exact - 1.0
            });
            let order = (errors[1] / errors[2]).abs().log2();
            if session.world().is_root() {
                println!("{:?} {}, moved by {distortion}: errors {errors:?}, order {order:.2}", kind.shape, kind.order);
            }
            let _ = expected;
        }
    }
}

/// ω_min of K x = ω² M x with lumped mass, by inverse iteration. Collective.
fn lowest_frequency(Parts { mesh, body, lumped, .. }: &Parts) -> f64 {
    let mut stiffness = body.combination(0.0, 0.0).unwrap();
    stiffness.zero_rows_columns(&body.clamps.rows, 1.0).unwrap();
    stiffness.declare_positive_definite().unwrap();
    let mut solver = Ksp::new(&mesh.comm, "", &stiffness).unwrap();
    let mut x = body.clamps.free.duplicate().unwrap();
    x.copy_from(&body.clamps.free).unwrap();
    let mut momentum = x.duplicate().unwrap();
    let mut square = 0.0;
    // The next such mode has nine times the eigenvalue: its share falls to 9⁻¹².
    for _ in 0..12 {
        momentum.copy_from(&x).unwrap();
        momentum.pointwise_mult(&lumped.mass).unwrap();
        solver.solve(&momentum, &mut x).unwrap();
        let work = x.dot(&momentum).unwrap();
        momentum.copy_from(&x).unwrap();
        momentum.pointwise_mult(&lumped.mass).unwrap();
        let length = x.dot(&momentum).unwrap();
        square = work / length;
        x.scale(1.0 / length.sqrt()).unwrap();
    }
    square.sqrt()
}
