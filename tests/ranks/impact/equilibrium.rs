//! Bodies that start in static equilibrium under their loads: reactions, rest until the impact, and the same impact as
//! without loads.

use std::ops::ControlFlow;

use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::model::{Model, Simulation};
use ricochet::scene::Scene;

use crate::modelled::{parse, run};
use crate::start::start;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![
    reactions_are_the_weight,
    a_plate_on_a_pad_sinks_in_evenly,
    a_reduced_body_sinks_as_far,
    all_terms_have_relaxed,
    nothing_moves_before_the_hit,
    loads_do_not_change_the_impact_of_a_linear_body,
    soft_springs_have_an_equilibrium,
    what_nothing_holds_has_no_equilibrium
];

/// A pane under its weight and a pressure on a part of it, with the given lines of the body, the supports, the impactor
/// and the time.
fn scene(body: &str, supports: &str, impactor: &str, time: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n{body}\n{supports}\n\
         [load]\ngravity = [0.0, 0.0, -9.80665]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0.0, 0.0, -500.0]\n\
         within = {{ box = [[0.0, 0.0, -1.0], [0.2, 0.3, 1.0]] }}\n\
         [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n{impactor}\n\
         [time]\ninitial = \"equilibrium\"\n{time}\n"
    )
}

const SOLID: &str = "model = \"solid\"\nreduction = \"none\"\norder = 1\nsize = [0.8, 1.0, 0.02]\ncells = [4, 5, 1]";
const PLATE: &str = "model = \"mindlin\"\nsymmetry = \"none\"\nreduction = 40\nsize = [0.42, 0.5, 0.02]";
/// In its plane the pane is free: no load acts there.
const SIDES: &str = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e7]\n";
/// Pads under strips: next to the pressed corner, the middle of the far strip lifts off.
const STRIPS: &str = "[[support]]\nsurface = \"bottom\"\nwithin = { rim = 0.1 }\nkind = \"pad\"\nstiffness = [0, 0, 1e8]\nnormal = [0, 0, -1]\n";

fn reactions_are_the_weight(session: &Session) {
    let world = session.world();
    let damped = SIDES.to_owned() + "damping = [0, 0, 1e4]\n";
    for supports in [SIDES, &damped, STRIPS] {
        let (_, impact) = start(&world, &scene(SOLID, supports, "", "end = 1e-3\nstep = 1e-5\nscheme = \"newmark\""));
        let mut u = impact.state().u.duplicate().unwrap();
        u.copy_from(&impact.state().u).unwrap();
        let mut body = impact.into_body();
        let mut reaction = u.duplicate().unwrap();
        if let Some(support) = &body.terms.support {
            support.mult(&u, &mut reaction).unwrap();
        }
        if let Some(pads) = &mut body.pads {
            pads.add_force(None, &u, &mut reaction).unwrap();
        }
        // Positive along the impactor's direction, downwards.
        let (held, load) =
            (body.terms.translation.dot(&reaction).unwrap(), body.terms.translation.dot(&body.terms.load).unwrap());
        let weight = 2500.0 * 9.80665 * 0.8 * 1.0 * 0.02 + 500.0 * 0.2 * 0.3;
        if world.is_root() {
            println!("  {load} N, {weight} N, {:.1e}", held / load - 1.0);
        }
        // The edge of the loaded part cuts cells; the reactions must agree to 1e-9.
        assert!((load / weight - 1.0).abs() < 1e-6 && (held / load - 1.0).abs() < 1e-9, "{held} {load} {weight}");
    }
}

