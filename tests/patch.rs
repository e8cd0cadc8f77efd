//! The vector a of a patch: Hertz's pressure over a disc of the surface, and the radius chosen for it.

#[path = "common/bricks.rs"]
mod bricks;
#[path = "common/field.rs"]
mod field;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use petsc_wrap::Session;
use ricochet::contact::{Localization, Reason, hertz};
use ricochet::element::Shape;
use ricochet::error::Error;
use ricochet::mesh::Mesh;
use ricochet::scene::{Fault, Scene};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        start,
        &[
            ("totals_and_moments", totals_and_moments),
            ("an_edge_under_the_patch", an_edge_under_the_patch),
            ("the_same_on_all_numbers_of_ranks", the_same_on_all_numbers_of_ranks),
            ("radius_chosen", radius_chosen),
            ("patches_without_room", patches_without_room),
            ("other_parts_of_the_surface", other_parts_of_the_surface),
            ("negative_stiffness_refused", negative_stiffness_refused),
            ("a_quarter", a_quarter),
        ],
    )
}

const SIZE: [f64; 3] = [0.4, 0.3, 0.1];
const YOUNG: f64 = 70e9;
const POISSON: f64 = 0.23;

/// A scene whose impact is so weak that no radius is too small, hit from above.
fn scene(geometry: &str, order: usize, point: [f64; 3]) -> Scene {
    let text = format!(
        "[body]\nyoung = {YOUNG:e}\npoisson = {POISSON}\ndensity = 2500.0\n{geometry}\norder = {order}\n\
         [impactor]\nmass = 1e-3\nradius = 0.05\nstiffness = 1e4\nspeed = 1e-3\n{}\n[time]\nend = 4e-4\nstep = 2e-5\n",
        if geometry.starts_with("mesh") { "point = [0, 0, 0]" } else { "" }
    );
    let (mut scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene.impactor.point = point;
    scene
}

fn boxed(size: [f64; 3], cells: [usize; 3]) -> String {
    format!("size = {size:?}\ncells = {cells:?}")
}

fn made(file: &Path, text: &str) -> String {
    std::fs::write(file, text).unwrap();
    format!("mesh = {file:?}")
}

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").join(name)
}

/// A flat face of a body: its centre, two unit vectors along it, right-handed about its outward normal, with the room that there is, and whether its facets are
/// affine.
struct Face {
    name: &'static str,
    geometry: String,
    centre: [f64; 3],
    along: [[f64; 3]; 2],
    room: [f64; 2],
    affine: bool,
}

/// A rotation about no axis of the mesh.
fn turn(x: [f64; 3]) -> [f64; 3] {
    let rotation = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    (rotation * nalgebra::Vector3::from(x)).into()
}

/// The mesh in a file's text, turned.
fn turned(text: &str) -> String {
    let (head, rest) = text.split_once("$Nodes\n").unwrap();
    let (nodes, tail) = rest.split_once("$EndNodes").unwrap();
    let (count, nodes) = nodes.split_once('\n').unwrap();
    let nodes: String = nodes
        .lines()
        .map(|line| {
            let mut words = line.split(' ');
            let number = words.next().unwrap();
            let x: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
            let [x, y, z] = turn([x[0], x[1], x[2]]);
            format!("{number} {x:.17e} {y:.17e} {z:.17e}\n")
        })
        .collect();
    format!("{head}$Nodes\n{count}\n{nodes}$EndNodes{tail}")
}

