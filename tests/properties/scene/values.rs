//! Values of scenes after reading: defaults, the scenes of the paper, overrides, the keys of the reference.

use std::path::Path;

use crate::bad_scenes::{GOOD, MESH, SMALL};
use ricochet::Result;
use ricochet::form::Material;
use ricochet::scene::{
    Contact, Geometry, Model, Newton, Output, Probe, Reduction, Scene, Scheme, Solver, SupportKind, Symmetry,
};

fn parse(text: &str, overrides: &[&str]) -> Result<Scene> {
    let overrides: Vec<String> = overrides.iter().map(|&given| given.into()).collect();
    Ok(Scene::parse("scene.toml", text, &overrides)?.0)
}

/// A point of two numbers is on the face that is hit, whatever the thickness of the body is.
#[test]
fn a_point_of_two_numbers_is_on_the_face_that_is_hit() -> Result<()> {
    let laminate = crate::bad_scenes::layers::LAMINATE;
    for (text, overrides, point) in [
        (SMALL, &["impactor.point=[0.3,-0.2]"][..], [0.3, -0.2, 0.05]),
        (SMALL, &["impactor.point=[0.3,-0.2]", "body.size.2=0.02"], [0.3, -0.2, 0.01]),
        (SMALL, &["impactor.point=[0.3,-0.2]", "impactor.direction=[0,0.3,0.9]"], [0.3, -0.2, -0.05]),
        (SMALL, &["impactor.point=[0.3,0.02]", "impactor.direction=[0,1,0]"], [0.3, -0.75, 0.02]),
        (laminate, &["impactor.point=[0.1,0]", "body.layer.0.thickness=0.00914"], [0.1, 0.0, 0.01]),
    ] {
        let found = parse(text, overrides)?.impactor.point;
        // Tolerance: rounding of the sum of the thicknesses.
        assert!(found.iter().zip(point).all(|(x, y)| (x - y).abs() < 1e-15), "{overrides:?}: {found:?}");
    }
    // The layer that is hit is the one at the face.
    let from_below = parse(laminate, &["impactor.point=[0.1,0]", "impactor.direction=[0,0,1]"])?;
    assert_eq!(from_below.body.composition.struck_layer, 2);
    Ok(())
}

#[test]
fn defaults_are_those_of_the_reference() -> Result<()> {
    let scene = parse(SMALL, &[])?;
    assert_eq!(scene.title, "");
    assert!(scene.supports.is_empty() && scene.load.traction.is_empty());
    assert_eq!(scene.load.body_force, [0.0; 3]);
    assert_eq!((scene.body.model, scene.body.reduction), (Model::Auto, Reduction::Auto));
    assert_eq!(scene.body.order, 2);
    assert_eq!(scene.body.symmetry, Symmetry::Quarter { axes: [0, 1] });
    assert_eq!(scene.contact, Contact::Patch { radius: None, disc: None });
    assert_eq!(scene.tolerance, 1e-2);
    assert_eq!(scene.solver, Solver { newton: Newton::Condensed, energy_gate: None });
    assert_eq!(scene.impactor.point, [0.0, 0.0, 0.05]);
    assert_eq!(scene.impactor.direction, [0.0, 0.0, -1.0]);
    assert_eq!(scene.impactor.gap, 0.0);
    assert_eq!(scene.time.step, None);
    assert!(scene.time.modal);
    let (beta, gamma) = (0.25, 0.5);
    let newmark = parse(SMALL, &["time.scheme=newmark"])?.time;
    assert_eq!((newmark.modal, newmark.scheme), (false, Scheme::Newmark { beta, gamma }));
    assert_eq!(
        scene.output,
        Output {
            every: 1,
            checkpoint_steps: None,
            checkpoint_minutes: Some(10.0),
            fields: None,
            stress: true,
            probes: Vec::new()
        }
    );
    let schemes = ["generalized-alpha", "central-difference"].map(|name| format!("time.scheme={name}"));
    let rho_inf = 0.8;
    assert_eq!(parse(SMALL, &[&schemes[0]])?.time.scheme, Scheme::GeneralizedAlpha { rho_inf });
    let allow_unstable = false;
    assert_eq!(parse(SMALL, &[&schemes[1]])?.time.scheme, Scheme::CentralDifference { allow_unstable });
    let supported = parse(MESH, &[])?;
    let held = SupportKind::Clamped { components: [true; 3] };
    assert_eq!(supported.supports[0].kind, held);
    assert_eq!(supported.supports[0].damping, [0.0; 3]);
    assert_eq!(supported.supports[0].displacement, [0.0; 3]);
    Ok(())
}

