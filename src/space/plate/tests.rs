//! Tests of a plate's matrices against exact energies.

use super::layers::profile::rotation;
use super::*;

/// Checks the stiffness of springs against a rotation of all layers, which is the sum over the layers; the mass;
/// and the instantaneous stiffness of viscoelastic layers.
#[test]
fn layers_have_the_sums_of_their_parts() {
    let scene = |interlayer: &str, layers: [f64; 3]| {
        let layer = |(thickness, material): (f64, &str)| {
            format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
        };
        let layers: String = layers.into_iter().zip(["glass", "soft", "glass"]).map(layer).collect();
        let text = format!(
            "[body]\nsize = [0.6, 0.4]\nsymmetry = \"none\"\n{layers}\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n[material.soft]\ndensity = 1100.0\nbulk = 2e9\n{interlayer}\n\
             [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n\
             [[support]]\nsurface = \"x-min\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n"
        );
        Scene::parse("test", &text, &[]).expect("a scene").0
    };
    let settings = Settings { cell_size_factor: 2.4, ..Settings::default() };
    let plate = |scene: &Scene| Plate::new(scene, PlateTheory::Layerwise, &settings).expect("a plate");
    let energy = |matrix: &CsrMatrix<f64>, u: &[f64]| -> f64 {
        matrix.triplet_iter().map(|(i, j, value)| u[i] * value * u[j]).sum()
    };
    for layers in [[0.013, 0.004, 0.013], [0.018, 0.004, 0.008]] {
        let chain = "shear = 1e6\nprony = [{ modulus = 4e7, time = 1e-4 }, { modulus = 6e7, time = 2e-4 }]";
        let relaxing = plate(&scene(chain, layers));
        let [Relaxation { distortion, chain }] = &relaxing.system.terms.relaxations[..] else {
            panic!("one relaxation")
        };
        let layers_of = relaxing.layers();
        // The shear strains must be those for the secant modulus at half the contact time.
        let [stiff, soft] = [chain.instantaneous(), chain.equilibrium].map(|shear| {
            let elastic = plate(&scene(&format!("shear = {shear:e}"), layers)).points.layers;
            relaxing.points.tensor.matrix(&elastic.with_theory_of(layers_of).elastic())
        });
        let profile = &layers_of.profile;
        let tensor = &relaxing.points.tensor;
        for axis in 0..2 {
            let mut turned = vec![0.0; tensor.unknowns()];
            for layer in 0..3 {
                let field = rotation(profile.group_of(layer), axis, [0, 0]).field;
                turned.iter_mut().zip(tensor.one(field)).for_each(|(u, one)| *u = f64::max(*u, one));
            }
            let k = [2e9, 3e9][axis];
            let sum = energy(relaxing.system.terms.support.as_ref().expect("springs"), &turned);
            let exact = k * 0.03_f64.powi(3) / 12.0 * 0.4;
            // Rounding error of some hundred points.
            assert!((sum / exact - 1.0).abs() < 1e-12, "{layers:?} {axis}: {sum} {exact}");
        }
        let translation = &relaxing.system.terms.translation;
        let mass = energy(&relaxing.system.mass, translation);
        let exact = 0.6 * 0.4 * (2500.0 * 0.026 + 1100.0 * 0.004);
        assert!((mass / exact - 1.0).abs() < 1e-12 && energy(distortion, translation).abs() < 1e-12);
        let u: Vec<f64> = (0..translation.len()).map(|i| ((i * 7919) % 101) as f64 / 50.0 - 1.0).collect();
        let relaxed = energy(&relaxing.system.terms.elastic, &u);
        // Rounding error of converting E and ν to G and K.
        assert!((relaxed / energy(&soft, &u) - 1.0).abs() < 1e-9, "{relaxed} {}", energy(&soft, &u));
        let whole = relaxed + (chain.instantaneous() - chain.equilibrium) * energy(distortion, &u);
        assert!((whole / energy(&stiff, &u) - 1.0).abs() < 1e-9, "{whole} {}", energy(&stiff, &u));
    }
}

