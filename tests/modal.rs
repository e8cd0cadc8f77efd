//! Steps in modal coordinates against solutions known to many digits.

use std::ops::ControlFlow;

use ricochet::body::{ModalBody, Modes};
use ricochet::impact::ModalImpact;
use ricochet::impact::step::Step;
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
        let end = steps.iter().skip(1).find(|s| s.contact.force == 0.0).unwrap().time;
        println!("{lambda} {} {} {}", -last.impactor.velocity / v, largest / force, end / time);
        assert!((-last.impactor.velocity / v - restitution).abs() < 1e-5);
        assert!((largest / force - peak).abs() < 1e-5);
        assert!((end / time - duration).abs() < 1e-5);
    }
}

/// Hertz on a half-space.
#[test]
fn half_space() {
    let scene = scene(&["accuracy.tolerance=1e-6"]);
    let impactor = &scene.impactor;
    let (k, m, v) = (impactor.stiffness, impactor.mass, impactor.speed);
    let steps = run(&scene, &ModalBody::given(Modes::none()));
    let last = steps.last().unwrap();
    let largest = steps.iter().map(|s| s.contact.force).fold(0.0, f64::max);
    let end = steps.iter().skip(1).find(|s| s.contact.force == 0.0).unwrap().time;
    println!(
        "{} {} {}",
        last.impactor.velocity,
        largest / (k.powf(0.4) * m.powf(0.6) * v.powf(1.2)),
        end / (m * m / (k * k * v)).powf(0.2)
    );
    println!("{:?}", last.energy);
}
