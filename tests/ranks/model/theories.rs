//! Theories are compared with published solutions.

use crate::glass::{plate, sides};
use crate::modelled::run;
use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::contact::zener;
use ricochet::form::Material;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] =
    tests![half_space, infinite_plate, karas, timoshenko, mindlin_has_the_solids_contacts, mindlin_tends_to_kirchhoff];

fn near(what: &str, value: f64, expected: f64, part: f64) {
    println!("  {what}: {value:.6e}, {expected:.6e}, {:+.1e}", value / expected - 1.0);
    assert!((value / expected - 1.0).abs() < part, "{what}: {value} instead of {expected}");
}

const BALL: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.0, 1.0, 0.1]\n\
                    [impactor]\nmass = 2.0\nradius = 0.05\nstiffness = 1e9\nspeed = 3.0\n";

/// Hertz (1882): F = 1.14326 k0^{0.4} m^{0.6} v^{1.2}, contact time 3.21807 (m²/(k0² v))^{0.2}, restitution 1; the
/// tolerance is the given digits.
fn half_space(session: &Session) {
    let text =
        BALL.replace("[body]", "[body]\nmodel = \"half-space\"") + "[time]\nend = 5e-3\n[accuracy]\ntolerance = 1e-6\n";
    let ran = run(&session.world(), &text);
    let (k, m, v) = (1e9_f64, 2.0_f64, 3.0_f64);
    near("peak", ran.contacts[0].peak_force, 1.14326 * k.powf(0.4) * m.powf(0.6) * v.powf(1.2), 5e-6);
    near("contact time", ran.contacts[0].end, 3.21807 * (m * m / (k * k * v)).powf(0.2), 5e-6);
    near("rebound", ran.steps.last().unwrap().impactor.velocity, -v, 1e-6);
    // A contact shorter than a time step is detected too.
    let step = 2.0 * ran.contacts[0].end;
    let ran = run(&session.world(), &text.replace("end = 5e-3\n", &format!("end = 5e-3\nstep = {step:e}\n")));
    assert_eq!(ran.contacts.len(), 1);
    assert!(ran.contacts[0].peak_force > 0.0 && ran.steps.last().unwrap().impactor.velocity < 0.0);
}

/// Zener's table (C. Zener, Phys. Rev. 59, 1941): all its digits, so 5e-6 for numbers of order one.
fn infinite_plate(session: &Session) {
    let table = [
        (0.1, 0.84334, 1.03555, 3.27849),
        (0.2, 0.71404, 0.94606, 3.34866),
        (0.5, 0.43690, 0.75023, 3.62444),
        (1.0, 0.18412, 0.55616, 4.38761),
        (2.0, 0.02068, 0.36466, 8.48322),
    ];
    let (m, v) = (2.0_f64, 3.0_f64);
    let impedance = zener::impedance(&Material { young: 70e9, poisson: 0.23, density: 2500.0 }, 0.1);
    for (lambda, restitution, peak, time) in table {
        let k = (lambda * impedance / (v.powf(0.2) * m.powf(0.6))).powf(2.5);
        let unit = (m * m / (k * k * v)).powf(0.2);
        let text = BALL.replace("[body]", "[body]\nmodel = \"infinite-plate\"").replace("1e9", &format!("{k:e}"))
            + &format!("[time]\nend = {:e}\n[accuracy]\ntolerance = 1e-6\n", 10.0 * unit);
        let ran = run(&session.world(), &text);
        let contact = ran.contacts[0];
        let found = [
            -ran.steps.last().unwrap().impactor.velocity / v,
            contact.peak_force / (k.powf(0.4) * m.powf(0.6) * v.powf(1.2)),
            contact.end / unit,
        ];
        println!("  λ = {lambda}: {found:.6?}");
        // The energy lost by the impactor, 1 − e² of ½ m v², is in the plate's waves. The numerical energy is within
        // the tolerance.
        let (energy, initial) = (ran.steps.last().unwrap().energy, 0.5 * m * v * v);
        assert!((energy.dissipated / initial - (1.0 - found[0] * found[0])).abs() < 1e-6, "{energy:?}");
        assert!(energy.numerical.abs() < 1e-6 * initial, "{energy:?}");
        for (found, expected) in found.into_iter().zip([restitution, peak, time]) {
            // Half of the table's last digit, plus the tolerance of the run.
            assert!((found - expected).abs() < 7e-6, "λ = {lambda}: {found} instead of {expected}");
        }
    }
}

/// Karas' problem, a steel ball on a simply supported steel plate: the series of 301² modes.
fn karas(session: &Session) {
    let mass = 7833.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    let text = format!(
        "[body]\nmodel = \"kirchhoff\"\nyoung = 206e9\npoisson = 0.3\ndensity = 7833.0\nsize = [0.2, 0.2, 0.008]\n\
         [[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n\
         [impactor]\nmass = {mass:e}\nradius = 0.01\nyoung = 206e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = 2e-4\n[accuracy]\ntolerance = 5e-4\n"
    );
    let ran = run(&session.world(), &text);
    let contact = ran.contacts[0];
    near("peak", contact.peak_force, 1383.2, 2e-3);
    near("its time", contact.peak_time, 32.8e-6, 2e-2);
    near("end", contact.end, 73.2e-6, 5e-3);
    near("rebound", ran.steps.last().unwrap().impactor.velocity, -0.6640, 2e-3);
    assert_eq!(ran.contacts.len(), 1);
}

