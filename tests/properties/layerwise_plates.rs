//! Layerwise plates at rest: comparison with the waves of an infinite stack, with a single plate, and with sliding
//! plies.

use crate::plates::{Operator, a, answer, navier, plate, rigidity, scene, series};
use ricochet::scene::Scene;
use ricochet::space::plate::{Disc, PlateTheory};

/// A rectangular laminate of glass, a soft layer and glass (thicknesses in m), with Navier's edge supports.
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

/// A layerwise plate with Navier's edge supports: each wave has the response of the infinite stack in the same theory,
/// including the moments of the load and of the displacement average. Symmetric and unsymmetric stacks are tested.
#[test]
fn navier_layerwise() {
    for layers in [[0.012, 0.002, 0.012], [0.016, 0.002, 0.008]] {
        let scene = laminate([0.9, 0.7], layers, "young = 1e8\npoisson = 0.45\ndensity = 1100.0");
        let errors = [2.0, 1.0].map(|cell_size_factor| {
            let plate = plate(&scene, PlateTheory::Layerwise, cell_size_factor);
            let layers = plate.layers();
            assert_eq!(plate.system.terms.contact.compliance, -4.0 * layers.compliance);
            let (theory, Disc { spread, radius }) = (layers.theory(), layers.disc.unwrap());
            let exact =
                series([0.9, 0.7], 500, |xi| theory.face_deflection(&theory.wave(xi)) * spread.square(xi * radius));
            1.0 - answer(&plate, 0.0) / exact
        });
        // Same tolerances as for one layer on similar cells.
        assert!(errors[0].abs() < 4e-3 && errors[1].abs() < 4e-4, "{layers:?}: {errors:?}");
    }
}

/// With a softer interlayer two plies slide more. At rest, the compliance increases from the value of one plate (with
/// an interlayer of glass) to the value for the sum of the plies' rigidities.
#[test]
fn softer_interlayers_let_plies_slide() {
    let yields = |soft: &str| {
        let scene = laminate([0.9, 0.7], [0.01, 0.001, 0.01], &format!("{soft}\ndensity = 2500.0"));
        let plate = plate(&scene, PlateTheory::Layerwise, 1.0);
        let deflection = a(&plate).dot(&Operator::new(&plate, 0.0).solve(&plate, &plate.system.terms.contact.force));
        (deflection / plate.system.terms.multiplicity, plate.layers().compliance)
    };
    let one = plate(&scene("size = [0.9, 0.7, 0.021]", "", &navier()), PlateTheory::Layerwise, 1.0);
    let whole = answer(&one, 0.0) + one.layers().compliance;
    let (deflection, compliance) = yields("young = 70.0001e9\npoisson = 0.23");
    // The discretisation errors of the two plates are some 1e-4.
    let off = (deflection + compliance) / whole - 1.0;
    println!("an interlayer of glass: {off:e}");
    assert!(off.abs() < 5e-4, "{off:e}");
    // All these interlayers resist a change of volume, so they are not compressed.
    let softer = [1e9, 1e8, 1e7, 1e6, 1e5, 1e4].map(|shear| yields(&format!("bulk = 2e9\nshear = {shear:e}")).0);
    assert!(softer.is_sorted() && softer[0] > deflection, "{softer:?}");
    let sliding = series([0.9, 0.7], 1000, |xi| 1.0 / (2.0 * rigidity(0.01) * xi.powi(4)));
    println!("{softer:?} {sliding:e}");
    // Sources of the difference: shear of the plies, (ξh)² of the longest waves; and the remaining coupling by the
    // interlayer, A r² G/(h E h ξ²) of the plies' own rigidity.
    assert!((softer[5] / sliding - 1.0).abs() < 1e-2, "{softer:?} {sliding:e}");
}
