//! Properties of the scene reader with random scenes, random texts and random overrides.

use crate::bad_scenes::{GOOD, MESH, QUARTER, SMALL};
use proptest::prelude::*;
use ricochet::Error;
use ricochet::form::Material;
use ricochet::scene::{Geometry, Scene, Scheme, SupportKind, Vec3};

/// Positive numbers over the range that scenes have.
fn positive() -> impl Strategy<Value = f64> {
    (0.1..1.0f64, -6..12i32).prop_map(|(digits, exponent)| digits * 10f64.powi(exponent))
}

fn vector(entry: impl Strategy<Value = f64>) -> impl Strategy<Value = Vec3> {
    proptest::array::uniform(entry)
}

/// A box, a point on one of its faces and a direction into the box.
fn hit() -> impl Strategy<Value = (Vec3, Vec3, Vec3)> {
    let face = (0..3usize, any::<bool>());
    (vector(1e-3..10.0), vector(-1.0..1.0), vector(-1.0..1.0), face, 0.05..1.0).prop_map(
        |(size, at, mut direction, (axis, top), inward): (Vec3, Vec3, Vec3, _, f64)| {
            let sign = if top { 1.0 } else { -1.0 };
            let mut point: Vec3 = std::array::from_fn(|i| at[i] * size[i] / 2.0);
            point[axis] = sign * size[axis] / 2.0;
            direction[axis] = -sign * inward;
            (size, point, direction)
        },
    )
}

/// Reads a scene to the end, including the report of a refusal, and reads the stored text again.
fn survive(text: &str, overrides: &[String]) {
    match Scene::parse("random.toml", text, overrides) {
        Ok((scene, source)) => {
            let again = Scene::parse("random.toml", source.text(), &[]).map(|(scene, _)| scene);
            assert_eq!(again.ok(), Some(scene));
        }
        Err(error) => {
            assert!(error.line() >= 1 && !error.advice().is_empty());
            let place = format!(":{}: {}: ", error.line(), error.key());
            assert!(error.to_string().contains(&place));
            assert!(!Error::from(error).report(false).is_empty());
        }
    }
}

