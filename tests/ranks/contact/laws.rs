//! Contact laws other than Hertz's, and damping: energies, impulses and restitution are compared with closed forms, in
//! modal coordinates and in time steps.

use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::contact::{ForceLaw, Power, Table};

use crate::modelled::{Ran, run};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![
    a_mass_on_a_wall,
    restitution_of_hunt_and_crossley,
    a_damped_force_is_that_of_the_law,
    strong_damping_is_one_contact,
    a_power_of_three_halves_is_hertz,
    every_scheme_converges_to_the_same_history,
    energy_is_kept_or_dissipated,
    a_run_ends_where_its_table_does
];

const MASS: f64 = 50.0;
const SPEED: f64 = 4.0;

/// A pane hit by a soft impactor, with the given lines of the body and the contact, and further tables.
fn scene(body: &str, contact: &str, rest: &str) -> String {
    format!(
        "[body]\n{body}\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.0, 1.0, 0.02]\n\
         [impactor]\nmass = {MASS:?}\nspeed = {SPEED:?}\n[contact]\n{contact}\n{rest}"
    )
}

/// Points of a power law, as an array.
fn points(stiffness: f64, exponent: f64, end: f64, count: usize) -> String {
    let point = |i: usize| {
        let x = end * i as f64 / count as f64;
        format!("[{x:e}, {:e}]", stiffness * x.powf(exponent))
    };
    format!("[{}]", (0..=count).map(point).collect::<Vec<_>>().join(", "))
}

/// Largest change of a run's total plus dissipated energy, over the initial energy.
fn imbalance(ran: &Ran) -> f64 {
    let all = ran.steps.iter().map(|step| step.energy.total + step.energy.dissipated);
    let first = ran.steps[0].energy.total;
    all.fold(0.0_f64, |most, energy| most.max((energy / first - 1.0).abs()))
}

/// A mass on a half-space, which is rigid with such a law. The mass returns with its initial speed and its impulse is 2
/// m v. At the peak force the potential of the law is m v²/2, and the contact time follows from the law.
fn a_mass_on_a_wall(session: &Session) {
    let energy = 0.5 * MASS * SPEED * SPEED;
    let table = format!("law = \"table\"\ntable = {}", points(5e4, 1.0, 0.2, 7));
    for (contact, stiffness, exponent) in [
        ("law = \"power\"\nstiffness = 5e4\nexponent = 1.0", 5e4, 1.0),
        ("law = \"power\"\nstiffness = 2e5\nexponent = 1.2", 2e5, 1.2),
        ("law = \"power\"\nstiffness = 3e6\nexponent = 2.0", 3e6, 2.0),
        (&table, 5e4, 1.0),
    ] {
        let way = (energy * (exponent + 1.0) / stiffness).powf(1.0 / (exponent + 1.0));
        let end = 8.0 * way / SPEED;
        // Time steps of a thousandth of the contact. The error is of fourth order in them, except at the first touch,
        // where the force has a kink.
        let time = format!("[time]\nend = {end:e}\nstep = {:e}\n", end / 4000.0);
        let ran = run(&session.world(), &scene("model = \"half-space\"", contact, &time));
        let last = ran.steps.last().unwrap();
        let [episode] = ran.contacts[..] else { panic!("{} contacts", ran.contacts.len()) };
        let errors = [
            last.impactor.velocity / -SPEED - 1.0,
            last.energy.impactor / energy - 1.0,
            episode.impulse / (2.0 * MASS * SPEED) - 1.0,
            imbalance(&ran),
        ];
        println!("  {contact}: {errors:?}, peak {:.6e} N", episode.peak_force);
        assert!(errors.iter().all(|error| error.abs() < 1e-8), "{contact}: {errors:?}");
        // The peak lies between two steps: (π/1000)²/8 of it is missed.
        let peak = stiffness * way.powf(exponent);
        assert!((episode.peak_force / peak - 1.0).abs() < 2e-6, "{} {peak}", episode.peak_force);
        if exponent == 1.0 {
            let time = std::f64::consts::PI * (MASS / stiffness).sqrt();
            assert!((episode.end / time - 1.0).abs() < 1e-7, "{} {time}", episode.end);
        }
    }
}