fn faces(folder: &Path) -> Vec<Face> {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let top = [0.0, 0.0, SIZE[2] / 2.0];
    let room = [SIZE[0] / 2.0, SIZE[1] / 2.0];
    let mesh =
        |name: &str, shape, distortion| made(&folder.join(name), &bricks::bricks(shape, SIZE, [6, 5, 3], distortion));
    let tetrahedra = bricks::bricks(Shape::Tetrahedron, SIZE, [6, 5, 3], 0.3);
    let distorted = bricks::bricks(Shape::Hexahedron, SIZE, [6, 5, 3], 0.2);
    let face = |name, geometry, affine| Face { name, geometry, centre: top, along: [x, y], room, affine };
    vec![
        face("box, top", boxed(SIZE, [6, 5, 2]), true),
        Face {
            centre: [-SIZE[0] / 2.0, 0.0, 0.0],
            along: [z, y],
            room: [SIZE[2] / 2.0, SIZE[1] / 2.0],
            ..face("box, x-min", boxed(SIZE, [3, 7, 4]), true)
        },
        face("tetrahedra", mesh("tetrahedra.msh", Shape::Tetrahedron, 0.3), true),
        face("distorted hexahedra", mesh("hexahedra.msh", Shape::Hexahedron, 0.2), false),
        Face {
            centre: turn(top),
            along: [turn(x), turn(y)],
            ..face("tetrahedra, turned", made(&folder.join("turned-tetrahedra.msh"), &turned(&tetrahedra)), true)
        },
        Face {
            centre: turn([0.0, SIZE[1] / 2.0, 0.0]),
            along: [turn(z), turn(x)],
            room: [SIZE[2] / 2.0, SIZE[0] / 2.0],
            ..face("hexahedra, turned", made(&folder.join("turned-hexahedra.msh"), &turned(&distorted)), false)
        },
        Face {
            centre: [0.0, 0.0, 0.01],
            room: [0.25, 0.25],
            ..face("plate20.msh", format!("mesh = {:?}", sample("plate20.msh")), true)
        },
        Face {
            centre: [0.0, 0.0, 0.01],
            // A square within the polygon that is its rim.
            room: [0.17, 0.17],
            ..face("disc.msh", format!("mesh = {:?}", sample("disc.msh")), false)
        },
        Face {
            centre: [0.0, 0.0, 0.5],
            room: [0.5, 0.5],
            ..face("block-hex.msh", format!("mesh = {:?}", sample("block-hex.msh")), false)
        },
    ]
}

/// Numbers in (0, 1) that look random (SplitMix64), the same on all ranks.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn combine(terms: &[(f64, [f64; 3])]) -> [f64; 3] {
    [0, 1, 2].map(|i| terms.iter().map(|(factor, x)| factor * x[i]).sum())
}

/// A field of the second degree, and its part of the first.
fn quadratic([x, y, z]: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = linear([x, y, z]);
    [a + 3.0 * x * y - z * z, b + x * x - 2.0 * y * z, c + y * y + x * z + 5.0 * x * x]
}

fn linear([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.3 + x - 2.0 * y + 0.5 * z, -0.2 + 0.7 * x + y - z, 0.1 - x + 0.4 * y + 3.0 * z]
}

/// aᵀu of a field. Collective.
fn reading(mesh: &Mesh, a: &Localization, of: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
    let mut u = a.vector.duplicate().unwrap();
    field::interpolate(mesh, &mut u, of);
    let value = a.vector.dot(&u).unwrap();
    u.destroy().unwrap();
    value
}

/// ∫p = 1, ∫p x = 0, ∫p x² = r²/5 by the reading of fields, for centres anywhere and radii from a hundredth of a cell to the whole
/// face, hit from all directions.
fn totals_and_moments(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    let mut worst: f64 = 0.0;
    for face in faces(folder.path()) {
        for order in [1, 2] {
            let mut scene = scene(&face.geometry, order, face.centre);
            let normal = cross(face.along[0], face.along[1]);
            scene.impactor.direction = combine(&[(-1.0, normal)]);
            let mesh = Mesh::new(&world, &scene.body).unwrap();
            let mut random = Random(order as u64);
            for _ in 0..12 {
                let place = [0, 1].map(|i| (1.8 * random.next() - 0.9) * face.room[i]);
                let room = (0..2).map(|i| face.room[i] - place[i].abs()).fold(f64::INFINITY, f64::min);
                let radius = room * 1e-3_f64.powf(random.next());
                let point = combine(&[(1.0, face.centre), (place[0], face.along[0]), (place[1], face.along[1])]);
                let tilt = [random.next() - 0.5, random.next() - 0.5];
                let d = combine(&[(-1.0, normal), (tilt[0], face.along[0]), (tilt[1], face.along[1])]);
                let d = combine(&[(dot(d, d).sqrt().recip(), d)]);
                (scene.impactor.point, scene.impactor.direction) = (point, d);
                let name = format!("{}, order {order}, r = {radius:.2e} at {point:?}", face.name);
                let a = Localization::patch(&mesh, &scene, Some(radius)).unwrap_or_else(|e| panic!("{name}: {e}"));
                let mut error: f64 = 0.0;
                for component in 0..3 {
                    let one = move |_| [0, 1, 2].map(|i| if i == component { 1.0 } else { 0.0 });
                    error = error.max((reading(&mesh, &a, one) - d[component]).abs());
                }
                error = error.max((reading(&mesh, &a, linear) - dot(d, linear(point))).abs());
                if order == 2 && face.affine {
                    // The mean of x² in the plane is r²/5; second differences of a quadratic are exact.
                    let second = face.along.map(|t| {
                        let at = |s: f64| dot(d, quadratic(combine(&[(1.0, point), (s, t)])));
                        at(1.0) + at(-1.0) - 2.0 * at(0.0)
                    });
                    let mean = dot(d, quadratic(point)) + radius * radius / 10.0 * (second[0] + second[1]);
                    error = error.max((reading(&mesh, &a, quadratic) - mean).abs());
                }
                // Gmsh's coordinates are good to 1e-11: the top of a mesh is flat to that.
                assert!(error < 1e-10, "{name}: {error:e}");
                worst = worst.max(error);
                assert_eq!(a.patch.unwrap().reason, Reason::Scene);
            }
            world.collect_garbage().unwrap();
        }
    }
    if world.is_root() {
        println!("largest error of a total or moment: {worst:.1e}");
    }
}

