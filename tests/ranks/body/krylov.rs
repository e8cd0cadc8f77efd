//! Large Krylov bases: orthonormality in the mass matrix, and the operators projected onto the basis.

use crate::glass;
use mpi_test::{Test, tests};
use nalgebra::{DMatrix, DVector};
use petsc_wrap::Session;
use ricochet::body::{
    BodyTerms, Closed, Columns, ContactPort, DirectSum, Krylov, LinearBody, LocalBody, ModalBody, Operator, Start,
};
use ricochet::scene::Scene;
use ricochet::space::plate::{Plate, PlateTheory, Settings};

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    long_bases_are_orthonormal,
    blocks_make_orthonormal_bases,
    blocks_span_the_vectors_of_a_relaxing_body,
    projections_grow_with_their_bases,
    a_free_body_drifts_after_a_short_contact,
    short_waves_have_the_density_of_modes,
    classes_have_bases_of_their_own,
    classes_that_end_leave_the_rest_to_others,
    weak_dampers_do_not_end_a_basis,
    nearly_full_matrices_are_solved_with_and_projected,
];

fn parse(pane: &str, supports: &str) -> Scene {
    let text = glass::scene(pane, "mass = 0.5\nspeed = 3", "end = 0.01", supports);
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// A thin pane by Mindlin's theory on springs, with some two thousand unknowns and dampers of c, N s/m³.
fn body(damping: f64) -> LocalBody {
    let scene = parse("size = [0.5, 0.5, 0.004]\nmodel = \"mindlin\"", &glass::sides(1e9, damping));
    let settings = Settings::new(1e-1, PlateTheory::Layerwise);
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &settings).unwrap_or_else(|error| panic!("{error}"));
    LocalBody::new(plate.system)
}

/// A larger, unsupported pane with coarse cells.
fn free() -> LocalBody {
    let pane = "size = [1.0, 1.5, 0.01]\nmodel = \"mindlin\"";
    coarse(&parse(pane, ""), PlateTheory::Layerwise)
}

/// Two plies of glass with a soft elastic interlayer, on a smaller pane.
fn laminate() -> LocalBody {
    let plies = [("glass", 0.004), ("soft", 0.001), ("glass", 0.004)];
    let layers = plies.map(|(material, h)| format!("[[body.layer]]\nmaterial = \"{material}\"\nthickness = {h}\n"));
    let text = format!(
        "[body]\nsize = [1.0, 0.7]\n{}[material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\n\
         [material.soft]\nyoung = 30e6\npoisson = 0.49\ndensity = 1100\n\
         [impactor]\nmass = 0.5\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 3\n[time]\nend = 0.01\n",
        layers.concat()
    );
    coarse(
        &Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0,
        PlateTheory::Layerwise,
    )
}

fn coarse(scene: &Scene, theory: PlateTheory) -> LocalBody {
    let settings = Settings { cell_size_factor: 2.4, separates_short_waves: true, ..Settings::default() };
    let plate = Plate::new(scene, theory, &settings);
    LocalBody::new(plate.unwrap_or_else(|error| panic!("{error}")).system)
}

fn grown(body: &LocalBody, vectors: usize) -> Krylov {
    let mut krylov = Krylov::new(body, 1e5).unwrap();
    krylov.grow(body, vectors).unwrap();
    krylov
}

