//! Tests of linear solvers, on one and two ranks.

use std::cell::Cell;
use std::process::ExitCode;
use std::rc::Rc;

#[path = "problems/chain.rs"]
mod chain;

use chain::{LOCAL, error_of_solve, laplacian};
use petsc_wrap::{
    Diverged, Error, Insert, Ksp, Matrix, Preconditioner, ResidualNorm, Session, Tolerances, Vector, options,
};

fn start() -> Session {
    let limited = "-cg_ksp_type cg -cg_pc_type jacobi -cg_ksp_rtol 1e-12 -cg_ksp_max_it 3";
    let words: Vec<String> = limited.split(' ').map(String::from).collect();
    Session::start(&words).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2],
        start,
        &[
            ("methods_solve_to_their_tolerance", methods_solve_to_their_tolerance),
            ("a_changed_matrix_is_set_up_again", a_changed_matrix_is_set_up_again),
            ("a_closure_preconditions", a_closure_preconditions),
            ("a_factorisation_follows_its_matrix", a_factorisation_follows_its_matrix),
            ("a_closure_multiplies", a_closure_multiplies),
            ("each_rank_has_a_factor_of_all", each_rank_has_a_factor_of_all),
            ("a_guess_is_used_or_not", a_guess_is_used_or_not),
            ("options_choose_by_prefix_and_divergence_is_told", options_choose_by_prefix_and_divergence_is_told),
            ("a_singular_matrix_is_told", a_singular_matrix_is_told),
            ("what_does_not_fit_is_refused", what_does_not_fit_is_refused),
            ("mumps_takes_more_memory_where_it_factorises", mumps_takes_more_memory_where_it_factorises),
            ("a_solver_keeps_its_matrix", a_solver_keeps_its_matrix),
            ("a_right_hand_side_is_not_written", a_right_hand_side_is_not_written),
            ("a_slice_that_is_read_does_not_change", a_slice_that_is_read_does_not_change),
            ("a_right_hand_side_stays_in_its_place", a_right_hand_side_stays_in_its_place),
            ("types_that_are_not_admitted_are_refused", types_that_are_not_admitted_are_refused),
            ("a_row_without_diagonal_is_refused", a_row_without_diagonal_is_refused),
        ],
    )
}

/// Conjugate gradients with a diagonal preconditioner and a relative tolerance of 1e-12.
fn gradients(matrix: &Matrix) -> Ksp {
    let mut ksp = Ksp::new(matrix.comm()).unwrap();
    ksp.set_operators(matrix, matrix).unwrap();
    ksp.set_type("cg").unwrap();
    ksp.pc().unwrap().set_type("jacobi").unwrap();
    ksp.set_tolerances(Tolerances { relative: Some(1e-12), ..Default::default() }).unwrap();
    ksp
}

fn methods_solve_to_their_tolerance(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = gradients(&matrix);
    // Error bound: the condition number, about n² = 6400, times the residual.
    for norm in [ResidualNorm::Preconditioned, ResidualNorm::Unpreconditioned, ResidualNorm::Natural] {
        ksp.set_residual_norm(norm).unwrap();
        assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-8, "{norm:?}");
    }
    assert!(ksp.iterations().unwrap() > 1);
    assert_eq!((ksp.type_name().unwrap(), ksp.pc().unwrap().type_name().unwrap()), ("cg".into(), "jacobi".into()));
    // Without a norm all iterations are done, and convergence is unknown.
    ksp.set_residual_norm(ResidualNorm::None).unwrap();
    ksp.set_tolerances(Tolerances { iterations: Some(7), ..Default::default() }).unwrap();
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    b.fill(1.0).unwrap();
    let mut x = b.duplicate().unwrap();
    let Err(Error::Diverged(Diverged { iterations, .. })) = ksp.solve(&b, &mut x) else { panic!("converged") };
    assert_eq!((iterations, ksp.iterations().unwrap()), (7, 7));
}

