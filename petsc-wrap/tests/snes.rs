//! Tests of Newton's method with closures, on one and two ranks.

use std::process::ExitCode;

#[path = "problems/separable.rs"]
mod separable;

use petsc_wrap::{Error, Int, Lag, Matrix, Session, Snes, SnesTolerances, Tolerances, Vector, options};
use separable::{jacobian, residual};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2],
        start,
        &[
            ("newton_converges_quadratically", newton_converges_quadratically),
            ("slopes_are_those_of_the_potential", slopes_are_those_of_the_potential),
            ("errors_of_closures_come_back", errors_of_closures_come_back),
            ("panics_of_closures_come_back", panics_of_closures_come_back),
            ("what_does_not_fit_is_refused", what_does_not_fit_is_refused),
            ("a_closure_is_not_called_after_its_solve", a_closure_is_not_called_after_its_solve),
            ("a_solve_without_a_search_of_its_own", a_solve_without_a_search_of_its_own),
            ("a_preconditioner_lags_as_it_is_told", a_preconditioner_lags_as_it_is_told),
            ("nan_stops_the_solve", nan_stops_the_solve),
            ("too_few_iterations_are_told", too_few_iterations_are_told),
            ("types_that_are_not_admitted_are_refused", types_that_are_not_admitted_are_refused),
            ("a_jacobian_without_diagonal_is_refused", a_jacobian_without_diagonal_is_refused),
        ],
    )
}

const LOCAL: usize = 3;
const TOLERANCE: f64 = 1e-12;

/// A solver for separable equations g(x_i) = 0, and its starting point x = 2.
fn solver(session: &Session, iterations: usize) -> (Snes, Vector) {
    let world = session.world();
    let jacobian = Matrix::aij(&world, (LOCAL, LOCAL), &[1; LOCAL], &[0; LOCAL]).unwrap();
    let mut x = Vector::new(&world, LOCAL).unwrap();
    x.fill(2.0).unwrap();
    let mut snes = Snes::new(&world).unwrap();
    snes.set_type("newtonls").unwrap();
    snes.set_line_search_type("shell").unwrap();
    let mut ksp = snes.ksp().unwrap();
    ksp.set_type("cg").unwrap();
    // For a diagonal matrix Jacobi's method is the exact inverse.
    ksp.pc().unwrap().set_type("jacobi").unwrap();
    ksp.set_tolerances(Tolerances { relative: Some(1e-13), ..Default::default() }).unwrap();
    drop(ksp);
    snes.set_tolerances(SnesTolerances {
        absolute: Some(TOLERANCE),
        relative: Some(0.0),
        step: Some(0.0),
        iterations: Some(iterations),
        evaluations: None,
    })
    .unwrap();
    snes.set_jacobian(jacobian).unwrap();
    (snes, x)
}

fn newton_converges_quadratically(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    let mut norms = Vec::new();
    let iterations = snes
        .solve_with_search(
            &mut x,
            |x, f| {
                residual(x, f, |x| x * x * x - 2.0)?;
                norms.push(f.norm()?);
                Ok(())
            },
            |x, j, _| Ok(jacobian(x, j, |x| 3.0 * x * x)?),
            |_| Ok(1.0),
        )
        .unwrap();
    let root = 2f64.cbrt();
    assert!(x.read().unwrap().iter().all(|x| (x - root).abs() < 1e-12));
    // The residual is evaluated once at the start, and once in each iteration, at step length 1.
    assert_eq!(norms.len(), iterations + 1);
    // Order log(e3/e2)/log(e2/e1) from the last norms above rounding.
    let e: Vec<f64> = norms.into_iter().filter(|&norm| norm > 1e-11).collect();
    let last = &e[e.len() - 3..];
    let order = (last[2] / last[1]).ln() / (last[1] / last[0]).ln();
    assert!(order > 1.8, "observed order {order}");
}

fn slopes_are_those_of_the_potential(session: &Session) {
    let (mut snes, mut x) = solver(session, 30);
    let n = x.len() as f64;
    let mut first = None;
    // Residual x, potential Σx²/2, a Jacobian too small by a factor of two: direction −2x, slope −2·4n + 4λ·4n … at λ =
    // 0, 1/2, 1.
    snes.solve_with_search(
        &mut x,
        |x, f| Ok(residual(x, f, |x| x)?),
        |x, j, _| Ok(jacobian(x, j, |_| 0.5)?),
        |trial| {
            let slopes = [trial.slope(0.0)?, trial.slope(0.5)?, trial.slope(1.0)?];
            first.get_or_insert(slopes);
            Ok(0.5)
        },
    )
    .unwrap();
    assert_eq!(first, Some([-8.0 * n, 0.0, 8.0 * n]));
    assert_eq!(x.norm_max().unwrap(), 0.0);
}

