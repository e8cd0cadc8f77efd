//! Cases where iterative solvers fail, and their remedies: rigid motions of a free body, supports as stiff as a clamp.

use crate::start::{run, start};
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Matrix, Session, options};
use ricochet::body::Body;
use ricochet::impact::SteppedImpact;
use ricochet::impact::step::Step;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::solve::linear::{Method, is_direct, solver};
use ricochet::space::finite_element::by_iterations;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] =
    tests![free_body, a_run_by_multigrid, large_bodies, stiff_support, clamped_in_the_limit];

pub(super) const COARSE: &str = "[10, 10, 1]";
const FINE: &str = "[30, 30, 2]";

pub(super) const MULTIGRID: &[(&str, &str)] = &[("-ksp_type", "cg"), ("-pc_type", "gamg")];

/// The 0.1 m plate with linear elements.
fn scene(cells: &str, side: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.1]\ncells = {cells}\norder = 1\n\
         symmetry = \"none\"\n{side}\
         [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
         [time]\nend = 2e-3\nstep = 2e-5\n[contact]\nlocalization = \"point\"\n"
    )
}

fn elastic(stiffness: &str) -> String {
    format!("[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = {stiffness}\n")
}

const CLAMPED: &str = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\n";

pub(super) fn solid(comm: &Comm, cells: &str, side: &str) -> Body {
    let (scene, _) = Scene::parse("test", &scene(cells, side), &[]).unwrap_or_else(|error| panic!("{error}"));
    Body::solid(&scene, &Mesh::new(comm, &scene.body).unwrap()).unwrap()
}

/// Does some work with PETSc options set, and removes them.
pub(super) fn with_options<T>(session: &Session, chosen: &[(&str, &str)], work: impl FnOnce() -> T) -> T {
    chosen.iter().for_each(|(name, value)| options::set(session, name, value).unwrap());
    let outcome = work();
    chosen.iter().for_each(|(name, _)| options::clear(session, name).unwrap());
    outcome
}

/// Number of iterations for S⁻¹a with the options; the solution must equal the direct method's.
fn iterations(session: &Session, body: &Body, matrix: &Matrix, chosen: &[(&str, &str)]) -> usize {
    let (world, a) = (session.world(), &body.terms.contact.force);
    let (mut exact, mut x) = (a.duplicate().unwrap(), a.duplicate().unwrap());
    solver(&world, "", matrix, Method::Cholesky).unwrap().solve(a, &mut exact).unwrap();
    let mut ksp = with_options(session, chosen, || solver(&world, "", matrix, Method::Cholesky).unwrap());
    ksp.solve(a, &mut x).unwrap();
    x.axpy(-1.0, &exact).unwrap();
    // The residual of 1e-12 times the effect of the condition number.
    let error = x.norm().unwrap() / exact.norm().unwrap();
    assert!(error < 1e-8, "{error:e} off");
    ksp.iterations().unwrap()
}

/// With the rigid motions, multigrid needs a similar number of iterations on any mesh. Without them it needs several
/// times as many, and the number grows.
fn free_body(session: &Session) {
    let world = session.world();
    // In such a time step the plate's bending waves cross it many times: S is nearly K, which is singular.
    let c2 = 4.0 / 1e-2_f64.powi(2);
    let [coarse, fine] = [COARSE, FINE].map(|cells| {
        let body = solid(&world, cells, "");
        let with = iterations(session, &body, &body.operator(0.0, c2).unwrap(), MULTIGRID);
        let mut matrix = body.combination(0.0, c2).unwrap();
        matrix.declare_positive_definite().unwrap();
        (with, iterations(session, &body, &matrix, MULTIGRID))
    });
    if world.is_root() {
        println!(
            "free body: {coarse:?} iterations on the coarse mesh, {fine:?} on the fine one, with and without rigid motions"
        );
    }
    // Iterations seen: 56 and 117; 37 and 166.
    assert!(coarse.0 <= 70 && fine.0 <= 60, "{coarse:?} {fine:?}");
    assert!(fine.1 >= 3 * fine.0 && fine.1 as f64 >= 1.2 * coarse.1 as f64, "{coarse:?} {fine:?}");
}

/// Accelerations of a run with PETSc options set.
fn accelerations(session: &Session, side: &str, chosen: &[(&str, &str)]) -> Vec<f64> {
    let world = session.world();
    with_options(session, chosen, || {
        let (_, mut impact) = start(&world, &scene(COARSE, side));
        let accelerations = run(&mut impact).iter().map(|step: &Step| step.impactor.acceleration).collect();
        drop(impact);
        world.collect_garbage().unwrap();
        accelerations
    })
}

fn peak(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |max, value| max.max(value.abs()))
}

/// The default tolerance of an iterative solver has no visible effect on a run; a requested looser one has.
fn a_run_by_multigrid(session: &Session) {
    let direct = accelerations(session, "", &[]);
    let error = |more: &[(&str, &str)]| {
        let values = accelerations(session, "", &[MULTIGRID, more].concat());
        peak(values.iter().zip(&direct).map(|(a, b)| a - b)) / peak(direct.iter().copied())
    };
    let (default, loose) = (error(&[]), error(&[("-ksp_rtol", "1e-4")]));
    if session.world().is_root() {
        println!("run by multigrid: {default:.1e} off the direct one; with -ksp_rtol 1e-4, {loose:.1e}");
    }
    // A hundred time steps with a relative error of 1e-12 each.
    assert!(default <= 1e-9, "{default:e}");
    assert!(loose >= 1e-6, "{loose:e}");
}