fn a_changed_matrix_is_set_up_again(session: &Session) {
    let mut matrix = laplacian(session, 2.0);
    let mut ksp = gradients(&matrix);
    ksp.set_type("preonly").unwrap();
    ksp.pc().unwrap().set_type("redundant").unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
    let other = matrix.duplicate().unwrap();
    matrix.axpy(1.0, &other).unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
}

/// A closure can precondition: its values are used and its memory is freed with it. One triangle of the matrix can be
/// the operator. A panic gives an error, and so does one of PETSc's preconditioners with the triangle.
fn a_closure_preconditions(session: &Session) {
    let world = session.world();
    let matrix = laplacian(session, 2.0);
    for operator in [matrix.duplicate().unwrap(), matrix.upper_triangle(1).unwrap()] {
        let (counted, calls) = (Rc::new(Cell::new(0)), Rc::new(Cell::new(0)));
        let mut ksp = Ksp::new(&world).unwrap();
        ksp.set_type("cg").unwrap();
        ksp.set_tolerances(Tolerances { relative: Some(1e-12), ..Default::default() }).unwrap();
        let owned = calls.clone();
        ksp.set_closure(&operator, move |_, _| owned.set(-1)).unwrap();
        let owned = counted.clone();
        ksp.set_closure(&operator, move |r, z| {
            owned.set(owned.get() + 1);
            z.iter_mut().zip(r).for_each(|(z, r)| *z = 0.5 * r);
        })
        .unwrap();
        assert_eq!(Rc::strong_count(&calls), 1, "the first closure is released");
        assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-8);
        assert!(counted.get() >= ksp.iterations().unwrap() && ksp.iterations().unwrap() > 1);
        assert_eq!(calls.get(), 0);
        let is_aij = operator.diagonal(&mut Vector::new(&world, LOCAL).unwrap()).is_ok();
        ksp.pc().unwrap().set_type("jacobi").unwrap();
        assert_eq!(Rc::strong_count(&counted), 1, "another type releases it");
        let (b, mut x) = (Vector::new(&world, LOCAL).unwrap(), Vector::new(&world, LOCAL).unwrap());
        assert_eq!(ksp.solve(&b, &mut x).is_ok(), is_aij);
        ksp.set_closure(&operator, |_, _| panic!("of a test")).unwrap();
        let mut b = b;
        b.fill(1.0).unwrap();
        assert!(matches!(ksp.solve(&b, &mut x), Err(Error::Petsc { code: 8383, .. })));
        ksp.destroy().unwrap();
    }
}

/// The function that makes a closure from the matrix is called before the first solve and after each change, and is
/// dropped with the solver. If it returns no closure, the solve fails like with a failed PETSc factorisation. If it
/// fails or panics, the solve returns an error.
fn a_factorisation_follows_its_matrix(session: &Session) {
    let mut matrix = laplacian(session, 2.0);
    let made = Rc::new(Cell::new(0));
    let mut ksp = Ksp::new(&session.world()).unwrap();
    ksp.set_type("cg").unwrap();
    ksp.set_tolerances(Tolerances { relative: Some(1e-12), ..Default::default() }).unwrap();
    let counted = made.clone();
    // The diagonal of the solver's matrix.
    ksp.set_factorisation(&matrix, move |matrix| {
        counted.set(counted.get() + 1);
        let first = matrix.row_range().start;
        let row = matrix.row(first)?;
        let at = row.columns.iter().position(|column| *column == first).unwrap();
        let diagonal = row.values[at];
        Ok((diagonal < 5.0).then(|| -> Preconditioner {
            Box::new(move |r, z| z.iter_mut().zip(r).for_each(|(z, r)| *z = r / diagonal))
        }))
    })
    .unwrap();
    for _ in 0..2 {
        assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-8);
        assert_eq!(made.get(), 1, "an unchanged matrix is not factorised again");
    }
    let one = matrix.duplicate().unwrap();
    matrix.axpy(1.0, &one).unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-8);
    assert_eq!(made.get(), 2);
    matrix.axpy(1.0, &one).unwrap();
    let (mut b, mut x) = (Vector::new(&session.world(), LOCAL).unwrap(), Vector::new(&session.world(), LOCAL).unwrap());
    b.fill(1.0).unwrap();
    let Err(Error::Diverged(failure)) = ksp.solve(&b, &mut x) else { panic!("solved without a factor") };
    assert!(failure.reason.contains("PC_FAILED"), "{failure}");
    ksp.destroy().unwrap();
    assert_eq!(Rc::strong_count(&made), 1, "it goes with the solver");

    let mut ksp = Ksp::new(&session.world()).unwrap();
    ksp.set_type("preonly").unwrap();
    ksp.set_factorisation(&one, |_| panic!("of a test")).unwrap();
    assert!(matches!(ksp.solve(&b, &mut x), Err(Error::Petsc { code: 8383, .. })));
    ksp.destroy().unwrap();
}