/// On a rigid wall the rate of the indentation is the impactor's velocity: every row has the force of the law at its
/// indentation and velocity, to rounding. The laws have kinks, steep parts, and exponent 1.
fn a_damped_force_is_that_of_the_law(session: &Session) {
    let points = [[0.0, 0.0], [0.01, 100.0], [0.02, 3000.0], [0.03, 3100.0], [0.06, 9000.0], [0.4, 90000.0]];
    let power = |exponent: f64| {
        let text = format!("law = \"power\"\nstiffness = 5e4\nexponent = {exponent:?}");
        (text, ForceLaw::Power(Power { stiffness: 5e4, exponent }))
    };
    let table = ForceLaw::Table(Table::new(&points).unwrap());
    for (text, law) in [(format!("law = \"table\"\ntable = {points:?}"), table), power(1.0), power(1.5)] {
        for (damping, step) in [(0.1, ""), (0.1, "step = 1e-4\n"), (1.0, ""), (5.0, "")] {
            let contact = format!("{text}\ndamping = {damping:?}\n");
            let time = format!("[time]\nend = 0.2\n{step}");
            let ran = run(&session.world(), &scene("model = \"half-space\"", &contact, &time));
            let [episode] = ran.contacts[..] else { panic!("{contact}: {} contacts", ran.contacts.len()) };
            let off = ran.steps.iter().map(|row| {
                let factor = (1.0 + damping * row.impactor.velocity).max(0.0);
                (row.contact.force - factor * law.force(row.contact.indentation)).abs() / episode.peak_force
            });
            let off = off.fold(0.0, f64::max);
            println!("  {contact:?} {step:?}: {off:.1e}, {} rows", ran.steps.len());
            assert!(off < 1e-11, "{contact} {step}: {off:e}");
        }
    }
}

/// With damping times speed of 30 the force falls to rounding long before the indentation ends: there is one contact, not
/// one for each sign of the rounding. It ends where the impactor has returned, at nearly the speed 1/d.
fn strong_damping_is_one_contact(session: &Session) {
    for damping in [7.5, 15.0] {
        let contact = format!("damping = {damping:?}\n");
        let steel = scene("model = \"half-space\"", &contact, "[time]\nend = 0.02\n");
        let steel = steel.replace("[contact]", "radius = 0.05\nyoung = 210e9\npoisson = 0.3\n[contact]");
        let ran = run(&session.world(), &steel);
        let [episode] = ran.contacts[..] else { panic!("d = {damping}: {} contacts", ran.contacts.len()) };
        let end = ran.steps.iter().find(|row| row.time >= episode.end).unwrap();
        assert!(end.contact.indentation <= 0.0 && end.time < 0.02, "{end:?}");
    }
}

/// The rebound speed v′ for the damping d: d (v + v′) = ln((1 + d v)/(1 − d v′)) for every law (K. H. Hunt & F. R. E.
/// Crossley, J. Appl. Mech. 42, 1975).
fn rebound(damping: f64) -> f64 {
    let (mut low, mut high) = (0.0, SPEED.min(1.0 / damping));
    for _ in 0..200 {
        let v = 0.5 * (low + high);
        let off = damping * (SPEED + v) - ((1.0 + damping * SPEED) / (1.0 - damping * v)).ln();
        *(if off > 0.0 { &mut low } else { &mut high }) = v;
    }
    low
}

