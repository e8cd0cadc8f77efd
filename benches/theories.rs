//! Measures theories, reductions and sweeps on the 0.04 m plate of the paper over 20 ms:
//! `cargo bench --bench theories`.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::process::{Command, Stdio};
use std::time::Duration;

use criterion::Criterion;
use petsc_wrap::{Comm, Session};
use ricochet::impact::ModalImpact;
use ricochet::model::{Dynamics, Model, Simulation};
use ricochet::scene::Scene;

fn text(model: &str, tolerance: f64) -> String {
    format!(
        "[body]\nmodel = \"{model}\"\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.04]\n\
         [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = 0.02\n[accuracy]\ntolerance = {tolerance:e}\n"
    )
}

fn scene(model: &str, tolerance: f64) -> Scene {
    Scene::parse("bench", &text(model, tolerance), &[]).expect("a scene").0
}

/// Builds the model of a scene and runs the whole impact. Returns the final velocity of the impactor, m/s.
fn whole(comm: &Comm, scene: &Scene) -> f64 {
    let model = Model::new(comm, scene).expect("a model");
    let mut simulation = Simulation::new(scene, model).expect("an impact");
    let mut last = 0.0;
    let flow = simulation.run(|step| {
        last = step.impactor.velocity;
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.expect("a run").is_continue());
    comm.collect_garbage().expect("nothing else is at work");
    last
}

/// Runs a sweep of 20 members in a separate process.
fn sweep(key: &str) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/out/bench");
    std::fs::create_dir_all(folder).expect("a folder for results");
    let (scene, out) = (format!("{folder}/plate.toml"), format!("{folder}/sweep.h5"));
    std::fs::write(&scene, text("mindlin", 1e-2)).expect("a scene's file");
    // An existing result would be continued.
    let _ = std::fs::remove_file(&out);
    let status = Command::new(env!("CARGO_BIN_EXE_ricochet"))
        .args(["sweep", &scene, "--log", "--vary", key, "-o", &out])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    assert!(status.expect("the program").success());
}

fn main() {
    // `cargo test` also builds and starts benches. Then nothing is measured.
    if !std::env::args().any(|arg| arg == "--bench") {
        return;
    }
    let session = Session::start(&[]).expect("the first session").expect("PETSc starts");
    let comm = session.world();
    // Criterion's plots need a registered font. The plotters build of this program has none.
    let criterion = Criterion::default().without_plots().sample_size(10);
    let mut criterion = criterion.measurement_time(Duration::from_secs(5)).configure_from_args();

    let plate = scene("mindlin", 1e-2);
    criterion.bench_function("mindlin at 1e-2", |b| b.iter(|| whole(&comm, black_box(&plate))));
    let Dynamics::Modal(body) = Model::new(&comm, &plate).expect("a model").dynamics else {
        panic!("the scene is modal");
    };
    criterion.bench_function("its modal run alone", |b| {
        b.iter(|| ModalImpact::new(black_box(&plate), &body).trace(None).expect("a run").0.peak());
    });
    let solid = scene("solid", 3e-3);
    criterion.bench_function("reduced solid at 3e-3", |b| b.iter(|| whole(&comm, black_box(&solid))));
    criterion.bench_function("sweep of 20 speeds", |b| b.iter(|| sweep("impactor.speed=0.1..10:20")));
    criterion.bench_function("sweep of 20 stiffnesses", |b| b.iter(|| sweep("support.0.stiffness=1e6..1e12:20")));
    criterion.final_summary();
}
