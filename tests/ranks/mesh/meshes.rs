//! Meshes from Gmsh files: their measures, and meshes that are refused.

use crate::bricks;
use mpi_test::{Test, tests};
use std::path::{Path, PathBuf};

use petsc_wrap::{Comm, Matrix, Session};
use ricochet::body::Body;
use ricochet::element::Shape;
use ricochet::error::Error;
use ricochet::impact::SteppedImpact;
use ricochet::mesh::Mesh;
use ricochet::scene::{Fault, Scene};

pub const RANKS: &[usize] = &[1, 2, 3];
pub const TESTS: &[Test<Session>] =
    tests![volumes_and_areas, formats_2_and_4_give_the_same, mirrored_tetrahedra_are_accepted, refusals];

const DENSITY: f64 = 2500.0;

/// A scene with a body from a mesh file, hit from above at `height`, with unit springs on one surface.
fn scene(mesh: &Path, order: usize, height: f64, surface: &str) -> Scene {
    supported(mesh, order, height, &[(surface, "1.0")])
}

/// The same with springs of a stiffness each on surfaces.
fn supported(mesh: &Path, order: usize, height: f64, springs: &[(&str, &str)]) -> Scene {
    let support = |(surface, stiffness): &(&str, &str)| {
        format!("[[support]]\nsurface = {surface:?}\nkind = \"elastic\"\nstiffness = {stiffness}\n")
    };
    let supports: String = springs.iter().map(support).collect();
    let text = format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = {DENSITY}\nmesh = {mesh:?}\norder = {order}\n{supports}\
         [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\npoint = [0.0, 0.0, {height}]\n\
         [time]\nend = 5e-5\nstep = 1e-6\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\n"
    );
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}")).0
}

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").join(name)
}

fn body(comm: &Comm, scene: &Scene) -> Result<Body, Error> {
    Body::solid(scene, &Mesh::new(comm, &scene.body)?)
}

/// 1ᵀA1 for the displacements along each axis: the mass for M, the area for unit springs.
fn sums(matrix: &Matrix, like: &Body) -> [f64; 3] {
    let (mut ones, mut product) = (like.terms.load.duplicate().unwrap(), like.terms.load.duplicate().unwrap());
    [0, 1, 2].map(|axis| {
        let first = ones.range().start as usize;
        for (i, value) in ones.write().unwrap().iter_mut().enumerate() {
            *value = f64::from(u8::from((first + i) % 3 == axis));
        }
        matrix.mult(&ones, &mut product).unwrap();
        product.dot(&ones).unwrap()
    })
}

/// Volumes and areas agree with the geometry, on any number of ranks.
fn volumes_and_areas(session: &Session) {
    // The rim of the disc is a polygon.
    let (sides, radius, thickness) = (32.0, 0.25, 0.02);
    let angle = std::f64::consts::PI / sides;
    let disc = sides * radius * radius * angle.sin() * angle.cos();
    let rim = 2.0 * sides * radius * angle.sin() * thickness;
    let cube = [("side", 4.0), ("top", 1.0), ("bottom", 1.0)];
    let cases = [
        ("plate20.msh", 0.01, 0.005, [("side", 0.04), ("top", 0.25), ("bottom", 0.25)]),
        ("disc.msh", 0.01, disc * thickness, [("rim", rim), ("top", disc), ("bottom", disc)]),
        ("block-tet22.msh", 0.5, 1.0, cube),
        ("block-tet41.msh", 0.5, 1.0, cube),
        ("block-hex.msh", 0.5, 1.0, cube),
    ];
    for (name, height, volume, surfaces) in cases {
        for order in [1, 2] {
            // Unit springs along another axis on each surface: one body has the areas of all.
            let along = ["[1, 0, 0]", "[0, 1, 0]", "[0, 0, 1]"];
            let springs: Vec<_> = surfaces.iter().zip(along).map(|((surface, _), axis)| (*surface, axis)).collect();
            let body = body(&session.world(), &supported(&file(name), order, height, &springs)).unwrap();
            for mass in sums(&body.mass, &body) {
                let error = mass / DENSITY / volume - 1.0;
                // Gmsh writes coordinates to 1e-11 of the size (edges of block-hex.msh); sums add rounding.
                assert!(error.abs() < 1e-10, "{name}, order {order}: volume {error:e} off");
            }
            let found = sums(body.terms.support.as_ref().expect("unit springs"), &body);
            for ((surface, area), found) in surfaces.iter().zip(found) {
                let error = found / area - 1.0;
                assert!(error.abs() < 1e-10, "{name}, order {order}: {surface} {error:e} off");
            }
        }
        session.world().collect_garbage().unwrap();
    }
}

