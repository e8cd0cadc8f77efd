//! Layers and materials of a scene, in the form in which the program uses them.

use crate::bad_scenes::SMALL;
use crate::bad_scenes::layers::LAMINATE;
use ricochet::description::{Description, Portion};
use ricochet::scene::{Geometry, Parts, Scene};

fn scene(overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|given| (*given).to_owned()).collect();
    Scene::parse("test", LAMINATE, &overrides).unwrap_or_else(|error| panic!("{error}")).0
}

#[test]
fn layers_make_the_thickness() {
    let scene = scene(&[]);
    let Geometry::Box { size, planes, .. } = &scene.body.geometry else { panic!("a box") };
    // Rounding of two sums.
    assert!(size[..2] == [0.5, 0.5] && (size[2] / 0.02086 - 1.0).abs() < 1e-15);
    assert_eq!(scene.impactor.point, [0.0, 0.0, 0.5 * size[2]]);
    assert!(scene.body.composition.interfaces().iter().all(|height| planes[2].contains(height)));
    let mass = 0.25 * (2500.0 * 0.0201 + 1100.0 * 0.00076);
    assert!((scene.body.mass().expect("a mass") / mass - 1.0).abs() < 1e-14);
    assert_eq!((scene.body.struck().young, scene.body.struck_thickness(size[2])), (70e9, 0.010));
    // An impact from below hits the last layer.
    let below = self::scene(&["impactor.direction=[0, 0, 1]"]);
    assert_eq!(below.body.struck_thickness(size[2]), 0.0101);
    assert!(scene.time.modal, "a relaxing body moves in modal coordinates");
    let parts = Description::new(&scene).parts;
    let ends: Vec<[f64; 2]> = parts
        .iter()
        .map(|part| match part.portion {
            Portion::Layer(ends) => ends,
            _ => panic!("a layer"),
        })
        .collect();
    assert!(ends.windows(2).all(|pair| pair[0][1] == pair[1][0]), "{ends:?}");
    assert_eq!((ends[0][0], ends[2][1]), (-0.5 * size[2], 0.5 * size[2]));
    // From below, the layer of 10.1 mm is the first.
    assert!((ends[0][1] - ends[0][0] - 0.0101).abs() < 1e-16);
}

#[test]
fn temperature_shifts_the_times() {
    let times = |temperature: &str| {
        let scene = scene(&[&format!("body.temperature={temperature}")]);
        let Parts::Layers(layers) = &scene.body.composition.parts else { panic!("layers") };
        let chain = layers[1].material.shear.clone().expect("a chain");
        chain.terms.iter().map(|term| term.time).collect::<Vec<_>>()
    };
    assert_eq!(times("20"), [1e-5, 1e-4]);
    // log a_T = −20 · 10/100.
    let warm = times("30");
    assert!((warm[0] / 1e-7 - 1.0).abs() < 1e-12 && (warm[1] / 1e-6 - 1.0).abs() < 1e-12, "{warm:?}");
}

/// Prony terms in a file equal those in a list. The stored text of the scene does not need the file. A message says if
/// the file lacks something.
#[test]
fn terms_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let given = "prony = [{ modulus = 7e6, time = 1e-5 }, { modulus = 4e6, time = 1e-4 }]";
    let text = LAMINATE.replacen(given, "prony = \"series.csv\"", 1);
    let read = |content: &str| {
        std::fs::write(folder.path().join("series.csv"), content).unwrap();
        Scene::within("test", folder.path(), &text, &[])
    };
    let (scene, source) = read("time (s), modulus (Pa)\n1e-5, 7e6\n1e-4, 4e6\n").unwrap();
    assert_eq!(scene, self::scene(&[]));
    assert_eq!(Scene::parse("test", source.text(), &[]).unwrap().0, scene);
    for (content, fragment) in [
        ("1e-4, 4e6\n1e-5, 7e6\n", "do not ascend"),
        ("1e-5, 7e6, 1\n", "has not two columns but 3"),
        ("1e-5, 7e6\n1e-5, 4e6\n", "there twice"),
        ("1e-5, -7e6\n", "must be positive"),
        ("", "there is no term"),
    ] {
        let error = read(content).expect_err(fragment).to_string();
        assert!(error.contains(fragment) && error.contains("material.interlayer.prony"), "{error}");
    }
}

