//! The localisation vector a of a contact patch: Hertz's pressure over a disc of the surface.

use crate::bricks;
use crate::field::{linear, quadratic};
use mpi_test::{Test, tests};
use std::collections::BTreeMap;
use std::path::Path;

use crate::patches::{POISSON, SIZE, YOUNG, boxed, made, reading, refused, sample, scene, turn, turned};
use petsc_wrap::Session;
use ricochet::body::Body;
use ricochet::contact::{Localization, Reason};
use ricochet::element::Shape;
use ricochet::mesh::Mesh;
use ricochet::scene::{Support, SupportKind};
use ricochet::solve::linear::{Method, solver};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![
    totals_and_moments,
    an_edge_under_the_patch,
    the_same_on_all_numbers_of_ranks,
    a_quarter,
    the_half_space_is_taken_out
];

/// A flat face of a body: its centre, two unit vectors along it (right-handed with the outward normal), the room in
/// these directions, and whether its facets are affine.
struct Face {
    name: &'static str,
    geometry: String,
    centre: [f64; 3],
    along: [[f64; 3]; 2],
    room: [f64; 2],
    affine: bool,
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
            // A square inside the polygon of the disc's rim.
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

/// Pseudo-random numbers in (0, 1) (SplitMix64), the same on all ranks.
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

/// ∫p = 1, ∫p x = 0 and ∫p x² = r²/5, measured with fields, for centres anywhere, radii from a hundredth of a cell to
/// the whole face, and all directions of impact.
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
                for (component, d) in d.into_iter().enumerate() {
                    let one = move |_| [0, 1, 2].map(|i| if i == component { 1.0 } else { 0.0 });
                    error = error.max((reading(&mesh, &a, one) - d).abs());
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
                // Gmsh writes coordinates to 1e-11, so the top of a mesh is flat to that.
                assert!(error < 1e-10, "{name}: {error:e}");
                worst = worst.max(error);
                assert_eq!(a.footprint.patch().unwrap().reason, Reason::Scene);
            }
            world.collect_garbage().unwrap();
        }
    }
    if world.is_root() {
        println!("largest error of a total or moment: {worst:.1e}");
    }
}

/// A field with a kink along an edge of the mesh, |x − x_edge|, has the average r (3/8 + 3/4 e² − e⁴/8), where the edge
/// is at a distance e r from the centre. It is smooth in e, unlike a point value, also if the edge is very close.
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
                // Entries are accurate to 1e-13, and the values are up to 0.1.
                assert!((found - expected).abs() < 2e-14, "{cells:?}, r = {radius}, e = {e}: {found} {expected}");
            }
        }
        world.collect_garbage().unwrap();
    }
}

/// Component, position (in 1e-7 m) and value of all entries, sorted. Collective.
fn by_place(mesh: &Mesh, a: &Localization) -> Vec<([i64; 4], f64)> {
    let (mut nodes, mut places) = (Vec::new(), Vec::new());
    for facet in 0..mesh.facets.len() {
        for (node, x) in mesh.facets.nodes(facet).iter().zip(mesh.facets.node_positions(facet)) {
            nodes.push(*node);
            places.extend(x.map(|x| (1e7 * x).round() as i64));
        }
    }
    let (nodes, places) = (mesh.comm.all_gather(&nodes), mesh.comm.all_gather(&places));
    let place: BTreeMap<_, _> = nodes.iter().zip(places.chunks_exact(3)).collect();
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
            // At the centre, which may be a vertex, and away from it.
            for (shift, part) in [(0.0, 0.5), (0.237, 0.3), (0.5, 0.02)] {
                scene.impactor.point = combine(&[(1.0, face.centre), (shift * face.room[1], face.along[1])]);
                let radius = part * (1.0 - shift) * face.room[0].min(face.room[1]);
                let [a, b] = [&meshes[0], &meshes[1]].map(|mesh| {
                    Localization::patch(mesh, &scene, Some(radius)).unwrap_or_else(|e| panic!("{name}: {e}"))
                });
                // Every rank has the same ascending list, to the last bit.
                let (indices, values): (Vec<_>, Vec<f64>) = a.entries.iter().copied().unzip();
                assert!(indices.is_sorted_by(|one, next| one < next), "{name}");
                assert_eq!(world.all_gather(&indices), indices.repeat(world.size()), "{name}");
                assert_eq!(world.all_gather(&values), values.repeat(world.size()), "{name}");
                // The list equals the vector.
                let begin = a.vector.range().start as usize;
                let mut dense = vec![0.0; a.vector.len()];
                a.entries.iter().for_each(|(index, value)| dense[*index as usize] = *value);
                let here = a.vector.read().unwrap();
                assert_eq!(here[..], dense[begin..begin + here.len()], "{name}");
                // It also equals the list on a single rank, except for the order of sums.
                let [lists, expected] = [(&meshes[0], &a), (&meshes[1], &b)].map(|(mesh, a)| by_place(mesh, a));
                let large = |list: &[([i64; 4], f64)]| -> Vec<[i64; 4]> {
                    list.iter().filter(|(_, value)| value.abs() > 1e-12).map(|(place, _)| *place).collect()
                };
                assert_eq!(large(&lists), large(&expected), "{name}");
                let sum = |list: &[([i64; 4], f64)]| -> BTreeMap<[i64; 4], f64> { list.iter().copied().collect() };
                let (lists, expected) = (sum(&lists), sum(&expected));
                for (place, value) in &lists {
                    let other = expected.get(place).copied().unwrap_or(0.0);
                    // The vertices of a facet may start at another one: the quadrature's error is 1e-13.
                    assert!((value - other).abs() < 1e-12, "{name}: {value:e} and {other:e} at {place:?}");
                }
                assert_eq!(a.compliance, b.compliance);
            }
            world.collect_garbage().unwrap();
        }
    }
}

