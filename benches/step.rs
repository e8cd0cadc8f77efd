//! Measures the cost of a time step and of a basis: `cargo bench --bench step`.
//!
//! Compares, on one plate of 25,000 unknowns: the condensed step with the linear solve that it contains, the full
//! Newton's method (SNES) with the condensed step, and a Krylov basis with its factorisation and solves. The
//! measurements alternate in rounds; the shortest times count.

use std::ops::ControlFlow;
use std::time::Instant;

use petsc_wrap::Session;
use ricochet::body::{Body, Krylov};
use ricochet::impact::SteppedImpact;
use ricochet::mesh::Mesh;
use ricochet::scene::{Newton, Scene};
use ricochet::scheme::newmark;
use ricochet::solve::linear::{Method, solver};

/// Time step Δt, s.
const STEP: f64 = 1e-5;

/// Number of condensed steps, or solves, timed together.
const CONDENSED: usize = 40;
/// Number of full Newton steps timed together.
const FULL: usize = 10;

/// Number of basis vectors.
const VECTORS: usize = 60;

const ROUNDS: usize = 5;

fn scene(steps: usize) -> Scene {
    let end = STEP * steps as f64;
    let text = format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.1]\ncells = [20, 20, 2]\nsymmetry = \"none\"\n\
         [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\ndamping = 1e5\n\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = {end:e}\nstep = {STEP:e}\n"
    );
    Scene::parse("bench", &text, &[]).expect("a scene").0
}

/// Time of one step, s. The first step, which factorises, is not counted.
fn step(mesh: &Mesh, newton: Newton, steps: usize) -> f64 {
    let mut scene = scene(steps + 1);
    scene.solver.newton = newton;
    let body = Body::solid(&scene, mesh).expect("a body");
    let mut impact = SteppedImpact::new(&scene, body).expect("an impact");
    let mut begin = Instant::now();
    let flow = impact.run(|step| {
        if step.number == 1 {
            begin = Instant::now();
        }
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.expect("a run").is_continue());
    begin.elapsed().as_secs_f64() / steps as f64
}

/// Time of one solve with the operator of a step, s.
fn solve(mesh: &Mesh) -> f64 {
    let scene = scene(1);
    let body = Body::solid(&scene, mesh).expect("a body");
    let stage = newmark(0.25, 0.5).stage(STEP);
    let matrix = body.operator(stage.c1, stage.c2).expect("an operator");
    let mut ksp = solver(&mesh.comm, "", &matrix, Method::Cholesky).expect("a solver");
    let mut x = body.load.duplicate().expect("a vector");
    let b = &body.localization.vector;
    ksp.solve(b, &mut x).expect("a solve");
    let begin = Instant::now();
    for _ in 0..CONDENSED {
        ksp.solve(b, &mut x).expect("a solve");
    }
    begin.elapsed().as_secs_f64() / CONDENSED as f64
}

/// Times of building a basis of the plate without its damper, and of its factorisation and solves alone, s.
fn basis(mesh: &Mesh) -> [f64; 2] {
    let mut scene = scene(1);
    scene.supports.iter_mut().for_each(|support| support.damping = [0.0; 3]);
    let body = Body::solid(&scene, mesh).expect("a body");
    let shift = 1e4;
    let begin = Instant::now();
    let mut krylov = Krylov::new(&body, shift).expect("a basis");
    krylov.grow(&body, VECTORS).expect("a basis");
    krylov.projection(&body).expect("a projection");
    let of_basis = begin.elapsed().as_secs_f64();
    drop(krylov);
    let begin = Instant::now();
    let matrix = body.operator(0.0, shift * shift).expect("an operator");
    let mut ksp = solver(&mesh.comm, "", &matrix, Method::Cholesky).expect("a solver");
    let mut x = body.load.duplicate().expect("a vector");
    (0..VECTORS).for_each(|_| ksp.solve(&body.localization.vector, &mut x).expect("a solve"));
    [of_basis, begin.elapsed().as_secs_f64()]
}

fn main() {
    // `cargo test` also builds and starts benches. Then nothing is measured.
    if !std::env::args().any(|arg| arg == "--bench") {
        return;
    }
    let session = Session::start(&[]).expect("the first session").expect("PETSc starts");
    let mesh = Mesh::new(&session.world(), &scene(1).body).expect("a mesh");
    let mut best = [f64::INFINITY; 5];
    for _ in 0..ROUNDS {
        let [whole, bare] = basis(&mesh);
        let round =
            [solve(&mesh), step(&mesh, Newton::Condensed, CONDENSED), step(&mesh, Newton::Full, FULL), whole, bare];
        best.iter_mut().zip(round).for_each(|(best, time)| *best = best.min(time));
    }
    let [solve, condensed, full, whole, bare] = best;
    println!(
        "{} unknowns: bare solve {:.2} ms; condensed step {:.2} ms, {:.2} bare solves; full Newton step {:.1} ms, {:.1} condensed steps",
        3 * mesh.nodes,
        1e3 * solve,
        1e3 * condensed,
        condensed / solve,
        1e3 * full,
        full / condensed
    );
    println!(
        "basis of {VECTORS} vectors: {whole:.2} s, {:.2} of its factorisation and solves ({bare:.2} s)",
        whole / bare
    );
}
