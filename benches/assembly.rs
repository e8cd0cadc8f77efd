//! Measures the speed-up of assembly from one rank to two: `cargo bench --bench assembly`.
//!
//! Starts itself under `mpirun -n 1` and `-n 2` alternately, three rounds. Prints the shortest times and their ratio.

use std::time::Instant;

use petsc_wrap::{Session, mpi};
use ricochet::body::Body;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

/// Environment variable that is set for the processes under mpirun.
const CHILD: &str = "RICOCHET_BENCH_CHILD";

/// Name, geometry, and coordinate z of the upper surface, m.
const SCENES: [(&str, &str, f64); 4] = [
    ("Q2 hexahedra 20×20×2", "size = [1.5, 1.5, 0.1]\ncells = [20, 20, 2]", 0.05),
    ("Q2 hexahedra 30×30×3", "size = [1.5, 1.5, 0.1]\ncells = [30, 30, 3]", 0.05),
    ("Q2 hexahedra 36×36×4", "size = [1.5, 1.5, 0.15]\ncells = [36, 36, 4]", 0.075),
    ("P2 tetrahedra", concat!("mesh = \"", env!("CARGO_MANIFEST_DIR"), "/out/bench/plate.msh\""), 0.01),
];

fn main() {
    // `cargo test` also builds and starts benches. Then nothing is measured.
    if !std::env::args().any(|arg| arg == "--bench") {
        return;
    }
    if std::env::var_os(CHILD).is_some() { child() } else { parent() }
}

fn parent() {
    let program = std::env::current_exe().expect("the path of this program");
    make_mesh();
    let mut best = [[f64::INFINITY; 2]; SCENES.len()];
    let mut unknowns = [0.0; SCENES.len()];
    for _ in 0..3 {
        for ranks in [1, 2] {
            let output = mpi_test::mpirun(ranks).arg(&program).arg("--bench").env(CHILD, "1").output().expect("mpirun");
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
            for (i, line) in text.lines().enumerate() {
                let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
                unknowns[i] = numbers[0];
                best[i][ranks - 1] = best[i][ranks - 1].min(numbers[1]);
            }
        }
    }
    for (i, (name, ..)) in SCENES.iter().enumerate() {
        let [one, two] = best[i];
        println!(
            "{name}, {} unknowns: assembly {one:.3} s on 1 rank, {two:.3} s on 2, speed-up {:.2}",
            unknowns[i],
            one / two
        );
    }
}

/// Makes a finer mesh of the plate in meshes/ with gmsh (Debian package).
fn make_mesh() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/out/bench");
    std::fs::create_dir_all(folder).expect("a folder for the mesh");
    let status = std::process::Command::new("gmsh")
        .args([concat!(env!("CARGO_MANIFEST_DIR"), "/meshes/plate20.geo"), "-3", "-clscale", "0.36", "-v", "0", "-o"])
        .arg(format!("{folder}/plate.msh"))
        .status()
        .expect("gmsh (Debian's package of that name)");
    assert!(status.success());
}

fn child() {
    let session = Session::start(&[]).expect("the first session").expect("PETSc starts");
    let world = session.world();
    for (name, geometry, top) in SCENES {
        let text = format!(
            "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\norder = 2\nsymmetry = \"none\"\n{geometry}\n\
             [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\npoint = [0.0, 0.0, {top}]\n\
             [time]\nend = 1e-3\n[contact]\nlocalization = \"point\"\n[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n"
        );
        let scene = Scene::parse(name, &text, &[]).expect("the scene is right").0;
        let mesh = Mesh::new(&world, &scene.body).expect("a mesh");
        let (mut best, mut unknowns) = (f64::INFINITY, 0);
        for _ in 0..3 {
            use mpi::traits::CommunicatorCollectives;
            world.mpi().barrier();
            let begin = Instant::now();
            let body = Body::solid(&scene, &mesh).expect("a body");
            world.mpi().barrier();
            best = best.min(begin.elapsed().as_secs_f64());
            unknowns = body.unknowns();
            drop(body);
            world.collect_garbage().expect("nothing else is at work");
        }
        if world.is_root() {
            println!("{unknowns} {best}");
        }
    }
}