/// A quarter disc at the impact point: the corner of a box carries a quarter of the disc, and a is scaled so that it
/// sums to d.
fn a_quarter(session: &Session) {
    let world = session.world();
    let mut scene = scene(&boxed(SIZE, [8, 6, 2]), 2, [0.2, 0.15, 0.05]);
    let mut mesh = Mesh::new(&world, &scene.body).unwrap();
    assert!(refused(&mesh, &scene, Some(0.03)).message.contains("25.00% of a patch"));
    mesh.multiplicity = 4;
    let radius = 0.03;
    let a = Localization::patch(&mesh, &scene, Some(radius)).unwrap();
    let total: f64 = a.entries.iter().map(|(_, value)| value).sum();
    assert!((total + 1.0).abs() < 1e-14, "{total}");
    // The first moment of a quarter is 3/32 r for a quarter of the force, so 3/8 r on average.
    let found = reading(&mesh, &a, |[x, y, _]| [0.0, 0.0, -(0.2 - x) - 2.0 * (0.15 - y)]);
    assert!((found - 9.0 / 8.0 * radius).abs() < 1e-13, "{found}");
    let compliance = 4.0 * 0.6 * (1.0 - POISSON * POISSON) / (YOUNG * radius);
    assert!((a.compliance / compliance - 1.0).abs() < 1e-14);
    // The thickness along the edge where the two planes of symmetry meet.
    assert!((a.footprint.patch().unwrap().thickness - 0.1).abs() < 1e-14);
    // A patch without room on the quarter has none on the whole.
    scene.impactor.point = [0.2, 0.14, 0.05];
    assert!(refused(&mesh, &scene, Some(radius)).message.contains("within a patch"));
}

/// On a solid block, the static aᵀK⁻¹a changes with the patch radius like c_l, so their difference depends on the block
/// only: for an impact along the normal, and for an oblique one with its tangential part.
fn the_half_space_is_taken_out(session: &Session) {
    let world = session.world();
    let mut scene = scene(&boxed([0.48, 0.48, 0.24], [12, 12, 6]), 2, [0.0, 0.0, 0.12]);
    let kind = SupportKind::Clamped { components: [true; 3] };
    scene.supports.push(Support {
        surface: "bottom".into(),
        within: None,
        kind,
        damping: [0.0; 3],
        displacement: [0.0; 3],
    });
    let mesh = Mesh::new(&world, &scene.body).unwrap();
    let body = Body::solid(&scene, &mesh).unwrap();
    let mut stiffness = body.combination(0.0, 0.0).unwrap();
    stiffness.zero_rows_columns(&body.clamps.rows, YOUNG).unwrap();
    stiffness.declare_positive_definite().unwrap();
    let mut ksp = solver(&world, "", &stiffness, Method::Cholesky).unwrap();
    for direction in [[0.0, 0.0, -1.0], [0.8, 0.0, -0.6]] {
        for point in [[0.0, 0.0, 0.12], [0.011, 0.008, 0.12]] {
            (scene.impactor.point, scene.impactor.direction) = (point, direction);
            let [small, large] = [0.06, 0.08].map(|radius| {
                let a = Localization::patch(&mesh, &scene, Some(radius)).unwrap();
                let mut u = a.vector.duplicate().unwrap();
                ksp.solve(&a.vector, &mut u).unwrap();
                (a.vector.dot(&u).unwrap(), a.compliance)
            });
            let ratio = (small.0 - large.0) / (small.1 - large.1);
            // 3% with these cells, of 2/3 and 1/2 of the radius; 2% with cells of 3/4 of that size. For an oblique
            // impact, the c_l of the normal alone would be 9% smaller.
            assert!((ratio - 1.0).abs() < 0.035, "{direction:?} at {point:?}: {ratio}");
        }
    }
}