/// A closure can be an operator: its products are used, its errors and panics end a solve, and its memory is freed with
/// the last object that keeps it.
fn a_closure_multiplies(session: &Session) {
    let world = session.world();
    let (matrix, kept) = (laplacian(session, 2.0), Rc::new(()));
    let (inner, held) = (laplacian(session, 2.0), kept.clone());
    let operator = Matrix::closure(&world, LOCAL, move |x, y| {
        let _ = &held;
        inner.mult(x, y)
    })
    .unwrap();
    let mut ksp = Ksp::new(&world).unwrap();
    ksp.set_type("cg").unwrap();
    ksp.set_tolerances(Tolerances { relative: Some(1e-12), ..Default::default() }).unwrap();
    ksp.set_closure(&operator, |r, z| z.copy_from_slice(r)).unwrap();
    assert!(operator.duplicate().is_err(), "two operators of one closure");
    operator.destroy().unwrap();
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-8);
    assert_eq!(Rc::strong_count(&kept), 2, "the solver keeps it");
    // PETSc's preconditioners cannot use an operator without entries.
    ksp.pc().unwrap().set_type("jacobi").unwrap();
    let (mut b, mut x) = (Vector::new(&world, LOCAL).unwrap(), Vector::new(&world, LOCAL).unwrap());
    assert!(is_invalid(ksp.solve(&b, &mut x)));
    ksp.destroy().unwrap();
    assert_eq!(Rc::strong_count(&kept), 1);
    let longer = Vector::new(&world, LOCAL + 1).unwrap();
    let failing = Matrix::closure(&world, LOCAL, move |_, y| y.copy_from(&longer)).unwrap();
    let panicking = Matrix::closure(&world, LOCAL, |_, _| panic!("of a test")).unwrap();
    b.fill(1.0).unwrap();
    for operator in [failing, panicking] {
        assert!(matches!(operator.mult(&b, &mut x), Err(Error::Petsc { code: 8383, .. })));
        operator.destroy().unwrap();
    }
}

fn each_rank_has_a_factor_of_all(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = Ksp::new(&session.world()).unwrap();
    ksp.set_type("preonly").unwrap();
    ksp.pc().unwrap().set_type("redundant").unwrap();
    // Without the check, PETSc would use a matrix that does not exist.
    assert!(matches!(ksp.pc().unwrap().redundant_pc().err(), Some(Error::Invalid { .. })));
    ksp.set_operators(&matrix, &matrix).unwrap();
    let mut pc = ksp.pc().unwrap();
    let mut each = pc.redundant_pc().unwrap();
    each.set_type("cholesky").unwrap();
    each.set_factor_package("petsc").unwrap();
    assert_eq!(each.type_name().unwrap(), "cholesky");
    // The condition number is about n² = 6400. The tolerance 1e-12 covers rounding, but not the error of an iterative
    // solver.
    assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12);
    // Another method has no such preconditioner.
    ksp.pc().unwrap().set_type("jacobi").unwrap();
    assert!(matches!(ksp.pc().unwrap().redundant_pc().err(), Some(Error::Petsc { .. })));
}

