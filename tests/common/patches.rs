//! Scenes, meshes and displacement averages for the tests of the contact patch.

use std::path::{Path, PathBuf};

use ricochet::contact::Localization;
use ricochet::error::Error;
use ricochet::mesh::Mesh;
use ricochet::scene::{Fault, Scene};

use super::field;

/// Edges of the box in most tests, m.
pub const SIZE: [f64; 3] = [0.4, 0.3, 0.1];

/// Young's modulus of the body, Pa.
pub const YOUNG: f64 = 70e9;

/// Poisson's ratio of the body.
pub const POISSON: f64 = 0.23;

/// A scene with an impact from above, so weak that no patch radius is too small.
pub fn scene(geometry: &str, order: usize, point: [f64; 3]) -> Scene {
    let text = format!(
        "[body]\nyoung = {YOUNG:e}\npoisson = {POISSON}\ndensity = 2500.0\n{geometry}\norder = {order}\n\
         [impactor]\nmass = 1e-3\nradius = 0.05\nstiffness = 1e4\nspeed = 1e-3\n{}\n[time]\nend = 4e-4\nstep = 2e-5\n",
        if geometry.starts_with("mesh") { "point = [0, 0, 0]" } else { "" }
    );
    let (mut scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene.impactor.point = point;
    scene
}

/// Lines of a scene for a box.
pub fn boxed(size: [f64; 3], cells: [usize; 3]) -> String {
    format!("size = {size:?}\ncells = {cells:?}\nsymmetry = \"none\"")
}

/// Writes the text of a mesh into a file, and returns the scene's line for it.
pub fn made(file: &Path, text: &str) -> String {
    std::fs::write(file, text).unwrap();
    format!("mesh = {file:?}")
}

/// Path of a mesh of the project.
pub fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes").join(name)
}

/// A rotation about an axis that is none of the mesh's axes.
pub fn turn(x: [f64; 3]) -> [f64; 3] {
    let rotation = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    (rotation * nalgebra::Vector3::from(x)).into()
}

/// The mesh of a file's text, rotated.
pub fn turned(text: &str) -> String {
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

/// aᵀu, where u is the interpolant of a field. Collective.
pub fn reading(mesh: &Mesh, a: &Localization, of: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
    let mut u = a.vector.duplicate().unwrap();
    field::interpolate(mesh, &mut u, of);
    let value = a.vector.dot(&u).unwrap();
    u.destroy().unwrap();
    value
}

/// The fault of the patch radius with which a patch is refused, on all ranks. Collective.
pub fn refused(mesh: &Mesh, scene: &Scene, radius: Option<f64>) -> Fault {
    match Localization::patch(mesh, scene, radius) {
        Err(Error::Fault(fault)) => {
            assert!(fault.everywhere && fault.key == "contact.patch_radius", "{fault}");
            assert_eq!(Error::Fault(fault.clone()).status(), 2);
            *fault
        }
        Err(error) => panic!("{error}"),
        Ok(a) => panic!("accepted: {:?}", a.footprint.patch()),
    }
}