/// Points that are on a face of the box, up to the digits of typed numbers, are placed on it. For a mesh file this is
/// checked with the mesh.
#[test]
fn probes_and_fields() -> Result<()> {
    let probes = "output.probes=[{ name = \"bottom ½\", point = [0.1, 0, -0.05000000001] }, { point = [-0.75, 1e-13, 0], name = \"side\" }]";
    let output = parse(SMALL, &[probes, "output.fields=50"])?.output;
    let probe = |name: &str, point| Probe { name: name.into(), point };
    let expected = vec![probe("bottom ½", [0.1, 0.0, -0.05]), probe("side", [-0.75, 0.0, 0.0])];
    assert_eq!(
        output,
        Output {
            every: 1,
            checkpoint_steps: None,
            checkpoint_minutes: Some(10.0),
            fields: Some(50),
            stress: true,
            probes: expected
        }
    );
    let far = parse(MESH, &["output.probes=[{ name = \"far\", point = [7, 8, 9] }]"])?.output;
    assert_eq!(far.probes, [probe("far", [7.0, 8.0, 9.0])]);
    assert!(far.has_points() && !parse(MESH, &[])?.output.has_points());
    Ok(())
}

/// Modal coordinates are the default unless something excludes them; then it is Newmark's method.
#[test]
fn modal_coordinates_are_the_default_where_nothing_rules_them_out() -> Result<()> {
    for (good, given, modal) in [
        (SMALL, "body.model=solid", true),
        (SMALL, "body.model=half-space", true),
        (SMALL, "body.reduction=60", true),
        (SMALL, "time.step=1e-5", true),
        (MESH, "support.0.displacement=[0,0,0]", true),
        (SMALL, "time.scheme=modal", true),
        (SMALL, "body.reduction=none", false),
        (SMALL, "solver.newton=full", false),
        (SMALL, "time.beta=0.25", false),
        (SMALL, "time.gamma=0.5", false),
        (SMALL, "time.scheme=energy", false),
        (SMALL, "support=[{surface='bottom',kind='pad',stiffness=1e9,normal=[0,0,-1]}]", true),
        (SMALL, "support=[{surface='bottom',kind='pad',stiffness=1e14,normal=[0,0,-1]}]", false),
        (MESH, "support.0.displacement=[0,0,1e-4]", false),
    ] {
        let time = parse(good, &[given])?.time;
        assert_eq!(time.modal, modal, "{given}");
        assert_eq!(time.scheme == Scheme::Newmark { beta: 0.25, gamma: 0.5 }, !given.ends_with("energy"), "{given}");
    }
    // Without unknowns there is nothing to integrate in time steps, whatever the reduction.
    assert!(parse(SMALL, &["body.model=infinite-plate", "body.reduction=none"])?.time.modal);
    Ok(())
}

/// Whether all cells have the same size, to the rounding of the coordinates.
fn is_uniform(planes: &[f64]) -> bool {
    let cell = planes[1] - planes[0];
    planes.windows(2).all(|pair| ((pair[1] - pair[0]) / cell - 1.0).abs() < 1e-13)
}

