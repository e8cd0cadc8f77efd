//! Measures the cost of a time step and of a basis: `cargo bench --bench step`.
//!
//! Compares, on one plate of 25,000 unknowns: the condensed step with the linear solve that it contains, the full
//! Newton's method (SNES) with the condensed step, and a Krylov basis with its factorisation and solves. Steps and
//! solves alternate one by one, so that both meet the same load of the machine, and their medians count. The other
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

/// Number of condensed steps, and of solves between them.
const CONDENSED: usize = 200;
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

/// A plate under its impactor, without steps yet.
fn impact(mesh: &Mesh, newton: Newton, steps: usize) -> SteppedImpact {
    let mut scene = scene(steps);
    scene.solver.newton = newton;
    SteppedImpact::new(&scene, Body::solid(&scene, mesh).expect("a body")).expect("an impact")
}

/// Median times of one solve with the operator of a step, and of one condensed step, s.
fn solve_and_step(mesh: &Mesh) -> [f64; 2] {
    let body = Body::solid(&scene(1), mesh).expect("a body");
    let stage = newmark(0.25, 0.5).stage(STEP);
    let matrix = body.operator(stage.c1, stage.c2).expect("an operator");
    let mut ksp = solver(&mesh.comm, "", &matrix, Method::Cholesky).expect("a solver");
    let mut x = body.terms.load.duplicate().expect("a vector");
    let b = &body.terms.contact.force;
    ksp.solve(b, &mut x).expect("a solve");
    let mut times = [const { Vec::new() }; 2];
    let mut begin = None;
    let flow = impact(mesh, Newton::Condensed, CONDENSED).run(|_| {
        // Before the first step nothing is timed.
        times[1].extend(begin.map(|begin: Instant| begin.elapsed().as_secs_f64()));
        let start = Instant::now();
        ksp.solve(b, &mut x)?;
        times[0].push(start.elapsed().as_secs_f64());
        begin = Some(Instant::now());
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.expect("a run").is_continue());
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    })
}

/// Time of one full Newton step, s. The first step, which factorises, is not counted.
fn full_step(mesh: &Mesh) -> f64 {
    let mut begin = Instant::now();
    let flow = impact(mesh, Newton::Full, FULL + 1).run(|step| {
        if step.number == 1 {
            begin = Instant::now();
        }
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.expect("a run").is_continue());
    begin.elapsed().as_secs_f64() / FULL as f64
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
    let mut x = body.terms.load.duplicate().expect("a vector");
    (0..VECTORS).for_each(|_| ksp.solve(&body.terms.contact.force, &mut x).expect("a solve"));
    [of_basis, begin.elapsed().as_secs_f64()]
}

fn main() {
    // `cargo test` also builds and starts benches. Then nothing is measured.
    if !std::env::args().any(|arg| arg == "--bench") {
        return;
    }
    let session = Session::start(&[]).expect("the first session").expect("PETSc starts");
    let mesh = Mesh::new(&session.world(), &scene(1).body).expect("a mesh");
    let [solve, condensed] = solve_and_step(&mesh);
    let mut best = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        let [whole, bare] = basis(&mesh);
        best.iter_mut().zip([full_step(&mesh), whole, bare]).for_each(|(best, time)| *best = best.min(time));
    }
    let [full, whole, bare] = best;
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