fn a_guess_is_used_or_not(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = gradients(&matrix);
    let mut x = Vector::new(&session.world(), LOCAL).unwrap();
    x.fill(1.0).unwrap();
    let mut b = x.duplicate().unwrap();
    matrix.mult(&x, &mut b).unwrap();
    ksp.set_initial_guess_nonzero(true).unwrap();
    ksp.solve(&b, &mut x).unwrap();
    assert_eq!(ksp.iterations().unwrap(), 0);
    ksp.set_initial_guess_nonzero(false).unwrap();
    ksp.solve(&b, &mut x).unwrap();
    assert!(ksp.iterations().unwrap() > 0);
}

fn options_choose_by_prefix_and_divergence_is_told(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = Ksp::new(&session.world()).unwrap();
    ksp.set_options_prefix("cg_").unwrap();
    ksp.set_operators(&matrix, &matrix).unwrap();
    ksp.set_from_options().unwrap();
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    b.fill(1.0).unwrap();
    let mut x = b.duplicate().unwrap();
    // Three iterations cannot reach 1e-12 for this chain of springs.
    let Err(Error::Diverged(failure)) = ksp.solve(&b, &mut x) else { panic!("converged") };
    assert_eq!((failure.solver, failure.iterations), ("KSP", 3));
    assert!(failure.reason.contains("DIVERGED_ITS"), "{failure}");
    assert!(failure.norm > 0.0);
}

/// A singular matrix, diag(0, 1), is reported: it has a zero pivot.
fn a_singular_matrix_is_told(session: &Session) {
    let alone = session.alone();
    let matrix = Matrix::csr(&alone, &[0, 1, 2], &[0, 1], &[0.0, 1.0]).unwrap();
    let mut ksp = Ksp::new(&alone).unwrap();
    ksp.set_operators(&matrix, &matrix).unwrap();
    ksp.set_type("preonly").unwrap();
    ksp.pc().unwrap().set_type("lu").unwrap();
    let (mut b, mut x) = (Vector::new(&alone, 2).unwrap(), Vector::new(&alone, 2).unwrap());
    b.fill(1.0).unwrap();
    let Err(Error::Diverged(Diverged { reason, .. })) = ksp.solve(&b, &mut x) else { panic!("solved") };
    assert!(reason.contains("PC_FAILED") && reason.contains("zero pivot"), "{reason}");
}

fn is_invalid<T>(outcome: petsc_wrap::Result<T>) -> bool {
    matches!(outcome, Err(Error::Invalid { .. }))
}

fn what_does_not_fit_is_refused(session: &Session) {
    let world = session.world();
    let vector = |local| Vector::new(&world, local).unwrap();
    let mut ksp = Ksp::new(&world).unwrap();
    assert!(is_invalid(ksp.solve(&vector(LOCAL), &mut vector(LOCAL))), "no operator");
    let matrix = laplacian(session, 2.0);
    // A matrix that is not square, and types whose rows PETSc cannot return.
    let mut wide = Matrix::aij(&world, (2, 4), &[1, 1], &[0, 0]).unwrap();
    wide.assemble().unwrap();
    assert!(is_invalid(ksp.set_operators(&wide, &wide)));
    let triangle = matrix.upper_triangle(1).unwrap();
    assert!(is_invalid(ksp.set_operators(&triangle, &matrix)) && is_invalid(ksp.set_operators(&matrix, &triangle)));
    let mut ksp = gradients(&matrix);
    assert!(is_invalid(ksp.solve(&vector(LOCAL + 1), &mut vector(LOCAL))));
    assert!(is_invalid(ksp.solve(&vector(LOCAL), &mut vector(LOCAL - 1))));
    if world.size() > 1 {
        let alone = Vector::new(&session.alone(), LOCAL).unwrap();
        assert!(is_invalid(ksp.solve(&alone, &mut vector(LOCAL))));
        assert!(is_invalid(Ksp::new(&session.alone()).unwrap().set_operators(&matrix, &matrix)));
    }
    // The solver's work vectors have the size of the first matrix.
    let mut small = Matrix::aij(&world, (1, 1), &[1], &[0]).unwrap();
    small.assemble().unwrap();
    assert!(is_invalid(ksp.set_operators(&small, &small)));
    // Entries that are set but not assembled.
    let mut matrix = matrix;
    let first = matrix.row_range().start;
    matrix.set_values(&[first], &[first], &[3.0], Insert::Replace).unwrap();
    assert!(is_invalid(ksp.solve(&vector(LOCAL), &mut vector(LOCAL))));
    matrix.assemble().unwrap();
    ksp.solve(&vector(LOCAL), &mut vector(LOCAL)).unwrap();
}