/// Splines on few cells couple nearly all unknowns, so their matrices are treated as dense. The first basis vector is
/// the response to a force at the shift, and the projection equals the one computed with the body's own products.
fn nearly_full_matrices_are_solved_with_and_projected(_: &Session) {
    let rate = 1e4;
    for support in [1e9, 1e6] {
        let scene = parse("size = [1.5, 1.5, 0.1]\nmodel = \"mindlin\"", &glass::sides(support, 0.0));
        let theory = PlateTheory::Layerwise;
        let plate = Plate::new(&scene, theory, &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
        let body = LocalBody::new(plate.system);
        let full = (body.unknowns() * body.unknowns()) as f64;
        assert!(body.system().terms.elastic.nnz() as f64 > 0.2 * full, "{} {full}", body.unknowns());
        let mut krylov = Krylov::new(&body, rate).unwrap();
        krylov.grow(&body, 5).unwrap();
        krylov.projection(&body).unwrap();
        krylov.grow(&body, 12).unwrap();
        let projection = krylov.projection(&body).unwrap();
        let basis = krylov.basis();
        let products = basis.products(&body.apply(Operator::Elastic, basis).unwrap());
        // Rounding of sums of some hundred products.
        assert!((products - &projection.terms.elastic).amax() < 1e-12 * projection.terms.elastic.amax());
        // For an unsupported body S q₁ is parallel to the localisation vector a, to the rounding of K's largest
        // entries.
        let first = basis.range(0..1);
        let mut image = body.apply(Operator::Elastic, &first).unwrap();
        image.add(rate * rate, &body.apply(Operator::Mass, &first).unwrap());
        image.add(1.0, &body.apply(Operator::Support, &first).unwrap());
        let properties = body.properties().unwrap();
        let mut force = properties.layout.one(properties.terms.contact.force);
        [&mut image, &mut force].into_iter().for_each(|vector| vector.zero_rows(&properties.held));
        let factor = image.dot(&force) / force.dot(&force);
        image.add(-factor, &force);
        let off = image.largest() / (factor * force.largest()).abs();
        assert!(off < 1e-6, "{off:e}");
    }
}

/// Beyond 256 vectors, one of the two orthogonalisation passes uses the last two vectors only.
fn long_bases_are_orthonormal(_: &Session) {
    let body = body(0.0);
    let krylov = grown(&body, 330);
    assert_eq!(krylov.basis().count(), 330);
    // Rounding of sums of two thousand products, after a second pass.
    let worst = off_orthonormal(&body, krylov.basis());
    assert!(worst < 1e-12, "{worst:e}");
}

/// Largest entry of VᵀMV − 1.
fn off_orthonormal(body: &LocalBody, basis: &Columns) -> f64 {
    let products = basis.products(&body.apply(Operator::Mass, basis).unwrap());
    (products - DMatrix::identity(basis.count(), basis.count())).amax()
}

/// Vectors orthogonalised in blocks are orthonormal too, and the first ones do not change as the basis grows.
fn blocks_make_orthonormal_bases(_: &Session) {
    let body = body(0.0);
    let mut blocks = Krylov::new(&body, Start { in_blocks: true, ..Start::from(1e5) }).unwrap();
    blocks.grow(&body, 100).unwrap();
    let first = blocks.projection(&body).unwrap();
    blocks.grow(&body, 330).unwrap();
    let whole = blocks.projection(&body).unwrap();
    assert!(whole.leading(100).terms.elastic == first.terms.elastic && whole.vectors() == 330);
    let worst = off_orthonormal(&body, blocks.basis());
    // Rounding of sums of two thousand products.
    assert!(worst < 1e-12, "{worst:e}");
}

/// A thin laminate whose interlayer relaxes little: its vectors are made at one shift.
fn relaxing() -> LocalBody {
    let layer = |thickness: f64, material: &str| {
        format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
    };
    let layers = [layer(0.004, "glass"), layer(0.00076, "soft"), layer(0.004, "glass")].concat();
    let text = format!(
        "[body]\nsize = [0.3, 0.2]\nmodel = \"layerwise\"\n{layers}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.soft]\nbulk = 2e9\ndensity = 1100.0\nshear = 8e6\nprony = [{{ modulus = 3e6, time = 1e-4 }}]\n\
         [impactor]\nmass = 0.5\nradius = 0.05\nstiffness = 1e10\nspeed = 3.0\n[time]\nend = 1e-2\n"
    );
    let (scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let settings = Settings::new(1e-1, PlateTheory::Layerwise);
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &settings).unwrap_or_else(|error| panic!("{error}"));
    LocalBody::new(plate.system)
}

/// With relaxation, vectors made in blocks and one by one span the same space.
fn blocks_span_the_vectors_of_a_relaxing_body(_: &Session) {
    let body = relaxing();
    assert_eq!(body.chains().len(), 1);
    let grown = |in_blocks: bool| {
        let mut krylov = Krylov::new(&body, Start { in_blocks, ..Start::from(1e5) }).unwrap();
        krylov.grow(&body, 60).unwrap();
        krylov
    };
    let [blocks, singly] = [true, false].map(grown);
    let worst = off_orthonormal(&body, blocks.basis());
    // Rounding of sums of two thousand products.
    assert!(worst < 1e-12, "{worst:e}");
    let momenta = body.apply(Operator::Mass, &blocks.basis().range(0..40)).unwrap();
    let within = singly.basis().products(&momenta);
    let outside = within.column_iter().map(|column| (1.0 - column.norm_squared()).abs().sqrt()).fold(0.0, f64::max);
    println!("  part outside: {outside:e}");
    // A factor in single precision would leave 1e-7 and the rounding of earlier vectors; measured: 6e-8.
    assert!(outside < 1e-5, "{outside:e}");
}

/// The projection is the same by blocks and by single products, and in several steps and in one.
fn projections_grow_with_their_bases(_: &Session) {
    let body = body(1e5);
    let mut krylov = grown(&body, 20);
    let first = krylov.projection(&body).unwrap();
    krylov.grow(&body, 75).unwrap();
    let whole = krylov.projection(&body).unwrap();
    assert_eq!((first.vectors(), whole.vectors()), (20, 75));
    for (operator, found) in [
        (Operator::Elastic, &whole.terms.elastic),
        (Operator::Support, whole.terms.support.as_ref().unwrap()),
        (Operator::Damping, whole.terms.damping.as_ref().unwrap()),
    ] {
        let exact = krylov.basis().products(&body.apply(operator, krylov.basis()).unwrap());
        // Sums of a thousand products in another order.
        assert!((found - exact).amax() < 1e-12 * found.amax(), "{operator:?}");
    }
    assert!(whole.leading(20).terms.elastic == first.terms.elastic);
}

/// On a basis for a contact of any duration, a force moves an unsupported body with the acceleration 1/m, to rounding.
fn a_free_body_drifts_after_a_short_contact(_: &Session) {
    let body = free();
    let mut krylov = Krylov::new(&body, 3e6).unwrap();
    krylov.grow(&body, 12).unwrap();
    let modes = ModalBody::of(&krylov.projection(&body).unwrap());
    let closed = Closed { tangent: 1e6, compliance: 0.0, mass: 0.033, accuracy: 1e-9, end: 1.0 };
    let free = modes.modes(1e12, &closed).unwrap().free;
    let mass = 2500.0 * 1.0 * 1.5 * 0.01;
    let drift = free.mobility * mass / body.system().terms.multiplicity;
    // Rounding of a mass of a thousand entries.
    assert!((drift - 1.0).abs() < 1e-9, "{drift}");
}

/// The modes of a plate respond at the impact point like the waves of an infinite plate: Σ φ² up to a frequency follows
/// from the infinite plate's density of modes, and the number of modes from the closed form.
fn short_waves_have_the_density_of_modes(_: &Session) {
    for (name, body, vectors, modes_below) in [("one layer", free(), 160, 100.0), ("laminate", laminate(), 200, 100.0)]
    {
        let mut krylov = Krylov::new(&body, 3e4).unwrap();
        krylov.grow(&body, vectors).unwrap();
        let projection = krylov.projection(&body).unwrap();
        let closed = Closed { tangent: 1e6, compliance: 0.0, mass: 1.0, accuracy: 1e-9, end: 1.0 };
        let modes = ModalBody::of(&projection).modes(1e12, &closed).unwrap();
        let plate = body.infinite_plate().unwrap();
        let frequency = plate.modes.frequency(modes_below);
        let below: Vec<f64> =
            modes.modes.iter().filter(|mode| mode.rate.im < frequency).map(|mode| mode.input.re).collect();
        let sum = modes.free.mobility + below.iter().map(|input| input * input).sum::<f64>();
        let waves: f64 = (0..1000).map(|i| plate.density_at(frequency * (f64::from(i) + 0.5) / 1000.0)).sum::<f64>()
            * frequency
            / 1000.0;
        println!("  {name}: {} modes of {modes_below:.0}, mobility {:.4} of the waves'", below.len(), sum / waves);
        // The difference is about one wave of a hundred, with reflections from the edges: 0.1% to 3% were found for
        // other frequencies.
        assert!((sum / waves - 1.0).abs() < 0.05, "{name}: {sum} {waves}");
        // The edges change the number of modes by about its square root.
        assert!((below.len() as f64 / modes_below - 1.0).abs() < 0.25, "{name}: {}", below.len());
    }
}

/// With weak dampers at a low shift, a vector soon lies in the basis to rounding, but the basis grows on. On it, the
/// response to a force at other rates is that of the whole body. (When such a vector ended the sequence, the basis
/// had 41 vectors, whatever number was asked for.)
fn weak_dampers_do_not_end_a_basis(_: &Session) {
    let scene = parse("size = [0.5, 0.4, 0.01]\nmodel = \"mindlin\"", &glass::sides(1e8, 1e3));
    let body = coarse(&scene, PlateTheory::Layerwise);
    let properties = body.properties().unwrap();
    let moving: Vec<usize> = (0..body.unknowns()).filter(|unknown| !properties.held.contains(unknown)).collect();
    let mut unit = properties.layout.zeros(moving.len());
    moving.iter().enumerate().for_each(|(column, &row)| unit.get_mut(column)[row] = 1.0);
    let full = |operator| unit.products(&body.apply(operator, &unit).unwrap());
    let [stiffness, damping, mass] =
        [full(Operator::Elastic) + full(Operator::Support), full(Operator::Damping), full(Operator::Mass)];
    let force = DVector::from_vec(properties.terms.contact.force).select_rows(&moving);
    let exact = |rate: f64| {
        let operator = &stiffness + &damping * rate + &mass * (rate * rate);
        force.dot(&operator.cholesky().expect("a response").solve(&force))
    };
    let mut krylov = Krylov::new(&body, 3e3).unwrap();
    let rates = [3e2, 1e4, 3e4];
    let off = [30, 90].map(|vectors| {
        krylov.grow(&body, vectors).unwrap();
        assert_eq!(krylov.vectors(), vectors);
        let BodyTerms { elastic, support, damping, contact: ContactPort { force, .. }, .. } =
            krylov.projection(&body).unwrap().terms;
        let supported = elastic + support.expect("springs");
        let worst = rates.map(|rate| {
            let damping = damping.as_ref().expect("dampers") * rate;
            let operator = &supported + damping + DMatrix::identity(vectors, vectors) * (rate * rate);
            let found = force.dot(&operator.lu().solve(&force).expect("a response"));
            (found / exact(rate) - 1.0).abs()
        });
        worst.into_iter().fold(0.0, f64::max)
    });
    println!("  {off:?}");
    assert!(off_orthonormal(&body, krylov.basis()) < 1e-12);
    // Rounding of the solutions by the whole matrices.
    assert!(off.iter().all(|off| *off < 1e-9), "{off:?}");
}

/// Classes that can add no further vectors leave them to the others, until all have ended. (The division of the last
/// vectors among classes that had ended did not end.)
fn classes_that_end_leave_the_rest_to_others(_: &Session) {
    let hit = "mass = 0.5\nspeed = 3\npoint = [0.1, 0.07, 0.01]";
    let text = glass::scene("size = [0.5, 0.4, 0.02]\nmodel = \"mindlin\"", hit, "end = 0.01", &glass::sides(1e9, 1e4));
    let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0;
    let body = coarse(&scene, PlateTheory::Layerwise);
    assert_eq!(body.classes().len(), 4);
    let mut sum = DirectSum::new(&body, 1e4).unwrap();
    for vectors in (50..).step_by(50).take_while(|vectors| *vectors < 2 * body.unknowns()) {
        sum.grow(&body, vectors).unwrap();
        assert!(sum.vectors() == vectors || sum.is_exhausted(), "{} of {vectors}", sum.vectors());
        if sum.is_exhausted() {
            break;
        }
    }
    println!("  {} vectors of {} unknowns", sum.vectors(), body.unknowns());
    assert!(sum.is_exhausted() && off_orthonormal(&body, sum.basis()) < 1e-10);
}

/// A pane hit off its centre has four symmetry classes. Their bases together are a basis of the whole body: orthonormal
/// in the mass, and K is the projected one. Each class has the same number of vectors, and no vector belongs to two
/// classes.
fn classes_have_bases_of_their_own(_: &Session) {
    let pane = "size = [0.5, 0.4, 0.01]\nmodel = \"mindlin\"";
    let hit = "mass = 0.5\nspeed = 3\npoint = [0.1, 0.07, 0.005]";
    let text = glass::scene(pane, hit, "end = 0.01", &glass::sides(1e9, 0.0));
    let scene = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0;
    let settings = Settings::new(1e-1, PlateTheory::Layerwise);
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &settings).unwrap_or_else(|error| panic!("{error}"));
    let body = LocalBody::new(plate.system);
    assert_eq!((body.classes().len(), body.unknowns()), (4, 4 * body.classes()[0].unknowns()));
    let mut sum = DirectSum::new(&body, 1e5).unwrap();
    sum.grow(&body, 30).unwrap();
    let first = sum.projection(&body).unwrap();
    sum.grow(&body, 60).unwrap();
    let whole = sum.projection(&body).unwrap();
    assert!(
        whole.leading(30).terms.elastic == first.terms.elastic
            && whole.leading(30).terms.contact.force == first.terms.contact.force
    );
    let basis = sum.basis();
    assert_eq!(basis.count(), 60);
    // Rounding of sums of two thousand products.
    let worst = off_orthonormal(&body, basis);
    assert!(worst < 1e-12, "{worst:e}");
    let springs = basis.products(&body.apply(Operator::Elastic, basis).unwrap());
    assert!((springs - &whole.terms.elastic).amax() < 1e-12 * whole.terms.elastic.amax());
    let size = body.unknowns() / 4;
    for (j, entries) in basis.iter().enumerate() {
        let met = (0..4).filter(|class| entries[class * size..(class + 1) * size].iter().any(|v| *v != 0.0));
        assert_eq!(met.collect::<Vec<_>>(), [j % 4], "{j}");
    }
    // The projection of the localisation vector a of the whole; the force excites all classes.
    let force = basis.along(&body.system().terms.contact.force);
    assert!((&whole.terms.contact.force - force).amax() < 1e-12 * whole.terms.contact.force.amax());
    assert!((0..4).all(|class| whole.terms.contact.force[class] != 0.0));
}
