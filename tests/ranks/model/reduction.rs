//! Reduced bodies are compared with the full ones, with the same time steps, to check the estimated error of the basis.

use crate::glass::{plate, sides};
use crate::modelled::{Ran, parse, run, run_scene};
use mpi_test::{Test, tests};
use petsc_wrap::Session;
use ricochet::body::{Krylov, ModalBody, Projection};
use ricochet::impact::{ModalImpact, Steps};
use ricochet::model::watch::Unwatched;
use ricochet::model::{Built, ModelContext, build, rate, reduce};
use ricochet::scene::{Newton, Reduction, Scene, Solver};

/// On one rank: bases are tested on several ranks together with their bodies.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    the_estimate_is_the_error,
    a_free_body_keeps_its_motion,
    loads_leave_the_force_its_vectors,
    a_loaded_body_is_stable_in_long_steps,
    short_waves_act_as_those_of_a_basis,
    short_waves_of_laminates_act_as_those_of_a_basis,
    short_waves_of_strongly_relaxing_laminates_act_as_those_of_a_basis,
    growing_bases_are_judged_in_steps_that_show_their_modes,
];
pub const LONG: &[Test<Session>] =
    tests![the_estimate_is_the_error_on_more_plates, short_waves_of_relaxing_laminates_act_as_those_of_a_basis,];

/// The paper's plates with coarse quadratic hexahedra. Both runs use Newmark's method with the same time step, so the
/// basis is the only difference. Time steps and mesh need not be fine for this.
fn scene(size: &str, cells: &str, supports: &str) -> Scene {
    let body = format!("model = \"solid\"\nsize = {size}\ncells = {cells}");
    parse(
        &(plate(&body, "end = 8e-3\nstep = 2e-5\nscheme = \"newmark\"", supports) + "[contact]\npatch_radius = 0.03\n"),
    )
}

fn the_estimate_is_the_error(session: &Session) {
    check_estimates(session, &[("[1.5, 1.5, 0.1]", "[12, 12, 2]")], &[sides(1e10, 0.0)]);
    check_estimates(session, &[("[0.5, 0.5, 0.02]", "[12, 12, 2]")], &[String::new(), sides(1e8, 2e5)]);
}

fn the_estimate_is_the_error_on_more_plates(session: &Session) {
    let plates =
        [("[1.5, 1.5, 0.1]", "[16, 16, 2]"), ("[1.5, 1.5, 0.04]", "[20, 20, 2]"), ("[0.5, 0.5, 0.02]", "[16, 16, 2]")];
    let supports = [String::new(), sides(1e8, 0.0), sides(1e9, 0.0), sides(1e10, 0.0), sides(1e8, 2e5)];
    check_estimates(session, &plates, &supports);
}

/// Checks the estimates for plates (size and cells) and supports, with few and many basis vectors.
fn check_estimates(session: &Session, plates: &[(&str, &str)], supports: &[String]) {
    let comm = session.world();
    for &(size, cells) in plates {
        for supports in supports {
            let full = scene(size, cells, supports);
            assert!(!full.time.modal && full.solver == Solver { newton: Newton::Condensed, energy_gate: None });
            let reference = run_scene(&comm, &full);
            for vectors in [24, 48] {
                let mut reduced = full.clone();
                reduced.body.reduction = Reduction::Vectors(vectors);
                let ran = run_scene(&comm, &reduced);
                assert_eq!((reference.vectors, ran.vectors), (None, Some(vectors)));
                let (_, error) = reference.difference(&ran);
                let estimate = without_patch(ran.error, thickness(size));
                println!(
                    "  {size} {:?} {vectors} vectors: error {error:.1e}, estimate {estimate:.1e}",
                    supports.lines().last()
                );
                // Rounding differs between the two runs: 1e-9 of the peak.
                assert!(error <= estimate + 1e-9, "{size} {supports} {vectors}: {error:e} over {estimate:e}");
                assert!(estimate <= 10.0 * error + 1e-8, "{size} {supports} {vectors}: {estimate:e} for {error:e}");
            }
        }
    }
}

/// The part of an estimate that is due to the basis. The part of the patch is known, and both are combined as the sum
/// of their powers of 1.5.
fn without_patch(estimate: f64, thickness: f64) -> f64 {
    let of_patch = 0.025 * (0.03_f64 / thickness).powi(2);
    (estimate.powf(1.5) - of_patch.powf(1.5)).powf(1.0 / 1.5)
}

fn thickness(size: &str) -> f64 {
    size.trim_end_matches(']').rsplit(", ").next().unwrap().parse().unwrap()
}