/// Stiffness of springs along the sides against a rotation of a whole plate of one layer along one axis: k h³/12 per
/// unit of length.
#[test]
fn springs_resist_rotations() {
    let text = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.6, 0.4, 0.03]\nsymmetry = \"none\"\n\
                [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n\
                [[support]]\nsurface = \"x-min\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n\
                [[support]]\nsurface = \"y-max\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n";
    let scene = Scene::parse("test", text, &[]).expect("a scene").0;
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &Settings::default()).expect("a plate");
    let support = plate.system.terms.support.expect("springs");
    for (axis, k) in [2e9, 3e9].into_iter().enumerate() {
        let one = plate.points.tensor.one(rotation(0, axis, [0, 0]).field);
        let sum: f64 = support.triplet_iter().map(|(i, j, value)| one[i] * value * one[j]).sum();
        let exact = k * 0.03_f64.powi(3) / 12.0 * (0.4 + 0.6);
        // Rounding error of some hundred points.
        assert!((sum / exact - 1.0).abs() < 1e-12, "{sum} {exact}");
    }
}

/// A layer of a stack: thickness (m), shear modulus (Pa), density (kg/m³).
#[derive(Debug, Clone, Copy)]
struct Crossed {
    thickness: f64,
    shear: f64,
    density: f64,
}

/// Travel times through stacks of glass and other layers. Soft layers are interlayers only between stiff ones, and also
/// next to each other.
#[test]
fn soft_layers_between_plies_are_interlayers() {
    let glass = Crossed { thickness: 0.004, shear: 28.5e9, density: 2500.0 };
    let aluminium = Crossed { thickness: 0.003, shear: 26e9, density: 2700.0 };
    let film = |thickness: f64, shear: f64| Crossed { thickness, shear, density: 1100.0 };
    has_interlayers(&[glass, film(0.00076, 1e6), glass], &[1]);
    has_interlayers(&[glass, film(0.00076, 1e6), glass, film(0.00152, 2e7), glass], &[1, 3]);
    has_interlayers(&[glass, film(0.0004, 1e8), film(0.0002, 1e6), film(0.0004, 1e8), glass], &[1, 2, 3]);
    has_interlayers(&[glass, aluminium, glass], &[]);
    has_interlayers(&[film(0.002, 1e6), glass], &[]);
}

fn has_interlayers(layers: &[Crossed], interlayers: &[usize]) {
    let of_layer = |(i, Crossed { thickness, shear, density }): (usize, &Crossed)| {
        format!(
            "[[body.layer]]\nthickness = {thickness}\nmaterial = \"m{i}\"\n\
             [material.m{i}]\nyoung = {:e}\npoisson = 0.23\ndensity = {density:e}\n",
            2.46 * shear
        )
    };
    let body: String = layers.iter().enumerate().map(of_layer).collect();
    let text = format!(
        "[body]\nsize = [0.3, 0.3]\n{body}[impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n\
         speed = 1.0\n[time]\nend = 1e-3\n"
    );
    let scene = Scene::parse("test", &text, &[]).expect("a scene").0;
    let found = ShearTravelTimes::of(&scene);
    let mut exact = [0.0; 2];
    for (i, Crossed { thickness, shear, density }) in layers.iter().enumerate() {
        let time = thickness * (density / shear).sqrt() / scene.impactor.contact_time();
        exact[usize::from(interlayers.contains(&i))] += time;
    }
    // Rounding error of converting E and ν to G.
    let is_close = |one: f64, other: f64| (one - other).abs() <= 1e-12 * (exact[0] + exact[1]);
    assert!(is_close(found.plies, exact[0]) && is_close(found.interlayers, exact[1]), "{layers:?}: {exact:?}");
}