#[derive(Debug, thiserror::Error)]
#[error("closure says {0}")]
struct Marked(&'static str);

fn errors_of_closures_come_back(session: &Session) {
    for place in ["residual", "jacobian", "search"] {
        let (mut snes, mut x) = solver(session, 20);
        let fail = |here: &str| if here == place { Err(Marked(place)) } else { Ok(()) };
        let result = snes.solve_with_search(
            &mut x,
            |x, f| {
                fail("residual")?;
                Ok(residual(x, f, |x| x)?)
            },
            |x, j, _| {
                fail("jacobian")?;
                Ok(jacobian(x, j, |_| 1.0)?)
            },
            |_| {
                fail("search")?;
                Ok(1.0)
            },
        );
        let Err(Error::Callback(error)) = result else { panic!("{result:?}") };
        assert_eq!(error.downcast_ref::<Marked>().expect("the closure's own error").0, place);
    }
}

fn panics_of_closures_come_back(session: &Session) {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let (mut snes, mut x) = solver(session, 20);
        let _ = snes.solve_with_search(&mut x, |_, _| panic!("marked"), |_, _, _| Ok(()), |_| Ok(1.0));
    }));
    std::panic::set_hook(hook);
    assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"marked"));
}

fn what_does_not_fit_is_refused(session: &Session) {
    let world = session.world();
    let invalid =
        |outcome: petsc_wrap::Result<usize>| assert!(matches!(outcome, Err(Error::Invalid { .. })), "{outcome:?}");
    let mut without = Snes::new(&world).unwrap();
    let mut x = Vector::new(&world, LOCAL).unwrap();
    invalid(without.solve(&mut x, |_, _| Ok(()), |_, _, _| Ok(())));
    let (mut snes, _) = solver(session, 20);
    let mut other = Vector::new(&world, LOCAL + 1).unwrap();
    invalid(snes.solve(&mut other, |_, _| Ok(()), |_, _, _| Ok(())));
    let small = || Matrix::aij(&world, (1, 1), &[1], &[0]).unwrap();
    invalid(snes.set_jacobian(small()).map(|()| 0));
    if world.size() > 1 {
        let alone = Matrix::aij(&session.alone(), (1, 1), &[1], &[0]).unwrap();
        invalid(without.set_jacobian(alone).map(|()| 0));
    }
    let wide = Matrix::aij(&world, (1, 2), &[1], &[0]).unwrap();
    invalid(without.set_jacobian(wide).map(|()| 0));
    assert!(snes.set_preconditioner_lag(Lag::Every(0)).is_err());
}

/// A closure is not called after its solve. A matrix-free operator calls the residual in each product, also in a linear
/// solve after the nonlinear one, when its closures are gone.
fn a_closure_is_not_called_after_its_solve(session: &Session) {
    options::set(session, "-free_snes_mf_operator", "").unwrap();
    let (mut snes, mut x) = solver(session, 20);
    snes.set_options_prefix("free_").unwrap();
    snes.set_from_options().unwrap();
    let calls = std::cell::Cell::new(0);
    let on_the_heap = vec![2.0; 1000];
    snes.solve_with_search(
        &mut x,
        |x, f| {
            calls.set(calls.get() + 1);
            let x = x.read()?;
            f.write()?.iter_mut().zip(x.iter()).for_each(|(f, x)| *f = x * x * x - on_the_heap[7]);
            Ok(())
        },
        |x, j, _| Ok(jacobian(x, j, |x| 3.0 * x * x)?),
        |_| Ok(1.0),
    )
    .unwrap();
    drop(on_the_heap);
    let during = calls.get();
    assert!(during > 5 && (x.norm_max().unwrap() - 2f64.cbrt()).abs() < 1e-11);
    let mut b = x.duplicate().unwrap();
    b.fill(1.0).unwrap();
    let outcome = snes.ksp().unwrap().solve(&b, &mut x);
    assert!(matches!(outcome, Err(Error::Petsc { .. })), "{outcome:?}");
    assert_eq!(calls.get(), during);
}

