//! Cells of a scene's box, and its division into quarters.

use crate::bad_scenes::{QUARTER, SMALL};
use ricochet::Result;
use ricochet::scene::{Geometry, Scene, Symmetry};

fn parse(text: &str, overrides: &[&str]) -> Result<Scene> {
    let overrides: Vec<String> = overrides.iter().map(|&given| given.into()).collect();
    Ok(Scene::parse("scene.toml", text, &overrides)?.0)
}

/// Whether all cells have the same size, to the rounding of the coordinates.
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
    // Halves of 0.75 m divided 1:2, and 0.1 m divided 4:2:1 from below. The tolerance is three roundings.
    for (found, expected) in [(y, vec![-0.75, -0.25, 0.0, 0.25, 0.75]), (z, vec![-0.05, 0.05 / 7.0, 0.25 / 7.0, 0.05])]
    {
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
    }
    // Without the key, the numbers of cells are the default ones.
    let left_out = parse(SMALL, &[])?;
    let graded = parse(SMALL, &["body.grading=3"])?;
    assert_eq!(numbers(&graded), numbers(&left_out));
    for planes in planes(&graded) {
        let edges = planes.windows(2).map(|pair| pair[1] - pair[0]);
        let (least, most) = edges.fold((f64::INFINITY, 0.0), |(l, m), e| (e.min(l), e.max(m)));
        assert!((most / least - 3.0f64).abs() < 1e-12);
    }
    Ok(())
}

/// For a patch of any radius the default cells are at most half of it, for any body; for a point force they are
/// uniform.
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
            // 1e-8 for the rounding of a length.
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
        // A direction or a point off by rounding is neither tilted nor shifted.
        (vec!["impactor.direction=[1e-13,0,-1]", "impactor.point=[1e-10,-1e-10,0.05]"], [0, 1]),
        (vec![PARTNERS], [0, 1]),
        // The four sides given separately, in any order, are the same as "side".
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
        // Pads on two opposite ends.
        (
            vec![
                "support=[{surface='x-max',kind='pad',stiffness=1,normal=[1,0,0]},{surface='x-min',kind='pad',stiffness=1,normal=[-1,0,0]}]",
            ],
            [0, 1],
        ),
        // Faces with two names; two springs in opposite directions add up to a symmetric support.
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
        // Both symmetry planes are planes of the grid, which is symmetric.
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
        // The opposite support differs in stiffness, damping, kind or sign.
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
        // Only one sign is resisted.
        ("support=[{surface='bottom',kind='pad',stiffness=1,normal=[0.1,0,-1]}]", "support.0 on \"bottom\""),
        ("support=[{surface='side',kind='clamped',displacement=[0,1,0]}]", "y = 0"),
        (
            "support=[{surface='x-max',kind='clamped',components=['x']},{surface='x-min',kind='clamped',components=['x','y']}]",
            "x = 0",
        ),
        // On the edges between the surfaces the last support counts, and it differs between the two sides.
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
        let (Symmetry::None { reason: Some(reason) } | Symmetry::Parts { reason, .. }) = &scene.body.symmetry else {
            panic!("{given}: quartered")
        };
        assert!(reason.contains(part), "{given}: {reason}");
        let none = parse(QUARTER, &["body.symmetry=none", given])?;
        assert_eq!(none.body.symmetry, Symmetry::None { reason: None });
        assert!(parse(QUARTER, &[given]).is_err(), "{given}: a quarter");
    }
    Ok(())
}
