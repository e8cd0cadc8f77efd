//! Time steps in modal coordinates: order through several contacts, step control, comparison with Newmark's method on
//! the same body.

use mpi_test::{Test, tests};
use std::ops::ControlFlow;

use crate::glass::{plate, sides};
use crate::modelled::{parse, run_scene};
use petsc_wrap::Session;
use ricochet::body::ModalBody;
use ricochet::impact::{ModalImpact, Steps, Trace};
use ricochet::model::{Dynamics, Model};
use ricochet::scene::{Reduction, Scene};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    order_through_several_contacts,
    fewer_steps_than_newmark,
    energy_is_what_the_steps_make,
    no_step_is_unstable,
    every_speed_comes_to_its_end,
    a_ball_that_is_thrown_up_falls_back
];

/// The paper's plate of 0.04 m by Mindlin's theory, with the same basis for all runs.
fn scene(supports: &str, rest: &str) -> Scene {
    parse(&(plate("model = \"mindlin\"\nreduction = 60\nsize = [1.5, 1.5, 0.04]", "end = 8e-3", supports) + rest))
}

fn body(session: &Session, scene: &Scene) -> ModalBody {
    match Model::new(&session.world(), scene).unwrap().dynamics {
        Dynamics::Modal(body) => body,
        Dynamics::Stepped(_) => panic!("the scene is modal"),
    }
}

fn trace(scene: &Scene, body: &ModalBody, step: f64) -> Trace {
    ModalImpact::new(scene, body).trace(Some(Steps { largest: step, defect: None, peak: 5e4 })).unwrap().0
}

