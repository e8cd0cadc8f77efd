//! What a scene comes to: defaults, the scenes of the paper, overrides, the keys of the reference.

#[path = "common/bad_scenes.rs"]
#[expect(dead_code, reason = "only the good scenes are used here")]
mod bad_scenes;

use std::path::Path;

use bad_scenes::{GOOD, MESH, QUARTER, SMALL};
use ricochet::Result;
use ricochet::scene::{Contact, Geometry, Newton, Scene, Scheme, Solver, SupportKind, Symmetry};

fn parse(text: &str, overrides: &[&str]) -> Result<Scene> {
    let overrides: Vec<String> = overrides.iter().map(|&given| given.into()).collect();
    Ok(Scene::parse("scene.toml", text, &overrides)?.0)
}

#[test]
fn defaults_are_those_of_the_reference() -> Result<()> {
    let scene = parse(SMALL, &[])?;
    assert_eq!(scene.title, "");
    assert!(scene.supports.is_empty() && scene.load.traction.is_empty());
    assert_eq!(scene.load.body_force, [0.0; 3]);
    assert_eq!(scene.body.order, 2);
    assert_eq!(scene.body.symmetry, Symmetry::Quarter { axes: [0, 1] });
    assert_eq!(scene.contact, Contact::Patch { radius: None });
    assert_eq!(scene.tolerance, 1e-2);
    assert_eq!(scene.solver, Solver { newton: Newton::Condensed, energy_gate: None });
    assert_eq!(scene.impactor.point, [0.0, 0.0, 0.05]);
    assert_eq!(scene.impactor.direction, [0.0, 0.0, -1.0]);
    assert_eq!(scene.impactor.gap, 0.0);
    assert_eq!(scene.time.step, None);
    let (beta, gamma) = (0.25, 0.5);
    assert_eq!(scene.time.scheme, Scheme::Newmark { beta, gamma });
    assert_eq!(scene.output.every, 1);
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

/// To the rounding of coordinates over a cell.
fn is_uniform(planes: &[f64]) -> bool {
    let cell = planes[1] - planes[0];
    planes.windows(2).all(|pair| ((pair[1] - pair[0]) / cell - 1.0).abs() < 1e-13)
}

fn planes(scene: &Scene) -> &[Vec<f64>; 3] {
    match &scene.body.geometry {
        Geometry::Box { planes, .. } => planes,
        Geometry::Gmsh(_) => panic!("no box"),
    }
}

fn numbers(scene: &Scene) -> [usize; 3] {
    planes(scene).each_ref().map(|planes| planes.len() - 1)
}

#[test]
fn cells_are_those_given_and_graded_as_given() -> Result<()> {
    let uniform = parse(SMALL, &["body.cells=[7,4,2]"])?;
    assert_eq!(numbers(&uniform), [7, 4, 2]);
    assert!(planes(&uniform).iter().all(|planes| is_uniform(planes)));
    let graded = parse(SMALL, &["body.cells=[7,4,3]", "body.grading=[1,2,4]", "impactor.point=[0.3,0,0.05]"])?;
    assert_eq!(numbers(&graded), [7, 4, 3]);
    let [x, y, z] = planes(&graded);
    assert!(is_uniform(x));
    // Halves of 0.75 m in parts of 1 and 2; 0.1 m in parts of 4, 2 and 1 from below. Three roundings.
    for (found, expected) in [(y, vec![-0.75, -0.25, 0.0, 0.25, 0.75]), (z, vec![-0.05, 0.05 / 7.0, 0.25 / 7.0, 0.05])]
    {
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
    }
    // Left out: the numbers of the default mesh.
    let left_out = parse(SMALL, &[])?;
    let graded = parse(SMALL, &["body.grading=3"])?;
    assert_eq!(numbers(&graded), numbers(&left_out));
    for planes in planes(&graded) {
        let edges = planes.windows(2).map(|pair| pair[1] - pair[0]);
        let (least, most) = edges.fold((f64::INFINITY, 0.0), |(l, m), e| (e.min(l), e.max(m)));
        assert!((f64::max(most, least) / least - 3.0).abs() < 1e-12);
    }
    Ok(())
}

/// A patch of any radius gets cells of at most half of it, on a body of any kind; a force at a point the uniform ones.
#[test]
fn cells_left_out_resolve_the_patch() -> Result<()> {
    for (overrides, radius) in [
        (vec![], 0.025),
        (vec!["contact.patch_radius=0.01"], 0.01),
        (vec!["impactor.point=[0.2,-0.5,0.05]"], 0.025),
        (vec!["impactor.direction=[-1,0,0]"], 0.05),
        (vec!["body.order=1"], 0.025),
    ] {
        let scene = parse(SMALL, &overrides)?;
        for (planes, x) in planes(&scene).iter().zip(scene.impactor.point) {
            let at = planes.iter().position(|plane| *plane == x);
            let at = at.unwrap_or_else(|| panic!("{overrides:?}: no plane at {x}"));
            let cells = planes[at.saturating_sub(1)..(at + 2).min(planes.len())].windows(2);
            let largest = cells.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
            // 1e-8 for what rounding leaves of a length.
            assert!(largest <= 0.5 * radius * (1.0 + 1e-8), "{overrides:?}: {largest}");
        }
        assert!(numbers(&scene).iter().product::<usize>() <= 30_000);
    }
    let point = parse(SMALL, &["contact.localization=point"])?;
    assert_eq!(numbers(&point), [20, 20, 2]);
    assert!(planes(&point).iter().all(|planes| is_uniform(planes)));
    Ok(())
}

const PARTNERS: &str = "support=[{surface='x-max',kind='clamped',displacement=[1e-3,0,2e-3]},\
    {surface='top',kind='pad',stiffness=1e9,normal=[0,0,1]},\
    {surface='x-min',kind='clamped',displacement=[-1e-3,0,2e-3]},{surface='side',kind='elastic',stiffness=[1,2,3],damping=[3,2,1]}]";

#[test]
fn symmetric_scenes_are_quartered() -> Result<()> {
    for (overrides, axes) in [
        (vec![], [0, 1]),
        (vec!["impactor.direction=[1,0,0]"], [1, 2]),
        (vec!["impactor.direction=[0,-1,0]", "body.cells=[4,5,2]"], [0, 2]),
        // Rounding is no tilt, and no shift.
        (vec!["impactor.direction=[1e-13,0,-1]", "impactor.point=[1e-10,-1e-10,0.05]"], [0, 1]),
        (vec![PARTNERS], [0, 1]),
        // The four sides one by one, whatever the order, are what "side" is.
        (
            vec![
                "support=[{surface='y-max',kind='elastic',stiffness=1},{surface='x-min',kind='elastic',stiffness=2},\
            {surface='y-min',kind='elastic',stiffness=1},{surface='x-max',kind='elastic',stiffness=2}]",
            ],
            [0, 1],
        ),
        (
            vec![
                "support=[{surface='side',kind='elastic',stiffness=1},{surface='x-max',kind='elastic',stiffness=1}, \
            {surface='x-min',kind='elastic',stiffness=1}]",
            ],
            [0, 1],
        ),
        // Faces with two names; two springs that pull apart are one that does not.
        (
            vec![
                "impactor.direction=[1,0,0]",
                "support=[{surface='top',kind='elastic',stiffness=1,displacement=[0,0,1]},\
            {surface='z-min',kind='elastic',stiffness=1,displacement=[0,0,-1]}]",
            ],
            [1, 2],
        ),
        (
            vec![
                "support=[{surface='side',kind='elastic',stiffness=1,displacement=[1,0,0]},\
            {surface='side',kind='elastic',stiffness=1,displacement=[-1,0,0]}]",
            ],
            [0, 1],
        ),
        (
            vec![
                "load={body_force=[0,0,-1],traction=[{surface='x-max',value=[1,0,2]},{surface='top',value=[0,0,1]},\
            {surface='x-min',value=[-1,0,2]}]}",
            ],
            [0, 1],
        ),
    ] {
        let scene = parse(QUARTER, &overrides)?;
        assert_eq!(scene.body.symmetry, Symmetry::Quarter { axes }, "{overrides:?}");
        // Both cut planes are planes of the grid, which is its own mirror image.
        for axis in axes {
            let planes = &planes(&scene)[axis];
            assert!(planes.iter().eq(planes.iter().rev().map(|x| -x).collect::<Vec<_>>().iter()), "{planes:?}");
            assert!(planes.contains(&0.0));
            assert_eq!((scene.impactor.point[axis], scene.impactor.direction[axis]), (0.0, 0.0));
        }
    }
    Ok(())
}

#[test]
fn other_scenes_are_whole_and_tell_why() -> Result<()> {
    for (given, part) in [
        ("impactor.point=[0.1,0,0.05]", "not in the centre"),
        ("impactor.direction=[0,1e-9,-1]", "along the normal"),
        ("body.cells=[5,4,2]", "along x, 5, is odd"),
        (
            "support=[{surface='y-max',kind='elastic',stiffness=1}]",
            "support.0 on \"y-max\" has no mirror image across y = 0",
        ),
        // A partner of another stiffness, damping, kind, sign.
        (
            "support=[{surface='x-max',kind='elastic',stiffness=1},{surface='x-min',kind='elastic',stiffness=2}]",
            "support.0",
        ),
        (
            "support=[{surface='x-max',kind='elastic',stiffness=1},{surface='x-min',kind='elastic',stiffness=1,damping=1}]",
            "x = 0",
        ),
        (
            "support=[{surface='x-max',kind='elastic',stiffness=1},{surface='x-min',kind='pad',stiffness=1,normal=[-1,0,0]}]",
            "x = 0",
        ),
        (
            "support=[{surface='x-max',kind='elastic',stiffness=1,displacement=[1,0,0]},{surface='x-min',kind='elastic',stiffness=1,displacement=[1,0,0]}]",
            "x = 0",
        ),
        (
            "support=[{surface='x-max',kind='elastic',stiffness=1,displacement=[0,1,0]},{surface='x-min',kind='elastic',stiffness=1,displacement=[0,1,0]}]",
            "y = 0",
        ),
        // One sign only is resisted.
        ("support=[{surface='bottom',kind='pad',stiffness=1,normal=[0.1,0,-1]}]", "support.0 on \"bottom\""),
        ("support=[{surface='side',kind='clamped',displacement=[0,1,0]}]", "y = 0"),
        (
            "support=[{surface='x-max',kind='clamped',components=['x']},{surface='x-min',kind='clamped',components=['x','y']}]",
            "x = 0",
        ),
        // On the edges between them the last one counts, and that is another one on each side.
        (
            "support=[{surface='x-max',kind='clamped',components=['z']},{surface='side',kind='clamped',components=['z'],displacement=[0,0,1]},\
          {surface='x-min',kind='clamped',components=['z']}]",
            "x = 0",
        ),
        ("load.body_force=[0,1,0]", "load.body_force has a component along y"),
        ("load.traction=[{surface='side',value=[1,0,0]}]", "load.traction.0 on \"side\""),
        (
            "load.traction=[{surface='x-max',value=[1,0,0]},{surface='x-min',value=[1,0,0]}]",
            "load.traction.0 on \"x-max\"",
        ),
    ] {
        let scene = parse(QUARTER, &["body.symmetry=auto", given])?;
        let Symmetry::None { reason: Some(reason) } = &scene.body.symmetry else { panic!("{given}: quartered") };
        assert!(reason.contains(part), "{given}: {reason}");
        let none = parse(QUARTER, &["body.symmetry=none", given])?;
        assert_eq!(none.body.symmetry, Symmetry::None { reason: None });
        assert!(parse(QUARTER, &[given]).is_err(), "{given}: a quarter");
    }
    Ok(())
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
        let Geometry::Box { size: found, planes } = &scene.body.geometry else {
            panic!("{name} is no box");
        };
        assert_eq!(*found, size);
        assert!(planes.iter().all(|planes| is_uniform(planes)), "{name}");
        assert_eq!(scene.body.symmetry, Symmetry::None { reason: None });
        assert_eq!((scene.contact, scene.solver.newton), (Contact::Point, Newton::Full));
        assert_eq!((scene.body.young, scene.body.poisson, scene.body.density), (70e9, 0.23, 2500.0));
        assert_eq!((scene.impactor.mass, scene.impactor.radius), (52.0, 0.05));
        assert_eq!(scene.impactor.point, [0.0, 0.0, size[2] / 2.0]);
        assert_eq!((scene.time.end, scene.time.step), (end, Some(2e-5)));
        // k0 of the reference solutions; the last digits may differ by the order of the operations.
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
    let reference = include_str!("../docs/scene.md");
    // The keys that a table knows are named when it is given one that it does not.
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
    let reference = include_str!("../docs/scene.md");
    let example = reference.split("```").nth(1).and_then(|block| block.strip_prefix("toml\n"));
    parse(example.unwrap_or_default(), &[])?;
    Ok(())
}
