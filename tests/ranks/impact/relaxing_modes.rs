//! A viscoelastic laminate reduced to a basis: modal coordinates against time steps, energies, bases for other
//! temperatures and moduli.

use std::ops::ControlFlow;

use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::body::{Body, DirectSum, LinearBody, ModalBody, Operator, Projection};
use ricochet::description::Description;
use ricochet::impact::step::Step;
use ricochet::impact::{ModalImpact, SteppedImpact, Steps, TIME_STEP_SHARE, Trace, joined};
use ricochet::material::Maxwell;
use ricochet::model::watch::Unwatched;
use ricochet::model::{Built, ErrorFactors, ModelContext, build, rate, reduce};
use ricochet::scene::Scene;

use crate::modelled::parse;

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    steps_tend_to_modal_coordinates,
    order_is_that_of_elastic_bodies,
    energy_is_stored_or_lost,
    another_chain_is_the_body_of_that_chain,
    one_basis_serves_all_temperatures,
    few_directions_are_enough,
    estimates_hold_of_strong_relaxation,
    estimates_hold_of_the_smallest
];
/// Takes a minute.
pub const LONG: &[Test<Session>] = tests![estimates_hold];

/// A small laminate on few cells, with the interlayer's thickness (m), its temperature (°C), and further text.
fn laminate(layer: f64, temperature: f64, rest: &str) -> String {
    format!(
        "[body]\nsize = [0.15, 0.15]\nmodel = \"solid\"\ntemperature = {temperature:e}\n\
         [[body.layer]]\nthickness = 0.006\nmaterial = \"glass\"\n\
         [[body.layer]]\nthickness = {layer:e}\nmaterial = \"interlayer\"\n\
         [[body.layer]]\nthickness = 0.006\nmaterial = \"glass\"\n\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.interlayer]\nbulk = 2e9\ndensity = 1100.0\nshear = 1e6\n\
         wlf = {{ c1 = 8.6, c2 = 200.0, reference = 20.0 }}\n\
         prony = [{{ modulus = 6e7, time = 5e-6 }}, {{ modulus = 5e7, time = 5e-5 }}, {{ modulus = 3e7, time = 5e-4 }},\n\
         {{ modulus = 1e7, time = 5e-3 }}, {{ modulus = 3e6, time = 5e-2 }}]\n\
         [impactor]\nmass = 0.5\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [output]\nstress = false\n[accuracy]\ntolerance = 0.3\n[time]\nend = 4e-4\n{rest}"
    )
}

/// The body of a scene with all its unknowns.
fn whole(session: &Session, scene: &Scene) -> Box<Body> {
    let comm = session.world();
    match build(&ModelContext::new(&comm, &Unwatched(&comm)), scene, scene.body.model, 1.6).unwrap() {
        Built::Operators(built) => built.body.in_petsc(&session.alone()).unwrap(),
        Built::Given(_) => panic!("a solid has operators"),
    }
}

/// The body projected onto a basis with this number of vectors.
fn projected(body: &Body, scene: &Scene, vectors: usize) -> Projection {
    let mut krylov = DirectSum::new(body, rate(scene)).unwrap();
    krylov.grow(body, vectors).unwrap();
    krylov.projection(body).unwrap()
}

/// Error of the smaller of two bases over their difference, as the program assumes.
fn factor(body: &Body, scene: &Scene) -> f64 {
    ErrorFactors::of(body, rate(scene).into()).smaller
}

fn on_basis(session: &Session, scene: &Scene, vectors: usize) -> Projection {
    projected(&whole(session, scene), scene, vectors)
}

/// Time history of the force in modal coordinates with fixed time steps, s.
fn modal(scene: &Scene, projection: &Projection, step: f64) -> Trace {
    // No part of the plate has a higher contact stiffness than this peak gives; for a stiffer contact, fast modes would
    // be treated as springs at any time step.
    let steps = Steps { largest: step, defect: None, peak: 1e3 };
    ModalImpact::new(scene, &ModalBody::of(projection)).trace(Some(steps)).unwrap().0
}

