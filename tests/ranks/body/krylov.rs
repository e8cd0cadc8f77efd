//! Long Krylov bases: orthonormal in the mass, and the operators projected onto them.

use crate::glass;
use mpi_test::{Test, tests};
use petsc_wrap::{Session, Vector};
use ricochet::body::{Body, Krylov};
use ricochet::scene::Scene;
use ricochet::space::plate::{Plate, PlateTheory, Settings};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![long_bases_are_orthonormal, projections_grow_with_their_bases];

/// A thin pane by Mindlin's theory on springs, some two thousand unknowns, with dampers of c, N s/m³.
fn body(session: &Session, damping: f64) -> Body {
    let pane = "size = [0.5, 0.5, 0.004]\nmodel = \"mindlin\"";
    let text = glass::scene(pane, "mass = 0.5\nspeed = 3", "end = 0.01", &glass::sides(1e9, damping));
    let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0;
    let settings = Settings::new(1e-1, PlateTheory::Mindlin);
    let plate = Plate::new(&scene, PlateTheory::Mindlin, &settings).unwrap_or_else(|error| panic!("{error}"));
    Body::of(&session.alone(), &plate.system).unwrap()
}

fn grown(body: &Body, vectors: usize) -> Krylov {
    let mut krylov = Krylov::new(body, 1e5).unwrap();
    krylov.grow(body, vectors).unwrap();
    krylov
}

/// Beyond 256 vectors one pass of two takes the last two vectors only.
fn long_bases_are_orthonormal(session: &Session) {
    let body = body(session, 0.0);
    let krylov = grown(&body, 330);
    let basis = krylov.basis();
    assert_eq!(basis.len(), 330);
    let mut momentum = body.load.duplicate().unwrap();
    let mut worst = 0.0_f64;
    for (i, vector) in basis.iter().enumerate() {
        body.apply_mass(vector, &mut momentum).unwrap();
        for (j, product) in momentum.dots(basis).unwrap().into_iter().enumerate() {
            worst = worst.max((product - f64::from(u8::from(i == j))).abs());
        }
    }
    // Rounding of sums of two thousand products, after a second pass.
    assert!(worst < 1e-12, "{worst:e}");
}

/// Block by block as product by product, and in several steps as in one.
fn projections_grow_with_their_bases(session: &Session) {
    let body = body(session, 1e5);
    let mut krylov = grown(&body, 20);
    let first = krylov.projection(&body).unwrap();
    krylov.grow(&body, 75).unwrap();
    let whole = krylov.projection(&body).unwrap();
    assert_eq!((first.vectors(), whole.vectors()), (20, 75));
    let mut image = body.load.duplicate().unwrap();
    for (j, vector) in krylov.basis().iter().enumerate() {
        let mut check = |found: &nalgebra::DMatrix<f64>, apply: &dyn Fn(&Vector, &mut Vector)| {
            apply(vector, &mut image);
            let exact = image.dots(krylov.basis()).unwrap();
            let most = found.amax();
            // Sums of a thousand products in another order.
            assert!(
                exact.iter().enumerate().all(|(i, exact)| (found[(i, j)] - exact).abs() < 1e-12 * most),
                "column {j}"
            );
        };
        check(&whole.elastic, &|v, out| body.apply_elastic(v, out).unwrap());
        check(&whole.support, &|v, out| body.support.as_ref().unwrap().mult(v, out).unwrap());
        check(whole.damping.as_ref().unwrap(), &|v, out| body.damping.as_ref().unwrap().mult(v, out).unwrap());
    }
    assert!(whole.leading(20).elastic == first.elastic);
}