/// Conjugate gradients need many iterations for a support nearly as stiff as a clamp, unless the preconditioner
/// includes the support. A real clamp costs nothing.
fn stiff_support(session: &Session) {
    let world = session.world();
    let plain: &[(&str, &str)] = &[("-ksp_type", "cg"), ("-pc_type", "none")];
    let count = |side: &str, chosen| {
        let body = solid(&world, COARSE, side);
        iterations(session, &body, &body.operator(0.0, 4e6).unwrap(), chosen)
    };
    let stiff = elastic("1e18");
    let (plain_stiff, plain_clamped) = (count(&stiff, plain), count(CLAMPED, plain));
    let (multigrid_stiff, multigrid_clamped) = (count(&stiff, MULTIGRID), count(CLAMPED, MULTIGRID));
    if world.is_root() {
        println!(
            "k = 1e18: {plain_stiff} iterations ({multigrid_stiff} with multigrid), clamped {plain_clamped} ({multigrid_clamped})"
        );
    }
    // Iterations seen: 777 against 64; 46 against 34.
    assert!(plain_stiff >= 5 * plain_clamped);
    assert!(multigrid_stiff <= 2 * multigrid_clamped);
}

/// With the direct solver k → ∞ works: the peak tends to the clamped plate's like 1/k.
fn clamped_in_the_limit(session: &Session) {
    let clamped = peak(accelerations(session, CLAMPED, &[]));
    let stiffness = ["1e12", "1e14", "1e16", "1e18"];
    let errors = stiffness.map(|k| peak(accelerations(session, &elastic(k), &[])) / clamped - 1.0);
    if session.world().is_root() {
        println!("peak over the clamped one, less 1, for k = {stiffness:?}: {errors:?}");
    }
    // Well above the stiffness of the neighbouring cells, E/h_cell = 5e11, the error is c/k with c = 1.4e10: it falls
    // by two decades in each step of k.
    for pair in errors[1..].windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((90.0..110.0).contains(&ratio), "{errors:?}");
    }
    assert!(errors[0].abs() < 1e-2 && errors[3].abs() < 1e-7, "{errors:?}");
}

/// The methods for bodies too large for a factorisation, tested on a small body: the time history equals that with the
/// factorisation, to a hundredth of the requested tolerance, and a solve takes at most twenty iterations.
fn large_bodies(session: &Session) {
    let world = session.world();
    // The last case has such small time steps that the initial guess is nearly the solution of most.
    for (cells, step, end, tolerance) in
        [("[16, 16, 2]", 2e-5, 1e-3, 1e-2), ("[16, 16, 2]", 2e-5, 1e-3, 1e-4), ("[8, 8, 1]", 1e-6, 5e-4, 1e-2)]
    {
        let text = scene(cells, &elastic("1e9"))
            .replace("order = 1", "order = 2")
            .replace("symmetry = \"none\"", "symmetry = \"quarter\"")
            .replace("\"point\"", "\"patch\"");
        let settings = [
            "time.scheme=newmark".into(),
            format!("time.step={step:e}"),
            format!("time.end={end:e}"),
            format!("accuracy.tolerance={tolerance:e}"),
        ];
        let (scene, _) = Scene::parse("test", &text, &settings).unwrap_or_else(|error| panic!("{error}"));
        let history = |method: Method| -> Vec<Step> {
            let mut body = Body::solid(&scene, &Mesh::new(&world, &scene.body).unwrap()).unwrap();
            assert_eq!(body.method, Method::Cholesky, "a small one has a factor");
            body.method = method;
            if method != Method::Cholesky {
                let operator = body.operator(2.0 / step, 4.0 / (step * step)).unwrap();
                let (mut solver, mut x) = (body.solver(&operator).unwrap(), body.terms.load.duplicate().unwrap());
                solver.solve(&body.terms.contact.force, &mut x).unwrap();
                println!("  {method:?}: {} iterations", solver.iterations().unwrap());
                assert!(solver.iterations().unwrap() <= 20 && !is_direct(&solver).unwrap());
            }
            run(&mut SteppedImpact::new(&scene, body).unwrap())
        };
        let exact = history(Method::Cholesky);
        let multigrid = by_iterations(&scene);
        let Method::Multigrid { tolerance: part } = multigrid else { panic!("{multigrid:?}") };
        // Time steps choose between the two methods.
        for method in [multigrid, Method::Incomplete { tolerance: part }] {
            let steps = history(method);
            let peak = exact.iter().map(|step| step.impactor.acceleration).fold(0.0, f64::max);
            let off = steps.iter().zip(&exact).map(|(a, b)| (a.impactor.acceleration - b.impactor.acceleration).abs());
            let error = off.fold(0.0, f64::max) / peak;
            println!("  tolerance {tolerance:e}: {error:.1e} from the direct method after {} steps", steps.len() - 1);
            assert!(steps.len() == exact.len() && error <= 1e-2 * tolerance);
        }
    }
}