/// Timoshenko's problem: the ball on a short and on a long beam, modelled as a strip of plate without Poisson's effect;
/// the classical multiple impact.
fn timoshenko(session: &Session) {
    let hertz = |radius: f64| 4.0 / 3.0 * radius.sqrt() * 215.8e9 / (2.0 * (1.0 - 0.09));
    let beam = |length: f64, radius: f64, end: f64| {
        let mass = 7960.0 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let held = ["x-min", "x-max"]
            .map(|s| format!("[[support]]\nsurface = \"{s}\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n"))
            .concat();
        format!(
            "[body]\nmodel = \"kirchhoff\"\nyoung = 215.8e9\npoisson = 0.0\ndensity = 7960.0\nsize = [{length}, 0.01, 0.01]\n{held}\
             [impactor]\nmass = {mass:e}\nradius = {radius}\nstiffness = {:e}\nspeed = 0.01\n\
             [time]\nend = {end:e}\n[accuracy]\ntolerance = 1e-3\n",
            hertz(radius)
        )
    };
    let short = run(&session.world(), &beam(0.1535, 0.01, 8e-4));
    near("short: peak", short.contacts[0].peak_force, 4.98, 5e-3);
    near("short: end", short.contacts[0].end, 156.4e-6, 5e-3);
    let long = run(&session.world(), &beam(0.307, 0.02, 2.2e-3));
    assert_eq!(long.contacts.len(), 2, "{:?}", long.contacts);
    let [first, second] = [long.contacts[0], long.contacts[1]];
    near("first peak", first.peak_force, 9.01, 5e-3);
    near("first end", first.end, 434.6e-6, 5e-3);
    near("second start", second.start, 1336.6e-6, 5e-3);
    near("second peak", second.peak_force, 10.30, 5e-3);
    near("second end", second.end, 1782e-6, 5e-3);
}

/// Mindlin's plate has the contacts of solids converged by an independent program: the paper's plates with k = 0 and
/// 1e9.
fn mindlin_has_the_solids_contacts(session: &Session) {
    // Thickness, edge, k; start and end (ms) of each contact and its peak (m/s²).
    type Row = (f64, f64, f64, &'static [(f64, f64, f64)]);
    let rows: [Row; 5] = [
        (0.1, 1.5, 0.0, &[(0.0, 1.328, 2002.7)]),
        (0.04, 1.5, 0.0, &[(0.0, 1.885, 752.0), (3.501, 4.216, 121.0), (5.221, 6.954, 568.0)]),
        (0.04, 1.5, 1e9, &[(0.0, 2.941, 752.0), (3.317, 3.552, 4.4), (6.065, 7.655, 906.0)]),
        (0.02, 0.5, 0.0, &[(0.0, 1.880, 413.0), (2.015, 2.074, 1.9)]),
        (0.02, 0.5, 1e9, &[(0.0, 1.773, 258.0), (1.903, 7.867, 553.1)]),
    ];
    for (thickness, edge, stiffness, contacts) in rows {
        let end = contacts.last().unwrap().1 * 1e-3 + 1e-4;
        let body = format!("model = \"mindlin\"\nsize = [{edge}, {edge}, {thickness}]");
        let text = plate(&body, &format!("end = {end:e}"), &sides(stiffness, 0.0)) + "[accuracy]\ntolerance = 3e-3\n";
        let ran = run(&session.world(), &text);
        let highest = contacts.iter().map(|(_, _, peak)| *peak).fold(0.0, f64::max);
        assert_eq!(ran.contacts.len(), contacts.len(), "{thickness} m, k = {stiffness:e}: {:?}", ran.contacts);
        for (found, (start, end, peak)) in ran.contacts.iter().zip(contacts) {
            let found = [1e3 * found.start, 1e3 * found.end, found.peak_force / 52.0];
            println!("  {thickness} m, k = {stiffness:e}: {found:.4?} ({start}, {end}, {peak})");
            // The theory's own error, 1% of the history's peak, and 1% of the time of contact.
            assert!((found[0] - start).abs() < 0.03 && (found[1] - end).abs() < 0.03);
            assert!((found[2] - peak).abs() < 0.01 * highest);
        }
    }
}

/// As the plate becomes thinner relative to the contact, the time histories of both theories converge to each other:
/// there is no locking.
fn mindlin_tends_to_kirchhoff(session: &Session) {
    let mut differences = Vec::new();
    for ratio in [1e-1_f64, 1e-2, 1e-3, 1e-4] {
        // Lengths and times are chosen so that the dimensionless history of Kirchhoff's plate stays the same: mass and
        // stiffness of the impactor are scaled with the plate's.
        let thickness = ratio;
        let bending = 70e9 * thickness.powi(3) / 12.0 / (1.0 - 0.23_f64.powi(2));
        let mass = 0.2 * 2500.0 * thickness;
        let period = (2500.0 * thickness / bending).sqrt();
        // Hertz's contact time is a third of the time L²√(ρh/D).
        let speed = thickness / period;
        let stiffness = (mass * mass / speed).sqrt() / (0.1 * period).powf(2.5);
        let text = |model: &str| {
            format!(
                "[body]\nmodel = \"{model}\"\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.0, 1.0, {thickness:e}]\n\
                 [impactor]\nmass = {mass:e}\nradius = {thickness:e}\nstiffness = {stiffness:e}\nspeed = {speed:e}\n\
                 [time]\nend = {:e}\n[accuracy]\ntolerance = 3e-3\n",
                0.5 * period
            )
        };
        let [thin, thick] = ["kirchhoff", "mindlin"].map(|model| run(&session.world(), &text(model)));
        let (first, _) = thin.difference(&thick);
        println!("  h/L = {ratio:e}: {first:.1e}");
        differences.push(first);
    }
    // The difference is proportional to (h/L)², down to the tolerance.
    assert!(differences[1] < 0.03 * differences[0], "{differences:?}");
    assert!(differences[2..].iter().all(|difference| *difference < 3e-3), "{differences:?}");
}
