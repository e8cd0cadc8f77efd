//! Estimated errors of the acceleration in the first contact are compared with true errors, for the cheapest and
//! hardest of the impacts of scripts/estimates: thick plates on grids of few cells, clamped ones, and thick boxes.

use crate::modelled::{Ran, run};
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};

/// On one rank: the computation is the same on all ranks.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    estimates_are_above_the_errors_of_cells_basis_and_steps,
    estimates_for_thick_boxes_are_above_the_errors,
    a_contact_without_echoes_is_within_its_estimate,
    half_the_disc_changes_less_than_is_estimated,
];

/// An impact in the centre of a plate or a thick box, which ends shortly before the end of its first contact.
struct Case {
    body: &'static str,
    support: &'static str,
    impactor: &'static str,
    /// End time, s.
    end: f64,
}

const HELD: &str = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n";
const CLAMPED: &str = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\n";

const CASES: [Case; 4] = [
    Case {
        body: "young = 35e9\npoisson = 0.2\ndensity = 2400\nsize = [0.13, 0.13, 0.014]",
        support: HELD,
        impactor: "mass = 0.58\nradius = 0.013\nspeed = 4.9",
        end: 5.3031e-4,
    },
    Case {
        body: "young = 3.3e9\npoisson = 0.37\ndensity = 1190\nsize = [0.93, 0.93, 0.19]",
        support: HELD,
        impactor: "mass = 86\nradius = 0.0082\nspeed = 3.4",
        end: 5.6186e-3,
    },
    Case {
        body: "young = 210e9\npoisson = 0.3\ndensity = 7800\nsize = [0.61, 0.61, 0.048]",
        support: CLAMPED,
        impactor: "mass = 14\nradius = 0.029\nspeed = 0.21",
        end: 1.0403e-3,
    },
    Case {
        body: "young = 3.3e9\npoisson = 0.37\ndensity = 1190\nsize = [0.27, 0.27, 0.045]",
        support: "",
        impactor: "mass = 1.5\nradius = 0.0064\nspeed = 1.8",
        end: 1.1954e-3,
    },
];

/// Thick boxes with two to four cells along the edges.
const THICK_BOXES: [Case; 3] = [
    Case {
        body: "young = 70e9\npoisson = 0.33\ndensity = 2700\nsize = [0.061, 0.089, 0.038]",
        support: CLAMPED,
        impactor: "mass = 0.13\nradius = 0.045\nspeed = 0.29",
        end: 1.4716e-4,
    },
    Case {
        body: "young = 3.3e9\npoisson = 0.37\ndensity = 1190\nsize = [0.43, 0.16, 0.12]",
        support: HELD,
        impactor: "mass = 7.2\nradius = 0.014\nspeed = 0.3",
        end: 2.7592e-3,
    },
    Case {
        body: "young = 70e9\npoisson = 0.23\ndensity = 2500\nsize = [0.19, 0.19, 0.053]",
        support: "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n",
        impactor: "mass = 0.18\nradius = 0.066\nspeed = 0.24",
        end: 1.6453e-4,
    },
];

fn text(case: &Case, model: &str, tolerance: f64) -> String {
    let Case { body, support, impactor, end } = case;
    format!(
        "[body]\nmodel = \"{model}\"\n{body}\n[impactor]\nyoung = 210e9\npoisson = 0.3\n{impactor}\n\
         [time]\nend = {end:e}\n[accuracy]\ntolerance = {tolerance:e}\n{support}"
    )
}

/// The acceleration between time steps, by the cubic through the four nearest steps: the error of linear interpolation
/// would be as large as the differences of interest.
fn at(ran: &Ran, time: f64) -> f64 {
    let last = ran.steps.len() - 2;
    let after = ran.steps.partition_point(|step| step.time < time).clamp(2, last);
    let four = &ran.steps[after - 2..after + 2];
    let weight = |own: f64| {
        let others = four.iter().map(|step| step.time).filter(|other| *other != own);
        others.map(|other| (time - other) / (own - other)).product::<f64>()
    };
    four.iter().map(|step| weight(step.time) * step.impactor.acceleration).sum()
}

