//! Choices of `model = "auto"`: a half-space only if its error is as estimated, and no theory that cannot model the
//! scene.

use crate::glass::plate;
use crate::modelled::{make_model, parse, run_scene};
use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::scene;
use ricochet::space::spline;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![
    a_half_space_is_within_its_estimated_error,
    what_rules_a_half_space_out,
    what_rules_plates_out,
    strips_are_for_plates,
    sides_held_unevenly_are_for_solids,
    a_plate_stands_for_a_solid_too_large_for_splines,
    a_relaxing_plate_of_one_material_is_a_solid
];

/// A scene with a small steel ball on a glass plate.
fn ball(impactor: &str, rest: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.4, 0.4, 0.02]\n\
         [impactor]\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n{impactor}\n[time]\nend = 8e-5\n{rest}"
    )
}

/// Comparison with Mindlin's plate, which is within 1e-3 of a solid here. The estimate is the sum of the worst effects
/// of waves, of the plate's motion and of its thickness. The error is below the estimate, by not much more than a
/// factor of two.
fn a_half_space_is_within_its_estimated_error(session: &Session) {
    let comm = session.world();
    for (mass, radius) in [(1e-4, 0.002), (3e-4, 0.003), (1e-3, 0.005), (2e-3, 0.006)] {
        let text = ball(&format!("mass = {mass:e}\nradius = {radius}"), "[accuracy]\ntolerance = 1e-1\n");
        let auto = make_model(&comm, &parse(&text));
        assert_eq!(auto.theory, scene::Model::HalfSpace);
        let estimate = auto.error.total().expect("auto tells its error").first_contact;
        let fine = text.replace("tolerance = 1e-1", "tolerance = 1e-3");
        let [plate, half] = ["mindlin", "half-space"]
            .map(|name| run_scene(&comm, &parse(&fine.replace("[body]", &format!("[body]\nmodel = \"{name}\"")))));
        let (error, _) = plate.difference(&half);
        println!("  {mass:e} kg, {radius} m: error {error:.2e}, estimate {estimate:.2e}");
        assert!(error < estimate && estimate < 2.5 * error, "{mass:e} kg: {error:e}, {estimate:e}");
    }
}

/// A half-space is excluded by an impact near an edge, by forces that move the body before or during the impact, by a
/// strength or a tolerance of stresses, and by an estimate above the tolerance.
fn what_rules_a_half_space_out(session: &Session) {
    let comm = session.world();
    let light = "mass = 1e-4\nradius = 0.002";
    let tolerance = "[accuracy]\ntolerance = 1e-1\n";
    // The smallest plate whose edges are too far for their echoes to come back within the contact.
    let small = |text: String| text.replace("[0.4, 0.4", "[0.2, 0.2");
    let theory = |impactor: &str, rest: &str| make_model(&comm, &parse(&small(ball(impactor, rest)))).theory;
    assert_eq!(theory(light, tolerance), scene::Model::HalfSpace);
    for (impactor, rest) in [
        ("mass = 1e-4\nradius = 0.002\npoint = [0.085, 0.0, 0.01]", tolerance.to_owned()),
        ("mass = 1.0\nradius = 0.02", tolerance.to_owned()),
        (light, format!("{tolerance}[strength]\ntension = 45e6\n")),
        (light, format!("{tolerance}quantity = \"stress\"\n")),
        (light, format!("{tolerance}[load]\nbody_force = [0.0, 0.0, -1e5]\n")),
        (light, format!("{tolerance}[[load.traction]]\nsurface = \"top\"\nvalue = [0.0, 0.0, -1e3]\n")),
        (
            light,
            format!(
                "{tolerance}[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\ndisplacement = [0.0, 0.0, 1e-4]\n"
            ),
        ),
    ] {
        assert_ne!(theory(impactor, &rest), scene::Model::HalfSpace, "{impactor} {rest}");
    }
}

/// A free glass plate that Mindlin's theory models within a tenth, and the changes that require a solid. Its cells are
/// coarse if they do not matter, since it is not run.
fn what_rules_plates_out(session: &Session) {
    let comm = session.world();
    let text = |body: &str, impactor: &str, rest: &str| {
        format!(
            "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n{body}\n\
             [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n{impactor}\n\
             [time]\nend = 1e-3\n{rest}\n[accuracy]\ntolerance = 1e-1\n"
        )
    };
    let plate = "size = [1.0, 1.0, 0.04]";
    let coarse = "size = [1.0, 1.0, 0.04]\ncells = [8, 8, 1]\norder = 1";
    let found = |text: &str| {
        let model = make_model(&comm, &parse(text));
        (model.theory, model.reason.unwrap_or_default())
    };
    assert_eq!(found(&text(plate, "", "")).0, scene::Model::Mindlin);
    assert_eq!(found(&text(plate, "", "scheme = \"newmark\"\nstep = 2e-5")).0, scene::Model::Mindlin);
    let newmark = "scheme = \"newmark\"\nstep = 2e-5";
    for (body, impactor, rest, reason) in [
        (
            coarse,
            "",
            format!(
                "{newmark}\n[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nstiffness = 1e9\nnormal = [0.1, 0, -1]"
            ),
            "is a pad that acts along the plate",
        ),
        (
            coarse,
            "",
            format!("{newmark}\n[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ndisplacement = [0.0, 0.0, 1e-4]"),
            "a clamp has a displacement",
        ),
        (coarse, "direction = [0.1, 0.0, -1.0]", String::new(), "normal of a face"),
        (coarse, "", "[load]\nbody_force = [1.0, 0.0, 0.0]".to_owned(), "in the plate's plane"),
        (plate, "point = [0.49, 0.0, 0.02]", String::new(), "from an edge"),
        ("size = [0.1, 0.1, 0.04]", "", String::new(), "less than 4 times its thickness"),
        (coarse, "", "step = 2e-5\n[solver]\nnewton = \"full\"".to_owned(), "for solids only"),
        (coarse, "", "scheme = \"central-difference\"".to_owned(), "lumped mass"),
        (coarse, "", String::new(), "cells or their order"),
        (
            coarse,
            "",
            "[[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e12]".to_owned(),
            "presses the thickness together",
        ),
        (plate, "", "[contact]\npatch_radius = 0.01".to_owned(), "patch_radius is given"),
        (plate, "", format!("{newmark}\n[contact]\nlocalization = \"point\""), "a force at a point"),
    ] {
        let (theory, why) = found(&text(body, impactor, &rest));
        assert_eq!(theory, scene::Model::Solid, "{reason}: {why}");
        assert!(why.contains(reason), "{reason}: {why}");
    }
}

