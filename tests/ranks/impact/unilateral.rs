//! Unilateral foundations (pads) with plates and in modal coordinates: equality with springs while pressed, lift-off,
//! energy, equilibrium, and comparison with the solid on the same pads.

use mpi_test::{Test, tests};
use std::time::Instant;

use petsc_wrap::Session;
use ricochet::scene::Model as Theory;

use crate::modelled::{Ran, parse, run, run_scene};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    pads_that_are_never_left_are_springs,
    lifts_off_as_the_stepped_plate,
    energy_is_what_the_steps_make,
    nothing_moves_before_the_hit,
    a_body_that_tips_has_no_equilibrium,
    a_pane_on_strips_as_the_solid
];

/// A pane of glass under a soft impactor, with the given lines of the body, the supports and loads, the impactor and
/// the time.
fn scene(body: &str, rest: &str, impactor: &str, time: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.4, 0.02]\n{body}\n{rest}\n\
         [impactor]\nmass = 5.0\nradius = 0.05\nstiffness = 2e8\nspeed = 1.0\n{impactor}\n[time]\n{time}\n"
    )
}

const ON_STRIPS: &str = "[[support]]\nsurface = \"bottom\"\nwithin = { rim = 0.03 }\nkind = \"pad\"\nstiffness = 1e8\n\
    normal = [0, 0, -1]\n";
/// Impact from below, which throws the pane off its strips.
const UPWARDS: &str = "direction = [0, 0, 1]\npoint = [0, 0, -0.01]";
const GRAVITY: &str = "[load]\ngravity = [0, 0, -9.80665]\n";

/// Four posts under a pressure that the impact does not exceed, so pads and springs agree. Within each post the
/// deflection is so smooth that the quadratures of pads and of springs are equal.
fn pads_that_are_never_left_are_springs(session: &Session) {
    let posts = |kind: &str| -> String {
        let post = |x: f64, y: f64| {
            format!(
                "[[support]]\nsurface = \"bottom\"\nwithin = {{ box = [[{:e}, {:e}, -1], [{:e}, {:e}, 1]] }}\n{kind}",
                x - 0.005,
                y - 0.005,
                x + 0.005,
                y + 0.005
            )
        };
        [(0.2, 0.15), (-0.2, 0.15), (0.2, -0.15), (-0.2, -0.15)].map(|(x, y)| post(x, y)).concat()
            + "[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -3e5]\n"
    };
    let ran = |kind: &str| {
        // All unknowns of these cells.
        let body = "model = \"mindlin\"\nreduction = 2000";
        let time = "end = 3e-3\nstep = 2e-5\ninitial = \"equilibrium\"";
        run(&session.world(), &(scene(body, &posts(kind), "", time) + "[accuracy]\ntolerance = 0.5\ncell_factor = 4\n"))
    };
    let pads = ran("kind = \"pad\"\nstiffness = 1e10\nnormal = [0, 0, -1]\n");
    let springs = ran("kind = \"elastic\"\nstiffness = [0, 0, 1e10]\n");
    let (_, off) = springs.difference(&pads);
    println!("  {off:.1e} of {} steps", pads.steps.len());
    // Rounding: the eigenvalues of the small cells at the posts are 1e8 times those of the slow vibrations. (On posts twice as wide
    // the quadratures differ by 3e-8.)
    assert!(off < 1e-8 && pads.peak() > 0.0, "{off:e}");
}

/// Largest difference of two runs' accelerations at the time steps of the coarser one, over the peak.
fn off(coarse: &Ran, fine: &Ran) -> f64 {
    coarse.difference(fine).1 * coarse.peak() / fine.peak()
}

/// All unknowns of a plate with time steps of the average acceleration method, compared with modal coordinates on the
/// same cells: those that a tolerance of 5% gives first.
fn lifts_off_as_the_stepped_plate(session: &Session) {
    let ran = |body: &str, time: &str| {
        let text = scene(&format!("model = \"mindlin\"\n{body}"), ON_STRIPS, UPWARDS, &format!("end = 3e-3\n{time}"));
        run(&session.world(), &(text + "[accuracy]\ntolerance = 0.05\n"))
    };
    let whole = "reduction = 2000";
    let fine = ran(whole, "step = 5e-7");
    let newmark = |step: f64| ran("reduction = \"none\"", &format!("scheme = \"newmark\"\nstep = {step:e}"));
    let finest = newmark(1e-6);
    let apart = off(&finest, &fine);
    let stepped = [1e-5, 5e-6].map(|step| off(&newmark(step), &finest));
    let modal = [4e-5, 2e-5].map(|step| off(&ran(whole, &format!("step = {step:e}")), &fine));
    let orders = [stepped, modal].map(|[coarse, fine]| (coarse / fine).log2());
    println!("  {apart:.1e} apart, stepped {stepped:?}, modal {modal:?}, orders {orders:.2?}");
    // The average acceleration method is of order two, and so is the integration of λ by quadratics across its kinks.
    // For strips that cut cells, K is integrated exactly, but the excess pull of the pads at quadrature points. This
    // causes a difference of 5e-5 with these cells, and of 2e-5 with the next finer ones.
    assert!(orders.iter().all(|order| *order > 1.9) && apart < 1e-4 && modal[1] < 1e-5);
}