/// Without the pressure, a plate on a pad under its whole bottom has u = ρ g h/k everywhere, plus the compression of
/// its own thickness.
fn a_plate_on_a_pad_sinks_in_evenly(session: &Session) {
    let pad = STRIPS.replace("within = { rim = 0.1 }\n", "").replace("1e8", "1e6");
    let text = scene(SOLID, &pad, "gap = 0.5", "end = 1e-3\nstep = 1e-4\nscheme = \"energy\"")
        .replace("value = [0.0, 0.0, -500.0]", "value = [0.0, 0.0, 0.0]");
    let ran = run(&session.world(), &text);
    let (weight, thickness) = (2500.0 * 9.80665 * 0.02, 0.02);
    let sunk = weight / 1e6;
    // It is free to expand in its plane: it shortens like a column, by ρ g h²/2E.
    let exact = sunk + 0.5 * weight * thickness / 70e9;
    for step in &ran.steps {
        let off = step.contact.surface_displacement / exact - 1.0;
        // The shortening is 1e-7 of the displacement, and elements with linear displacements represent only a part of
        // it.
        assert!(off.abs() < 1e-7, "{off:e}");
    }
}

/// Reduced to a basis of any size, in modal coordinates and in time steps, the static deflection and the energy equal
/// the full body's.
fn a_reduced_body_sinks_as_far(session: &Session) {
    let damped = SIDES.to_owned() + "damping = [0, 0, 1e4]\n";
    for supports in [SIDES, &damped] {
        let at = |reduction: &str, time: &str| {
            let body = PLATE.replace("reduction = 40", &format!("reduction = {reduction}"));
            let ran = run(&session.world(), &scene(&body, supports, "gap = 0.5", &format!("end = 2e-3\n{time}")));
            let first = &ran.steps[0];
            [first.contact.surface_displacement, first.energy.elastic + first.energy.support]
        };
        let whole = at("\"none\"", "scheme = \"newmark\"\nstep = 1e-4");
        for (reduction, time) in [
            ("40", "step = 1e-4"),
            ("40", "step = 1e-3"),
            ("12", "step = 1e-4"),
            ("12", "scheme = \"newmark\"\nstep = 1e-4"),
            ("\"auto\"", ""),
        ] {
            let found = at(reduction, time);
            // \"auto\" chooses other cells, for this plate, which bends with a wavelength of its size. Rounding errors of the
            // modes are 1e-16 times the ratio of the squares of their frequencies, some 1e7.
            let tolerance = if reduction == "\"auto\"" { 1e-3 } else { 5e-9 };
            for (found, whole) in found.into_iter().zip(whole) {
                println!("  {reduction}, {time:?}: {found:e}, {:.1e}", found / whole - 1.0);
                assert!((found / whole - 1.0).abs() < tolerance, "{reduction}, {time}: {found:e} and not {whole:e}");
            }
        }
    }
}