fn restitution_of_hunt_and_crossley(session: &Session) {
    let table = format!("law = \"table\"\ntable = {}\n", points(5e4, 1.3, 0.3, 30));
    let laws = [
        "law = \"power\"\nstiffness = 1e5\nexponent = 1.3\n",
        "law = \"power\"\nstiffness = 2e9\nexponent = 1.5\n",
        &table,
    ];
    for contact in laws {
        for damping in [0.01, 0.1, 1.0] {
            let contact = format!("{contact}damping = {damping}\n");
            // The run contains the whole contact: the softest takes 0.09 s.
            let text = scene("model = \"half-space\"", &contact, "[time]\nend = 0.2\n[accuracy]\ntolerance = 1e-6\n");
            let ran = run(&session.world(), &text);
            let last = ran.steps.last().unwrap();
            let (found, exact) = (-last.impactor.velocity / SPEED, rebound(damping) / SPEED);
            let lost = 0.5 * MASS * SPEED * SPEED * (1.0 - found * found);
            println!("  d = {damping}: restitution {found:.8}, {exact:.8}; balance {:.1e}", imbalance(&ran));
            // The time steps have a tolerance of 1e-6 of the force.
            assert!((found - exact).abs() < 2e-6, "{contact}: {found} and not {exact}");
            assert!((last.energy.dissipated / lost - 1.0).abs() < 1e-5, "{} {lost}", last.energy.dissipated);
            assert!(ran.steps.iter().all(|step| step.contact.force >= 0.0));
            assert!(ran.steps.windows(2).all(|two| two[1].energy.dissipated >= two[0].energy.dissipated - 1e-9 * lost));
        }
    }
}

/// A power law of 3/2 with Hertz's k0 equals Hertz's law: on a solid, where the dent is removed from the patch, and on
/// a plate, where it is added.
fn a_power_of_three_halves_is_hertz(session: &Session) {
    for (body, time) in [
        ("model = \"solid\"\nreduction = 12\ncells = [6, 6, 1]", "end = 1e-3\nstep = 1e-5\n"),
        ("model = \"solid\"\nreduction = 12\ncells = [6, 6, 1]", "end = 1e-3\nstep = 1e-5\nscheme = \"energy\"\n"),
        ("model = \"mindlin\"\nreduction = 12\ncells = [8, 8, 1]", "end = 1e-3\nstep = 1e-5\n"),
    ] {
        let time = format!("[time]\n{time}");
        let hertz = scene(body, "law = \"hertz\"", &time).replace("mass", "radius = 0.05\nstiffness = 1.669e10\nmass");
        let power = scene(body, "law = \"power\"\nstiffness = 1.669e10\nexponent = 1.5", &time);
        let [hertz, power] = [hertz, power].map(|text| run(&session.world(), &text));
        assert_eq!(hertz.steps.len(), power.steps.len());
        let (off, _) = hertz.difference(&power);
        println!("  {body}: {off:.1e}");
        // Rounding of another formula, amplified by a stiff contact.
        assert!(off < 1e-9, "{body}: {off:e}");
        assert!(hertz.peak() > 0.0);
    }
}

/// A pane on springs with a damped contact: Newmark's method, generalised-α, the energy scheme and the central
/// difference method converge to the time history of modal coordinates, with the order of their time steps.
fn every_scheme_converges_to_the_same_history(session: &Session) {
    let support = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e7\n";
    let contact = "law = \"power\"\nstiffness = 1e6\nexponent = 1.2\ndamping = 0.1";
    let at = |body: &str, time: &str| {
        let time = format!("{support}[time]\nend = 0.02\n{time}");
        run(&session.world(), &scene(body, contact, &time))
    };
    // The body has only vibrations that all time steps resolve.
    let body = "model = \"mindlin\"\nreduction = 2\ncells = [4, 4, 1]";
    let modal = at(body, "step = 2e-5");
    for scheme in ["newmark", "generalized-alpha", "energy"] {
        let off = |step: f64| at(body, &format!("scheme = \"{scheme}\"\nstep = {step:e}")).difference(&modal).0;
        let (coarse, fine) = (off(2e-4), off(1e-4));
        println!("  {scheme}: {coarse:.1e}, {fine:.1e}, order {:.2}", (coarse / fine).log2());
        // Second order, reduced by the next term of the error.
        assert!((coarse / fine).log2() > 1.9 && fine < 5e-4, "{scheme}: {coarse:e} {fine:e}");
    }
    // The full Newton's method has the solution of the condensed one.
    let solid = |rest: &str, time: &str| {
        at("model = \"solid\"\nreduction = \"none\"\norder = 1\ncells = [4, 4, 1]", &format!("{time}\n{rest}"))
    };
    let condensed = solid("", "scheme = \"newmark\"\nstep = 1e-4");
    let full = solid("[solver]\nnewton = \"full\"\n", "scheme = \"newmark\"\nstep = 1e-4");
    // Newton's tolerance is 1e-10 of the largest force.
    assert!(condensed.difference(&full).1 < 1e-7, "{:?}", condensed.difference(&full));
}