fn a_solver_keeps_its_matrix(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = gradients(&matrix);
    drop(matrix);
    let other = laplacian(session, 2.0);
    assert!(error_of_solve(session, &mut ksp, &other) < 1e-8);
}

/// A solver with the option by which PETSc scales the matrix and the right-hand side in place, and then back.
fn scaled(session: &Session, matrix: &Matrix) -> Ksp {
    for name in ["-scaled_ksp_diagonal_scale", "-scaled_ksp_diagonal_scale_fix"] {
        options::set(session, name, "").unwrap();
    }
    let mut ksp = gradients(matrix);
    ksp.set_options_prefix("scaled_").unwrap();
    ksp.set_from_options().unwrap();
    ksp
}

/// The scaling does not change the right-hand side, also not by rounding of 1/√2 and √2, and not while it is read.
fn a_right_hand_side_is_not_written(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut ksp = scaled(session, &matrix);
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    let tenths: Vec<f64> = (1..=LOCAL).map(|i| 0.1 * i as f64).collect();
    b.write().unwrap().copy_from_slice(&tenths);
    let mut x = b.duplicate().unwrap();
    ksp.solve(&b, &mut x).unwrap();
    let seen = b.read().unwrap();
    ksp.solve(&b, &mut x).unwrap();
    assert_eq!(*seen, tenths);
    drop(seen);
    assert_eq!(*b.read().unwrap(), tenths);
    let mut residual = b.duplicate().unwrap();
    // PETSc has scaled its matrix back too.
    matrix.mult(&x, &mut residual).unwrap();
    residual.axpy(-1.0, &b).unwrap();
    assert!(residual.norm().unwrap() < 1e-9);
}

/// A slice of a vector does not change while it is read, also if PETSc lends the vector to a closure that solves with
/// it: the lent view does not know of the readers.
fn a_slice_that_is_read_does_not_change(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let mut inner = scaled(session, &matrix);
    // In the middle of the solve the right-hand side would be scaled.
    let during = Rc::new(Cell::new(f64::NAN));
    let mut b = Vector::new(&session.world(), LOCAL).unwrap();
    b.fill(1.0).unwrap();
    let (b, mut y) = (Rc::new(b), Vector::new(&session.world(), LOCAL).unwrap());
    let (seen, watched) = (during.clone(), b.clone());
    inner
        .set_closure(&matrix, move |r, z| {
            z.copy_from_slice(r);
            seen.set(watched.read().unwrap()[0]);
        })
        .unwrap();
    let inverse = Matrix::closure(&session.world(), LOCAL, move |x, y| inner.solve(x, y)).unwrap();
    let guard = b.read().unwrap();
    inverse.mult(&b, &mut y).unwrap();
    assert_eq!((during.get(), guard[0]), (1.0, 1.0));
    drop(guard);
    inverse.destroy().unwrap();
    // The closures hold a vector.
    session.world().collect_garbage().unwrap();
}

