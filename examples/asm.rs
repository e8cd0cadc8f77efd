#![allow(missing_docs)]
use petsc_wrap::Session;
use ricochet::body::Body;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
fn main() {
    let session = Session::start(&[]).unwrap().unwrap();
    let comm = session.world();
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    for cells in ["[20, 20, 2]", "[30, 30, 3]"] {
        let text = format!(
            "[body]\nmodel=\"solid\"\nreduction=\"none\"\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.1]\ncells = {cells}\nsymmetry = \"none\"\n[impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[contact]\nlocalization=\"point\"\n[time]\nend = 1e-3\nstep=1e-5\nscheme=\"newmark\"\n"
        );
        let scene = Scene::parse("bench", &text, &[]).unwrap().0;
        let t = std::time::Instant::now();
        let mesh = Mesh::new(&comm, &scene.body).unwrap();
        let m = t.elapsed().as_secs_f64();
        let mut best = 1e9f64;
        for _ in 0..n {
            let t = std::time::Instant::now();
            let body = Body::solid(&scene, &mesh).unwrap();
            best = best.min(t.elapsed().as_secs_f64());
            drop(body);
            comm.collect_garbage().unwrap();
        }
        println!("{cells}: mesh {m:.3} s, body {best:.3} s, unknowns {}", 3 * mesh.nodes);
    }
}