/// Largest error of the reported accelerations over the peak, in the first contact and over all time; and the number of
/// steps.
fn error(scene: &Scene, body: &ModalBody, reference: &Trace) -> (f64, f64, usize) {
    let mass = scene.impactor.mass / body.multiplicity;
    let (mut first, mut all, mut steps) = (0.0_f64, 0.0_f64, 0);
    let flow = ModalImpact::new(scene, body).run(|step| {
        let off = (mass * step.impactor.acceleration - reference.at(step.time)).abs() / reference.peak();
        all = all.max(off);
        if step.time <= reference.first_end() {
            (first, steps) = (first.max(off), step.number);
        }
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.unwrap().is_continue());
    (first, all, steps)
}

/// The errors of fixed time steps fall with second order or faster, through three contacts, with dampers and without.
/// Modes with frequencies above 3/Δt are treated as springs, which contributes to the error.
fn order_through_several_contacts(session: &Session) {
    for supports in [String::new(), sides(1e9, 0.0), sides(1e8, 2e5)] {
        let mut scene = scene(&supports, "");
        let body = body(session, &scene);
        // An eighth of the smallest step has a 64th of its error.
        let reference = trace(&scene, &body, 5e-7);
        let errors = [1.6e-5, 8e-6, 4e-6].map(|step| {
            scene.time.step = Some(step);
            let (first, all, _) = error(&scene, &body, &reference);
            [first, all]
        });
        let orders = [0, 1].map(|i| (errors[0][i] / errors[2][i]).log2() / 2.0);
        println!("  {:?}: {errors:?}, observed orders {orders:.2?}", supports.lines().nth(3));
        assert!(orders.iter().all(|order| *order >= 2.0));
    }
}

/// With an error of 1e-3 in the first contact and the scene's own step control, fewer steps are needed than with
/// Newmark's method.
fn fewer_steps_than_newmark(session: &Session) {
    for supports in [String::new(), sides(1e9, 0.0)] {
        let scene = scene(&supports, "");
        let body = body(session, &scene);
        let reference = trace(&scene, &body, 2.5e-7);
        let end = reference.first_end();
        let (error, _, steps) = error(&scene, &body, &reference);
        // Newmark's method on the same basis, with time steps halved until the error is as small.
        let mut stepped = scene.clone();
        stepped.time.modal = false;
        stepped.body.reduction = Reduction::Vectors(60);
        stepped.time.end = 1.05 * end;
        let mut step = 4e-5;
        let (newmark, off) = loop {
            stepped.time.step = Some(step);
            let ran = run_scene(&session.world(), &stepped);
            let mass = scene.impactor.mass / 4.0;
            let off = ran
                .steps
                .iter()
                .filter(|s| s.time <= end)
                .map(|s| (s.impactor.acceleration - reference.at(s.time) / mass).abs());
            let off = off.fold(0.0, f64::max) / (reference.peak() / mass);
            if off <= 1e-3 {
                break ((end / step) as usize, off);
            }
            step /= 1.2;
        };
        println!("  modal: {steps} steps, error {error:.1e}; Newmark: {newmark} steps, error {off:.1e}");
        // Rows of the modal run are denser than its steps, so that straight lines between them are within the tolerance.
        assert!(error <= 1e-3 && newmark >= 3 * steps);
    }
}

/// The numerical energy of the ledger falls with third order or faster in the time step. Without dampers it is the only
/// deviation of the energy balance.
fn energy_is_what_the_steps_make(session: &Session) {
    let made = [1.6e-5, 4e-6].map(|step| {
        let mut scene = scene(&sides(1e8, 2e5), "");
        scene.time.step = Some(step);
        let ran = run_scene(&session.world(), &scene);
        let (first, last) = (ran.steps[0].energy, ran.steps.last().unwrap().energy);
        let balance = last.total + last.dissipated - last.external - last.numerical - first.total;
        assert!(balance.abs() < 1e-12 * first.total, "{balance:e}");
        // Dampers dissipate energy in every step, up to the quadrature error of the contact's work.
        let mut dissipated = 0.0;
        for step in &ran.steps {
            assert!(step.energy.dissipated >= dissipated - 1e-4 * first.total);
            dissipated = step.energy.dissipated;
        }
        assert!(dissipated > 0.1 * first.total);
        last.numerical.abs() / first.total
    });
    println!("  {made:?}");
    assert!(made[0] < 1e-3 && made[1] < made[0] / 16.0);
}

/// No time step is unstable, where a patch's negative compliance makes other such schemes unstable: hundreds of modes,
/// large and small time steps.
fn no_step_is_unstable(session: &Session) {
    for (vectors, stiffness) in [(80, 1e10), (24, 1e9), (36, 1e9)] {
        stays_stable(session, vectors, stiffness);
    }
}

fn stays_stable(session: &Session, vectors: usize, stiffness: f64) {
    let body = format!("model = \"solid\"\nreduction = {vectors}\nsize = [0.5, 0.5, 0.02]\ncells = [12, 12, 2]");
    let mut scene = parse(&(plate(&body, "end = 8e-3", &sides(stiffness, 0.0)) + "[contact]\npatch_radius = 0.01\n"));
    let body = self::body(session, &scene);
    for step in [2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7] {
        scene.time.step = Some(step);
        let mut made = 0.0_f64;
        let mut initial = 0.0;
        let flow = ModalImpact::new(&scene, &body).run(|step| {
            initial = if step.number == 0 { step.energy.total } else { initial };
            made = made.max(step.energy.numerical.abs());
            Ok(ControlFlow::Continue(()))
        });
        assert!(flow.unwrap().is_continue());
        println!("  {vectors} vectors, Δt = {step:e}: {:.1e} of the energy made", made / initial);
        assert!(made < 2e-3 * initial);
    }
}

/// Runs with hundreds of speeds reach their end. Among them are contacts that graze, that end before they have begun,
/// and that begin while another one ends.
fn every_speed_comes_to_its_end(session: &Session) {
    let mut scene = scene(&sides(1e8, 0.0), "");
    scene.time.end = 0.02;
    let body = body(session, &scene);
    for n in 0..300 {
        scene.impactor.speed = 0.1 + 4.9 * f64::from(n) / 299.0;
        let (mut initial, mut made, mut last) = (0.0, 0.0_f64, 0.0);
        let flow = ModalImpact::new(&scene, &body).run(|step| {
            initial = if step.number == 0 { step.energy.total } else { initial };
            made = made.max(step.energy.numerical.abs());
            assert!(step.time > last || step.number == 0);
            last = step.time;
            Ok(ControlFlow::Continue(()))
        });
        assert!(flow.unwrap().is_continue());
        // The tolerance of the run is 1e-2.
        assert!((last - scene.time.end).abs() < 1e-12 && made < 1e-3 * initial, "{} {made}", scene.impactor.speed);
    }
}

/// A ball that a light plate throws up falls back at the time of a free fall, and its energy matches its height.
fn a_ball_that_is_thrown_up_falls_back(session: &Session) {
    const GRAVITY: f64 = 9.80665;
    let text = plate("model = \"mindlin\"\nreduction = 20\nsize = [1.5, 1.5, 0.04]", "end = 0.3", &sides(1e9, 1e5));
    let (gap, height) = (0.02, 0.1);
    let dropped = text.replace("speed = 1.0", &format!("drop_height = {height}\ngap = {gap}\ngravity = true"));
    let scene = parse(&dropped);
    assert_eq!(scene.impactor.speed, (2.0 * GRAVITY * height).sqrt());
    let body = body(session, &scene);
    let (mut steps, mut flights) = (Vec::new(), Vec::new());
    let _ = ModalImpact::new(&scene, &body)
        .run(|step| {
            steps.push(*step);
            Ok(ControlFlow::Continue(()))
        })
        .unwrap();
    // The first contact: gap = v t + g t²/2.
    let speed = scene.impactor.speed;
    let touch = (-speed + (speed * speed + 2.0 * GRAVITY * gap).sqrt()) / GRAVITY;
    let first = steps.iter().position(|step| step.contact.force > 0.0).expect("a contact");
    assert!((steps[first - 1].time - touch).abs() < 1e-12, "{} {touch}", steps[first - 1].time);
    // Between contacts the impactor moves on a parabola in time.
    for pair in steps.windows(2).filter(|pair| pair.iter().all(|step| step.contact.force == 0.0)) {
        let [from, to] = [&pair[0], &pair[1]];
        let t = to.time - from.time;
        let (x, v) = (from.impactor.position, from.impactor.velocity);
        assert!((to.impactor.position - (x + v * t + 0.5 * GRAVITY * t * t)).abs() < 1e-13);
        assert!((to.impactor.velocity - (v + GRAVITY * t)).abs() < 1e-13);
        flights.push(v);
    }
    assert!(flights.iter().any(|v| *v < -0.1) && flights.last().is_some_and(|v| *v > 0.1), "up and down");
    let closed = |step: &ricochet::impact::step::Step| {
        let energy = &step.energy;
        energy.total + energy.dissipated - energy.external - energy.numerical
    };
    let (start, largest) = (closed(&steps[0]), steps[0].energy.total);
    let off = steps.iter().map(|step| (closed(step) - start).abs()).fold(0.0, f64::max);
    // Rounding of some thousand time steps.
    assert!(off < 1e-11 * largest, "{off:e} of {largest:e}");
    // The work of the weight equals the loss of height.
    let weight = scene.impactor.mass * GRAVITY;
    assert!(steps.iter().all(|step| (step.energy.external - weight * step.impactor.position).abs() < 1e-9));
}