/// A laminate sinks as far as the elastic one with G∞, whatever the tolerance, and whatever terms its interlayer has that do not
/// relax within the run: in modal coordinates and in time steps.
fn all_terms_have_relaxed(session: &Session) {
    // Springs so stiff that the laminate's bending is most of its deflection.
    let sides = SIDES.replace("1e7", "1e9");
    let sunk = |[shear, prony]: [&str; 2], body: &str, rest: &str| {
        let prony = if prony.is_empty() { String::new() } else { format!("prony = [{prony}]\n") };
        let text = format!(
            "[body]\nsize = [0.3, 0.2]\n{body}\n\
             [[body.layer]]\nthickness = 0.004\nmaterial = \"glass\"\n\
             [[body.layer]]\nthickness = 0.0004\nmaterial = \"film\"\n\
             [[body.layer]]\nthickness = 0.004\nmaterial = \"glass\"\n\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.film]\nbulk = 2e9\ndensity = 1000.0\nshear = {shear}\n{prony}{sides}\
             [load]\ngravity = [0.0, 0.0, -9.80665]\n\
             [impactor]\nmass = 0.2\nradius = 0.02\nyoung = 210e9\npoisson = 0.3\nspeed = 0.5\n{rest}\n"
        );
        let ran = run(&session.world(), &text);
        let first = &ran.steps[0];
        [first.contact.surface_displacement, first.energy.elastic + first.energy.support]
    };
    let term = |modulus: f64, time: f64| format!("{{ modulus = {modulus:e}, time = {time:e} }}");
    let chains = [
        term(3e7, 2.0),
        [term(3e7, 2.0), term(5e6, 5e3)].join(", "),
        [term(1e7, 1e-4), term(3e7, 2.0), term(5e6, 1e12)].join(", "),
    ];
    for (solver, tolerances) in [
        ("[time]\nend = 5e-4\ninitial = \"equilibrium\"\nstep = 1e-5", &["1e-3", "0.05"][..]),
        ("[time]\nend = 5e-5\ninitial = \"equilibrium\"\nscheme = \"newmark\"\nstep = 1e-5", &["0.05"]),
    ] {
        let with = |film: [&str; 2], tolerance: &str| {
            let body = if solver.contains("newmark") {
                "model = \"solid\"\nreduction = \"none\"\ncells = [4, 4, 3]\norder = 2"
            } else {
                "model = \"layerwise\"\nreduction = 30"
            };
            sunk(film, body, &format!("{solver}\n[accuracy]\ntolerance = {tolerance}\n"))
        };
        let elastic = with(["2e5", ""], tolerances[0]);
        // The test would find a term that is taken for a spring.
        let stiff = with(["5.2e6", ""], tolerances[tolerances.len() - 1]);
        println!("  with a spring of 5 MPa: {:?}", [0, 1].map(|i| elastic[i] / stiff[i]));
        assert!(stiff.into_iter().zip(elastic).all(|(stiff, elastic)| elastic > 1.2 * stiff));
        for (prony, tolerance) in chains.iter().flat_map(|prony| tolerances.iter().map(move |of| (prony, of))) {
            for (found, elastic) in with(["2e5", prony], tolerance).into_iter().zip(elastic) {
                println!("  {prony}, {tolerance}: {found:e}, {:.1e}", found / elastic - 1.0);
                // A basis of 30 vectors differs with the chain: 2e-4 at most.
                assert!((found / elastic - 1.0).abs() < 1e-3, "{prony}, {tolerance}: {found:e} and not {elastic:e}");
            }
        }
    }
}

/// The impact time follows from gap and speed. Until then the surface does not move, with every time integration.
fn nothing_moves_before_the_hit(session: &Session) {
    for (body, supports, time) in [
        (SOLID, SIDES, "scheme = \"newmark\"\nstep = 2e-5"),
        (SOLID, STRIPS, "scheme = \"newmark\"\nstep = 2e-5"),
        (SOLID, STRIPS, "scheme = \"energy\"\nstep = 2e-5"),
        (SOLID, SIDES, "scheme = \"central-difference\""),
        (SOLID, STRIPS, "scheme = \"generalized-alpha\""),
        (PLATE, SIDES, "step = 2e-5"),
        (PLATE, &(SIDES.to_owned() + "damping = [0, 0, 1e4]\n"), "step = 2e-5"),
    ] {
        let time = format!("end = 3e-3\n{time}");
        let ran = run(&session.world(), &scene(body, supports, "gap = 2e-3", &time));
        let rest = ran.steps[0].contact.surface_displacement;
        let before = || ran.steps.iter().take_while(|step| step.contact.force == 0.0);
        let moved = before().map(|step| (step.contact.surface_displacement / rest - 1.0).abs()).fold(0.0, f64::max);
        let hit = ran.contacts[0].start;
        println!("  {time:?}: {rest:.3e} m, moves by {moved:.1e}, hit at {hit:.6e} s");
        assert!(rest > 1e-6 && before().count() > 50 && moved < 1e-9, "{body} {supports} {time}: {moved:e}");
        // The start of a contact is known to within one time step.
        assert!((hit - 2e-3).abs() < 2e-5, "{hit}");
        let first = ran.steps[0].energy;
        assert_eq!((first.external, first.dissipated), (0.0, 0.0));
    }
}

