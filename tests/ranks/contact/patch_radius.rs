//! Choice of the patch radius, and radii that are refused.

use crate::bricks;
use crate::patches;
use mpi_test::{Test, tests};

use crate::patches::{POISSON, SIZE, YOUNG, boxed, made, reading, refused, sample, scene, turn, turned};
use petsc_wrap::Session;
use ricochet::contact::{Localization, Reason, hertz};
use ricochet::element::Shape;
use ricochet::mesh::Mesh;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] =
    tests![radius_chosen, patches_without_room, other_parts_of_the_surface, negative_stiffness_refused];

/// The reason for the chosen radius, and the reported local geometry.
fn radius_chosen(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    let turned = turned(&bricks::bricks(Shape::Hexahedron, SIZE, [40, 30, 4], 0.0));
    let turned = made(&folder.path().join("turned.msh"), &turned);
    let top = [0.0, 0.0, 0.05];
    let disc = format!("mesh = {:?}", sample("disc.msh"));
    let (down, along_x) = ([0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    // Geometry, point, inward normal, thickness, longest edge, radius, reason.
    type Case<'a> = (&'a str, [f64; 3], [f64; 3], f64, f64, f64, Reason);
    let cases: [Case; 8] = [
        (&boxed(SIZE, [40, 30, 2]), top, down, 0.1, 0.01, 0.025, Reason::Thickness),
        (&boxed(SIZE, [32, 30, 2]), top, down, 0.1, 0.0125, 0.025, Reason::Thickness),
        (&boxed(SIZE, [16, 30, 2]), top, down, 0.1, 0.025, 0.05, Reason::Cells),
        (&boxed(SIZE, [16, 12, 8]), [-0.2, 0.011, 0.003], along_x, 0.4, 0.025, 0.1 * 0.8_f64.powi(4), Reason::Surface),
        (&boxed(SIZE, [40, 30, 2]), [0.19, 0.0, 0.05], down, 0.1, 0.01, 0.025 * 0.8_f64.powi(5), Reason::Surface),
        (&turned, turn(top), turn(down), 0.1, 0.01, 0.025, Reason::Thickness),
        (&turned, turn([-0.2, 0.003, 0.004]), turn(along_x), 0.4, 0.025, 0.1 * 0.8_f64.powi(4), Reason::Surface),
        (&disc, [0.004, 0.003, 0.01], down, 0.02, f64::NAN, f64::NAN, Reason::Cells),
    ];
    for (geometry, point, direction, thickness, cell, radius, reason) in cases {
        let mut scene = scene(geometry, 1, point);
        scene.impactor.direction = direction;
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        let a = Localization::patch(&mesh, &scene, None).unwrap();
        let patch = a.footprint.patch().unwrap();
        let name = format!("{point:?}: {patch:?}");
        assert_eq!(patch.reason, reason, "{name}");
        // Rounding of rotated coordinates that were written and read.
        assert!((patch.thickness / thickness - 1.0).abs() < 1e-11, "{name}");
        let (cell, radius) = if cell.is_nan() { (patch.cell, 2.0 * patch.cell) } else { (cell, radius) };
        assert!((patch.cell / cell - 1.0).abs() < 1e-11 && (patch.radius / radius - 1.0).abs() < 1e-11, "{name}");
        // (3/5)(1−ν²)/(E r), since the impact is along the normal up to rounding.
        let compliance = 0.6 * (1.0 - POISSON * POISSON) / (YOUNG * radius);
        assert!((a.compliance / compliance - 1.0).abs() < 1e-11, "{name}: {}", a.compliance);
        assert!((patch.error().unwrap() / (0.025 * (radius / thickness).powi(2)) - 1.0).abs() < 1e-10, "{name}");
        assert!(!patch.is_critical(), "{name}");
        world.collect_garbage().unwrap();
    }
}

/// Patches without enough room are refused. The part of a patch on the surface next to a straight edge, at the distance
/// e r, is 1/2 + 3/4 (e − e³/3).
fn patches_without_room(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    let tetrahedra = bricks::bricks(Shape::Tetrahedron, SIZE, [6, 5, 3], 0.3);
    let tetrahedra = made(&folder.path().join("tetrahedra.msh"), &tetrahedra);
    for geometry in [boxed(SIZE, [8, 6, 2]), tetrahedra] {
        let mut scene = scene(&geometry, 2, [0.0, 0.0, 0.05]);
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        for (distance, radius) in [(0.0, 0.03), (0.01, 0.03), (0.02, 0.03), (0.029, 0.03)] {
            scene.impactor.point = [0.2 - distance, 0.013, 0.05];
            let e: f64 = distance / radius;
            let share = format!("{:.2}% of a patch", 100.0 * (0.5 + 0.75 * (e - e.powi(3) / 3.0)));
            let fault = refused(&mesh, &scene, Some(radius));
            assert!(fault.message.contains(&share), "{share}: {fault}");
        }
        // A disc that touches the edge has room, and so has the default radius, which is reduced.
        assert!(Localization::patch(&mesh, &scene, Some(0.029 * (1.0 - 1e-12))).is_ok());
        // Points so close to an edge that no patch fits.
        for place in [[0.2, 0.013], [0.2, 0.15], [0.2 - 1e-9, 0.0]] {
            scene.impactor.point = [place[0], place[1], 0.05];
            let fault = refused(&mesh, &scene, None);
            assert!(fault.message.contains("no room") && fault.help.contains("point"), "{fault}");
        }
        world.collect_garbage().unwrap();
    }
}

/// Three cubes in the form of an L: the surface of the lower step does not belong to the patch, though it has the same
/// normal.
fn other_parts_of_the_surface(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    // Nodes (i, j, k) of x = 0…2, y = 0…1, z = 0…2.
    let number = |i: usize, j: usize, k: usize| 1 + i + 3 * (j + 2 * k);
    let nodes: String = (0..18).map(|n| format!("{} {} {} {}\n", n + 1, n % 3, n / 3 % 2, n / 6)).collect();
    // The corner above the step is not a node.
    let nodes: String = nodes
        .lines()
        .filter(|line| !line.ends_with("2 0 2") && !line.ends_with("2 1 2"))
        .map(|l| format!("{l}\n"))
        .collect();
    let cubes: String = [(0, 0), (1, 0), (0, 1)]
        .into_iter()
        .enumerate()
        .map(|(n, (i, k))| {
            let corner = |[a, b, c]: [usize; 3]| number(i + a, b, k + c).to_string();
            let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
            let corners: Vec<String> = [0, 1].iter().flat_map(|c| ring.map(|[a, b]| corner([a, b, *c]))).collect();
            format!("{} 5 2 1 1 {}\n", n + 1, corners.join(" "))
        })
        .collect();
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n16\n{nodes}$EndNodes\n$Elements\n3\n{cubes}$EndElements\n"
    );
    let mut scene = scene(&made(&folder.path().join("step.msh"), &text), 2, [0.8, 0.5, 2.0]);
    let mesh = Mesh::new(&world, &scene.body).unwrap();
    let share = |e: f64| format!("{:.2}% of a patch", 100.0 * (0.5 + 0.75 * (e - e.powi(3) / 3.0)));
    let fault = refused(&mesh, &scene, Some(0.4));
    assert!(fault.message.contains(&share(0.5)), "{fault}");
    assert_eq!(Localization::patch(&mesh, &scene, Some(0.2)).unwrap().footprint.patch().unwrap().thickness, 2.0);
    // On the step next to the wall, which is not part of the surface that is hit.
    scene.impactor.point = [1.2, 0.5, 1.0];
    let fault = refused(&mesh, &scene, Some(0.4));
    assert!(fault.message.contains(&share(0.5)), "{fault}");
    assert_eq!(Localization::patch(&mesh, &scene, Some(0.2)).unwrap().footprint.patch().unwrap().thickness, 1.0);
    // Across a ridge of the disc's rim: the whole patch is on the surface, evenly above and below.
    let mut scene = patches::scene(&format!("mesh = {:?}", sample("disc.msh")), 2, [0.25, 0.0, 0.0]);
    scene.impactor.direction = [-1.0, 0.0, 0.0];
    let mesh = Mesh::new(&world, &scene.body).unwrap();
    let a = Localization::patch(&mesh, &scene, Some(0.009)).unwrap();
    assert!(reading(&mesh, &a, |[_, _, z]| [z, 0.0, 0.0]).abs() < 1e-15);
}