/// Terms far too fast or too slow for the impact simulation are not followed in time; `check` says so with these words.
#[test]
fn terms_that_the_run_cannot_tell_are_pruned() {
    let prony = "material.interlayer.prony=[{ modulus = 7e6, time = 1e-9 }, { modulus = 4e6, time = 1e-4 }, { modulus = 1e6, time = 1e5 }]";
    let scene = scene(&[prony, "time.step=1e-4"]);
    let parts = Description::new(&scene).parts;
    let words = parts[1].pruned.as_ref().expect("a relaxing layer").to_string();
    let expected = "Maxwell chain of 3 terms: 1 computed over time, 1 too slow to relax in this run (kept as elastic stiffness), 1 relaxed before \
                    the contact can feel it (left out)";
    assert_eq!(words, expected);
    assert!(parts[0].pruned.is_none() && parts[2].pruned.is_none());
    let chain = parts[1].material.shear.as_ref().expect("a chain");
    assert_eq!((chain.equilibrium, chain.terms.len()), (4e6, 1));
}

/// Layers of equal materials are one body.
#[test]
fn layers_alike_are_one() {
    let text = LAMINATE.replacen("material = \"interlayer\"", "material = \"glass\"", 1);
    let (start, rest) = text.split_once("[material.interlayer]").unwrap();
    let text =
        format!("{start}{}", rest.split_once("[impactor]").map(|(_, rest)| format!("[impactor]{rest}")).unwrap());
    let scene =
        Scene::parse("test", &text, &["body.temperature=".to_owned()]).unwrap_or_else(|error| panic!("{error}")).0;
    let parts = Description::new(&scene).parts;
    assert!(parts.len() == 1 && parts[0].portion == Portion::All && scene.time.modal);
    // The same as for a box of one material.
    let whole = Scene::parse("test", SMALL, &["body.size=[0.5, 0.5, 0.02086]".into()]).unwrap().0;
    assert_eq!(Description::new(&whole).parts, parts);
}

/// A stiff ply that is thin compared with the contact, on discs of two radii: the law of the narrower one ends at half the force
/// of the other, but the contact radius depends on the force alone. (With a radius continued as on a half-space, the tension
/// under the upper ply was 18% too large at twice that force.)
#[test]
fn the_contact_radius_does_not_depend_on_the_disc() {
    let contact = |disc: &str| {
        let text = format!(
            "[body]\nsize = [0.2, 0.2]\n\
             [[body.layer]]\nthickness = 0.003\nmaterial = \"glass\"\n[[body.layer]]\nthickness = 0.00152\nmaterial = \"soft\"\n\
             [[body.layer]]\nthickness = 0.008\nmaterial = \"glass\"\n\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.soft]\nbulk = 2e9\nshear = 1e8\ndensity = 1100.0\n\
             [impactor]\nmass = 20.0\nradius = 0.1\nyoung = 210e9\npoisson = 0.3\nspeed = 1.5\n[time]\nend = 1e-3\n{disc}"
        );
        let (scene, _) = Scene::parse("scene", &text, &[]).expect("a scene");
        scene.impactor.layered_contact().expect("a law of the layers").clone()
    };
    let [narrow, wide] = ["", "[contact]\ndisc_radius = 0.03\n"].map(contact);
    assert!(narrow.disc < 0.7 * wide.disc, "{} {}", narrow.disc, wide.disc);
    for force in [1e2, 1e4, 2.5e4, 1e5] {
        let [narrow, wide] = [&narrow, &wide].map(|contact| contact.radius(force));
        // Rounding only.
        assert!((narrow / wide - 1.0).abs() < 1e-9, "{force} N: {narrow} m, {wide} m");
    }
}