/// Both files contain the same mesh: the matrices and the motion are the same.
fn formats_2_and_4_give_the_same(session: &Session) {
    let world = session.world();
    let measures = |name: &str| {
        let scene = scene(&file(name), 2, 0.5, "bottom");
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        let body = Body::solid(&scene, &mesh).unwrap();
        let mut values: Vec<f64> = [&body.mass, &body.terms.elastic, body.terms.support.as_ref().unwrap()]
            .iter()
            .flat_map(|matrix| [matrix.trace().unwrap(), matrix.norm_frobenius().unwrap()])
            .collect();
        let mut impact = SteppedImpact::new(&scene, body).unwrap();
        let flow = impact.run(|step| {
            values.push(step.contact.force);
            Ok(std::ops::ControlFlow::Continue(()))
        });
        assert!(flow.unwrap().is_continue());
        values
    };
    let (two, four) = (measures("block-tet22.msh"), measures("block-tet41.msh"));
    let peak = two[6..].iter().fold(0.0, |max: f64, force| max.max(*force));
    assert_eq!(two.len(), four.len());
    for (i, (two, four)) in two.iter().zip(&four).enumerate() {
        // The files have different orders of cells and nodes, so rounding differs.
        let scale = if i < 6 { *two } else { peak };
        assert!((two - four).abs() <= 1e-9 * scale, "{i}: {two:e} and {four:e}");
    }
}

/// Writes a mesh into a folder, which each rank has separately.
fn write(folder: &tempfile::TempDir, text: &str) -> PathBuf {
    let path = folder.path().join("mesh.msh");
    std::fs::write(&path, text).unwrap();
    path
}

/// Half of the tetrahedra of [`bricks::bricks`] are mirrored; with two vertices of every cell exchanged, the other half
/// is.
fn mirrored_tetrahedra_are_accepted(session: &Session) {
    let folder = tempfile::tempdir().unwrap();
    let text = bricks::bricks(Shape::Tetrahedron, [1.0; 3], [2, 2, 2], 0.2);
    let exchanged = edit_cells(&text, "4", |vertices| vertices.swap(0, 1));
    assert_ne!(text, exchanged);
    let norms = [text, exchanged].map(|text| {
        let scene = scene(&write(&folder, &text), 2, 0.5, "top");
        let body = body(&session.world(), &scene).unwrap();
        let volume = sums(&body.mass, &body)[0] / DENSITY;
        assert!((volume - 1.0).abs() < 1e-13, "volume {volume}");
        body.terms.elastic.norm_frobenius().unwrap()
    });
    // The same cells with their vertices in another order, so rounding differs.
    assert!((norms[0] / norms[1] - 1.0).abs() < 1e-13, "{norms:?}");
}

