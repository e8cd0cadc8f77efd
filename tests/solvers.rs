//! Tests of the program's solvers on one and two ranks: methods, options that replace them, and a factorisation that is
//! kept.

use std::process::ExitCode;

#[path = "../petsc-wrap/tests/problems/chain.rs"]
mod chain;
#[path = "../petsc-wrap/tests/problems/separable.rs"]
mod separable;

use chain::{LOCAL, error_of_solve, laplacian};
use petsc_wrap::{Error, Insert, Int, Matrix, Session, Vector};
use ricochet::solve::Newton;
use ricochet::solve::linear::{Method, is_direct, solver};
use separable::{jacobian, residual};

fn start() -> Session {
    let line = "-factor_ksp_type preonly -factor_pc_type redundant -gmres_ksp_type gmres -gmres_ksp_rtol 1e-11 -gmres_pc_type jacobi";
    let words: Vec<String> = line.split(' ').map(String::from).collect();
    Session::start(&words).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        start,
        &[
            ("the_default_is_direct", the_default_is_direct),
            ("ranks_share_a_factor", ranks_share_a_factor),
            ("a_changed_matrix_is_factorised_again", a_changed_matrix_is_factorised_again),
            ("a_singular_matrix_is_told", a_singular_matrix_is_told),
            ("methods_and_options_in_their_place", methods_and_options_in_their_place),
            ("an_untouched_jacobian_is_not_factorised_again", an_untouched_jacobian_is_not_factorised_again),
            ("a_factor_that_is_no_help_is_replaced", a_factor_that_is_no_help_is_replaced),
        ],
    )
}

fn the_default_is_direct(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = solver(&session.world(), "", &matrix, Method::Cholesky).unwrap();
    // The condition number is about n² = 6400. The tolerance 1e-12 covers rounding, but not the error of an iterative
    // solver.
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
    ksp.destroy().unwrap();
}

/// Ranks share a factorisation. The system is a membrane of lines of eight points, twelve lines on each rank. Lines
/// between the ranks form an interface, and each rank has a factor of it. Some rows inside and on the interface are
/// coupled to nothing, like the rows of clamped unknowns.
fn ranks_share_a_factor(session: &Session) {
    const WIDTH: Int = 8;
    const LINES: usize = 12;
    let (world, rows) = (session.world(), LINES * WIDTH as usize);
    let count = (rows * world.size()) as Int;
    let mut matrix = Matrix::aij(&world, (rows, rows), &vec![5; rows], &vec![2; rows]).unwrap();
    let is_alone = |row: Int| row % 13 == 5;
    for row in matrix.row_range() {
        let beside =
            [(row % WIDTH > 0, -1), (row % WIDTH < WIDTH - 1, 1), (row >= WIDTH, -WIDTH), (row < count - WIDTH, WIDTH)];
        let others = beside.into_iter().filter(|(is_there, by)| *is_there && !is_alone(row) && !is_alone(row + by));
        // Couplings that differ, and a small addition to the diagonal.
        let others = others.map(|(_, by)| (row + by, -1.0 - f64::from((2 * row + by) % 7) / 10.0));
        let mut entries: Vec<(Int, f64)> = others.collect();
        let diagonal = 0.01 - entries.iter().map(|(_, value)| value).sum::<f64>();
        entries.push((row, diagonal));
        for (column, value) in entries {
            matrix.set_values(&[row], &[column], &[value], Insert::Replace).unwrap();
        }
    }
    matrix.assemble().unwrap();
    matrix.declare_positive_definite().unwrap();
    let mut ksp = solver(&world, "", &matrix, Method::Cholesky).unwrap();
    let kind = ksp.pc().unwrap().type_name().unwrap();
    assert_eq!(kind, if world.size() > 1 { "shell" } else { "cholesky" });
    let mut exact = Vector::new(&world, rows).unwrap();
    let begin = exact.range().start;
    let write = |(i, value): (usize, &mut f64)| *value = (begin as f64 + i as f64).sin();
    exact.write().unwrap().iter_mut().enumerate().for_each(write);
    let (mut b, mut x) = (exact.duplicate().unwrap(), exact.duplicate().unwrap());
    matrix.mult(&exact, &mut b).unwrap();
    ksp.solve(&b, &mut x).unwrap();
    x.axpy(-1.0, &exact).unwrap();
    // The condition number is at most 2 · 8 · 1.6/0.01.
    let error = x.norm_max().unwrap();
    assert!(error < 1e-12, "{error:e}");
    ksp.destroy().unwrap();
}

