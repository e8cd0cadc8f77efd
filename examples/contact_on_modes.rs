//! A contact in modal coordinates: the body moves exactly between the values of the force, and each step solves for the
//! force at its middle and its end.
//!
//! The vibrations of the reduced body are ẍ + ω²x = φF, and the surface under the impactor moves by Σ φx + rF, with the
//! static response r of the modes that are left out. Hertz's law (15) couples them with the impactor, m0 q̈ = −F.
//!
//!     cargo run --release --example contact_on_modes

use std::ops::ControlFlow;

use ricochet::body::{Krylov, LinearBody, LocalBody, ModalBody, Start};
use ricochet::impact::ModalImpact;
use ricochet::scene::Scene;
use ricochet::space::plate::{Plate, PlateTheory, Settings};

const SCENE: &str = include_str!("../scenes/pane.toml");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (scene, _) = Scene::parse("pane.toml", SCENE, &[])?;
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &Settings::new(1e-2, PlateTheory::Layerwise))?;
    let body = LocalBody::new(plate.system);
    let class = body.classes()[0];
    let mut krylov = Krylov::new(class, Start::from(15.0 / scene.impactor.contact_time()))?;
    krylov.grow(class, 60)?;
    let modal = ModalBody::of(&krylov.projection(class)?);

    // Without a step of the scene, steps are chosen for an error of the tolerance's share.
    let (mut peak, mut impulse, mut velocity, mut balance) = (0.0_f64, 0.0, 0.0, 0.0);
    let _ = ModalImpact::new(&scene, &modal).run(|step| {
        peak = peak.max(step.contact.force);
        (impulse, velocity, balance) = (step.contact.impulse, step.impactor.velocity, step.energy.numerical);
        Ok(ControlFlow::Continue(()))
    })?;
    println!("peak force {peak:.1} N; impulse {impulse:.5} N s; velocity at the end {velocity:.5} m/s");
    // m0 Δv = ∫F dt, to the rounding of the sums; the energy of 1/2 m0 v² is kept as far as the steps are exact.
    let (mass, speed) = (scene.impactor.mass, scene.impactor.speed);
    assert!((impulse - mass * (speed - velocity)).abs() < 1e-9 * mass * speed);
    assert!(balance.abs() < 1e-4 * 0.5 * mass * speed * speed);
    Ok(())
}
