//! Steps in modal coordinates against solutions known to many digits.

use std::ops::ControlFlow;

use ricochet::body::{ModalBody, Modes};
use ricochet::impact::ModalImpact;
use ricochet::impact::step::Step;
use ricochet::record::episodes::{Episode, Episodes};
use ricochet::scene::Scene;

const SCENE: &str = r#"
[body]
model = "solid"
young = 70e9
poisson = 0.23
density = 2500.0
size = [1.0, 1.0, 0.1]
[impactor]
mass = 2.0
radius = 0.05
young = 210e9
poisson = 0.3
speed = 3.0
point = [0.0, 0.0, 0.05]
direction = [0.0, 0.0, -1.0]
stiffness = 1e9
[time]
end = 0.005
"#;

fn scene(overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Scene::parse("test", SCENE, &overrides).unwrap().0
}

fn run(scene: &Scene, body: &ModalBody) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut impact = ModalImpact::new(scene, body);
    let flow = impact.run(|step| {
        steps.push(*step);
        Ok(ControlFlow::Continue(()))
    });
    assert!(flow.unwrap().is_continue());
    println!(
        "{} steps, {} solves, {} iterations, error {:?}",
        steps.len(),
        impact.count.solves,
        impact.count.iterations,
        impact.count.error
    );
    steps
}

/// Zener's plate: restitution, peak and contact time to the digits of the table.
#[test]
fn infinite_plate() {
    let table = [
        (0.1, 0.84334, 1.03555, 3.27849),
        (0.2, 0.71404, 0.94606, 3.34866),
        (0.5, 0.43690, 0.75023, 3.62444),
        (1.0, 0.18412, 0.55616, 4.38761),
        (2.0, 0.02068, 0.36466, 8.48322),
    ];
    let scene = scene(&["accuracy.tolerance=1e-6", "time.end=0.02"]);
    let impactor = &scene.impactor;
    let (k, m, v) = (impactor.stiffness, impactor.mass, impactor.speed);
    let (force, time) = (k.powf(0.4) * m.powf(0.6) * v.powf(1.2), (m * m / (k * k * v)).powf(0.2));
    for (lambda, restitution, peak, duration) in table {
        let impedance = k.powf(0.4) * v.powf(0.2) * m.powf(0.6) / lambda;
        let steps = run(&scene, &ModalBody::given(Modes::dashpot(impedance)));
        let last = steps.last().unwrap();
        let largest = steps.iter().map(|s| s.contact.force).fold(0.0, f64::max);
        let mut episodes = Episodes::default();
        steps.iter().for_each(|step| episodes.push(step));
        let [Episode { end, .. }] = episodes.all()[..] else { panic!("one contact") };
        println!("{lambda} {} {} {}", -last.impactor.velocity / v, largest / force, end / time);
        assert!((-last.impactor.velocity / v - restitution).abs() < 1e-5);
        assert!((largest / force - peak).abs() < 1e-5);
        assert!((end / time - duration).abs() < 1e-5);
        // What the impactor has lost, the plate's waves have taken: 1 − e² of ½ m v², whose rounding is 2e-5 of the table's digits.
        let lost = last.energy.dissipated / (0.5 * m * v * v);
        assert!((lost - (1.0 - restitution * restitution)).abs() < 2e-5, "{lost}");
        assert!(last.energy.numerical.abs() < 1e-6 * 0.5 * m * v * v, "{:?}", last.energy);
    }
}

/// Hertz on a half-space: peak and contact time to the digits of the formulas, and all of the speed given back.
#[test]
fn half_space() {
    let scene = scene(&["accuracy.tolerance=1e-6"]);
    let impactor = &scene.impactor;
    let (k, m, v) = (impactor.stiffness, impactor.mass, impactor.speed);
    let steps = run(&scene, &ModalBody::given(Modes::none()));
    let last = steps.last().unwrap();
    let largest = steps.iter().map(|s| s.contact.force).fold(0.0, f64::max);
    let mut episodes = Episodes::default();
    steps.iter().for_each(|step| episodes.push(step));
    let [Episode { end, .. }] = episodes.all()[..] else { panic!("one contact") };
    let (peak, duration) = (largest / (k.powf(0.4) * m.powf(0.6) * v.powf(1.2)), end / (m * m / (k * k * v)).powf(0.2));
    let rebound = last.impactor.velocity / v;
    println!("{rebound} {peak} {duration}");
    // The peak may lie between two of some thousand steps; the tolerance is 1e-6.
    assert!((peak - 1.14326).abs() < 1e-5 && (duration - 3.21807).abs() < 1e-5 && (rebound + 1.0).abs() < 1e-6);
    // Energies and what they were made of by the integration: E + numerical stays, and numerical is within the tolerance.
    let initial = 0.5 * m * v * v;
    assert!((last.energy.total - last.energy.numerical - initial).abs() < 1e-13 * initial);
    assert!(last.energy.numerical.abs() < 1e-6 * initial);
}
