//! Newton's method with closures, on one and two ranks.

use std::process::ExitCode;

use petsc_wrap::{Error, Insert, Int, Matrix, Session, Snes, Vector};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2],
        start,
        &[
            ("newton_converges_quadratically", newton_converges_quadratically),
            ("an_untouched_jacobian_is_not_factorised_again", an_untouched_jacobian_is_not_factorised_again),
            ("a_factor_that_is_no_help_is_replaced", a_factor_that_is_no_help_is_replaced),
            ("slopes_are_those_of_the_potential", slopes_are_those_of_the_potential),
            ("errors_of_closures_come_back", errors_of_closures_come_back),
            ("panics_of_closures_come_back", panics_of_closures_come_back),
            ("a_handle_taken_out_of_a_closure_stays_valid", a_handle_taken_out_of_a_closure_stays_valid),
            ("nan_stops_the_solve", nan_stops_the_solve),
            ("too_few_iterations_are_told", too_few_iterations_are_told),
        ],
    )
}

const LOCAL: usize = 3;
const TOLERANCE: f64 = 1e-12;

/// A solver, and its start at x = 2, for separable equations g(x_i) = 0.
fn solver(session: &Session, iterations: usize) -> (Snes, Vector) {
    let world = session.world();
    let jacobian = Matrix::aij(&world, (LOCAL, LOCAL), &[1; LOCAL], &[0; LOCAL]).unwrap();
    let mut x = Vector::new(&world, LOCAL).unwrap();
    x.fill(2.0).unwrap();
    (Snes::new(&world, jacobian, TOLERANCE, iterations).unwrap(), x)
}

fn residual(x: &Vector, f: &mut Vector, g: fn(f64) -> f64) -> petsc_wrap::Result<()> {
    let x = x.read()?;
    for (f, x) in f.write()?.iter_mut().zip(x.iter()) {
        *f = g(*x);
    }
    Ok(())
}

fn jacobian(x: &Vector, matrix: &mut Matrix, slope: fn(f64) -> f64) -> petsc_wrap::Result<()> {
    for (i, x) in x.range().zip(x.read()?.iter()) {
        matrix.set_values(&[i], &[i], &[slope(*x)], Insert::Replace)?;
    }
    matrix.assemble()?;
    matrix.declare_positive_definite()
}

fn newton_converges_quadratically(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    let mut norms = Vec::new();
    let iterations = snes
        .solve(
            &mut x,
            |x, f| {
                residual(x, f, |x| x * x * x - 2.0)?;
                norms.push(f.norm()?);
                Ok(())
            },
            |x, j| Ok(jacobian(x, j, |x| 3.0 * x * x)?),
            |_| Ok(1.0),
        )
        .unwrap();
    let root = 2f64.cbrt();
    assert!(x.read().unwrap().iter().all(|x| (x - root).abs() < 1e-12));
    // The step length 1 is evaluated once an iteration, and the start once.
    assert_eq!(norms.len(), iterations + 1);
    // Order log(e3/e2)/log(e2/e1) from the last norms above rounding.
    let e: Vec<f64> = norms.into_iter().filter(|&norm| norm > 1e-11).collect();
    let last = &e[e.len() - 3..];
    let order = (last[2] / last[1]).ln() / (last[1] / last[0]).ln();
    assert!(order > 1.8, "observed order {order}");
}

fn an_untouched_jacobian_is_not_factorised_again(session: &Session) {
    let (mut snes, mut x) = solver(session, 100);
    let mut calls = 0;
    // The chord method: the slope at the start serves throughout, so convergence is linear, with factor 1 − g′/12.
    snes.solve(
        &mut x,
        |x, f| Ok(residual(x, f, |x| x * x * x - 2.0)?),
        |x, j| {
            calls += 1;
            if calls == 1 {
                jacobian(x, j, |x| 3.0 * x * x)?;
            }
            Ok(())
        },
        |_| Ok(1.0),
    )
    .unwrap();
    assert!(calls > 20, "{calls} iterations: quadratic convergence would need 6");
    assert!((x.norm_max().unwrap() - 2f64.cbrt()).abs() < 1e-11);
}