/// A field with a kink along an edge of the mesh, |x − x_edge|, is read as r (3/8 + 3/4 e² − e⁴/8) with the edge at e r from the
/// centre: smooth in e, unlike a point's reading, also where the edge is a hair away.
fn an_edge_under_the_patch(session: &Session) {
    let world = session.world();
    for cells in [[8, 6, 2], [80, 6, 2]] {
        let mut scene = scene(&boxed(SIZE, cells), 1, [0.1, 0.02, 0.05]);
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        for radius in [0.002, 0.04] {
            for e in [0.0, 1e-15, -1e-12, 1e-9, -1e-6, 1e-3, 0.1, -0.4, 0.7, -0.99, 0.999_999, 1.0, -1.0] {
                scene.impactor.point[0] = 0.1 + e * radius;
                let a = Localization::patch(&mesh, &scene, Some(radius)).unwrap();
                let e = (scene.impactor.point[0] - 0.1) / radius;
                let found = reading(&mesh, &a, |[x, ..]| [0.0, 0.0, -(x - 0.1).abs()]);
                let expected = radius * (0.375 + 0.75 * e * e - e.powi(4) / 8.0);
                // Entries are good to 1e-13, and read values of up to 0.1.
                assert!((found - expected).abs() < 2e-14, "{cells:?}, r = {radius}, e = {e}: {found} {expected}");
            }
        }
        world.collect_garbage().unwrap();
    }
}

/// Component, place (in 1e-7 m) and value of all entries, sorted. Collective.
fn by_place(mesh: &Mesh, a: &Localization) -> Vec<([i64; 4], f64)> {
    let (mut nodes, mut places) = (Vec::new(), Vec::new());
    for facet in 0..mesh.facets.len() {
        for (node, x) in mesh.facets.nodes(facet).iter().zip(mesh.facets.node_positions(facet)) {
            nodes.push(*node);
            places.extend(x.map(|x| (1e7 * x).round() as i64));
        }
    }
    let (nodes, places) = (mesh.comm.all_gather(&nodes), mesh.comm.all_gather(&places));
    let place: std::collections::BTreeMap<_, _> = nodes.iter().zip(places.chunks_exact(3)).collect();
    let mut list: Vec<([i64; 4], f64)> = a
        .entries
        .iter()
        .map(|(index, value)| {
            let x = place[&(index / 3)];
            ([i64::from(index % 3), x[0], x[1], x[2]], *value)
        })
        .collect();
    list.sort_by_key(|(place, _)| *place);
    list
}

