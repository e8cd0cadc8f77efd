//! Hits whose speed, duration or energy is not that of the impactor alone at t = 0: light free bodies, gaps with gravity, and
//! weights that are laid down.

use mpi_test::{Test, tests};
use petsc_wrap::Session;

use crate::modelled::{Ran, run};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    heavy_impactors_meet_light_bodies,
    a_fall_through_a_gap_is_a_hit_at_its_end,
    a_weight_that_is_laid_down_bounces,
    impulses_are_integrals_of_the_force
];

/// A body of glass with keys of the body, supports, impactor, time and the rest.
fn scene([body, supports, impactor, time, rest]: [&str; 5]) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n{body}\n{supports}\n[output]\nstress = false\n\
         [impactor]\nyoung = 210e9\npoisson = 0.3\n{impactor}\n[time]\n{time}\n{rest}"
    )
}

fn peak_force(ran: &Ran) -> f64 {
    ran.steps.iter().map(|step| step.contact.force).fold(0.0, f64::max)
}

/// Automatic steps against fixed small ones, within the tolerance of 1e-2: a free pane, a pane on soft springs, and a block that is
/// hit off its centre.
fn heavy_impactors_meet_light_bodies(session: &Session) {
    let soft = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e5\n";
    let pane = ("size = [0.1, 0.1, 0.005]", "radius = 0.05\nspeed = 0.2", 1e-3);
    let strip = ("size = [0.3, 0.12, 0.012]", "radius = 0.03\nspeed = 0.4\npoint = [0.05, 0.0]", 2e-3);
    for ((body, impactor, end), supports, mass) in [
        (pane, "", 1250.0),
        (pane, soft, 1e5),
        (strip, "", 1e6),
        (("size = [0.1, 0.08, 0.04]", "radius = 0.05\nspeed = 0.5\npoint = [0.02, 0.01]", 3e-4), "", 1e5),
    ] {
        let with = |step: &str| {
            let (impactor, time) = (format!("mass = {mass}\n{impactor}"), format!("end = {end}\n{step}"));
            run(&session.world(), &scene([body, supports, &impactor, &time, ""]))
        };
        let [own, fixed] = ["", "step = 1e-6"].map(with);
        let peak = fixed.peak();
        let off = own.steps.iter().map(|step| (fixed.at(step.time) - step.impactor.acceleration).abs() / peak);
        let off = off.fold(0.0, f64::max);
        println!(
            "  {body}: {:.2} N, fixed {:.2} N, {off:.1e}, estimated {:.1e}",
            peak_force(&own),
            peak_force(&fixed),
            own.error
        );
        assert!(off < 1e-2, "{body}: {off:e}");
    }
}

/// A fall through a gap has the theory, the peak and the stable steps of a hit at the speed at its end. Weights act in both.
fn a_fall_through_a_gap_is_a_hit_at_its_end(session: &Session) {
    let sides = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n";
    let (body, gate) = ("size = [0.5, 0.5, 0.02]", "[solver]\nenergy_gate = 0.1\n");
    let gap = 0.25;
    let speed = (2.0 * 9.80665_f64 * gap).sqrt();
    let ball = "mass = 0.01\nradius = 0.01\ngravity = true";
    let direct = format!("{ball}\nspeed = {speed:e}");
    let direct = run(&session.world(), &scene([body, sides, &direct, "end = 2e-4", gate]));
    for start in ["speed = 0", "speed = 1e-6"] {
        let falling = format!("{ball}\n{start}\ngap = {gap}");
        let fallen = run(&session.world(), &scene([body, sides, &falling, "end = 0.226", gate]));
        assert_eq!(fallen.theory, direct.theory);
        // The same steps from the touch on; 1e-6 m/s change the speed by less.
        let off = peak_force(&fallen) / peak_force(&direct) - 1.0;
        println!("  {start}: {:.2} N, {off:.1e}, {} rows", peak_force(&fallen), fallen.steps.len());
        assert!(off.abs() < 1e-4, "{start}: {off:e}");
    }
}

/// ∫ F dα = m g α: a weight that is laid down bounces up to 2.5 times its weight by Hertz's law, and the run goes on although the
/// initial energy is nothing. On a body that does not bend, and for a force law of another exponent.
fn a_weight_that_is_laid_down_bounces(session: &Session) {
    let body = "model = \"half-space\"\nsize = [0.5, 0.5, 0.02]";
    for (mass, law, factor) in
        [(0.01, "", 2.5), (1e3, "", 2.5), (0.2, "[contact]\nlaw = \"power\"\nstiffness = 1e8\nexponent = 1.2\n", 2.2)]
    {
        let impactor = format!("mass = {mass}\nradius = 0.01\nspeed = 1e-9\ngravity = true");
        let ran = run(&session.world(), &scene([body, "", &impactor, "end = 0.05", law]));
        let found = peak_force(&ran) / (factor * mass * 9.80665);
        println!("  {mass} kg: {found} of the closed form in {} rows", ran.steps.len());
        // Rows are up to a twentieth of a period apart, which a cosine's peak does not show by 1.2%.
        assert!((found - 1.0).abs() < 1.3e-2, "{mass}: {found}");
    }
}

/// The impulse of a contact equals the integral of its force also when the weight acts, in modal coordinates and in time steps.
fn impulses_are_integrals_of_the_force(session: &Session) {
    let sides = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e8\n";
    let plate = "model = \"mindlin\"\nsize = [0.6, 0.6, 0.01]\nreduction = 30\ncells = [6, 6, 1]";
    for (body, time) in [
        (plate, "end = 0.03\nstep = 2e-6".to_owned()),
        (&plate.replace("30", "\"none\""), "end = 0.03\nscheme = \"newmark\"\nstep = 2e-6".to_owned()),
    ] {
        let impactor = "mass = 20.0\nradius = 0.05\nspeed = 0.3\ngravity = true";
        let ran = run(&session.world(), &scene([body, sides, impactor, &time, ""]));
        let force = |n: usize| ran.steps[n].contact.force;
        let steps = 1..ran.steps.len();
        let integral = steps.map(|n| 0.5 * (force(n) + force(n - 1)) * (ran.steps[n].time - ran.steps[n - 1].time));
        let (integral, impulse) =
            (integral.sum::<f64>(), ran.contacts.iter().map(|contact| contact.impulse).sum::<f64>());
        let last = &ran.steps[ran.steps.len() - 1];
        let of_velocity = 20.0 * (0.3 - last.impactor.velocity);
        println!("  {impulse} N s, ∫F dt = {integral}, m Δv = {of_velocity}");
        // Trapezoidal rule in steps of 2 µs.
        assert!((impulse / integral - 1.0).abs() < 1e-4, "{impulse} {integral}");
        assert!((of_velocity / integral - 1.0).abs() > 1e-2, "the weight has no part in it");
    }
}