fn a_changed_matrix_is_factorised_again(session: &Session) {
    let mut matrix = laplacian(session, 2.0);
    let mut ksp = solver(&session.world(), "", &matrix, Method::Cholesky).unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
    let other = matrix.duplicate().unwrap();
    matrix.axpy(1.0, &other).unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
    ksp.destroy().unwrap();
}

fn a_singular_matrix_is_told(session: &Session) {
    // With ends = 1, constant vectors are the null space. The scaling makes the last pivot exactly zero.
    let matrix = laplacian(session, 1.0);
    let mut ksp = solver(&session.world(), "", &matrix, Method::Cholesky).unwrap();
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    b.fill(1.0).unwrap();
    let mut x = b.duplicate().unwrap();
    match ksp.solve(&b, &mut x) {
        Err(Error::Diverged(failure)) => assert!(failure.reason.contains("PC_FAILED"), "{failure}"),
        // On one rank CHOLMOD reports it.
        Err(Error::Petsc { message, .. }) => assert!(message.contains("not positive definite"), "{message}"),
        // Rounding may leave a tiny pivot: the answer is then huge, not plausible.
        Ok(()) => assert!(x.norm().unwrap() > 1e6),
        Err(error) => panic!("{error}"),
    }
    ksp.destroy().unwrap();
}

/// Each method solves to its tolerance, also from a bad guess, and so do the methods that options set instead of
/// conjugate gradients.
fn methods_and_options_in_their_place(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let multigrid = Method::Multigrid { tolerance: 1e-11 };
    // (The tolerance is the condition number, some thousands at most, times the residual.)
    for (prefix, method, direct) in [
        ("", multigrid, false),
        ("", Method::Diagonal { tolerance: 1e-11 }, false),
        ("factor_", multigrid, true),
        ("gmres_", multigrid, false),
    ] {
        let mut ksp = solver(&session.world(), prefix, &matrix, method).unwrap();
        assert_eq!(is_direct(&ksp).unwrap(), direct, "{prefix} {method:?}");
        let error = error_of_solve(session, &mut ksp, &matrix);
        assert!(error < 1e-7, "{prefix} {method:?}: {error:e}");
    }
}

/// Number of separable equations on each rank.
const EQUATIONS: usize = 3;
const TOLERANCE: f64 = 1e-12;

/// A solver for separable equations g(x_i) = 0, and its starting point x = 2.
fn newton(session: &Session, iterations: usize) -> (Newton, Vector) {
    let world = session.world();
    let jacobian = Matrix::aij(&world, (EQUATIONS, EQUATIONS), &[1; EQUATIONS], &[0; EQUATIONS]).unwrap();
    let mut x = Vector::new(&world, EQUATIONS).unwrap();
    x.fill(2.0).unwrap();
    (Newton::new(&world, jacobian, TOLERANCE, iterations).unwrap(), x)
}

fn an_untouched_jacobian_is_not_factorised_again(session: &Session) {
    let (mut solver, mut x) = newton(session, 100);
    let mut calls = 0;
    // The chord method uses the slope at the start throughout, so convergence is linear, with factor 1 − g′/12.
    solver
        .solve(
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

/// A factorisation that does not help is replaced. The factor of the unit matrix is kept for a matrix whose three
/// hundred eigenvalues lie between 1 and 1e12. Conjugate gradients cannot solve this within their limit of one hundred
/// iterations.
fn a_factor_that_is_no_help_is_replaced(session: &Session) {
    const MANY: usize = 300;
    let world = session.world();
    let jacobian = Matrix::aij(&world, (MANY, MANY), &[1; MANY], &[0; MANY]).unwrap();
    let mut x = Vector::new(&world, MANY).unwrap();
    let first = x.range().start;
    let mut newton = Newton::new(&world, jacobian, TOLERANCE, 20).unwrap();
    for exponent in [0.0, 12.0] {
        let slope = |i: Int| 10_f64.powf(exponent * (i - first) as f64 / MANY as f64);
        x.fill(1.0).unwrap();
        newton
            .solve(
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