/// A basis contains the rigid motions: momentum is transferred to the body to rounding, without supports.
fn a_free_body_keeps_its_motion(session: &Session) {
    let comm = session.world();
    let text = plate(
        "model = \"solid\"\nsize = [0.5, 0.5, 0.02]\ncells = [8, 8, 2]",
        "end = 5e-3",
        "[contact]\npatch_radius = 0.03\n",
    );
    let ran = run_scene(&comm, &parse(&text));
    let (mass, body) = (52.0, 2500.0 * 0.5 * 0.5 * 0.02);
    let last = ran.steps.last().unwrap();
    let initial = ran.steps[0].energy.total;
    // The numerical energy of the integration, for a tolerance of 1e-2.
    assert!(last.energy.numerical.abs() < 1e-3 * initial, "{:e}", last.energy.numerical);
    let balance = last.energy.total - last.energy.numerical - initial;
    assert!(balance.abs() < 1e-10 * initial, "{balance:e}");
    let momentum = mass * (1.0 - last.impactor.velocity);
    assert!(last.energy.kinetic >= 0.5 * momentum * momentum / body * (1.0 - 1e-9));
}

/// A weight accelerates a free body as a whole and has no other effect: it needs one vector of the basis, and the force
/// has the others.
fn loads_leave_the_force_its_vectors(session: &Session) {
    let comm = session.world();
    let weight = "[load]\nbody_force = [0.0, 0.0, -24525.0]\n[contact]\npatch_radius = 0.03\n";
    let body = "model = \"solid\"\nsize = [0.5, 0.5, 0.02]\ncells = [12, 12, 2]";
    let full = parse(&plate(body, "end = 4e-3\nstep = 2e-5\nscheme = \"newmark\"", weight));
    let mut reduced = full.clone();
    reduced.body.reduction = Reduction::Vectors(48);
    let [full, ran] = [full, reduced].map(|scene| run_scene(&comm, &scene));
    assert_eq!(ran.vectors, Some(48));
    let (_, error) = full.difference(&ran);
    let estimate = without_patch(ran.error, 0.02);
    println!("  error {error:.1e}, estimate {estimate:.1e}");
    assert!(error <= estimate && estimate < 1e-2, "{error:e} {estimate:e}");
}

/// The impactor hits a loaded plate. The steps do not resolve most modes. These respond to the contact as springs, and no
/// energy is created. (With all modes in motion, a contact in long steps gained 44%
/// of the initial energy.)
fn a_loaded_body_is_stable_in_long_steps(session: &Session) {
    let rest = "[load]\nbody_force = [0.0, 0.0, -24525.0]\n\
                [[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n";
    let body = "model = \"mindlin\"\nsize = [0.5, 0.4, 0.006]\nreduction = 60";
    let ran = run(&session.world(), &plate(body, "end = 0.02\nstep = 5e-4", rest));
    let created = ran.steps.iter().map(|step| step.energy.numerical.abs());
    let created = created.fold(0.0, f64::max) / ran.steps[0].energy.total;
    println!("  {created:.1e} in {} contacts", ran.contacts.len());
    // The quadratic force within a step follows the contact law to about a thousandth.
    assert!(!ran.contacts.is_empty() && created < 1e-3, "{created:e}");
}

/// A light ball on a thin plate excites short waves. The part that a basis does not represent is added by the waves of
/// the infinite plate, waves of thickness shear included. The result equals the result with a basis of all waves.
/// (Without the waves of thickness shear the error of the force was 1.3e-3 of its peak.)
fn short_waves_act_as_those_of_a_basis(session: &Session) {
    let comm = session.world();
    let text = |vectors: &str| {
        format!(
            "[body]\nmodel = \"mindlin\"\nyoung = 206e9\npoisson = 0.3\ndensity = 7833.0\nsize = [0.22, 0.22, 0.0026]\n{vectors}\n\
             [impactor]\nyoung = 210e9\npoisson = 0.3\nmass = 0.12\nradius = 0.013\nspeed = 0.71\n\
             [time]\nend = 4e-5\n[accuracy]\ntolerance = 5e-4\n"
        )
    };
    check_short_waves(["", "reduction = 300"].map(|vectors| run(&comm, &text(vectors))), 1e-3);
}

/// Compares a run whose basis leaves short waves out with one on a basis that contains them.
fn check_short_waves([apart, all]: [Ran; 2], limit: f64) {
    assert!(apart.vectors < all.vectors, "the first one is to leave waves out: {:?}", apart.vectors);
    let (error, _) = all.difference(&apart);
    let estimates = apart.error + all.error;
    println!("  {:?} vectors, {error:.1e} off {:?}; estimates {estimates:.1e}", apart.vectors, all.vectors);
    assert!(error <= estimates && estimates < limit, "{error:e} {estimates:e}");
}

