//! A plate on a Krylov basis: few vectors answer a force as all unknowns do.
//!
//! The basis of S⁻¹a, S⁻¹M S⁻¹a, … with S = K + s²M is orthonormal in the mass. It represents the displacement under a
//! force F e^{σt} exactly at σ = s, and near it the better the more vectors it has.
//!
//!     cargo run --release --example reduced_plate

use nalgebra::DMatrix;
use ricochet::body::{Krylov, LinearBody, LocalBody, Projection, Start};
use ricochet::scene::Scene;
use ricochet::space::plate::{Plate, PlateTheory, Settings};

const SCENE: &str = include_str!("../scenes/pane.toml");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (scene, _) = Scene::parse("pane.toml", SCENE, &[])?;
    // Mindlin's plate on splines: matrices and vectors of M ü + K u = a F.
    let settings = Settings::new(1e-2, PlateTheory::Layerwise);
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &settings)?;
    let body = LocalBody::new(plate.system);
    let class = body.classes()[0];
    let shift = 15.0 / scene.impactor.contact_time();

    // Vᵀa and VᵀKV give the dynamic compliance aᵀ(K + σ²M)⁻¹a on the basis, where M is the identity.
    let compliance = |reduced: &Projection, rate: f64| {
        let force = &reduced.terms.contact.force;
        let mass = DMatrix::from_diagonal_element(force.len(), force.len(), rate * rate);
        (reduced.stiffness_at_rate() + mass).cholesky().map(|factor| force.dot(&factor.solve(force)))
    };
    let mut krylov = Krylov::new(class, Start::from(shift))?;
    println!("{} unknowns; displacement per newton at eight times the shift, m/N", class.unknowns());
    let mut found = Vec::new();
    for vectors in [5, 10, 20, 40] {
        krylov.grow(class, vectors)?;
        let reduced = krylov.projection(class)?;
        let moved = compliance(&reduced, 8.0 * shift).ok_or("K + s²M is positive definite")?;
        println!("{vectors:4} vectors: {moved:.12e}");
        found.push(moved);
    }
    // By Galerkin's principle the displacement grows with the basis, towards that of all unknowns.
    let grown = |from: usize| found[from + 1] / found[from] - 1.0;
    assert!(grown(0) > grown(1) && grown(1) > grown(2) && grown(2) > -1e-12 && grown(2) < 1e-4);
    Ok(())
}
