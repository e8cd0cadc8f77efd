//! Iterative solvers where they fail: rigid motions of a free body, and supports as stiff as a clamp.

#[path = "common/start.rs"]
mod start;

use std::process::ExitCode;

use petsc_wrap::{Comm, Ksp, Matrix, Session, options};
use ricochet::body::Solid;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use start::{run, start};

fn session() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2],
        session,
        &[("free_body", free_body), ("stiff_support", stiff_support), ("clamped_in_the_limit", clamped_in_the_limit)],
    )
}

fn scene(side: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.1]\ncells = [10, 10, 1]\n\
         symmetry = \"none\"\n{side}\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = 2e-3\nstep = 2e-5\n[contact]\nlocalization = \"point\"\n"
    )
}

fn side(kind: &str) -> String {
    format!("[[support]]\nsurface = \"side\"\nkind = {kind}\n")
}

fn solid(comm: &Comm, side: &str) -> Solid {
    let (scene, _) = Scene::parse("test", &scene(side), &[]).unwrap_or_else(|error| panic!("{error}"));
    Solid::new(&scene, &Mesh::new(comm, &scene.body).unwrap()).unwrap()
}

/// Iterations of conjugate gradients with multigrid for S⁻¹a, and how far that is from the direct solution.
fn iterations(session: &Session, body: &Solid, matrix: &Matrix) -> (usize, f64) {
    let world = session.world();
    let a = &body.localization.vector;
    let mut exact = a.duplicate().unwrap();
    Ksp::new(&world, "", matrix).unwrap().solve(a, &mut exact).unwrap();
    let chosen = [("-ksp_type", "cg"), ("-pc_type", "gamg")];
    chosen.iter().for_each(|(name, value)| options::set(session, name, value).unwrap());
    let mut ksp = Ksp::new(&world, "", matrix).unwrap();
    let mut x = a.duplicate().unwrap();
    let solved = ksp.solve(a, &mut x);
    chosen.iter().for_each(|(name, _)| options::clear(session, name).unwrap());
    let count = ksp.iterations().unwrap();
    if let Err(e) = solved {
        println!("{e}");
    }
    x.axpy(-1.0, &exact).unwrap();
    (count, x.norm().unwrap() / exact.norm().unwrap())
}

fn free_body(session: &Session) {
    let world = session.world();
    for step in [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0] {
        let body = solid(&world, "");
        let c2 = 4.0 / (step * step);
        let with = iterations(session, &body, &body.operator(0.0, c2).unwrap());
        let mut matrix = body.combination(0.0, c2).unwrap();
        matrix.declare_positive_definite().unwrap();
        let without = iterations(session, &body, &matrix);
        println!("{step}: {with:?} {without:?}");
    }
}

fn stiff_support(session: &Session) {
    let world = session.world();
    for k in ["1e10", "1e12", "1e14", "1e16", "1e18"] {
        let body = solid(&world, &side(&format!("\"elastic\"\nstiffness = {k}")));
        println!("{k}: {:?}", iterations(session, &body, &body.operator(0.0, 4e10).unwrap()));
        println!("{k}: {:?}", iterations(session, &body, &body.operator(0.0, 4e6).unwrap()));
    }
    let body = solid(&world, &side("\"clamped\""));
    println!("clamped: {:?}", iterations(session, &body, &body.operator(0.0, 4e6).unwrap()));
}

fn clamped_in_the_limit(session: &Session) {
    let world = session.world();
    let peak = |kind: &str| {
        let (_, mut impact) = start(&world, &scene(&side(kind)));
        run(&mut impact).iter().fold(0.0, |max: f64, step| max.max(step.impactor.acceleration))
    };
    let clamped = peak("\"clamped\"");
    for k in ["1e10", "1e11", "1e12", "1e13", "1e14", "1e15", "1e16", "1e17", "1e18"] {
        let value = peak(&format!("\"elastic\"\nstiffness = {k}"));
        println!("{k}: {:e}", value / clamped - 1.0);
    }
}