/// The same on a wide laminate, whose short waves have the dispersion of its layers. The force on the shorter basis
/// equals that on a basis of all waves, within the estimated errors of both.
fn short_waves_of_laminates_act_as_those_of_a_basis(session: &Session) {
    let interlayer = "young = 300e6\npoisson = 0.495";
    check_short_waves_of_laminates(session, "[0.6, 0.4]", interlayer, ("mass = 0.5\nradius = 0.04", 200));
}

/// The same with an interlayer that relaxes during the contact.
fn short_waves_of_relaxing_laminates_act_as_those_of_a_basis(session: &Session) {
    let interlayer =
        "bulk = 2e9\nshear = 5e6\nprony = [{ modulus = 7e6, time = 1e-5 }, { modulus = 4e6, time = 1e-4 }]";
    check_short_waves_of_laminates(session, "[0.5, 0.4]", interlayer, ("mass = 0.2\nradius = 0.02", 450));
}

/// The same with an interlayer that keeps a third of its modulus, so that the plies come apart. Its basis has vectors at several
/// shifts, with the modulus at each.
fn short_waves_of_strongly_relaxing_laminates_act_as_those_of_a_basis(session: &Session) {
    let interlayer =
        "bulk = 2e9\nshear = 8e5\nprony = [{ modulus = 80e6, time = 5e-5 }, { modulus = 30e6, time = 1e-3 }]";
    check_short_waves_of_laminates(session, "[0.4, 0.4]", interlayer, ("mass = 0.5\nradius = 0.04", 300));
}

/// Compares the automatic basis, without short waves, with a basis of `vectors` vectors that contains them.
fn check_short_waves_of_laminates(session: &Session, size: &str, interlayer: &str, (impactor, vectors): (&str, usize)) {
    let layer = |(material, h): (&str, f64)| format!("[[body.layer]]\nmaterial = \"{material}\"\nthickness = {h}\n");
    let layers = [("glass", 0.005), ("soft", 0.00152), ("glass", 0.005)].map(layer).concat();
    let runs = [String::new(), format!("reduction = {vectors}")].map(|basis| {
        let text = format!(
            "[body]\nmodel = \"layerwise\"\nsize = {size}\n{basis}\n{layers}\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.soft]\ndensity = 1100.0\n{interlayer}\n\
             [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [0.0, 0.0, 5e8]\n\
             [impactor]\nyoung = 210e9\npoisson = 0.3\n{impactor}\nspeed = 4.0\n\
             [time]\nend = 4e-4\nstep = 2e-6\n[accuracy]\ntolerance = 1e-2\n"
        );
        run(&session.world(), &text)
    });
    check_short_waves(runs, 1.6e-2);
}

/// A basis that grows from ten vectors is compared in time steps that resolve the modes of its last vectors: its error
/// in the first contact is within its estimate. (In the time steps of the first vectors, bases of 19 and 30 vectors
/// differed by only 2e-11 of the peak, but their error was 2e-4.)
fn growing_bases_are_judged_in_steps_that_show_their_modes(session: &Session) {
    let comm = session.world();
    let scene = parse(
        "[body]\nmodel = \"solid\"\nyoung = 3e9\npoisson = 0.45\ndensity = 1200.0\nsize = [0.06, 0.06, 0.0026]\n\
         [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e8\n\
         [impactor]\nmass = 4.8\nradius = 0.02\nyoung = 210e9\npoisson = 0.3\nspeed = 0.56\n\
         [time]\nend = 5.4e-3\n[accuracy]\ntolerance = 1e-3\n",
    );
    let Built::Operators(built) =
        build(&ModelContext::new(&comm, &Unwatched(&comm)), &scene, scene.body.model, 1.0).unwrap()
    else {
        panic!("a box has cells of its own");
    };
    let body = built.body.linear();
    let reduced = reduce(&ModelContext::new(&comm, &Unwatched(&comm)), body, &scene).unwrap();
    let mut krylov = Krylov::new(body, rate(&scene)).unwrap();
    krylov.grow(body, 2 * reduced.projection.vectors()).unwrap();
    let long = krylov.projection(body).unwrap();
    // Time steps a third as long have a twenty-seventh of the defect of those chosen for this tolerance.
    let Steps { largest, defect, peak } = ModalImpact::new(&scene, ModalBody::of(&long)).trace(None).unwrap().1;
    let fine = Steps { largest: largest / 3.0, defect: defect.map(|defect| defect / 27.0), peak };
    let force =
        |projection: &Projection| ModalImpact::new(&scene, ModalBody::of(projection)).trace(Some(fine)).unwrap().0;
    let error = force(&long).difference(&force(&reduced.projection)).first_contact;
    let estimate = reduced.error.first_contact;
    println!("  {} vectors: error {error:.1e}, estimate {estimate:.1e}", reduced.projection.vectors());
    assert!(error <= estimate && estimate <= 5e-4, "{error:e} {estimate:e}");
}
