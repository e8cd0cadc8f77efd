//! What a step costs: `cargo bench --bench step`.
//!
//! The condensed step against the bare linear solve that it contains, and the full Newton's method by SNES against the
//! condensed step, on one plate of 25,000 unknowns in contact. Rounds take turns; the shortest times count.

use std::ops::ControlFlow;
use std::time::Instant;

use petsc_wrap::{Ksp, Session};
use ricochet::body::Body;
use ricochet::impact::Impact;
use ricochet::mesh::Mesh;
use ricochet::scene::{Newton, Scene};
use ricochet::scheme::newmark;

/// Δt, s.
const STEP: f64 = 1e-5;

/// Steps, or solves, that are timed together.
const CONDENSED: usize = 40;
const FULL: usize = 10;

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

/// Seconds a step; the first step, which factorises, is not counted.
fn step(mesh: &Mesh, newton: Newton, steps: usize) -> f64 {
    let mut scene = scene(steps + 1);
    scene.solver.newton = newton;
    let body = Body::solid(&scene, mesh).expect("a body");
    let mut impact = Impact::new(&scene, body).expect("an impact");
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

/// Seconds a solve with the operator of a step.
fn solve(mesh: &Mesh) -> f64 {
    let scene = scene(1);
    let body = Body::solid(&scene, mesh).expect("a body");
    let stage = newmark(0.25, 0.5).stage(STEP);
    let matrix = body.operator(stage.c1, stage.c2).expect("an operator");
    let mut ksp = Ksp::new(&mesh.comm, "", &matrix).expect("a solver");
    let mut x = body.load.duplicate().expect("a vector");
    let b = &body.localization.vector;
    ksp.solve(b, &mut x).expect("a solve");
    let begin = Instant::now();
    for _ in 0..CONDENSED {
        ksp.solve(b, &mut x).expect("a solve");
    }
    begin.elapsed().as_secs_f64() / CONDENSED as f64
}

fn main() {
    // `cargo test` also builds and starts benches; there is nothing to measure then.
    if !std::env::args().any(|arg| arg == "--bench") {
        return;
    }
    let session = Session::start(&[]).expect("the first session").expect("PETSc starts");
    let mesh = Mesh::new(&session.world(), &scene(1).body).expect("a mesh");
    let mut best = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        let round = [solve(&mesh), step(&mesh, Newton::Condensed, CONDENSED), step(&mesh, Newton::Full, FULL)];
        best.iter_mut().zip(round).for_each(|(best, time)| *best = best.min(time));
    }
    let [solve, condensed, full] = best;
    println!(
        "{} unknowns: bare solve {:.2} ms; condensed step {:.2} ms, {:.2} of it; full Newton step {:.1} ms, {:.1} condensed ones",
        3 * mesh.nodes,
        1e3 * solve,
        1e3 * condensed,
        condensed / solve,
        1e3 * full,
        full / condensed
    );
}