/// The text of a mesh with the vertices of every element of a Gmsh type changed.
fn edit_cells(text: &str, kind: &str, change: impl Fn(&mut [&str])) -> String {
    let line = |line: &str| {
        let mut words: Vec<&str> = line.split(' ').collect();
        if words.len() > 5 && words[1] == kind {
            change(&mut words[5..]);
        }
        words.join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

/// A file in MSH 2.2 with these nodes and elements (each a line without its number); surface 1 is "top", volume 4 is
/// "body".
fn msh(nodes: &[[f64; 3]], elements: &[&str]) -> String {
    let nodes: String = nodes.iter().enumerate().map(|(i, [x, y, z])| format!("{} {x} {y} {z}\n", i + 1)).collect();
    let elements: String = elements.iter().enumerate().map(|(i, element)| format!("{} {element}\n", i + 1)).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"top\"\n3 4 \"body\"\n$EndPhysicalNames\n\
         $Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n{elements}$EndElements\n",
        nodes.lines().count(),
        elements.lines().count()
    )
}

const TETRAHEDRON: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn refusals(session: &Session) {
    // The middle vertex is moved out through a corner.
    let cube = bricks::bricks(Shape::Hexahedron, [1.0; 3], [2, 2, 2], 0.0);
    let pulled = |line: &str| if line.starts_with("14 0.0") { "14 0.6 0.6 0.6".to_owned() } else { line.to_owned() };
    let tangled = cube.lines().map(pulled).collect::<Vec<_>>().join("\n") + "\n";
    assert_ne!(tangled, cube);
    let middles = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];
    let middle = |[i, j]: [usize; 2]| [0, 1, 2].map(|c| (TETRAHEDRON[i][c] + TETRAHEDRON[j][c]) / 2.0);
    let second_order: Vec<[f64; 3]> = TETRAHEDRON.into_iter().chain(middles.map(middle)).collect();
    let curved = msh(&second_order, &["9 2 1 1 1 2 3 5 6 7", "11 2 4 4 1 2 3 4 5 6 7 8 9 10"]);
    // A prism below a tetrahedron, and a hexahedron next to one.
    let below = [[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0]];
    let stacked: Vec<[f64; 3]> = TETRAHEDRON.into_iter().chain(below).collect();
    let prism = msh(&stacked, &["2 2 1 1 1 2 4", "4 2 4 4 1 2 3 4", "6 2 4 4 5 6 7 1 2 3"]);
    let cell = Shape::Hexahedron.reference_vertices().iter().map(|[x, y, z]| [x + 5.0, *y, *z]);
    let beside: Vec<[f64; 3]> = TETRAHEDRON.into_iter().chain(cell).collect();
    let mixed = msh(&beside, &["2 2 1 1 1 2 4", "4 2 4 4 1 2 3 4", "5 2 4 4 5 6 7 8 9 10 11 12"]);
    let flat = msh(&TETRAHEDRON[..3], &["2 2 1 1 1 2 3"]);
    let two = [&TETRAHEDRON[..], &[[1.0, 1.0, 1.0]]].concat();
    let inside = msh(&two, &["2 2 1 1 2 3 4", "4 2 4 4 1 2 3 4", "4 2 4 4 2 3 4 5"]);
    let unnamed = msh(&TETRAHEDRON, &["4 2 4 4 1 2 3 4"]);
    for (name, text, key, expected) in [
        ("tangled", tangled, "body.mesh", "tangled"),
        ("curved", curved, "body.mesh", "ElementOrder = 1"),
        ("prism", prism, "body.mesh", "tetrahedra"),
        ("mixed", mixed, "body.mesh", "mixes shapes: 1 tetrahedra"),
        ("flat", flat, "body.mesh", ""),
        ("inside", inside, "support.0.surface", "inside the body"),
        ("unnamed", unnamed, "support.0.surface", "\"top\" of the mesh"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let fault = refusal(&session.world(), &write(&folder, &text), name);
        assert_eq!(fault.key, key, "{name}: {fault}");
        assert!(format!("{fault} {}", fault.help).contains(expected), "{name}: {fault}");
        assert!(fault.everywhere, "{name}: all ranks go on to end in order");
    }
    // The fault is found on a single rank too.
    let folder = tempfile::tempdir().unwrap();
    let fault = refusal(&session.alone(), &write(&folder, &msh(&[], &[])), "empty");
    assert_eq!(fault.key, "body.mesh", "empty: {fault}");
}

/// The fault with which a mesh is refused.
fn refusal(comm: &Comm, mesh: &Path, name: &str) -> Fault {
    match body(comm, &scene(mesh, 1, 0.5, "top")) {
        Err(Error::Fault(fault)) => *fault,
        Err(error) => panic!("{name}: not a fault of the scene: {error}"),
        Ok(_) => panic!("{name}: accepted"),
    }
}