/// A solve without a search closure uses PETSc's own line search. It is an error if the line search is of the type that
/// calls a closure.
fn a_solve_without_a_search_of_its_own(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    let outcome = snes.solve(&mut x, |x, f| Ok(residual(x, f, |x| x)?), |x, j, _| Ok(jacobian(x, j, |_| 1.0)?));
    assert!(matches!(outcome, Err(Error::Callback(_))), "{outcome:?}");
    snes.set_line_search_type("bt").unwrap();
    let root = |x: f64| x.atan();
    x.fill(2.0).unwrap();
    // Full Newton steps diverge from this starting point.
    snes.solve(&mut x, |x, f| Ok(residual(x, f, root)?), |x, j, _| Ok(jacobian(x, j, |x| 1.0 / (1.0 + x * x))?))
        .unwrap();
    assert!(x.norm_max().unwrap() < TOLERANCE);
}

/// The lag of the preconditioner takes effect: one factorisation for all Jacobians is the chord method, which converges
/// linearly; a new one for each converges quadratically.
fn a_preconditioner_lags_as_it_is_told(session: &Session) {
    let mut iterations = [0, 0];
    for (lag, iterations) in [Lag::Every(1), Lag::RebuildThenKeep].into_iter().zip(&mut iterations) {
        let (mut snes, mut x) = solver(session, 100);
        snes.ksp().unwrap().set_type("preonly").unwrap();
        let mut linear = Vec::new();
        *iterations = snes
            .solve_with_search(
                &mut x,
                |x, f| Ok(residual(x, f, |x| x * x * x - 2.0)?),
                |x, j, progress| {
                    linear.push(progress.linear_iterations()?);
                    if linear.len() == 1 {
                        progress.set_preconditioner_lag(lag)?;
                    }
                    Ok(jacobian(x, j, |x| 3.0 * x * x)?)
                },
                |_| Ok(1.0),
            )
            .unwrap();
        assert!(linear.len() == *iterations && linear[1..].iter().all(|count| *count == 1), "{linear:?}");
    }
    assert!(iterations[0] < 8 && iterations[1] > 20, "{iterations:?}");
}

fn nan_stops_the_solve(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    let last = session.world().size() as Int * LOCAL as Int - 1;
    // The residual of only one rank is undefined, but all ranks stop.
    let result = snes.solve_with_search(
        &mut x,
        |x, f| {
            residual(x, f, |x| x)?;
            if x.range().contains(&last) {
                f.write()?[LOCAL - 1] = f64::NAN;
            }
            Ok(())
        },
        |x, j, _| Ok(jacobian(x, j, |_| 1.0)?),
        |_| Ok(1.0),
    );
    let Err(Error::Diverged(failure)) = result else { panic!("{result:?}") };
    assert!(failure.reason.contains("DOMAIN"), "{failure}");
}

fn too_few_iterations_are_told(session: &Session) {
    let (mut snes, mut x) = solver(session, 2);
    let result = snes.solve_with_search(
        &mut x,
        |x, f| Ok(residual(x, f, |x| x * x * x - 2.0)?),
        |x, j, _| Ok(jacobian(x, j, |x| 3.0 * x * x)?),
        |_| Ok(1.0),
    );
    let Err(Error::Diverged(failure)) = result else { panic!("{result:?}") };
    assert_eq!((failure.solver, failure.iterations), ("SNES", 2));
    assert!(failure.reason.contains("MAX_IT") && failure.norm > TOLERANCE, "{failure}");
}

fn is_invalid<T>(outcome: petsc_wrap::Result<T>) -> bool {
    matches!(outcome, Err(Error::Invalid { .. }))
}

/// After a change from `newtontr` to another type, for instance, PETSc reads the data of a type in place of another's.
fn types_that_are_not_admitted_are_refused(session: &Session) {
    let (mut snes, _) = solver(session, 20);
    for name in ["newtontr", "nleqerr", "no such method", ""] {
        assert!(is_invalid(snes.set_type(name)) && is_invalid(snes.set_line_search_type(name)), "{name}");
    }
}

/// A closure may leave out entries of which the preconditioner needs those on the diagonal.
fn a_jacobian_without_diagonal_is_refused(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    snes.ksp().unwrap().pc().unwrap().set_type("gamg").unwrap();
    let outcome = snes.solve_with_search(&mut x, |x, f| Ok(f.copy_from(x)?), |_, j, _| Ok(j.assemble()?), |_| Ok(1.0));
    let Err(Error::Callback(error)) = outcome else { panic!("{outcome:?}") };
    assert!(error.to_string().contains("diagonal"), "{error}");
}
