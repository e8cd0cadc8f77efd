//! The condensed step on pads: the full Newton's solution, with its nonlinear part on the pads' unknowns alone.

#[path = "common/start.rs"]
mod start;

use std::process::ExitCode;
use std::time::Instant;

use petsc_wrap::Session;
use ricochet::impact::step::Step;
use start::{run, start};

fn session() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(&[1, 2, 3], session, &[("agrees_with_full", agrees_with_full)])
}

const ENERGY: &str = "scheme = \"energy\"";
const PAD: &str =
    "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = [0.0, 0.0, 1e10]\n";
const HARD_PAD: &str =
    "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = [0.0, 0.0, 1e15]\n";
const ALL: &str = "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\ndisplacement = [1e-5, 0.0, -5e-5]\n\
    [[support]]\nsurface = \"x-max\"\nkind = \"elastic\"\nstiffness = [1e9, 2e9, 1e10]\ndamping = 1e5\n\
    displacement = [0.0, 1e-5, 1e-4]\n\
    [[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.6, -0.8]\nstiffness = [0.0, 1e9, 3e10]\n\
    displacement = [0.0, -1e-5, 2e-5]\n";

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
        case("centred", PAD, "speed = 1.0", "", 2e-5, 100),
        case("off-centre", PAD, off, "", 2e-5, 100),
        case("off-centre, large steps", PAD, off, "", 1e-3, 60),
        case("off-centre, generalised α", PAD, off, "scheme = \"generalized-alpha\"\nrho_inf = 0.6", 2e-5, 100),
        case("off-centre, energy", PAD, off, ENERGY, 2e-5, 100),
        case("clamped, elastic and pad, moved", ALL, "speed = 1.0", "", 2e-5, 60),
        case("clamped, elastic and pad, moved; large steps", ALL, "speed = 1.0", ENERGY, 1e-3, 60),
        case("a pad like a wall, corner", HARD_PAD, "speed = 5.0\npoint = [0.25, 0.25, 0.01]", ENERGY, 1e-3, 20),
        case("a pad like a wall", HARD_PAD, off, ENERGY, 1e-4, 60),
        case("a pad like a wall, small steps", HARD_PAD, off, ENERGY, 1e-5, 100),
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

fn agrees_with_full(session: &Session) {
    let world = session.world();
    for case in cases() {
        let solve = |newton: &str| {
            let (_, mut impact) = start(&world, &scene(&case, newton));
            let begin = Instant::now();
            let steps = run(&mut impact);
            let time = begin.elapsed().as_secs_f64();
            let iterations = impact.count.iterations as f64 / (steps.len() - 1) as f64;
            drop(impact);
            world.collect_garbage().unwrap();
            (steps, iterations, time)
        };
        let (full, of_full, time_full) = solve("full");
        let (condensed, of_condensed, time) = solve("condensed");
        let worst = |get: fn(&Step) -> f64| {
            let scale = full.iter().fold(0.0, |max: f64, step| max.max(get(step).abs()));
            let error = |(a, b): (&Step, &Step)| (get(a) - get(b)).abs() / scale;
            full.iter().zip(&condensed).map(error).fold(0.0, f64::max)
        };
        let errors = [
            worst(|step| step.impactor.position),
            worst(|step| step.contact.surface_displacement),
            worst(|step| step.contact.force),
            worst(|step| step.energy.total),
        ];
        if world.is_root() {
            println!(
                "{:45} {:.1e} {:.1e} {:.1e} {:.1e}; iterations a step {of_full:.2} {of_condensed:.2}, {time_full:.2} s {time:.2} s",
                case.name, errors[0], errors[1], errors[2], errors[3]
            );
        }
    }
}
