#![allow(missing_docs)]
use petsc_wrap::Session;
use ricochet::model::{Model, Simulation};
use ricochet::scene::Scene;
use std::ops::ControlFlow;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let session = Session::start(&[]).unwrap().unwrap();
    let comm = session.world();
    let n: usize = args[2].parse().unwrap();
    let scene = Scene::read(std::path::Path::new(&args[1]), &args[3..]).unwrap().0;
    let mut best = (1e9f64, 1e9f64);
    for _ in 0..n {
        let t = std::time::Instant::now();
        let model = Model::new(&comm, &scene).unwrap();
        let mut sim = Simulation::new(&scene, model).unwrap();
        let b = t.elapsed().as_secs_f64();
        let mut k = 0;
        let _ = sim
            .run(|_| {
                k += 1;
                Ok(ControlFlow::Continue(()))
            })
            .unwrap();
        let r = t.elapsed().as_secs_f64() - b;
        best = (best.0.min(b), best.1.min(r));
        drop(sim);
        comm.collect_garbage().unwrap();
        if n == 1 {
            println!("steps {k}");
        }
    }
    println!("build {:.2} ms, run {:.2} ms", 1e3 * best.0, 1e3 * best.1);
}
