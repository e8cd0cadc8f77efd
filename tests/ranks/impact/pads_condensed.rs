//! The condensed Newton's method with pads: it has the solution of the full method, and iterates on the pads' unknowns
//! only.

use mpi_test::{Test, tests};
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::impact::newton::{ALL, HARD_PAD, PAD};
use crate::start::{run, start};
use petsc_wrap::{Comm, Session};
use ricochet::body::Body;
use ricochet::impact::Method;
use ricochet::impact::step::Step;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![methods, reference, agrees_with_full];

const ENERGY: &str = "scheme = \"energy\"";
struct Case {
    name: &'static str,
    supports: &'static str,
    impactor: &'static str,
    time: &'static str,
    step: f64,
    steps: usize,
}

fn cases() -> Vec<Case> {
    let case = |name, supports, impactor, time, step, steps| Case { name, supports, impactor, time, step, steps };
    let off = "speed = 1.0\npoint = [0.13, 0.07, 0.01]";
    vec![
        case("centred", PAD, "speed = 1.0", "", 2e-5, 30),
        case("off-centre", PAD, off, "", 2e-5, 30),
        case("off-centre, large steps", PAD, off, "", 1e-3, 30),
        case("off-centre, generalised α", PAD, off, "scheme = \"generalized-alpha\"\nrho_inf = 0.6", 2e-5, 30),
        case("off-centre, energy", PAD, off, ENERGY, 2e-5, 30),
        case("clamped, elastic and pad, moved", ALL, "speed = 1.0", "", 2e-5, 30),
        case("clamped, elastic and pad, moved; large steps", ALL, "speed = 1.0", ENERGY, 1e-3, 20),
        case("a pad like a wall, corner", HARD_PAD, "speed = 5.0\npoint = [0.25, 0.25, 0.01]", ENERGY, 3e-4, 40),
        case("a pad like a wall", HARD_PAD, off, ENERGY, 1e-4, 30),
        case("a pad like a wall, small steps", HARD_PAD, off, ENERGY, 1e-5, 30),
    ]
}

fn scene(case: &Case, newton: &str) -> String {
    let Case { supports, impactor, time, step, steps, .. } = case;
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\ncells = [4, 4, 1]\n\
         symmetry = \"none\"\n{supports}\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n{impactor}\n\
         [time]\nend = {:e}\nstep = {step:e}\n{time}\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"{newton}\"\n",
        step * *steps as f64
    )
}

/// Runs a scene by one of the two methods.
fn solve(comm: &Comm, text: &str) -> Run {
    let (_, mut impact) = start(comm, text);
    let begin = Instant::now();
    let steps = run(&mut impact);
    let (seconds, count) = (begin.elapsed().as_secs_f64(), impact.count.iterations);
    drop(impact);
    comm.collect_garbage().unwrap();
    Run { iterations: count as f64 / (steps.len() - 1) as f64, steps, seconds }
}

struct Run {
    steps: Vec<Step>,
    /// Mean number of Newton iterations in a time step.
    iterations: f64,
    seconds: f64,
}

impl Run {
    /// Largest difference from another run, over its largest value.
    fn error(&self, other: &Self, get: impl Fn(&Step) -> f64) -> f64 {
        let scale = other.steps.iter().fold(0.0, |max: f64, step| max.max(get(step).abs()));
        let pairs = self.steps.iter().zip(&other.steps);
        pairs.map(|(one, other)| (get(one) - get(other)).abs() / scale).fold(0.0, f64::max)
    }

    /// Largest change of the energy balance, over the initial energy.
    fn drift(&self) -> f64 {
        let balance = |step: &Step| step.energy.total + step.energy.dissipated - step.energy.external;
        let first = balance(&self.steps[0]);
        self.steps.iter().map(|step| (balance(step) - first).abs()).fold(0.0, f64::max) / first
    }
}

