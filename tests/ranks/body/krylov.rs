//! Long Krylov bases: orthonormal in the mass, and the operators projected onto them.

use crate::glass;
use mpi_test::{Test, tests};
use petsc_wrap::{Session, Vector};
use ricochet::body::{Body, Closed, DirectSum, Krylov, ModalBody, Start};
use ricochet::scene::Scene;
use ricochet::space::plate::{Plate, PlateTheory, Settings};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    long_bases_are_orthonormal,
    blocks_make_orthonormal_bases,
    projections_grow_with_their_bases,
    a_free_body_drifts_after_a_short_contact,
    short_waves_have_the_density_of_modes,
    classes_have_bases_of_their_own,
    nearly_full_matrices_are_solved_with_and_projected,
];

fn parse(pane: &str, supports: &str) -> Scene {
    let text = glass::scene(pane, "mass = 0.5\nspeed = 3", "end = 0.01", supports);
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// A thin pane by Mindlin's theory on springs, some two thousand unknowns, with dampers of c, N s/m³.
fn body(session: &Session, damping: f64) -> Body {
    let scene = parse("size = [0.5, 0.5, 0.004]\nmodel = \"mindlin\"", &glass::sides(1e9, damping));
    let settings = Settings::new(1e-1, PlateTheory::Mindlin);
    let plate = Plate::new(&scene, PlateTheory::Mindlin, &settings).unwrap_or_else(|error| panic!("{error}"));
    Body::of(&session.alone(), &plate.system).unwrap()
}

/// A larger pane on no springs, in coarse cells.
fn free(session: &Session) -> Body {
    let pane = "size = [1.0, 1.5, 0.01]\nmodel = \"mindlin\"";
    let scene = parse(pane, "");
    let plate = Plate::new(&scene, PlateTheory::Mindlin, &Settings { cell_size_factor: 2.4, ..Settings::default() });
    Body::of(&session.alone(), &plate.unwrap_or_else(|error| panic!("{error}")).system).unwrap()
}

fn grown(body: &Body, vectors: usize) -> Krylov {
    let mut krylov = Krylov::new(body, 1e5).unwrap();
    krylov.grow(body, vectors).unwrap();
    krylov
}

/// Splines on few cells couple nearly all unknowns: their matrices are taken as full ones. The first vector is what a force does at the rate,
/// and the projection is that by the body's own products.
fn nearly_full_matrices_are_solved_with_and_projected(session: &Session) {
    let rate = 1e4;
    for support in [1e9, 1e6] {
        let scene = parse("size = [1.5, 1.5, 0.1]\nmodel = \"mindlin\"", &glass::sides(support, 0.0));
        let theory = PlateTheory::Mindlin;
        let plate = Plate::new(&scene, theory, &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
        let body = Body::of(&session.alone(), &plate.system).unwrap();
        let full = (body.unknowns() * body.unknowns()) as f64;
        assert!(body.elastic.entries().unwrap() as f64 > 0.2 * full, "{} {full}", body.unknowns());
        let mut krylov = Krylov::new(&body, rate).unwrap();
        krylov.grow(&body, 5).unwrap();
        krylov.projection(&body).unwrap();
        krylov.grow(&body, 12).unwrap();
        let projection = krylov.projection(&body).unwrap();
        let basis = krylov.basis();
        let mut image = body.load.duplicate().unwrap();
        let largest = projection.elastic.amax();
        for (j, vector) in basis.iter().enumerate() {
            body.apply_elastic(vector, &mut image).unwrap();
            for (i, product) in image.dots(basis).unwrap().into_iter().enumerate() {
                // Rounding of sums of some hundred products.
                assert!((product - projection.elastic[(i, j)]).abs() < 1e-12 * largest, "{i} {j}");
            }
        }
        // S q₁ is along a where nothing is held, to the rounding of K's largest entries.
        body.operator(0.0, rate * rate).unwrap().mult(&basis[0], &mut image).unwrap();
        let mut force = body.load.duplicate().unwrap();
        force.copy_from(&body.localization.vector).unwrap();
        body.clamps.zero(&mut force).unwrap();
        let factor = image.dot(&force).unwrap() / force.dot(&force).unwrap();
        image.axpy(-factor, &force).unwrap();
        let off = image.norm_max().unwrap() / (factor * force.norm_max().unwrap()).abs();
        assert!(off < 1e-6, "{off:e}");
    }
}

/// Beyond 256 vectors one pass of two takes the last two vectors only.
fn long_bases_are_orthonormal(session: &Session) {
    let body = body(session, 0.0);
    let krylov = grown(&body, 330);
    assert_eq!(krylov.basis().len(), 330);
    // Rounding of sums of two thousand products, after a second pass.
    let worst = off_orthonormal(&body, krylov.basis());
    assert!(worst < 1e-12, "{worst:e}");
}

/// Largest entry of VᵀMV − 1.
fn off_orthonormal(body: &Body, basis: &[Vector]) -> f64 {
    let mut momentum = body.load.duplicate().unwrap();
    let mut worst = 0.0_f64;
    for (i, vector) in basis.iter().enumerate() {
        body.apply_mass(vector, &mut momentum).unwrap();
        for (j, product) in momentum.dots(basis).unwrap().into_iter().enumerate() {
            worst = worst.max((product - f64::from(u8::from(i == j))).abs());
        }
    }
    worst
}

/// Vectors that are made orthogonal in blocks are orthonormal too, and the first of them stay the same as the basis grows.
fn blocks_make_orthonormal_bases(session: &Session) {
    let body = body(session, 0.0);
    let mut blocks = Krylov::new(&body, Start { in_blocks: true, ..Start::from(1e5) }).unwrap();
    blocks.grow(&body, 100).unwrap();
    let first = blocks.projection(&body).unwrap();
    blocks.grow(&body, 330).unwrap();
    let whole = blocks.projection(&body).unwrap();
    assert!(whole.leading(100).elastic == first.elastic && whole.vectors() == 330);
    let worst = off_orthonormal(&body, blocks.basis());
    // Rounding of sums of two thousand products.
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

/// However short the contact is for which a basis is made, a force moves a free body as a whole by 1/m, to rounding.
fn a_free_body_drifts_after_a_short_contact(session: &Session) {
    let body = free(session);
    let mut krylov = Krylov::new(&body, 3e6).unwrap();
    krylov.grow(&body, 12).unwrap();
    let modes = ModalBody::of(&krylov.projection(&body).unwrap());
    let closed = Closed { tangent: 1e6, compliance: 0.0, mass: 0.033, accuracy: 1e-9 };
    let free = modes.modes(1e12, &closed).unwrap().free;
    let mass = 2500.0 * 1.0 * 1.5 * 0.01;
    let drift = free.mobility * mass / body.copies;
    // Rounding of a mass of a thousand entries.
    assert!((drift - 1.0).abs() < 1e-9, "{drift}");
}

/// The modes of a plate reach what is hit as the waves of an infinite one do: Σ φ² up to a frequency is that of the infinite plate's
/// density, and the number of modes is the closed form's.
fn short_waves_have_the_density_of_modes(session: &Session) {
    let body = free(session);
    let mut krylov = Krylov::new(&body, 3e4).unwrap();
    krylov.grow(&body, 160).unwrap();
    let projection = krylov.projection(&body).unwrap();
    let closed = Closed { tangent: 1e6, compliance: 0.0, mass: 1.0, accuracy: 1e-9 };
    let modes = ModalBody::of(&projection).modes(1e12, &closed).unwrap();
    let plate = body.infinite_plate.as_ref().unwrap();
    let frequency = 100.0 / plate.modes;
    let below: Vec<f64> =
        modes.modes.iter().filter(|mode| mode.rate.im < frequency).map(|mode| mode.input.re).collect();
    let sum = modes.free.mobility + below.iter().map(|input| input * input).sum::<f64>();
    let waves: f64 = (0..1000).map(|i| plate.density_at(frequency * (f64::from(i) + 0.5) / 1000.0)).sum::<f64>()
        * frequency
        / 1000.0;
    println!("  {} modes of {:.0}, mobility {:.4} of the waves'", below.len(), plate.modes * frequency, sum / waves);
    // A wave more or less of a hundred, with echoes from the edges: 0.1% to 3% were found up to other frequencies.
    assert!((sum / waves - 1.0).abs() < 0.05, "{sum} {waves}");
    // Edges add and take modes by the root of the number.
    assert!((below.len() as f64 / 100.0 - 1.0).abs() < 0.25, "{}", below.len());
}

/// A pane hit off its centre: four classes, whose bases are together one of the whole body, orthonormal in the mass, on which K is as
/// projected; of each class there are as many vectors, and none is of two.
fn classes_have_bases_of_their_own(session: &Session) {
    let pane = "size = [0.5, 0.4, 0.01]\nmodel = \"mindlin\"";
    let hit = "mass = 0.5\nspeed = 3\npoint = [0.1, 0.07, 0.005]";
    let text = glass::scene(pane, hit, "end = 0.01", &glass::sides(1e9, 0.0));
    let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0;
    let settings = Settings::new(1e-1, PlateTheory::Mindlin);
    let plate = Plate::new(&scene, PlateTheory::Mindlin, &settings).unwrap_or_else(|error| panic!("{error}"));
    let body = Body::of(&session.alone(), &plate.system).unwrap();
    assert_eq!((body.classes.len(), body.unknowns()), (4, 4 * body.classes[0].unknowns()));
    let mut sum = DirectSum::new(&body, 1e5).unwrap();
    sum.grow(&body, 30).unwrap();
    let first = sum.projection(&body).unwrap();
    sum.grow(&body, 60).unwrap();
    let whole = sum.projection(&body).unwrap();
    assert!(whole.leading(30).elastic == first.elastic && whole.leading(30).force == first.force);
    let basis = sum.basis().unwrap();
    assert_eq!(basis.len(), 60);
    let mut image = body.load.duplicate().unwrap();
    let size = body.unknowns() / 4;
    for (j, vector) in basis.iter().enumerate() {
        body.apply_mass(vector, &mut image).unwrap();
        let masses = image.dots(basis).unwrap();
        body.apply_elastic(vector, &mut image).unwrap();
        let springs = image.dots(basis).unwrap();
        for i in 0..60 {
            // Rounding of sums of two thousand products.
            assert!((masses[i] - f64::from(u8::from(i == j))).abs() < 1e-12, "{i} {j}: {}", masses[i]);
            assert!((springs[i] - whole.elastic[(i, j)]).abs() < 1e-12 * whole.elastic.amax(), "{i} {j}");
        }
        let entries = vector.read().unwrap();
        let met = (0..4).filter(|class| entries[class * size..(class + 1) * size].iter().any(|v| *v != 0.0));
        assert_eq!(met.collect::<Vec<_>>(), [j % 4], "{j}");
    }
    // a of the whole on the basis, which the force excites in all classes.
    let force = body.localization.vector.dots(basis).unwrap();
    for (j, exact) in force.into_iter().enumerate() {
        assert!((whole.force[j] - exact).abs() < 1e-12 * whole.force.amax(), "{j}");
    }
    assert!((0..4).all(|class| whole.force[class] != 0.0));
}