/// Largest difference over the reference's peak, at the time steps of a run.
fn difference(ran: &Ran, reference: &Ran) -> f64 {
    let peak = reference.steps.iter().fold(0.0_f64, |peak, step| peak.max(step.impactor.acceleration));
    let off = ran.steps.iter().map(|step| (at(reference, step.time) - step.impactor.acceleration).abs());
    off.fold(0.0, f64::max) / peak
}

/// References are of the same theory with a tolerance of 3e-4; their own estimates are a fraction of the differences
/// found. The estimates of solids would be 0.2 to 0.7 of their errors with one cell across the solids, and with the
/// sizes of the coarser cells instead of their numbers.
fn estimates_are_above_the_errors_of_cells_basis_and_steps(session: &Session) {
    let comm = session.world();
    for (number, case) in CASES.iter().enumerate() {
        check(&comm, &format!("case {number}"), case, &["mindlin", "solid"]);
    }
}

/// Coarser cells would be as many as the others along one edge, or two. In comparison with them, the estimates would be
/// 0.3 to 0.7 of the errors.
fn estimates_for_thick_boxes_are_above_the_errors(session: &Session) {
    let comm = session.world();
    for (number, case) in THICK_BOXES.iter().enumerate() {
        check(&comm, &format!("thick box {number}"), case, &["solid"]);
    }
}

fn check(comm: &Comm, name: &str, case: &Case, models: &[&str]) {
    for model in models {
        let of = |tolerance: f64| -> Ran { run(comm, &text(case, model, tolerance)) };
        let (ran, reference) = (of(1e-2), of(3e-4));
        let error = difference(&ran, &reference);
        println!("  {name}, {model}: error {error:.1e}, estimate {:.1e}", ran.error);
        assert!(error <= ran.error, "{name} {model}: {error:e} over {:e}", ran.error);
        // At most six times the error, or six times a tenth of the tolerance.
        assert!(ran.error <= 6.0 * error.max(1e-3), "{name} {model}: {:e} for {error:e}", ran.error);
    }
}

/// The contact with a free pane is over before the first echo, and its short waves are treated separately: a part of the
/// error is not shown by a smaller basis. Without that part the estimate is 3.0e-4, and the error 3.8e-4.
fn a_contact_without_echoes_is_within_its_estimate(session: &Session) {
    let comm = session.world();
    let case = Case {
        body: "young = 70e9\npoisson = 0.23\ndensity = 2500\nsize = [0.8, 0.6, 0.006]",
        support: "",
        impactor: "mass = 0.05\nradius = 0.0115\nspeed = 2.0",
        end: 1.74e-4,
    };
    let [ran, reference] = [1e-2, 1e-3].map(|tolerance| run(&comm, &text(&case, "mindlin", tolerance)));
    let error = difference(&ran, &reference);
    println!("  error {error:.1e}, estimate {:.1e}", ran.error);
    // A part of the error is the reference's, whose estimate is 2e-4.
    assert!(error <= ran.error && ran.error <= 6.0 * error, "{:e} for {error:e}", ran.error);
}

/// A plate whose force acts on a disc with a radius of one thickness instead of two: the time history differs by no
/// more than both estimates allow. (At tolerances of 1e-3 the difference is 3e-4, mostly from the coarser grid.)
fn half_the_disc_changes_less_than_is_estimated(session: &Session) {
    let comm = session.world();
    let case = &CASES[3];
    let of = |disc: &str| -> Ran { run(&comm, &(text(case, "mindlin", 1e-3) + disc)) };
    let (whole, half) = (of(""), of("[contact]\ndisc_radius = 0.045\n"));
    let off = difference(&half, &whole);
    println!("  {off:.1e}, estimates {:.1e} and {:.1e}", whole.error, half.error);
    // Far above rounding: the key has an effect.
    assert!(off > 1e-6 && off <= whole.error + half.error, "{off:e}");
    let same = of("[contact]\ndisc_radius = 0.09\n");
    assert!(difference(&same, &whole) < 1e-12, "two thicknesses are the default");
}