/// The factor of the unit matrix, kept for one whose three hundred eigenvalues lie between 1 and 1e12: conjugate gradients
/// cannot do it in their hundred iterations.
fn a_factor_that_is_no_help_is_replaced(session: &Session) {
    const MANY: usize = 300;
    let world = session.world();
    let jacobian = Matrix::aij(&world, (MANY, MANY), &[1; MANY], &[0; MANY]).unwrap();
    let mut x = Vector::new(&world, MANY).unwrap();
    let first = x.range().start;
    let mut snes = Snes::new(&world, jacobian, TOLERANCE, 20).unwrap();
    for exponent in [0.0, 12.0] {
        let slope = |i: Int| 10_f64.powf(exponent * (i - first) as f64 / MANY as f64);
        x.fill(1.0).unwrap();
        snes.solve(
            &mut x,
            |x, f| {
                let x = x.read()?;
                for ((i, f), x) in (first..).zip(f.write()?.iter_mut()).zip(x.iter()) {
                    *f = slope(i) * x;
                }
                Ok(())
            },
            |x, matrix| {
                for i in x.range() {
                    matrix.set_values(&[i], &[i], &[slope(i)], Insert::Replace)?;
                }
                matrix.assemble()?;
                Ok(matrix.declare_positive_definite()?)
            },
            |_| Ok(1.0),
        )
        .unwrap();
        assert!(x.norm_max().unwrap() <= TOLERANCE);
    }
}

fn slopes_are_those_of_the_potential(session: &Session) {
    let (mut snes, mut x) = solver(session, 30);
    let n = x.len() as f64;
    let mut first = None;
    // Residual x, potential Σx²/2, a Jacobian twice too small: direction −2x, slope −2·4n + 4λ·4n … at λ = 0, 1/2, 1.
    snes.solve(
        &mut x,
        |x, f| Ok(residual(x, f, |x| x)?),
        |x, j| Ok(jacobian(x, j, |_| 0.5)?),
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
        let result = snes.solve(
            &mut x,
            |x, f| {
                fail("residual")?;
                Ok(residual(x, f, |x| x)?)
            },
            |x, j| {
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
        let _ = snes.solve(&mut x, |_, _| panic!("marked"), |_, _| Ok(()), |_| Ok(1.0));
    }));
    std::panic::set_hook(hook);
    assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"marked"));
}

fn a_handle_taken_out_of_a_closure_stays_valid(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    let mut taken = x.duplicate().unwrap();
    let mut calls = 0;
    snes.solve(
        &mut x,
        |x, f| {
            residual(x, f, |x| x)?;
            calls += 1;
            if calls == 1 {
                std::mem::swap(f, &mut taken);
            }
            Ok(())
        },
        |x, j| Ok(jacobian(x, j, |_| 1.0)?),
        |_| Ok(1.0),
    )
    .unwrap();
    drop(snes);
    // SNES goes on in the vector that it lent, which is the one taken; it must outlive the solver.
    assert!(taken.norm_max().unwrap().is_finite());
}

fn nan_stops_the_solve(session: &Session) {
    let (mut snes, mut x) = solver(session, 20);
    let last = session.world().size() as Int * LOCAL as Int - 1;
    // Only one rank's residual is undefined; all of them stop.
    let result = snes.solve(
        &mut x,
        |x, f| {
            residual(x, f, |x| x)?;
            if x.range().contains(&last) {
                f.write()?[LOCAL - 1] = f64::NAN;
            }
            Ok(())
        },
        |x, j| Ok(jacobian(x, j, |_| 1.0)?),
        |_| Ok(1.0),
    );
    let Err(Error::Diverged(failure)) = result else { panic!("{result:?}") };
    assert!(failure.reason.contains("DOMAIN"), "{failure}");
}

fn too_few_iterations_are_told(session: &Session) {
    let (mut snes, mut x) = solver(session, 2);
    let result = snes.solve(
        &mut x,
        |x, f| Ok(residual(x, f, |x| x * x * x - 2.0)?),
        |x, j| Ok(jacobian(x, j, |x| 3.0 * x * x)?),
        |_| Ok(1.0),
    );
    let Err(Error::Diverged(failure)) = result else { panic!("{result:?}") };
    assert_eq!((failure.solver, failure.iterations), ("SNES", 2));
    assert!(failure.reason.contains("MAX_IT") && failure.norm > TOLERANCE, "{failure}");
}
