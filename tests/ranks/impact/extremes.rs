//! Very small and very large inputs give a right result or a clear refusal, and never NaN.

use mpi_test::{Test, tests};
use std::ops::ControlFlow;

use petsc_wrap::Session;
use ricochet::body::Body;
use ricochet::contact::hertz;
use ricochet::error::{Error, Result};
use ricochet::impact::SteppedImpact;
use ricochet::impact::step::Step;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![answers_or_refusals, a_tiny_mass];

const SCENE: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.1]\ncells = [4, 4, 1]\ngrading = 3\n\
    [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 2e-3\n";

fn series(session: &Session, overrides: &[&str]) -> Result<(Scene, Vec<Step>)> {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let (scene, _) = Scene::parse("extreme", SCENE, &overrides)?;
    let mesh = Mesh::new(&session.world(), &scene.body)?;
    let body = Body::solid(&scene, &mesh)?;
    let mut impact = SteppedImpact::new(&scene, body)?;
    let mut steps = Vec::new();
    let ended = impact.run(|step| {
        steps.push(*step);
        Ok(ControlFlow::Continue(()))
    });
    // Steps reported before a failure must be finite too.
    for step in &steps {
        let Step { impactor, contact, energy, .. } = step;
        let all = [
            impactor.position,
            impactor.velocity,
            impactor.acceleration,
            contact.force,
            energy.total,
            energy.numerical,
        ];
        assert!(all.iter().all(|value| value.is_finite()), "{overrides:?}: {step:?}");
    }
    ended.map(|_| (scene, steps))
}

fn answers_or_refusals(session: &Session) {
    let inputs = [
        "impactor.gap=-1e-3",
        "impactor.gap=1e9",
        "impactor.speed=0",
        "impactor.speed=1e-9",
        "impactor.speed=1e5",
        "impactor.mass=1e-6",
        "impactor.mass=1e9",
        "impactor.stiffness=1e-3",
        "impactor.stiffness=1e20",
        "impactor.radius=1e-6",
        "impactor.radius=1e3",
        "body.young=1e3",
        "body.density=1e-3",
        "body.density=1e6",
    ];
    let (mut answered, mut refused) = (0, 0);
    for input in inputs {
        for localization in ["contact.localization=patch", "contact.localization=point"] {
            for step in ["time.step=", "time.step=1e-5"] {
                // Here the contact is a thousand times shorter than a wave's time through a cell: the run is refused
                // only after minutes, so it is left out.
                if input == "impactor.stiffness=1e20" && localization.ends_with("point") && step == "time.step=" {
                    continue;
                }
                let (scene, steps) = match series(session, &[input, localization, step]) {
                    Ok(answer) => answer,
                    Err(Error::Scene(_) | Error::Fault(_) | Error::Solve(_) | Error::Unstable(_)) => {
                        refused += 1;
                        continue;
                    }
                    Err(other) => panic!("{input} {localization} {step}: {other}"),
                };
                answered += 1;
                let (first, last) = (steps[0], steps[steps.len() - 1]);
                let energy = |step: &Step| {
                    step.energy.total + step.energy.dissipated - step.energy.external - step.energy.numerical
                };
                let off = (energy(&last) - energy(&first)).abs() / first.energy.total;
                // Rounding of K u, if the body takes only a tiny part of a huge energy.
                assert!(off < 1e-7, "{input} {localization} {step}: energy off by {off:e}");
                // With Newmark's γ = 1/2, the impactor's change of momentum is the trapezoidal sum of F.
                let impulse: f64 = steps
                    .windows(2)
                    .map(|pair| 0.5 * (pair[0].contact.force + pair[1].contact.force) * (pair[1].time - pair[0].time))
                    .sum();
                let momentum = scene.impactor.mass * (first.impactor.velocity - last.impactor.velocity);
                let rounding = 1e-12 * scene.impactor.mass * scene.impactor.speed;
                let difference = (impulse - momentum).abs();
                assert!(difference <= 1e-7 * impulse + rounding, "{input} {localization} {step}: {impulse} {momentum}");
            }
        }
    }
    println!("{answered} answers, {refused} refusals");
    assert!(answered > 30 && refused > 6);
}

/// For a milligram the plate is a half-space at rest: Hertz's contact time, peak force and full rebound, with a patch.
fn a_tiny_mass(session: &Session) {
    let (scene, steps) = series(session, &["impactor.mass=1e-6", "time.end=2e-6", "accuracy.tolerance=1e-3"]).unwrap();
    let impactor = &scene.impactor;
    let expected = hertz::peak_force(impactor.stiffness, impactor.mass, impactor.speed);
    let peak = steps.iter().fold(0.0_f64, |peak, step| peak.max(step.contact.force));
    // The tolerance of the time steps, and of the peak between two of them.
    assert!((peak / expected - 1.0).abs() < 2e-3, "{peak} {expected}");
    let rebound = steps[steps.len() - 1].impactor.velocity / impactor.speed;
    assert!((rebound + 1.0).abs() < 2e-3, "{rebound}");
}