#[test]
fn the_paper_s_scenes_have_the_paper_s_plates_and_impactor() -> Result<()> {
    for (name, size, end) in [
        ("plate100", [1.5, 1.5, 0.1], 2.5e-3),
        ("plate40", [1.5, 1.5, 0.04], 10e-3),
        ("plate20", [0.5, 0.5, 0.02], 10e-3),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}.toml"));
        let (scene, source) = Scene::read(&path, &["support.0.stiffness=1e7".into()])?;
        let Geometry::Box { size: found, planes, .. } = &scene.body.geometry else {
            panic!("{name} is no box");
        };
        assert_eq!(*found, size);
        assert!(planes.iter().all(|planes| is_uniform(planes)), "{name}");
        assert_eq!(scene.body.symmetry, Symmetry::None { reason: None });
        assert_eq!((scene.contact, scene.solver.newton), (Contact::Point, Newton::Full));
        assert_eq!((scene.body.model, scene.body.reduction), (Model::Solid, Reduction::None));
        assert_eq!((scene.time.modal, scene.time.scheme), (false, Scheme::Newmark { beta: 0.25, gamma: 0.5 }));
        assert_eq!(scene.body.struck(), Material { young: 70e9, poisson: 0.23, density: 2500.0 });
        assert_eq!(scene.body.composition.uniform(), Some(&scene.body.struck()));
        assert_eq!((scene.impactor.mass, scene.impactor.radius), (52.0, Some(0.05)));
        assert_eq!(scene.impactor.point, [0.0, 0.0, size[2] / 2.0]);
        assert_eq!((scene.time.end, scene.time.step), (end, Some(2e-5)));
        // k0 of the reference solutions; the last digits may differ with the order of the operations.
        assert!((scene.impactor.stiffness / 16690188300.054407 - 1.0).abs() < 1e-14);
        assert_eq!(scene.supports.len(), 1);
        let stiffness = [1e7; 3];
        assert_eq!(scene.supports[0].kind, SupportKind::Elastic { stiffness });
        assert!(source.text().contains("# k, N/m3"), "the comment went lost");
    }
    Ok(())
}

#[test]
fn a_mesh_file_is_relative_to_the_scene_file() -> Result<()> {
    let folder = tempfile::tempdir().map_err(|error| ricochet::Error::io(Path::new("tmp"), error))?;
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, MESH).map_err(|error| ricochet::Error::io(&path, error))?;
    let (scene, _) = Scene::read(&path, &[])?;
    let expected = folder.path().join("meshes/plate.msh");
    assert_eq!(scene.body.geometry, Geometry::Gmsh(expected));
    let here = Geometry::Gmsh("meshes/plate.msh".into());
    assert_eq!(parse(MESH, &[])?.body.geometry, here);
    Ok(())
}

#[test]
fn an_override_is_as_good_as_an_edit() -> Result<()> {
    for (given, from, to) in [
        ("time.step=1e-6", "step = 1e-5", "step = 1e-6"),
        ("support.1.stiffness=3e9", "[0, 0, 2e9]", "3e9"),
        ("support.1.stiffness.2=3e9", "[0, 0, 2e9]", "[0, 0, 3e9]"),
        ("title=Another plate", "\"Plate\"", "\"Another plate\""),
        ("support.0.surface=top", "\"side\"", "\"top\""),
        ("body.mesh=plate.msh", "size = [1.5, 1.5, 0.1]\ncells = [20, 20, 2]", "mesh = 'plate.msh'"),
        ("impactor.stiffness=1e10", "gap = 0.0", "gap = 0.0\nstiffness = 1e10"),
        ("load.traction.0.value.1=7", "value = [0.0, 0.0, -1e3]", "value = [0.0, 7, -1e3]"),
    ] {
        assert_eq!(GOOD.matches(from).count(), 1, "{from}");
        let edited = parse(&GOOD.replacen(from, to, 1), &[])?;
        let base = match given.starts_with("body.mesh") {
            true => GOOD.replacen(from, "", 1),
            false => GOOD.to_owned(),
        };
        assert_eq!(parse(&base, &[given])?, edited, "{given}");
    }
    Ok(())
}

#[test]
fn overrides_make_missing_tables_and_the_last_one_wins() -> Result<()> {
    let scene =
        parse(SMALL, &["output.every=3", "output.every=5", "load={body_force=[0,0,-9]}", "load.body_force.0=1"])?;
    assert_eq!(scene.output.every, 5);
    assert_eq!(scene.load.body_force, [1.0, 0.0, -9.0]);
    assert!(parse(GOOD, &["support=[]"])?.supports.is_empty());
    Ok(())
}

#[test]
fn the_stored_text_repeats_the_scene() -> Result<()> {
    let overrides: Vec<String> =
        ["support=[]", "time.step=1e-6", "load.traction=[{surface='top',value=[0,0,1]}]", "title=a \"b\""]
            .map(Into::into)
            .into();
    for text in [GOOD, SMALL] {
        let (scene, source) = Scene::parse("scene.toml", text, &overrides)?;
        let (again, same) = Scene::parse("scene.toml", source.text(), &[])?;
        assert_eq!(again, scene);
        assert_eq!(same.text(), source.text());
    }
    Ok(())
}

