//! Linear solvers, on one and two ranks.

use std::process::ExitCode;

use petsc_wrap::{Error, Insert, Int, Ksp, Matrix, Method, Session, Vector};

fn start() -> Session {
    let limited = "-cg_ksp_type cg -cg_pc_type jacobi -cg_ksp_rtol 1e-12 -cg_ksp_max_it 3";
    let others = "-factor_ksp_type preonly -factor_pc_type redundant -gmres_ksp_type gmres -gmres_ksp_rtol 1e-11 -gmres_pc_type jacobi";
    let words: Vec<String> = [limited, others].iter().flat_map(|line| line.split(' ')).map(String::from).collect();
    Session::start(&words).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2],
        start,
        &[
            ("the_default_is_direct", the_default_is_direct),
            ("a_changed_matrix_is_factorised_again", a_changed_matrix_is_factorised_again),
            ("options_choose_by_prefix_and_divergence_is_told", options_choose_by_prefix_and_divergence_is_told),
            ("a_singular_matrix_is_told", a_singular_matrix_is_told),
            ("methods_and_options_in_their_place", methods_and_options_in_their_place),
        ],
    )
}

const LOCAL: usize = 40;

/// tridiag(−1, 2, −1) with `ends` in the first and last place of the diagonal.
fn laplacian(session: &Session, ends: f64) -> Matrix {
    let counts = (vec![3; LOCAL], vec![1; LOCAL]);
    let mut matrix = Matrix::aij(&session.world(), (LOCAL, LOCAL), &counts.0, &counts.1).unwrap();
    let n = (LOCAL * session.world().size()) as Int;
    for i in matrix.row_range() {
        let columns: Vec<Int> = (i - 1..=i + 1).filter(|j| (0..n).contains(j)).collect();
        let diagonal = if i == 0 || i == n - 1 { ends } else { 2.0 };
        let values: Vec<f64> = columns.iter().map(|&j| if j == i { diagonal } else { -1.0 }).collect();
        matrix.set_values(&[i], &columns, &values, Insert::Replace).unwrap();
    }
    matrix.assemble().unwrap();
    matrix.declare_positive_definite().unwrap();
    matrix
}

fn error_of_solve(session: &Session, ksp: &mut Ksp, matrix: &Matrix) -> f64 {
    let mut exact = Vector::new(&session.world(), LOCAL).unwrap();
    let begin = exact.range().start as usize;
    for (i, value) in exact.write().unwrap().iter_mut().enumerate() {
        *value = ((begin + i) as f64).sin();
    }
    let mut b = exact.duplicate().unwrap();
    let mut x = exact.duplicate().unwrap();
    matrix.mult(&exact, &mut b).unwrap();
    ksp.solve(&b, &mut x).unwrap();
    x.axpy(-1.0, &exact).unwrap();
    x.norm_max().unwrap()
}

fn the_default_is_direct(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = Ksp::new(&session.world(), "", &matrix).unwrap();
    // Condition number about n² = 6400: 1e-12 leaves room for rounding, none for an iterative tolerance.
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
}

fn a_changed_matrix_is_factorised_again(session: &Session) {
    let mut matrix = laplacian(session, 2.0);
    let mut ksp = Ksp::new(&session.world(), "", &matrix).unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
    let other = matrix.duplicate().unwrap();
    matrix.axpy(1.0, &other).unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
}

fn options_choose_by_prefix_and_divergence_is_told(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = Ksp::new(&session.world(), "cg_", &matrix).unwrap();
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    b.fill(1.0).unwrap();
    let mut x = b.duplicate().unwrap();
    // Three iterations cannot reach 1e-12 on this chain.
    let Err(Error::Diverged(failure)) = ksp.solve(&b, &mut x) else { panic!("converged") };
    assert_eq!((failure.solver, failure.iterations), ("KSP", 3));
    assert!(failure.reason.contains("DIVERGED_ITS"), "{failure}");
    assert!(failure.norm > 0.0);
}

fn a_singular_matrix_is_told(session: &Session) {
    // ends = 1: constant vectors are the null space; scaled so that the last pivot is exactly zero.
    let matrix = laplacian(session, 1.0);
    let mut ksp = Ksp::new(&session.world(), "", &matrix).unwrap();
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    b.fill(1.0).unwrap();
    let mut x = b.duplicate().unwrap();
    match ksp.solve(&b, &mut x) {
        Err(Error::Diverged(failure)) => assert!(failure.reason.contains("PC_FAILED"), "{failure}"),
        // On one rank CHOLMOD tells it.
        Err(Error::Petsc { message, .. }) => assert!(message.contains("not positive definite"), "{message}"),
        // Rounding may leave a tiny pivot: then the answer is huge, not silently plausible.
        Ok(()) => assert!(x.norm().unwrap() > 1e6),
        Err(error) => panic!("{error}"),
    }
}

/// Each method solves to its tolerance, from a bad guess too, and whatever options put in the place of conjugate gradients.
fn methods_and_options_in_their_place(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let multigrid = Method::Multigrid { tolerance: 1e-11 };
    // (The condition, some thousand at most, times the residual.)
    for (prefix, method, direct) in [
        ("", multigrid, false),
        ("", Method::Diagonal { tolerance: 1e-11 }, false),
        ("factor_", multigrid, true),
        ("gmres_", multigrid, false),
    ] {
        let mut ksp = Ksp::with(&session.world(), prefix, &matrix, method).unwrap();
        assert_eq!(ksp.is_direct().unwrap(), direct, "{prefix} {method:?}");
        let error = error_of_solve(session, &mut ksp, &matrix);
        assert!(error < 1e-7, "{prefix} {method:?}: {error:e}");
    }
}