/// Energy balance without dampers and with them, from rest and from equilibrium.
fn energy_is_what_the_steps_make(session: &Session) {
    let dampers = ON_STRIPS.to_owned() + "damping = [0, 0, 1e4]\n";
    for (supports, initial) in [(ON_STRIPS, "rest"), (&dampers, "rest"), (&dampers, "equilibrium")] {
        let made = [4e-5, 1e-5].map(|step| {
            let body = "model = \"mindlin\"\nreduction = 40";
            let time = format!("end = 4e-3\nstep = {step:e}\ninitial = \"{initial}\"");
            let ran = run(&session.world(), &scene(body, &(supports.to_owned() + GRAVITY), UPWARDS, &time));
            let first = ran.steps[0].energy;
            let mut largest = 0.0_f64;
            for step in &ran.steps {
                let now = step.energy;
                let balance = now.total + now.dissipated - now.external - now.numerical - first.total;
                // Rounding.
                assert!(balance.abs() < 1e-11 * first.total, "{balance:e}");
                // The energy that springs would have is subtracted: it is several times the total if the pane is far
                // off its strips.
                assert!(now.support >= -1e-8 * first.total, "{:e}", now.support);
                largest = largest.max(now.numerical.abs() / first.total);
            }
            largest
        });
        println!("  {initial}: {made:?}");
        assert!(made[0] < 1e-3 && made[1] < made[0] / 8.0);
    }
}

/// Pads carry the weight, and the static deflection equals the deflection of the plate with all its unknowns.
fn nothing_moves_before_the_hit(session: &Session) {
    // The pressure is off the middle, so corners are lifted off in equilibrium.
    let pressed = ON_STRIPS.to_owned()
        + GRAVITY
        + "[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -2e4]\nwithin = { box = [[-0.05, -0.05, -1], [0.2, 0.1, 1]] }\n";
    let ran = |body: &str, time: &str| {
        let time = format!("end = 3e-3\ninitial = \"equilibrium\"\n{time}");
        run(&session.world(), &scene(body, &pressed, "gap = 1e-3\npoint = [0.1, 0.0, 0.01]", &time))
    };
    let modal = ran("model = \"mindlin\"", "");
    let stepped = ran("model = \"mindlin\"\nreduction = \"none\"", "scheme = \"newmark\"\nstep = 1e-5");
    let rest = modal.steps[0].contact.surface_displacement;
    let whole = stepped.steps[0].contact.surface_displacement;
    println!("  {rest:e} m, {whole:e} m");
    assert!((rest / whole - 1.0).abs() < 1e-2 && rest > 1e-5);
    for step in modal.steps.iter().filter(|step| step.time < 0.9e-3) {
        let moved = step.contact.surface_displacement / rest - 1.0;
        assert!(moved.abs() < 1e-9, "{moved:e} at {} s", step.time);
        assert!(step.energy.kinetic < 1e-12 * step.energy.total, "{:e}", step.energy.kinetic);
    }
    // The error of the basis is within the tolerance.
    assert!(stepped.difference(&modal).0 < 1e-2);
}

/// A pane on one strip alone tips over and has no equilibrium.
fn a_body_that_tips_has_no_equilibrium(session: &Session) {
    let one = ON_STRIPS.replace("rim = 0.03", "box = [[-1, -1, -1], [-0.1, 1, 1]]") + GRAVITY;
    for body in ["model = \"mindlin\"", "model = \"solid\"\nreduction = \"none\"\ncells = [5, 4, 1]"] {
        let begin = Instant::now();
        let scene = parse(&scene(body, &one, "", "end = 1e-3\ninitial = \"equilibrium\""));
        let model = ricochet::model::Model::new(&session.world(), &scene);
        let refused = model.and_then(|model| ricochet::model::Simulation::new(&scene, model));
        let message = refused.err().expect("it tips").to_string();
        assert!(message.contains("there is no equilibrium"), "{message}");
        println!("  {:.2} s", begin.elapsed().as_secs_f64());
    }
}

/// The result is within 2% of the peak in the first contact, in a tenth of the solid's time or less; springs instead of
/// pads would have a larger error.
fn a_pane_on_strips_as_the_solid(session: &Session) {
    let timed = |text: String| {
        let begin = Instant::now();
        let ran = run_scene(&session.world(), &parse(&text));
        (ran, begin.elapsed().as_secs_f64())
    };
    let (plate, of_plate) = timed(scene("", ON_STRIPS, UPWARDS, "end = 3e-3"));
    assert!(plate.theory == Theory::Mindlin && plate.vectors.is_some());
    let solid = scene(
        "model = \"solid\"\nreduction = \"none\"",
        ON_STRIPS,
        UPWARDS,
        "end = 3e-3\nstep = 2e-5\nscheme = \"newmark\"",
    );
    let (solid, of_solid) = timed(solid);
    let springs = ON_STRIPS
        .replace("\"pad\"", "\"elastic\"")
        .replace("= 1e8", "= [0, 0, 1e8]")
        .replace("normal = [0, 0, -1]\n", "");
    let (springs, _) = timed(scene("model = \"mindlin\"", &springs, UPWARDS, "end = 3e-3"));
    let [off, linear] = [&plate, &springs].map(|ran| solid.difference(ran).0);
    println!(
        "  mindlin {off:.1e} off in {of_plate:.2} s, solid {of_solid:.2} s: a {:.0}th; springs {linear:.1e}",
        of_solid / of_plate
    );
    assert!(off < 0.02 && linear > 0.02);
}