/// The reported limit is r_p > 1.2 (E*/E′) √(R α) with the half-space's α. A radius that is too small even for a plate
/// is refused.
fn negative_stiffness_refused(session: &Session) {
    let world = session.world();
    let mut scene = scene(&boxed([0.4, 0.4, 0.02], [40, 40, 2]), 1, [0.0, 0.0, 0.01]);
    let mesh = Mesh::new(&world, &scene.body).unwrap();
    let (radius, young2, poisson2) = (0.05, 210e9, 0.3);
    scene.impactor.mass = 52.0;
    scene.impactor.speed = 1.0;
    scene.impactor.stiffness = hertz::stiffness(radius, (YOUNG, POISSON), (young2, poisson2));
    let (plane1, plane2) = (YOUNG / (1.0 - POISSON * POISSON), young2 / (1.0 - poisson2 * poisson2));
    let combined = 1.0 / (1.0 / plane1 + 1.0 / plane2);
    // Energy: (2/5) k0 α^{5/2} = m v²/2.
    let alpha = (1.25 * 52.0 / scene.impactor.stiffness).powf(0.4);
    let limit = 1.2 * combined / plane1 * (radius * alpha).sqrt();
    let patch = |r| Localization::patch(&mesh, &scene, r).unwrap().footprint.patch().unwrap();
    // With fine cells the contact would determine the radius: here 1.25 times the limit is more than h/4.
    assert!((patch(None).limit_radius / limit - 1.0).abs() < 1e-12);
    assert!(1.25 * limit > 0.005 && patch(None).reason == Reason::Cells);
    assert!(!patch(Some(1.001 * limit)).is_critical() && patch(Some(0.999 * limit)).is_critical());
    // On a plate the indentation is smaller, so the radius may be smaller by the square root of that ratio.
    let refusal = refused(&mesh, &scene, Some(0.3 * limit));
    let least: f64 = refusal.message.split("about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(least < 0.7 * limit && least > 0.3 * limit, "{least} of {limit}");
    assert!(patch(Some(1.001 * least)).is_critical());
    assert!(refusal.help.contains("localization = \"point\""), "{refusal}");
    // A contact stiffness for which no patch on this plate is large enough.
    scene.impactor.stiffness = 1e20;
    for radius in [None, Some(0.005), Some(0.19)] {
        let fault = refused(&mesh, &scene, radius);
        assert!(fault.message.contains("negative stiffness"), "{fault}");
        assert!(fault.help.contains("point"), "{fault}");
    }
}