/// Both methods solve the same equations, and the energy scheme conserves the balance with pads too.
fn agrees_with_full(session: &Session) {
    let world = session.world();
    // The full Newton's method is slow on several ranks of a busy machine; the dense equations are solved on rank 0
    // anyway.
    let few =
        |case: &Case| matches!(case.name, "off-centre" | "off-centre, energy" | "clamped, elastic and pad, moved");
    for case in cases().into_iter().filter(|case| world.size() == 1 || few(case)) {
        let [full, condensed] = ["full", "condensed"].map(|newton| solve(&world, &scene(&case, newton)));
        let errors = [
            condensed.error(&full, |step| step.impactor.position),
            condensed.error(&full, |step| step.contact.surface_displacement),
            condensed.error(&full, |step| step.contact.force),
            condensed.error(&full, |step| step.energy.total),
        ];
        let drift = condensed.drift();
        if world.is_root() {
            println!(
                "{:45} {:.1e} {:.1e} {:.1e} {:.1e}, drift {drift:.1e} against {:.1e}; {:.2} iterations a step against {:.2}, time {:.2}",
                case.name,
                errors[0],
                errors[1],
                errors[2],
                errors[3],
                full.drift(),
                condensed.iterations,
                full.iterations,
                condensed.seconds / full.seconds
            );
        }
        // Each time step is solved to 1e-10 of the force on a half-space, by either method; after a hundred time steps
        // the difference is some 1e-9.
        assert!(errors.iter().all(|error| *error <= 1e-7), "{}: {errors:?}", case.name);
        assert!(condensed.steps.iter().any(|step| step.energy.support > 0.0), "{}: no pad is pressed", case.name);
        if case.time == ENERGY {
            // The forces on a pad as stiff as a wall are 1e6 times the others, so their rounding is larger.
            let rounding = if case.name.contains("wall") { 1e-8 } else { 1e-9 };
            assert!(drift <= rounding, "{}: {drift:e}", case.name);
        }
    }
}

/// The method used for a body with pads, and its unknowns.
fn methods(session: &Session) {
    let world = session.world();
    let method = |case: &Case, newton: &str, cells: &str| {
        let text = scene(case, newton).replace("cells = [4, 4, 1]", cells);
        let (scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        Method::of(scene.solver.newton, &Body::solid(&scene, &mesh).unwrap())
    };
    let pushed = |case: &Case| match method(case, "condensed", "cells = [4, 4, 1]") {
        Method::CondensedOnPads(unknowns) => unknowns.len(),
        other => panic!("{other:?}"),
    };
    let [plain, .., moved] = &cases()[..6] else { panic!("six cases") };
    // 9 × 9 nodes on the bottom, loaded by the pad along z; or along y and z, without the 9 clamped ones.
    assert_eq!((pushed(plain), pushed(moved)), (81, 2 * 72));
    assert_eq!(method(plain, "full", "cells = [4, 4, 1]"), Method::Full);
    assert_eq!(method(plain, "condensed", "cells = [18, 18, 1]"), Method::Full, "37 × 37 unknowns are too many");
    let without = Case { supports: "", ..cases().remove(0) };
    assert_eq!(method(&without, "condensed", "cells = [4, 4, 1]"), Method::Condensed);
}

/// The reference case of another program, with its mesh, element, scheme and quadrature of the pad.
fn reference(session: &Session) {
    let world = session.world();
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/reference/plate20-pad");
    let mesh = folder.join("mesh.msh");
    let text = format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nmesh = {mesh:?}\norder = 2\n\
         [[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = [0.0, 0.0, 1e9]\n\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\npoint = [0.0, 0.0, 0.01]\n\
         [time]\nend = 6e-3\nstep = 2e-5\n[contact]\nlocalization = \"point\"\n[solver]\nnewton = \"condensed\"\n"
    );
    let expected = table(&folder.join("series.csv"));
    let condensed = solve(&world, &text);
    assert_eq!(condensed.steps.len(), expected.len());
    let worst = |column: usize, get: fn(&Step) -> f64| {
        let scale = expected.iter().fold(0.0, |max: f64, row| max.max(row[column].abs()));
        let errors = condensed.steps.iter().zip(&expected).map(|(step, row)| (get(step) - row[column]).abs() / scale);
        errors.fold(0.0, f64::max)
    };
    let errors = [
        worst(1, |step| step.impactor.position),
        worst(2, |step| step.contact.surface_displacement),
        worst(3, |step| step.contact.force),
        worst(4, |step| step.impactor.acceleration),
    ];
    if world.is_root() {
        println!("plate20-pad: {errors:?}, {:.2} iterations a step", condensed.iterations);
    }
    // The reference's own rounding is up to 6e-9 (its README); the tolerance has a margin of a factor of ten.
    assert!(errors.iter().all(|error| *error <= 1e-7), "{errors:?}");
}

/// The numbers of a CSV file with one header line.
fn table(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).expect("the table");
    text.lines().skip(1).map(|line| line.split(',').map(|word| word.parse().expect("a number")).collect()).collect()
}
