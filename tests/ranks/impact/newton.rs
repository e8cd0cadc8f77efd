//! Newton's method in hard cases: it converges without tuning, and accepted steps solve the equations.

use crate::start::{run, start};
use mpi_test::{Test, tests};
use petsc_wrap::{Matrix, Session, Vector, options};
use ricochet::contact::hertz;
use ricochet::error::Error;
use ricochet::impact::SteppedImpact;
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![hard_cases, a_failure_tells_where];

/// A hard case: its differences from a plain impact on a free plate.
struct Case {
    name: &'static str,
    impactor: &'static str,
    rest: &'static str,
    step: f64,
    steps: usize,
}

const PLAIN: Case = Case { name: "", impactor: "speed = 1.0", rest: "", step: 1e-5, steps: 60 };

const STIFF_SIDE: &str = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n";
pub const PAD: &str =
    "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = [0.0, 0.0, 1e10]\n";
pub const HARD_PAD: &str =
    "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = [0.0, 0.0, 1e15]\n";
pub const ALL: &str = "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\ndisplacement = [1e-5, 0.0, -5e-5]\n\
    [[support]]\nsurface = \"x-max\"\nkind = \"elastic\"\nstiffness = [1e9, 2e9, 1e10]\ndamping = 1e5\n\
    displacement = [0.0, 1e-5, 1e-4]\n\
    [[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.6, -0.8]\nstiffness = [0.0, 1e9, 3e10]\n\
    displacement = [0.0, -1e-5, 2e-5]\n";

fn cases() -> Vec<Case> {
    vec![
        Case { name: "a contact of two or three steps", step: 1e-3, steps: 10, ..PLAIN },
        Case { name: "a contact within a step", step: 1e-2, steps: 5, ..PLAIN },
        Case { name: "a contact within a step, supported", step: 1e-2, steps: 5, rest: STIFF_SIDE, ..PLAIN },
        Case { name: "100 m/s", impactor: "speed = 100.0", ..PLAIN },
        Case { name: "100 m/s, large steps", impactor: "speed = 100.0", step: 1e-3, steps: 10, ..PLAIN },
        Case { name: "1 μm/s", impactor: "speed = 1e-6", step: 1e-4, ..PLAIN },
        Case { name: "stiff contact", impactor: "speed = 1.0\nstiffness = 1e16", ..PLAIN },
        Case { name: "stiff contact, large steps", impactor: "speed = 1.0\nstiffness = 1e16", step: 1e-3, ..PLAIN },
        Case { name: "soft contact", impactor: "speed = 1.0\nstiffness = 1e3", step: 1e-3, ..PLAIN },
        Case { name: "gap", impactor: "speed = 1.0\ngap = 1.234e-4", ..PLAIN },
        Case {
            name: "gap that closes far into a large step",
            impactor: "speed = 1.0\ngap = 9.9e-3",
            step: 1e-2,
            steps: 4,
            ..PLAIN
        },
        Case { name: "off-centre on a pad", impactor: "speed = 1.0\npoint = [0.13, 0.07, 0.01]", rest: PAD, ..PLAIN },
        Case {
            name: "off-centre on a pad, large steps",
            impactor: "speed = 1.0\npoint = [0.13, 0.07, 0.01]",
            rest: PAD,
            step: 1e-3,
            ..PLAIN
        },
        Case {
            name: "corner of a plate on a pad like a wall",
            impactor: "speed = 5.0\npoint = [0.25, 0.25, 0.01]",
            rest: HARD_PAD,
            step: 1e-3,
            steps: 20,
        },
        Case {
            name: "beside a simple support",
            impactor: "speed = 1.0\npoint = [0.2, 0.02, 0.01]",
            rest: "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n",
            ..PLAIN
        },
        Case { name: "clamped, elastic and pad, moved", rest: ALL, ..PLAIN },
        Case { name: "clamped, elastic and pad, moved; large steps", rest: ALL, step: 1e-3, ..PLAIN },
        Case { name: "clamped, elastic and pad, moved; slow", impactor: "speed = 1e-3", rest: ALL, ..PLAIN },
    ]
}