/// The energy scheme conserves the total plus dissipated energy to rounding; the other schemes report their numerical
/// energy.
fn energy_is_kept_or_dissipated(session: &Session) {
    let table = format!("law = \"table\"\ntable = {}\n", points(5e5, 1.3, 0.2, 20));
    for contact in ["law = \"hertz\"\n", "law = \"power\"\nstiffness = 1e6\nexponent = 1.2\n", &table] {
        for (scheme, step) in
            [("energy", 2e-4), ("newmark", 2e-4), ("generalized-alpha", 2e-4), ("central-difference", 0.0)]
        {
            let step = if step > 0.0 { format!("step = {step:e}\n") } else { String::new() };
            let time = format!("[time]\nend = 0.006\n{step}scheme = \"{scheme}\"\n");
            let body = "model = \"solid\"\nreduction = \"none\"\norder = 1\ncells = [4, 4, 1]";
            let text = scene(body, &format!("{contact}damping = 0.05"), &time);
            let ran = run(&session.world(), &text.replace("mass", "radius = 0.05\nyoung = 1e7\npoisson = 0.3\nmass"));
            let first = ran.steps[0].energy.total;
            let made = |step: &ricochet::impact::step::Step| {
                let energy = step.energy;
                (energy.total + energy.dissipated - energy.numerical) / first - 1.0
            };
            let off = ran.steps.iter().map(made).fold(0.0_f64, |most, made| most.max(made.abs()));
            let lost = ran.steps.last().unwrap().energy.dissipated / first;
            println!("  {scheme}, {}: {off:.1e}, {:.1e} kept, {lost:.3} lost", &contact[..14], imbalance(&ran));
            assert!(off < 1e-10, "{scheme}, {contact}: {off:e}");
            assert!(lost > 1e-3, "{scheme}, {contact}: {lost}");
            if scheme == "energy" {
                assert!(imbalance(&ran) < 1e-10, "{contact}: {:e}", imbalance(&ran));
            }
        }
    }
}

/// Beyond the end of its table a law is undefined: the step that reaches the end is refused, with every time
/// integration.
fn a_run_ends_where_its_table_does(session: &Session) {
    use ricochet::model::{Model, Simulation};
    let contact = format!("law = \"table\"\ntable = {}", points(5e4, 1.0, 0.05, 5));
    for (body, scheme) in [
        ("model = \"half-space\"", "modal"),
        ("model = \"solid\"\nreduction = \"none\"\norder = 1\ncells = [4, 4, 1]", "newmark"),
    ] {
        let text = scene(body, &contact, &format!("[time]\nend = 0.1\nstep = 1e-3\nscheme = \"{scheme}\"\n"));
        let scene = crate::modelled::parse(&text);
        let model = Model::new(&session.world(), &scene).unwrap();
        let mut simulation = Simulation::new(&scene, model).unwrap();
        let error = simulation.run(|_| Ok(std::ops::ControlFlow::Continue(()))).unwrap_err().to_string();
        assert!(error.contains("the end of contact.table") && error.contains("5.0000e-2 m"), "{error}");
    }
}