/// A guard that is taken during a solve looks at the vector's own memory, as one before and after it.
fn a_right_hand_side_stays_in_its_place(session: &Session) {
    let matrix = laplacian(session, 2.0);
    let place = Rc::new(Cell::new(std::ptr::null()));
    let b = Rc::new(Vector::new(&session.world(), LOCAL).unwrap());
    let (seen, watched) = (place.clone(), b.clone());
    let mut ksp = Ksp::new(&session.world()).unwrap();
    ksp.set_type("preonly").unwrap();
    ksp.set_closure(&matrix, move |r, z| {
        z.copy_from_slice(r);
        seen.set(watched.read().unwrap().as_ptr());
    })
    .unwrap();
    let outer = b.read().unwrap();
    ksp.solve(&b, &mut Vector::new(&session.world(), LOCAL).unwrap()).unwrap();
    assert_eq!(place.get(), outer.as_ptr());
    drop(outer);
    ksp.destroy().unwrap();
}

/// PETSc has types that crash for some matrices.
fn types_that_are_not_admitted_are_refused(session: &Session) {
    let mut ksp = Ksp::new(&session.world()).unwrap();
    for name in ["sor", "icc", "eisenstat", "ml", "hypre", "deflation", "shell", "no such method", "lu\0"] {
        assert!(is_invalid(ksp.pc().unwrap().set_type(name)), "{name}");
    }
    assert!(is_invalid(ksp.set_type("richardson")) && is_invalid(ksp.set_type("")));
    assert!(is_invalid(ksp.pc().unwrap().set_factor_package("no such package")));
}

/// The smoother of multigrid would read behind the entries of a row without diagonal, of which one rank has one here.
/// Incomplete factors would fail on this rank alone.
fn a_row_without_diagonal_is_refused(session: &Session) {
    let world = session.world();
    let n = LOCAL as petsc_wrap::Int;
    let first = n * world.rank() as petsc_wrap::Int;
    let rows = if world.is_root() { n - 1 } else { n };
    let offsets: Vec<_> = (0..=n).map(|row| row.min(rows)).collect();
    let columns: Vec<_> = (first..first + rows).collect();
    let matrix = Matrix::csr(&world, &offsets, &columns, &vec![1.0; columns.len()]).unwrap();
    let mut ksp = gradients(&matrix);
    let (b, mut x) = (Vector::new(&world, LOCAL).unwrap(), Vector::new(&world, LOCAL).unwrap());
    for name in ["gamg", "redundant", "bjacobi"] {
        ksp.pc().unwrap().set_type(name).unwrap();
        assert!(is_invalid(ksp.solve(&b, &mut x)), "{name}");
    }
    ksp.pc().unwrap().set_type("none").unwrap();
    ksp.solve(&b, &mut x).unwrap();
}

/// The memory margin is an error before there is a matrix to factorise, and has no effect if another package, or none,
/// factorises.
fn mumps_takes_more_memory_where_it_factorises(session: &Session) {
    let matrix = laplacian(session, 2.0);
    for package in ["mumps", "petsc"] {
        let mut ksp = Ksp::new(matrix.comm()).unwrap();
        ksp.set_type("preonly").unwrap();
        ksp.pc().unwrap().set_mumps_margin(80).unwrap();
        ksp.pc().unwrap().set_type("cholesky").unwrap();
        ksp.pc().unwrap().set_factor_package(package).unwrap();
        let early = ksp.pc().unwrap().set_mumps_margin(80);
        assert_eq!(is_invalid(early), package == "mumps", "{package}");
        ksp.set_operators(&matrix, &matrix).unwrap();
        if !petsc_wrap::Factor::Cholesky.is_available(package, &matrix).unwrap() {
            continue;
        }
        ksp.pc().unwrap().set_mumps_margin(80).unwrap();
        assert!(error_of_solve(session, &mut ksp, &matrix) < 1e-12, "{package}");
    }
}
