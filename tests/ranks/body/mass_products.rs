//! Tests the products with the mass matrix of a mesh, whose entries are stored once for three components.

use crate::glass;
use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::body::Body;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[1, 2, 3];
pub const TESTS: &[Test<Session>] = tests![products_are_those_of_the_matrix];

/// The product with a pseudo-random vector equals that by the assembled matrix, up to the rounding of sums of a hundred
/// terms.
fn products_are_those_of_the_matrix(session: &Session) {
    let text =
        glass::plate("size = [0.5, 0.4, 0.05]\nmodel = \"solid\"\ncells = [5, 4, 1]", "end = 1e-4\nstep = 1e-5", "");
    let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0;
    let mesh = Mesh::new(&session.world(), &scene.body).unwrap();
    let body = Body::solid(&scene, &mesh).unwrap();
    let [mut found, mut expected] = [body.terms.load.duplicate().unwrap(), body.terms.load.duplicate().unwrap()];
    body.apply_mass(&body.deviates, &mut found).unwrap();
    body.mass.mult(&body.deviates, &mut expected).unwrap();
    let largest = expected.norm_max().unwrap();
    found.axpy(-1.0, &expected).unwrap();
    let error = found.norm_max().unwrap() / largest;
    assert!(largest > 0.0 && error < 1e-14, "{error:e}");
}