fn scene(case: &Case) -> String {
    let Case { impactor, rest, step, .. } = case;
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\ncells = [4, 4, 1]\n\
         symmetry = \"none\"\n{rest}\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n{impactor}\n\
         [time]\nend = {step:e}\nstep = {step:e}\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\nenergy_gate = 1e9\n"
    )
}

/// Every time step converges, and the equations hold at its end.
fn hard_cases(session: &Session) {
    let world = session.world();
    for case in cases() {
        let text = scene(&case);
        let (_, mut impact) = start(&world, &text);
        let impactor = Scene::parse("test", &text, &[]).unwrap().0.impactor;
        let scale = hertz::peak_force(impactor.stiffness, impactor.mass, impactor.speed);
        let (mut most, mut largest) = (0, 0.0_f64);
        for number in 1..=case.steps {
            let before = impact.count.iterations;
            let step = run(&mut impact)[1];
            most = most.max(impact.count.iterations - before);
            largest = largest.max(step.contact.force);
            // Newton's method stops at 1e-10 of the force on a half-space: m0 q̈ = −F to ten times that.
            let row = impactor.mass * impact.state().q.acceleration + step.contact.force;
            assert!(row.abs() <= 1e-9 * scale, "{}, step {number}: {row:e} N left of {scale:e}", case.name);
            if impact.body().pads.is_none() {
                let left = residual(&impact, step.contact.force);
                assert!(left <= 1e-9 * scale, "{}, step {number}: {left:e} N left of {scale:e}", case.name);
            }
        }
        assert!(largest > 0.0, "{}: no contact", case.name);
        if world.is_root() {
            println!(
                "{:46} {:5.2} iterations a step, {most} at most",
                case.name,
                impact.count.iterations as f64 / case.steps as f64
            );
        }
        drop(impact);
        world.collect_garbage().unwrap();
    }
}

/// |M ü + C u̇ + K u − a F − f|, N, over the free unknowns of a body without pads.
fn residual(impact: &SteppedImpact, force: f64) -> f64 {
    let (body, state) = (impact.body(), impact.state());
    let (mut sum, mut product) = (state.u.duplicate().unwrap(), state.u.duplicate().unwrap());
    let terms: [(Option<&Matrix>, &Vector); 4] = [
        (Some(&body.mass), &state.a),
        (body.terms.damping.as_ref(), &state.v),
        (Some(&body.terms.elastic), &state.u),
        (body.terms.support.as_ref(), &state.u),
    ];
    for (matrix, vector) in terms {
        if let Some(matrix) = matrix {
            matrix.mult(vector, &mut product).unwrap();
            sum.axpy(1.0, &product).unwrap();
        }
    }
    sum.axpy(-force, &body.terms.contact.force).unwrap();
    sum.axpy(-1.0, &body.terms.load).unwrap();
    sum.axpy(-1.0, &body.terms.support_load).unwrap();
    body.clamps.zero(&mut sum).unwrap();
    sum.norm_max().unwrap()
}

/// One iteration is not enough for a time step in which contact begins; the error names the step.
fn a_failure_tells_where(session: &Session) {
    const OPTION: &str = "-snes_max_it";
    options::set(session, OPTION, "1").unwrap();
    let text = scene(&Case { impactor: "speed = 1.0\ngap = 2.5e-5", ..PLAIN }).replace("end = 1e-5", "end = 1e-3");
    let (_, mut impact) = start(&session.world(), &text);
    options::clear(session, OPTION).unwrap();
    let mut seen = 0;
    let error = impact
        .run(|step| {
            seen = step.number;
            Ok(std::ops::ControlFlow::Continue(()))
        })
        .unwrap_err();
    // The contact begins after 2.5 time steps.
    assert_eq!(seen, 2, "accepted steps are told before the failure");
    assert!(matches!(error, Error::Solve(_)), "{error:?}");
    assert!(error.is_everywhere());
    assert_eq!(error.status(), 3);
    let message = error.to_string();
    for part in ["step 3, t = 3.0", "e-5 s", "DIVERGED_MAX_IT", "after 1 iterations", "residual ", " N ("] {
        assert!(message.contains(part), "{part:?} is not in: {message}");
    }
    let residual = message.split("residual ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!(residual.parse::<f64>().unwrap() > 0.0, "{message}");
}