/// Times and forces (N on the modelled part) by Newmark's method.
fn stepped(scene: &Scene, body: Body, step: f64) -> Vec<(f64, f64)> {
    let mut scene = scene.clone();
    (scene.time.modal, scene.time.step) = (false, Some(step));
    let multiplicity = body.terms.multiplicity;
    let mut forces = Vec::new();
    let flow = SteppedImpact::new(&scene, body).unwrap().run(|step: &Step| {
        forces.push((step.time, step.contact.force / multiplicity));
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.unwrap().is_continue());
    forces
}

/// Largest difference from a time history, over its peak.
fn off(forces: &[(f64, f64)], reference: &Trace) -> f64 {
    forces.iter().map(|(time, force)| (force - reference.at(*time)).abs()).fold(0.0, f64::max) / reference.peak()
}

/// Newmark's time steps of the reduced body with its Maxwell terms converge to the modal solution with second order.
fn steps_tend_to_modal_coordinates(session: &Session) {
    let mut scene = parse(&laminate(0.00152, 20.0, ""));
    scene.time.end = 1e-4;
    let projection = on_basis(session, &scene, 8);
    assert!(projection.terms.relaxations[0].chain.terms.len() >= 2, "terms to follow");
    // In time steps all directions of D relax; in modal coordinates only those that the tolerance requires.
    let reference = modal(&Scene { tolerance: 1e-9, ..scene.clone() }, &projection, 5e-8);
    let alone = session.alone();
    let errors = [1e-7, 5e-8, 2.5e-8]
        .map(|step| off(&stepped(&scene, Body::of(&alone, &projection.system()).unwrap(), step), &reference));
    println!("  {errors:?}");
    let order = (errors[0] / errors[2]).log2() / 2.0;
    // These time steps resolve the fastest vibration of the basis, which makes the force oscillate a little.
    assert!((1.7..2.3).contains(&order) && errors[2] < 1e-3, "{order} {errors:?}");
}

/// Time steps in modal coordinates have the same order as without Maxwell terms, and errors no larger. The elastic body
/// for comparison has the moduli at the contact's time scale. The time steps resolve all vibrations of this basis; if
/// they do not, for example at 4e-6 s, both have lower orders.
fn order_is_that_of_elastic_bodies(session: &Session) {
    let relaxing = parse(&laminate(0.00152, 20.0, ""));
    let mut elastic = relaxing.clone();
    elastic.body.composition = relaxing.body.composition.with_secant_moduli(1e-4);
    let [without, with] = [elastic, relaxing].map(|scene| {
        let projection = on_basis(session, &scene, 8);
        let reference = modal(&scene, &projection, 1.25e-7);
        let times = (1..50).map(|i| 8e-6 * f64::from(i));
        let forces = |trace: &Trace| times.clone().map(|time| (time, trace.at(time))).collect::<Vec<_>>();
        let errors = [4e-6, 2e-6, 1e-6, 5e-7].map(|step| off(&forces(&modal(&scene, &projection, step)), &reference));
        println!("  {errors:?}, order {}", (errors[1] / errors[3]).log2() / 2.0);
        errors
    });
    for errors in [&without, &with] {
        // Order four, like Simpson's rule. The start of the contact, where F is proportional to t^{3/2}, does not
        // reduce it at these times.
        let order = (errors[1] / errors[3]).log2() / 2.0;
        assert!((3.6..4.4).contains(&order), "{order} {errors:?}");
    }
    // In steps that resolve the vibrations, dashpots do not increase the error. The longest step does not resolve them.
    let largest = [2.0, 1.2, 1.2, 1.2];
    let errors = || with.iter().zip(&without).zip(largest);
    assert!(errors().all(|((with, without), largest)| *with < largest * without), "{with:?} {without:?}");
}

/// The energy balance of every step is closed, dashpots only dissipate, and the numerical energy falls with third order
/// or faster in the time step.
fn energy_is_stored_or_lost(session: &Session) {
    let mut scene = parse(&laminate(0.00152, 20.0, ""));
    let body = ModalBody::of(&on_basis(session, &scene, 16));
    let made = [8e-6, 2e-6].map(|step| {
        scene.time.step = Some(step);
        let mut steps: Vec<Step> = Vec::new();
        let flow = ModalImpact::new(&scene, &body).run(|step| {
            steps.push(*step);
            Ok(ControlFlow::Continue(()))
        });
        assert!(flow.unwrap().is_continue());
        let (initial, last) = (steps[0].energy.total, steps[steps.len() - 1].energy);
        for step in &steps {
            let energy = step.energy;
            let left = energy.total + energy.dissipated - energy.external - energy.numerical - initial;
            assert!(left.abs() < 1e-9 * initial, "{left:e} at {}", step.time);
        }
        // Except for the quadrature error of the contact's work.
        assert!(steps.windows(2).all(|pair| pair[1].energy.dissipated >= pair[0].energy.dissipated - 1e-6 * initial));
        assert!(last.dissipated > 1e-3 * initial, "{:e}", last.dissipated / initial);
        (last.numerical.abs() / initial, last.dissipated / initial)
    });
    println!("  {made:?}");
    assert!(made[1].0 < made[0].0 / 16.0 && made[0].0 < 1e-3, "{made:?}");
    // The dissipated energy is a property of the body and does not depend on the time step.
    assert!((made[1].1 / made[0].1 - 1.0).abs() < 0.02, "{made:?}");
}

/// The Prony series that a scene's run follows.
fn chains(scene: &Scene) -> Vec<Maxwell> {
    Description::new(scene).relaxations().into_iter().map(|(chain, _)| chain.clone()).collect()
}

/// K_e and D are projected separately, so the Prony series can be changed on the same basis. The result equals the body
/// that was projected with that series.
fn another_chain_is_the_body_of_that_chain(session: &Session) {
    let [cold, warm] = [5.0, 45.0].map(|temperature| parse(&laminate(0.00152, temperature, "")));
    let (of_cold, of_warm) = (whole(session, &cold), whole(session, &warm));
    let mut krylov = DirectSum::new(&*of_cold, rate(&cold)).unwrap();
    krylov.grow(&*of_cold, 12).unwrap();
    let changed = krylov.projection(&*of_cold).unwrap().with_chains(&chains(&warm));
    let basis = krylov.basis();
    let exact = basis.products(&of_warm.apply(Operator::Elastic, basis).unwrap());
    assert_ne!(changed.terms.relaxations[0].chain, chains(&cold)[0]);
    assert_eq!(changed.terms.relaxations[0].chain, of_warm.terms.relaxations[0].chain);
    // The first vector of a free body is its translation, for which K is set to zero; the rest is rounding.
    assert!(
        (&changed.terms.elastic - &exact).amax() < 1e-10 * exact.amax(),
        "{:e}",
        (&changed.terms.elastic - &exact).amax() / exact.amax()
    );
}

/// A basis made at 20 °C is used at 0 to 50 °C. Its error is at most twice the error of a basis made at the
/// temperature, estimated from the difference to a basis with twice as many vectors.
fn one_basis_serves_all_temperatures(session: &Session) {
    let at = |temperature: f64| parse(&laminate(0.00152, temperature, ""));
    let body = whole(session, &at(20.0));
    let (shared, factor) = (projected(&body, &at(20.0), 40), factor(&body, &at(20.0)));
    for temperature in [0.0, 10.0, 35.0, 50.0] {
        let scene = at(temperature);
        let own = on_basis(session, &scene, 64);
        let reference = modal(&scene, &own, 1e-6);
        let here = shared.with_chains(&chains(&scene));
        let [small, large] = [20, 40].map(|vectors| modal(&scene, &here.leading(vectors), 1e-6));
        let estimate = factor * small.difference(&large).history;
        let error = small.difference(&reference).history;
        println!("  {temperature} °C: error {error:.1e}, estimate {estimate:.1e}");
        assert!(error <= estimate && estimate <= 10.0 * error, "{temperature}: {error:e} {estimate:e}");
    }
}

/// The directions of D that a tolerance leaves out change the force by less than the share of the time steps, on a basis
/// of many vectors that a short contact excites.
fn few_directions_are_enough(session: &Session) {
    for temperature in [10.0, 20.0, 35.0] {
        let text = laminate(0.00152, temperature, "");
        let scene = parse(&text.replace("mass = 0.5", "mass = 0.05").replace("end = 4e-4", "end = 3e-4"));
        let projection = on_basis(session, &scene, 80);
        let [few, all] = [1e-2, 1e-9].map(|tolerance| modal(&Scene { tolerance, ..scene.clone() }, &projection, 5e-7));
        let change = few.difference(&all).history;
        println!("  {temperature} °C: {change:.1e}");
        // A change of zero would mean that all directions relax.
        assert!(change > 1e-5 && change < TIME_STEP_SHARE * 1e-2, "{temperature}: {change:e}");
    }
}

/// Thickness of the interlayer, m, and temperature, °C.
const LAMINATES: [(f64, f64); 8] = [
    (0.00038, 0.0),
    (0.00038, 50.0),
    (0.00076, 10.0),
    (0.00076, 35.0),
    (0.00152, 0.0),
    (0.00152, 20.0),
    (0.00152, 50.0),
    (0.00304, 20.0),
];

fn estimates_hold_of_the_smallest(session: &Session) {
    estimate_holds(session, &LAMINATES[..1]);
}

fn estimates_hold(session: &Session) {
    estimate_holds(session, &LAMINATES[1..]);
}

/// The error of a basis, compared with all unknowns in the same time steps, is below its estimate, and the estimate is
/// at most ten times the error.
fn estimate_holds(session: &Session, laminates: &[(f64, f64)]) {
    for &(layer, temperature) in laminates {
        let scene = parse(&laminate(layer, temperature, ""));
        let body = whole(session, &scene);
        let (projection, factor) = (projected(&body, &scene, 24), factor(&body, &scene));
        let alone = session.alone();
        let [small, large] = [16, 24]
            .map(|vectors| stepped(&scene, Body::of(&alone, &projection.leading(vectors).system()).unwrap(), 2e-6));
        let full = stepped(&scene, *body, 2e-6);
        let peak = full.iter().fold(0.0_f64, |peak, (_, force)| peak.max(*force));
        let difference =
            |other: &[(f64, f64)]| small.iter().zip(other).map(|(a, b)| (a.1 - b.1).abs()).fold(0.0, f64::max) / peak;
        let (error, estimate) = (difference(&full), factor * difference(&large));
        println!("  {layer} m at {temperature} °C: error {error:.1e}, estimate {estimate:.1e}");
        assert!(error <= estimate && estimate <= 10.0 * error, "{error:e} {estimate:e}");
    }
}

/// Layerwise panes: temperature (°C), long-term modulus (Pa) and Prony terms of the interlayer. One interlayer relaxes
/// from 400 to 0.3 MPa; the others have a series over twelve decades, at three temperatures.
const STRONG: [(f64, f64, &str); 4] =
    [(28.0, 3e5, "{ modulus = 400e6, time = 1e-3 }"), (25.0, 1e5, WIDE), (30.0, 1e5, WIDE), (40.0, 1e5, WIDE)];

/// A Prony series similar to PVB's.
const WIDE: &str = "{ modulus = 3.7e7, time = 5e-9 }, { modulus = 1.4e8, time = 7e-8 }, { modulus = 3.4e7, time = 1e-5 },
    { modulus = 1.3e8, time = 2.8e-3 }, { modulus = 4.2e7, time = 0.16 }, { modulus = 1.4e7, time = 2.3 }, { modulus = 3.6e6, time = 35.0 }";

/// For bodies whose modulus relaxes by a factor of 4 to 1300 within the run, with a basis of the size that it requires:
/// the error of the basis is below its estimate. The estimate is at most four times the larger of the errors of the two
/// bases that were compared: the larger basis may be accurate by accident. The force in the time steps of the run, with
/// the directions of D that it chooses, has a further error of at most the share of the time steps. The reference is
/// Newmark's method for all unknowns in steps of 1.25e-7 s; twice the step changes the force by at most 5e-5 of its
/// peak. In modal coordinates, the steps are 2.5e-7 s, and all directions of D relax.
fn estimates_hold_of_strong_relaxation(session: &Session) {
    for (temperature, relaxed, series) in STRONG {
        let scene = parse(&format!(
            "[body]\nsize = [0.25, 0.25]\nmodel = \"layerwise\"\ntemperature = {temperature:e}\n\
             [[body.layer]]\nthickness = 0.010\nmaterial = \"glass\"\n\
             [[body.layer]]\nthickness = 0.00076\nmaterial = \"interlayer\"\n\
             [[body.layer]]\nthickness = 0.010\nmaterial = \"glass\"\n\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.interlayer]\nbulk = 2e9\ndensity = 1100.0\nshear = {relaxed:e}\nprony = [{series}]\n\
             wlf = {{ c1 = 20.0, c2 = 90.0, reference = 20.0 }}\n\
             [impactor]\nmass = 5.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 2.0\n\
             [output]\nstress = false\n[accuracy]\ntolerance = 3e-3\n[time]\nend = 3e-4\n"
        ));
        let body = whole(session, &scene);
        let comm = session.world();
        let reduced = reduce(&ModelContext::new(&comm, &Unwatched(&comm)), &*body, &scene).unwrap();
        let full = stepped(&scene, *body, 1.25e-7);
        let (allowed, exact) = (TIME_STEP_SHARE * scene.tolerance, Scene { tolerance: 1e-6, ..scene });
        let [error, of_other] = [&reduced.projection, &reduced.judge].map(|on| off(&full, &modal(&exact, on, 2.5e-7)));
        let (counts, estimate) = (reduced.counts(), reduced.error.history);
        println!("  {temperature} °C: {counts:?} vectors, errors {error:.1e} {of_other:.1e}, estimate {estimate:.1e}");
        assert!(error <= estimate, "{temperature}: {error:e} {estimate:e}");
        assert!(estimate <= 4.0 * error.max(of_other), "{temperature}: {error:e} {of_other:e} {estimate:e}");
        let (of_run, allowed) = (off(&full, &reduced.force.0), joined(estimate, allowed));
        assert!(of_run <= allowed, "{temperature}: {of_run:e} {allowed:e}");
    }
}