fn the_same_on_all_numbers_of_ranks(session: &Session) {
    let (world, alone) = (session.world(), session.alone());
    let folder = tempfile::tempdir().unwrap();
    for face in faces(folder.path()) {
        for order in [1, 2] {
            let name = format!("{}, order {order}", face.name);
            let normal = cross(face.along[0], face.along[1]);
            let mut scene = scene(&face.geometry, order, face.centre);
            scene.impactor.direction = combine(&[(-0.8, normal), (0.6, face.along[0])]);
            let meshes = [&world, &alone].map(|comm| Mesh::new(comm, &scene.body).unwrap());
            // At the centre, which may be a vertex, and off it.
            for (shift, part) in [(0.0, 0.9), (0.237, 0.7), (0.5, 0.02)] {
                scene.impactor.point = combine(&[(1.0, face.centre), (shift * face.room[1], face.along[1])]);
                let radius = part * (1.0 - shift) * face.room[0].min(face.room[1]);
                let [a, b] = [&meshes[0], &meshes[1]].map(|mesh| {
                    Localization::patch(mesh, &scene, Some(radius)).unwrap_or_else(|e| panic!("{name}: {e}"))
                });
                // Every rank has the same list, ascending, to the last bit.
                let (indices, values): (Vec<_>, Vec<f64>) = a.entries.iter().copied().unzip();
                assert!(indices.is_sorted_by(|one, next| one < next), "{name}");
                assert_eq!(world.all_gather(&indices), indices.repeat(world.size()), "{name}");
                assert_eq!(world.all_gather(&values), values.repeat(world.size()), "{name}");
                // It is the vector.
                let begin = a.vector.range().start as usize;
                let mut dense = vec![0.0; a.vector.len()];
                a.entries.iter().for_each(|(index, value)| dense[*index as usize] = *value);
                let here = a.vector.read().unwrap();
                assert_eq!(here[..], dense[begin..begin + here.len()], "{name}");
                // And the one of a single rank, but for the order of sums.
                let [lists, expected] = [(&meshes[0], &a), (&meshes[1], &b)].map(|(mesh, a)| by_place(mesh, a));
                let large = |list: &[([i64; 4], f64)]| -> Vec<[i64; 4]> {
                    list.iter().filter(|(_, value)| value.abs() > 1e-12).map(|(place, _)| *place).collect()
                };
                assert_eq!(large(&lists), large(&expected), "{name}");
                let sum = |list: &[([i64; 4], f64)]| -> std::collections::BTreeMap<[i64; 4], f64> {
                    list.iter().copied().collect()
                };
                let (lists, expected) = (sum(&lists), sum(&expected));
                for (place, value) in &lists {
                    let other = expected.get(place).copied().unwrap_or(0.0);
                    // A facet's vertices may start elsewhere: the quadrature's 1e-13.
                    assert!((value - other).abs() < 1e-12, "{name}: {value:e} and {other:e} at {place:?}");
                }
                assert_eq!(a.compliance, b.compliance);
            }
            world.collect_garbage().unwrap();
        }
    }
}

/// What decides the radius, and what is told of the place.
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
        let patch = a.patch.unwrap();
        let name = format!("{point:?}: {patch:?}");
        assert_eq!(patch.reason, reason, "{name}");
        // Coordinates turned and read back.
        assert!((patch.thickness / thickness - 1.0).abs() < 1e-11, "{name}");
        let (cell, radius) = if cell.is_nan() { (patch.cell, 2.0 * patch.cell) } else { (cell, radius) };
        assert!((patch.cell / cell - 1.0).abs() < 1e-11 && (patch.radius / radius - 1.0).abs() < 1e-11, "{name}");
        // (3/5)(1−ν²)/(E r), as the impact is along the normal up to rounding.
        let compliance = 0.6 * (1.0 - POISSON * POISSON) / (YOUNG * radius);
        assert!((a.compliance / compliance - 1.0).abs() < 1e-11, "{name}: {}", a.compliance);
        assert!((patch.error() / (0.025 * (radius / thickness).powi(2)) - 1.0).abs() < 1e-10, "{name}");
        assert!(!patch.is_critical(), "{name}");
        world.collect_garbage().unwrap();
    }
}

fn refused(mesh: &Mesh, scene: &Scene, radius: Option<f64>) -> Fault {
    match Localization::patch(mesh, scene, radius) {
        Err(Error::Fault(fault)) => {
            assert!(fault.everywhere && fault.key == "contact.patch_radius", "{fault}");
            assert_eq!(Error::Fault(fault.clone()).status(), 2);
            *fault
        }
        Err(error) => panic!("{error}"),
        Ok(a) => panic!("accepted: {:?}", a.patch),
    }
}

/// The share on the surface beside a straight edge at the distance e r is 1/2 + 3/4 (e − e³/3).
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
        // A disc that touches the edge has room, as has the default where it is made smaller.
        assert!(Localization::patch(&mesh, &scene, Some(0.029 * (1.0 - 1e-12))).is_ok());
        // Off every edge but by less than any patch.
        for place in [[0.2, 0.013], [0.2, 0.15], [0.2 - 1e-9, 0.0]] {
            scene.impactor.point = [place[0], place[1], 0.05];
            let fault = refused(&mesh, &scene, None);
            assert!(fault.message.contains("no room") && fault.help.contains("point"), "{fault}");
        }
        world.collect_garbage().unwrap();
    }
}