/// Pieces of scenes, to be inserted in wrong places.
fn scrap() -> impl Strategy<Value = String> {
    prop_oneof![
        "\\PC{0,4}",
        "[\\[\\]{}=.,\"'#\n\r\t 0-9eE+-]{1,6}",
        prop::sample::select(vec![
            "inf",
            "nan",
            "-1",
            "1e999",
            "9223372036854775808",
            "[[support]]\n",
            "[body]\n",
            "true",
            "1979-05-27",
            "{}",
            "[]",
            "\"\"\"",
            "\u{feff}",
            "young",
            "support",
            "é",
            "0x7fffffffffffffff",
        ])
        .prop_map(Into::into),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn a_valid_scene_parses_to_its_numbers(
        (size, point, direction) in hit(),
        cells in proptest::array::uniform3(1..200usize),
        order in 1..=2usize,
        // Limits of a scene: no impact is faster than waves, a thousand times wider than the body, or a hundred million
        // contacts long.
        (young, density, mass, radius, young2) in (1e7..1e12f64, 1.0..2e4f64, 1e-3..1e3f64, 1e-3..1.0f64, 1e7..1e12f64),
        (speed, gap, end) in (1e-3..20.0f64, positive(), 1e-6..100.0f64),
        (poisson, poisson2) in (-0.999..0.4999f64, -0.999..=0.5f64),
        (beta, gamma, steps) in (1e-3..=1.0f64, 0.0..=1.0f64, 1.0..1e6f64),
        (stiffness, damping, shift) in (vector(positive()), vector(positive()), vector(-1.0..1.0)),
        (force, traction) in (vector(-1e6..1e6), vector(-1e6..1e6)),
        every in 1..1000usize,
    ) {
        let step = end / steps;
        let text = format!("
            title = 'Plate \u{3b1}'
            body = {{ young = {young:e}, poisson = {poisson:e}, density = {density:e}, size = {size:?}, cells = {cells:?}, order = {order} }}
            output.every = {every}
            [[support]]
            surface = 'side'
            kind = 'elastic'
            stiffness = {stiffness:?}
            damping = {damping:?}
            displacement = {shift:?}
            [[support]]
            surface = 'z-min'
            kind = 'pad'
            stiffness = {k:e}
            normal = {direction:?}
            [[support]]
            surface = 'top'
            kind = 'clamped'
            components = ['z', 'x']
            [impactor]
            mass = {mass:e}
            radius = {radius:e}
            young = {young2:e}
            poisson = {poisson2:e}
            speed = {speed:e}
            gap = {gap:e}
            point = {point:?}
            direction = {direction:?}
            [load]
            body_force = {force:?}
            traction = [{{ surface = 'y-max', value = {traction:?} }}]
            [time]
            end = {end:e}
            step = {step:e}
            beta = {beta:e}
            gamma = {gamma:e}
        ", k = stiffness[0]);
        let (scene, _) = Scene::parse("scene.toml", &text, &[]).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assert_eq!(scene.title, "Plate \u{3b1}");
        let body = &scene.body;
        prop_assert_eq!((body.struck(), body.order), (Material { young, poisson, density }, order));
        let Geometry::Box { size: found, planes, .. } = &body.geometry else {
            return Err(TestCaseError::fail("a size was given"));
        };
        prop_assert_eq!(*found, size);
        prop_assert_eq!(planes.each_ref().map(|planes| planes.len() - 1), cells);
        prop_assert_eq!(scene.output.every, every);
        let [elastic, pad, clamped] = &scene.supports[..] else {
            return Err(TestCaseError::fail("three supports were given"));
        };
        prop_assert_eq!(&elastic.kind, &SupportKind::Elastic { stiffness });
        prop_assert_eq!((elastic.damping, elastic.displacement), (damping, shift));
        prop_assert_eq!(&clamped.kind, &SupportKind::Clamped { components: [true, false, true] });
        let SupportKind::Pad { stiffness: k, normal } = &pad.kind else {
            return Err(TestCaseError::fail("the second support is a pad"));
        };
        prop_assert_eq!(*k, [stiffness[0]; 3]);
        prop_assert_eq!(*normal, scene.impactor.direction);
        let impactor = &scene.impactor;
        prop_assert_eq!((impactor.mass, impactor.radius, impactor.speed, impactor.gap), (mass, Some(radius), speed, gap));
        prop_assert_eq!(impactor.point, point);
        // Equation (15), written in another way, with a tolerance for the rounding of some ten operations.
        let modulus = 1.0 / ((1.0 - poisson.powi(2)) / young + (1.0 - poisson2.powi(2)) / young2);
        let expected = 4.0 * modulus * radius.sqrt() / 3.0;
        prop_assert!((impactor.stiffness / expected - 1.0).abs() < 1e-14);
        let dot = |a: Vec3, b: Vec3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let length = dot(direction, direction).sqrt();
        // Of unit length and parallel, to rounding.
        prop_assert!((dot(impactor.direction, impactor.direction) - 1.0).abs() < 1e-15);
        prop_assert!((dot(impactor.direction, direction) / length - 1.0).abs() < 1e-15);
        prop_assert_eq!(scene.load.body_force, force);
        prop_assert_eq!((scene.load.traction[0].surface.as_str(), scene.load.traction[0].value), ("y-max", traction));
        prop_assert_eq!((scene.time.end, scene.time.step), (end, Some(step)));
        prop_assert_eq!(scene.time.scheme, Scheme::Newmark { beta, gamma });
    }

    #[test]
    fn random_text_is_refused_and_not_fatal(text in "\\PC{0,200}|[\\[\\]{}=.,\"'#\n\r 0-9a-z]{0,200}") {
        survive(&text, &[]);
    }

    #[test]
    fn a_damaged_scene_is_not_fatal(
        good in prop::sample::select(vec![GOOD, MESH, SMALL, QUARTER]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), 0..12usize, scrap()), 1..4),
    ) {
        let mut letters: Vec<char> = good.chars().collect();
        for (at, length, scrap) in damage {
            let start = at.index(letters.len());
            let end = (start + length).min(letters.len());
            letters.splice(start..end, scrap.chars());
            if letters.is_empty() {
                break;
            }
        }
        survive(&letters.iter().collect::<String>(), &[]);
    }

    #[test]
    fn random_values_of_real_keys_are_not_fatal(
        good in prop::sample::select(vec![GOOD, MESH, SMALL, QUARTER]),
        settings in prop::collection::vec((key(), scrap()), 1..4),
    ) {
        let overrides: Vec<String> = settings.into_iter().map(|(key, value)| format!("{key}={value}")).collect();
        survive(good, &overrides);
    }

    #[test]
    fn extreme_numbers_are_not_fatal(
        settings in prop::collection::vec((number_key(), any::<f64>()), 1..6),
    ) {
        let overrides: Vec<String> = settings.into_iter().map(|(key, value)| format!("{key}={value:e}")).collect();
        survive(SMALL, &overrides);
    }

    #[test]
    fn random_overrides_are_not_fatal(overrides in prop::collection::vec("\\PC{0,20}|[a-z0-9.=\\[\\]{}\"' ]{0,20}", 1..3)) {
        survive(SMALL, &overrides);
    }
}

fn key() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "title",
        "body",
        "body.young",
        "body.poisson",
        "body.size",
        "body.size.2",
        "body.layer",
        "body.layer.1.thickness",
        "body.temperature",
        "material.interlayer.prony.0",
        "material.interlayer.shear",
        "body.cells",
        "body.grading",
        "body.symmetry",
        "contact.patch_radius",
        "contact.disc_radius",
        "body.mesh",
        "body.reduction",
        "support",
        "support.0",
        "support.0.stiffness",
        "support.0.kind",
        "support.2.components.0",
        "impactor.point",
        "impactor.point.1",
        "impactor.stiffness",
        "load.traction",
        "load.traction.0.value",
        "time",
        "time.end",
        "time.step",
        "time.beta",
        "solver.newton",
        "output.every",
        "accuracy",
    ])
}

fn number_key() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "body.young",
        "body.poisson",
        "body.density",
        "body.size.0",
        "body.size.2",
        "body.grading",
        "contact.patch_radius",
        "contact.disc_radius",
        "impactor.mass",
        "impactor.radius",
        "impactor.young",
        "impactor.speed",
        "impactor.stiffness",
        "time.end",
        "time.step",
    ])
}