#[test]
fn an_error_found_later_points_into_the_scene() -> Result<()> {
    let (_, source) = Scene::parse("scene.toml", MESH, &["time.step=1e-5".into()])?;
    let error = source.error("support.0.surface", "the mesh has no surface \"rim\"", "its surfaces: \"side\"");
    assert_eq!((error.key(), error.line()), ("support.0.surface", 8));
    let report = ricochet::Error::from(error).report(false);
    assert!(report.contains("surface = \"rim\"") && report.contains("its surfaces"), "{report}");
    Ok(())
}

#[test]
fn the_reference_lists_every_key() {
    let reference = include_str!("../../../docs/scene.md");
    // If a table gets an unknown key, the message names the known ones.
    for table in [
        "",
        "body.",
        "support.0.",
        "impactor.",
        "contact.",
        "load.",
        "load.traction.0.",
        "time.",
        "accuracy.",
        "solver.",
        "output.",
    ] {
        let unknown = format!("{table}qqqqqqqqqqqq=1");
        let Err(error) = Scene::parse("scene.toml", GOOD, &[unknown]) else {
            panic!("an unknown key was accepted");
        };
        let known: Vec<&str> = error.advice().split('`').skip(1).step_by(2).collect();
        assert!(!known.is_empty());
        for key in known {
            let path = format!("{table}{key}").replace(".0.", ".");
            let listed = ["`{}` |", "**`[{}]`**", "**`[[{}]]`**"];
            assert!(listed.iter().any(|form| reference.contains(&form.replace("{}", &path))), "{path}");
        }
    }
}

#[test]
fn the_reference_s_example_is_a_scene() -> Result<()> {
    let reference = include_str!("../../../docs/scene.md");
    let example = reference.split("```").nth(1).and_then(|block| block.strip_prefix("toml\n"));
    parse(example.unwrap_or_default(), &[])?;
    Ok(())
}

/// A very long line is not printed in full: neither if the fault is at its end, nor if the fault is in a neighbouring
/// line.
#[test]
fn long_lines_are_not_drawn() {
    let probes: String = (0..4000).map(|i| format!("{{ name = \"p{i}\", point = [0, 0, 0] }}, ")).collect();
    for last in ["{ name = \"off\", point = [9, 0, 0] }]\n", "]\nevery = 0\n"] {
        let text = format!("{SMALL}\n[output]\nprobes = [{probes}{last}");
        let error = Scene::parse("scene.toml", &text, &[]).expect_err("a fault");
        let report = ricochet::Error::from(error).report(false);
        assert!(report.len() < 3000 && report.contains("output."), "{} bytes", report.len());
    }
}

/// The stiffness of a clamp on a part of a surface follows from the part that lies on the surface, however large the
/// given box is.
#[test]
fn parts_are_as_wide_as_what_they_have_of_the_surface() {
    let width = |surface: &str, within: &str| {
        let text = format!("{SMALL}\n[[support]]\nsurface = \"{surface}\"\nwithin = {within}\nkind = \"clamped\"\n");
        let (scene, _) = Scene::parse("scene.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let support = scene.supports.last().expect("a support");
        support.within.expect("a part").width(&scene.body.geometry, surface)
    };
    let (scene, _) = Scene::parse("scene.toml", SMALL, &[]).expect("a scene");
    let Geometry::Box { size: [x, y, _], .. } = scene.body.geometry else { panic!("a box") };
    let beyond = 0.3 * x;
    let strip = width("bottom", &format!("{{ box = [[-1e3, -1e3, -1e3], [-{beyond}, 1e3, 1e3]] }}"));
    assert!((strip / (0.5 * x - beyond) - 1.0).abs() < 1e-12, "{strip}");
    assert_eq!(width("bottom", "{ rim = 1e3 }"), 0.5 * x.min(y));
    assert_eq!(width("bottom", &format!("{{ disc = {{ centre = [0, 0, 0], radius = {x} }} }}")), x);
}