/// Three cubes in the form of an L: the step below is not under the patch, though it looks the same way.
fn other_parts_of_the_surface(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    // Nodes (i, j, k) of x = 0…2, y = 0…1, z = 0…2.
    let number = |i: usize, j: usize, k: usize| 1 + i + 3 * (j + 2 * k);
    let nodes: String = (0..18).map(|n| format!("{} {} {} {}\n", n + 1, n % 3, n / 3 % 2, n / 6)).collect();
    // The corner above the step is no node.
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
    assert_eq!(Localization::patch(&mesh, &scene, Some(0.2)).unwrap().patch.unwrap().thickness, 2.0);
    // On the step, where the wall beside it is no surface to hit.
    scene.impactor.point = [1.2, 0.5, 1.0];
    let fault = refused(&mesh, &scene, Some(0.4));
    assert!(fault.message.contains(&share(0.5)), "{fault}");
    assert_eq!(Localization::patch(&mesh, &scene, Some(0.2)).unwrap().patch.unwrap().thickness, 1.0);
}

/// r_p > 1.2 (E*/E′) √(R α) for the half-space's α is the limit told; what even a plate would break is refused.
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
    let patch = |r| Localization::patch(&mesh, &scene, r).unwrap().patch.unwrap();
    // Fine cells would leave the contact to decide: 1.25 limits are more than h/4 here.
    assert!((patch(None).limit_radius / limit - 1.0).abs() < 1e-12);
    assert!(1.25 * limit > 0.005 && patch(None).reason == Reason::Cells);
    assert!(!patch(Some(1.001 * limit)).is_critical() && patch(Some(0.999 * limit)).is_critical());
    // On a plate the indentation is less: the radius may be smaller by the root of that.
    let refusal = refused(&mesh, &scene, Some(0.3 * limit));
    let least: f64 = refusal.message.split("about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(least < 0.7 * limit && least > 0.3 * limit, "{least} of {limit}");
    assert!(patch(Some(1.001 * least)).is_critical());
    assert!(refusal.help.contains("localization = \"point\""), "{refusal}");
    // A contact stiffness that no patch on this plate is large enough for.
    scene.impactor.stiffness = 1e20;
    for radius in [None, Some(0.005), Some(0.19)] {
        let fault = refused(&mesh, &scene, radius);
        assert!(fault.message.contains("negative stiffness"), "{fault}");
        assert!(fault.help.contains("point"), "{fault}");
    }
}

/// A quarter about the impact point: the corner of a box carries a quarter of the disc, and a is made to sum to d.
fn a_quarter(session: &Session) {
    let world = session.world();
    let mut scene = scene(&boxed(SIZE, [8, 6, 2]), 2, [0.2, 0.15, 0.05]);
    let mut mesh = Mesh::new(&world, &scene.body).unwrap();
    assert!(refused(&mesh, &scene, Some(0.03)).message.contains("25.00% of a patch"));
    mesh.copies = 4;
    let radius = 0.03;
    let a = Localization::patch(&mesh, &scene, Some(radius)).unwrap();
    let total: f64 = a.entries.iter().map(|(_, value)| value).sum();
    assert!((total + 1.0).abs() < 1e-14, "{total}");
    // The first moment of a quarter is 3/32 r a quarter, 3/8 r in the mean.
    let found = reading(&mesh, &a, |[x, y, _]| [0.0, 0.0, -(0.2 - x) - 2.0 * (0.15 - y)]);
    assert!((found - 9.0 / 8.0 * radius).abs() < 1e-13, "{found}");
    let compliance = 4.0 * 0.6 * (1.0 - POISSON * POISSON) / (YOUNG * radius);
    assert!((a.compliance / compliance - 1.0).abs() < 1e-14);
    // The thickness along the edge where the two planes of symmetry meet.
    assert!((a.patch.unwrap().thickness - 0.1).abs() < 1e-14);
    // A patch with no room on the quarter has none on the whole.
    scene.impactor.point = [0.2, 0.14, 0.05];
    assert!(refused(&mesh, &scene, Some(radius)).message.contains("within the patch"));
}