/// A viscoelastic plate of one polymer is computed as a solid, and the stated reason names the plate theory that may be
/// chosen.
fn a_relaxing_plate_of_one_material_is_a_solid(session: &Session) {
    let text = "[body]\nsize = [0.4, 0.4]\n[[body.layer]]\nthickness = 0.04\nmaterial = \"polymer\"\n\
                [material.polymer]\ndensity = 1190.0\nbulk = 4e9\nshear = 1e9\nprony = [{ modulus = 0.5e9, time = 5e-4 }]\n\
                [impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
                [time]\nend = 1e-4\n[accuracy]\ntolerance = 1e-1\n";
    let auto = make_model(&session.world(), &parse(text));
    assert_eq!(auto.theory, scene::Model::Solid);
    let why = auto.reason.expect("a reason");
    assert!(why.contains("viscoelastic") && why.contains("\"layerwise\""), "{why}");
    let named = text.replace("size = [0.4", "model = \"layerwise\"\nsize = [0.4");
    assert_eq!(make_model(&session.world(), &parse(&named)).theory, scene::Model::Layerwise);
}

/// Narrow, usual and wide rubber strips under the edges: `auto` uses a plate, which is within the tolerance of the
/// solid.
fn strips_are_for_plates(session: &Session) {
    let comm = session.world();
    for width in [0.005, 0.02, 0.1] {
        let strip = format!(
            "[[support]]\nsurface = \"bottom\"\nwithin = {{ rim = {width} }}\nkind = \"elastic\"\nstiffness = [0, 0, 5e8]\n"
        );
        let text = plate("size = [0.5, 0.5, 0.02]", "end = 2.5e-3", &strip);
        let tolerance = parse(&text).tolerance;
        let auto = make_model(&comm, &parse(&text));
        assert_eq!(auto.theory, scene::Model::Mindlin, "{width}: {:?}", auto.reason);
        let solid = text.replace("size = [0.5", "model = \"solid\"\nsize = [0.5");
        let (error, _) = run_scene(&comm, &parse(&solid)).difference(&run_scene(&comm, &parse(&text)));
        println!(
            "  strips of {width} m: error {error:.1e}, estimate {:.1e}",
            auto.error.total().expect("auto tells its error").first_contact
        );
        assert!(error < tolerance, "{width}: {error:e}");
    }
}

/// A side that is supported only below its middle plane stretches the plate when it bends.
fn sides_held_unevenly_are_for_solids(session: &Session) {
    let comm = session.world();
    let held = |low: f64, stiffness: &str| {
        let part = format!("within = {{ box = [[-1, -1, {low}], [1, 1, 0]] }}");
        let support = format!("[[support]]\nsurface = \"side\"\n{part}\nkind = \"elastic\"\nstiffness = {stiffness}\n");
        parse(&plate("size = [0.5, 0.5, 0.02]", "end = 1e-4", &(support + "[accuracy]\ntolerance = 0.2\n")))
    };
    let auto = make_model(&comm, &held(-0.01, "1e9"));
    assert_eq!(auto.theory, scene::Model::Solid);
    assert!(
        auto.reason.as_deref().is_some_and(|reason| reason.contains("not even across the thickness")),
        "{:?}",
        auto.reason
    );
    // For supports normal to the plate the height does not matter.
    assert_eq!(make_model(&comm, &held(-0.01, "[0, 0, 1e9]")).theory, scene::Model::Mindlin);
}

/// A short impact on the whole of a wide plate, which would need 78,408 unknowns with splines: Mindlin's plate is used,
/// and its error, which is above its share of the tolerance, is reported. A quarter of the plate can be computed with
/// splines.
fn a_plate_stands_for_a_solid_too_large_for_splines(session: &Session) {
    let comm = session.world();
    let text = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.4, 0.4, 0.01]\nsymmetry = \"none\"\n\
                [impactor]\nmass = 0.05\nradius = 0.02\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 1e-4\n\
                [[support]]\nsurface = \"side\"\nkind = \"clamped\"\n[accuracy]\ntolerance = 1e-3\n";
    let whole = parse(text);
    let reason = spline::admits(&whole).expect_err("splines would take too many unknowns");
    let quarter = parse(&text.replace("symmetry = \"none\"\n", ""));
    assert_eq!(spline::admits(&quarter), Ok(()));
    let auto = make_model(&comm, &whole);
    assert_eq!(auto.theory, scene::Model::Mindlin, "{:?}", auto.reason);
    let why = auto.reason.unwrap_or_default();
    assert!(why.contains(&reason) && why.contains("but used"), "{why}");
    let estimate = auto.error.total().expect("auto tells its error").first_contact;
    assert!(
        auto.error.causes(ricochet::scene::Measure::Acceleration).contains(&"theory") && estimate > whole.tolerance,
        "{estimate:e}"
    );
}
