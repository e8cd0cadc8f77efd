//! Small bodies of each kind of element, with their lumped mass and largest frequency.

use std::path::Path;

use petsc_wrap::Comm;
use ricochet::body::{Body, Inertia, LargestFrequency, LinearContact, Lumped, largest_frequency};
use ricochet::contact::{Hertz, hertz};
use ricochet::description::Description;
use ricochet::element::Shape;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

use crate::bricks;

pub const DENSITY: f64 = 2500.0;
pub const YOUNG: f64 = 70e9;
pub const POISSON: f64 = 0.23;
pub const MASS: f64 = 2.0;

/// One kind of element, and the bricks into which the body is divided.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    pub shape: Shape,
    pub order: usize,
    pub cells: [usize; 3],
}

pub const KINDS: [Kind; 4] = [
    Kind { shape: Shape::Hexahedron, order: 1, cells: [3, 2, 2] },
    Kind { shape: Shape::Hexahedron, order: 2, cells: [2, 2, 1] },
    Kind { shape: Shape::Tetrahedron, order: 1, cells: [3, 2, 2] },
    Kind { shape: Shape::Tetrahedron, order: 2, cells: [2, 2, 1] },
];

pub const SIZE: [f64; 3] = [0.3, 0.2, 0.1];

pub const FREE: &str = "";
/// Clamped sides, which allow motion along the height only.
pub const SIDEWAYS: &str = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"x\", \"y\"]\n";
/// Springs so stiff that they contribute to the largest frequency.
pub const HELD: &str = "[[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\ncomponents = [\"y\", \"z\"]\n\
    [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [5e13, 1e13, 2e13]\n";
pub const ON_PAD: &str = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0.0, 0.0, -1.0]\nstiffness = 5e13\n\
    [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\ndamping = [1e5, 0.0, 2e6]\n";

/// A body distributed over all ranks of a communicator.
pub struct Parts {
    pub body: Body,
    pub lumped: Lumped,
    pub scene: Scene,
}

/// Makes the body from the scene's mesh. It consists of bricks whose vertices are moved by a fraction of their edges.
/// Collective.
pub fn parts(comm: &Comm, kind: Kind, size: [f64; 3], distortion: f64, supports: &str) -> Parts {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("body.msh");
    std::fs::write(&file, bricks::bricks(kind.shape, size, kind.cells, distortion)).unwrap();
    let (scene, _) = Scene::parse("test", &text(&file, kind.order, size, supports), &[]).unwrap();
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    let body = Body::solid(&scene, &mesh).unwrap();
    let lumped = Lumped::new(&Description::new(&scene), &mesh).unwrap();
    Parts { body, lumped, scene }
}

fn text(file: &Path, order: usize, size: [f64; 3], supports: &str) -> String {
    let top = 0.5 * size[2];
    format!(
        "[body]\nyoung = {YOUNG:e}\npoisson = {POISSON}\ndensity = {DENSITY}\nmesh = {file:?}\norder = {order}\n{supports}\
         [impactor]\nmass = {MASS}\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         point = [0.01, 0.02, {top}]\ndirection = [0.2, 0.0, -1.0]\n[time]\nend = 1e-3\nstep = 1e-5\n"
    )
}

/// Contact stiffness F′ at the peak of the impact on a half-space. No impact on a body exceeds it by much.
pub fn peak_contact(scene: &Scene) -> LinearContact {
    let impactor = &scene.impactor;
    let peak = hertz::peak_indentation(impactor.stiffness, impactor.mass, impactor.speed);
    LinearContact { tangent: Hertz { stiffness: impactor.stiffness }.tangent(peak), mass: impactor.mass }
}

/// Largest frequency ω_max of the parts, with lumped or consistent mass. Collective.
pub fn largest(parts: &mut Parts, consistent: bool, contact: Option<LinearContact>) -> LargestFrequency {
    let inertia = if consistent { Inertia::Consistent } else { Inertia::Lumped(&parts.lumped.mass) };
    largest_frequency(&mut parts.body, inertia, contact).unwrap()
}