/// Superposition: the motion of a linear body from equilibrium does not depend on the loads.
fn loads_do_not_change_the_impact_of_a_linear_body(session: &Session) {
    for (body, time) in [
        (SOLID, "end = 2e-3\nscheme = \"newmark\"\nstep = 2e-5"),
        (PLATE, "end = 2e-3\nstep = 2e-5"),
        (PLATE, "end = 2e-3\nscheme = \"energy\"\nstep = 2e-5"),
    ] {
        let loaded = scene(body, SIDES, "", time);
        // A billionth of the loads: without loads, the bases would lack the vector of the static deflection.
        let free = loaded.replace("-9.80665", "-9.80665e-9").replace("-500.0", "-500e-9");
        let [loaded, free] = [loaded, free].map(|text| run(&session.world(), &text));
        assert_eq!(loaded.steps.len(), free.steps.len());
        let peak = free.peak();
        let mut off = 0.0_f64;
        for (a, b) in loaded.steps.iter().zip(&free.steps) {
            assert!((a.time - b.time).abs() < 1e-10, "{} {}", a.time, b.time);
            off = off.max((a.impactor.acceleration - b.impactor.acceleration).abs() / peak);
        }
        println!("  {time:?}: {off:.1e}");
        // The deflection that remains under a billionth of the loads is far below the indentation; the rest is
        // rounding.
        assert!(off < 1e-8 && peak > 10.0, "{body}: {off:e}");
        let energy = |step: &ricochet::impact::step::Step| {
            step.energy.total + step.energy.dissipated - step.energy.external - step.energy.numerical
        };
        let first = energy(&loaded.steps[0]);
        assert!(loaded.steps.iter().all(|step| (energy(step) / first - 1.0).abs() < 1e-9));
    }
}

/// On soft springs, a soft plate vibrates with a period of 15 s, longer than the longest step of the search. A stiff
/// plate sinks so far that the rounding of K u is more than 1e-7 of the loads.
fn soft_springs_have_an_equilibrium(session: &Session) {
    for (young, stiffness) in [("7e6", "100"), ("70e9", "5000")] {
        let soft = SIDES.replace("1e7", stiffness);
        let text = scene(SOLID, &soft, "", "end = 1e-3\nstep = 1e-5\nscheme = \"newmark\"").replace("70e9", young);
        let (_, impact) = start(&session.world(), &text);
        let mut u = impact.state().u.duplicate().unwrap();
        u.copy_from(&impact.state().u).unwrap();
        let body = impact.into_body();
        let mut reaction = u.duplicate().unwrap();
        body.terms.support.as_ref().unwrap().mult(&u, &mut reaction).unwrap();
        let (held, load) =
            (body.terms.translation.dot(&reaction).unwrap(), body.terms.translation.dot(&body.terms.load).unwrap());
        println!("  {young} Pa: {load} N, {:.1e}", held / load - 1.0);
        assert!((held / load - 1.0).abs() < 1e-6, "{held} {load}");
    }
}

/// Pads that face the wrong way have no equilibrium, in time steps. Loads along an axis without support are an error of
/// the scene.
fn what_nothing_holds_has_no_equilibrium(session: &Session) {
    let wrong = STRIPS.replace("normal = [0, 0, -1]", "normal = [0, 0, 1]");
    let scene_of = |body: &str, supports: &str| scene(body, supports, "", "end = 1e-3\nstep = 1e-5");
    let text = scene_of(SOLID, &wrong);
    let parsed = parse(&text);
    let run = || {
        let mut simulation = Simulation::new(&parsed, Model::new(&session.world(), &parsed)?)?;
        simulation.run(|_| Ok(ControlFlow::Continue(())))
    };
    let Err(error) = run() else { panic!("{text} has one") };
    let error = error.to_string();
    assert!(error.contains("time.initial") && error.contains("there is no equilibrium"), "{error}");
    for (body, supports) in [(SOLID, ""), (PLATE, ""), (SOLID, &SIDES.replace("[0, 0, 1e7]", "[1e7, 1e7, 0]"))] {
        let Err(error) = Scene::parse("test", &scene_of(body, supports), &[]) else { panic!("{supports} holds it") };
        assert!(error.to_string().contains("loads act along z"), "{error}");
    }
}
