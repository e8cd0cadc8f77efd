//! Layerwise plates at rest: against the infinite stack's waves, one plate, and plies that slide.

use crate::plates::{Operator, a, answer, navier, plate, rigidity, scene, series};
use ricochet::scene::Scene;
use ricochet::space::plate::PlateTheory;

/// A rectangle with layers (m) of glass, soft and glass, between Navier's edges.
fn laminate([x, y]: [f64; 2], layers: [f64; 3], soft: &str) -> Scene {
    let layer = |(thickness, material): (f64, &str)| {
        format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
    };
    let layers: String = layers.into_iter().zip(["glass", "soft", "glass"]).map(layer).collect();
    let text = format!(
        "[body]\nsize = [{x}, {y}]\n{layers}[material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.soft]\n{soft}\n\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 1e-3\n{}",
        navier()
    );
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// The layerwise plate between Navier's edges: each wave is the infinite stack's in that theory, with the moments of load and reading; of symmetric and other
/// stacks.
#[test]
fn navier_layerwise() {
    for layers in [[0.012, 0.002, 0.012], [0.016, 0.002, 0.008]] {
        let scene = laminate([0.9, 0.7], layers, "young = 1e8\npoisson = 0.45\ndensity = 1100.0");
        let errors = [2.0, 1.0].map(|cell_size_factor| {
            let plate = plate(&scene, PlateTheory::Layerwise, cell_size_factor);
            let laminate = plate.laminate.as_ref().unwrap();
            assert_eq!(plate.system.compliance, -4.0 * laminate.compliance);
            let (theory, spread) = laminate.infinite();
            let exact =
                series([0.9, 0.7], 500, |xi| theory.read(&theory.wave(xi)) * spread.square(xi * laminate.radius));
            1.0 - answer(&plate, 0.0) / exact
        });
        // As Mindlin's plate on like cells.
        assert!(errors[0].abs() < 4e-3 && errors[1].abs() < 4e-4, "{layers:?}: {errors:?}");
    }
}

/// The softer the interlayer, the further two plies slide: at rest from one plate, which an interlayer of glass makes, to the sum of both plies'
/// rigidities.
#[test]
fn softer_interlayers_let_plies_slide() {
    let yields = |soft: &str| {
        let scene = laminate([0.9, 0.7], [0.01, 0.001, 0.01], &format!("{soft}\ndensity = 2500.0"));
        let plate = plate(&scene, PlateTheory::Layerwise, 1.0);
        let deflection = a(&plate).dot(&Operator::new(&plate, 0.0).solve(&plate, &plate.system.localization));
        (deflection / plate.system.copies, plate.laminate.unwrap().compliance)
    };
    let one = plate(&scene("size = [0.9, 0.7, 0.021]", "", &navier()), PlateTheory::Mindlin, 1.0);
    let whole = answer(&one, 0.0) + one.local.unwrap().compliance;
    let (deflection, compliance) = yields("young = 70.0001e9\npoisson = 0.23");
    // Cells of both leave some 1e-4.
    let off = (deflection + compliance) / whole - 1.0;
    println!("an interlayer of glass: {off:e}");
    assert!(off.abs() < 5e-4, "{off:e}");
    // They all resist a change of volume, so that the interlayer is not pressed together.
    let softer = [1e9, 1e8, 1e7, 1e6, 1e5, 1e4].map(|shear| yields(&format!("bulk = 2e9\nshear = {shear:e}")).0);
    assert!(softer.is_sorted() && softer[0] > deflection, "{softer:?}");
    let sliding = series([0.9, 0.7], 1000, |xi| 1.0 / (2.0 * rigidity(0.01) * xi.powi(4)));
    println!("{softer:?} {sliding:e}");
    // Shear of the plies, (ξh)² of longest waves, and what is left of the interlayer's hold, A r² G/(h E h ξ²) of the plies' own rigidity.
    assert!((softer[5] / sliding - 1.0).abs() < 1e-2, "{softer:?} {sliding:e}");
}
