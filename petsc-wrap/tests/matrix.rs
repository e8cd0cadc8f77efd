//! Matrices, on one to three ranks.

use std::process::ExitCode;

use petsc_wrap::{Error, Insert, Int, Ksp, Matrix, Session, Vector, estimate_cholesky, has_mumps};

fn start() -> Session {
    let words = ["-by_mumps_pc_type", "cholesky", "-by_mumps_pc_factor_mat_solver_type", "mumps"].map(String::from);
    Session::start(&words).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        start,
        &[
            ("a_pattern_becomes_the_matrix", a_pattern_becomes_the_matrix),
            ("rows_become_the_matrix", rows_become_the_matrix),
            ("products_norms_and_rows", products_norms_and_rows),
            ("an_entry_without_room_is_an_error", an_entry_without_room_is_an_error),
            ("rows_and_columns_are_zeroed", rows_and_columns_are_zeroed),
            ("sums_and_copies", sums_and_copies),
            ("symbolic_factorisation_counts_the_factor", symbolic_factorisation_counts_the_factor),
        ],
    )
}

/// Rows of a rank in these tests.
const LOCAL: usize = 4;

/// A chain of springs with blocks [1 −1; −1 1], each named and handed over by one rank.
fn springs(session: &Session) -> Matrix {
    let world = session.world();
    let n = (LOCAL * world.size()) as Int;
    let own = || (0..n - 1).filter(|i| *i as usize % world.size() == world.rank());
    let pairs = |places: [Int; 4]| own().flat_map(move |i| places.map(|place| i + place)).collect();
    let mut matrix = Matrix::of_pairs(&world, (LOCAL, LOCAL), pairs([0, 0, 1, 1]), pairs([0, 1, 0, 1])).unwrap();
    for i in own() {
        matrix.set_values(&[i, i + 1], &[i, i + 1], &[1.0, -1.0, -1.0, 1.0], Insert::Add).unwrap();
    }
    matrix.assemble().unwrap();
    matrix
}

/// The same matrix alone on a rank, from its rows; and a diagonal on all of them.
fn rows_become_the_matrix(session: &Session) {
    let world = session.world();
    let (first, n) = ((LOCAL * world.rank()) as Int, LOCAL as Int);
    let (offsets, own): (Vec<Int>, Vec<Int>) = ((0..=n).collect(), (first..first + n).collect());
    let ones = Matrix::csr(&world, &offsets, &own, &[1.0; LOCAL]).unwrap();
    let threes = ones.with_values(&offsets, &own, &[3.0; LOCAL]).unwrap();
    let all = (LOCAL * world.size()) as f64;
    assert_eq!((ones.trace().unwrap(), threes.trace().unwrap()), (all, 3.0 * all));
    let (offsets, columns, values) = ([0, 2, 5, 7], [0, 1, 0, 1, 2, 1, 2], [1.0, -1.0, -1.0, 2.0, -1.0, -1.0, 1.0]);
    let matrix = Matrix::csr(&session.alone(), &offsets, &columns, &values).unwrap();
    for i in 0..3 {
        let (row, range) = (matrix.row(i).unwrap(), offsets[i as usize] as usize..offsets[i as usize + 1] as usize);
        assert_eq!((row.columns(), row.values()), (&columns[range.clone()], &values[range]));
    }
    let twice = matrix.with_values(&offsets, &columns, &values.map(|value| 2.0 * value)).unwrap();
    assert_eq!((twice.trace().unwrap(), matrix.trace().unwrap()), (8.0, 4.0));
    assert!(Matrix::csr(&session.alone(), &[0, 1], &[1], &[1.0]).is_err());
    // Constants lie in memory that nobody may write.
    assert_eq!(Matrix::csr(&session.alone(), &[0, 1], &[0], &[4.0]).unwrap().trace().unwrap(), 4.0);
    assert!(Matrix::of_pairs(&session.alone(), (2, 2), vec![0], vec![2]).is_err());
}

fn a_pattern_becomes_the_matrix(session: &Session) {
    let matrix = springs(session);
    let n = LOCAL * session.world().size();
    assert_eq!(matrix.size(), (n, n));
    assert_eq!(matrix.entries().unwrap(), 3 * n as u64 - 2);
}

fn products_norms_and_rows(session: &Session) {
    let matrix = springs(session);
    let n = matrix.size().0;
    let mut x = Vector::new(&session.world(), LOCAL).unwrap();
    let mut y = x.duplicate().unwrap();
    x.fill(1.0).unwrap();
    matrix.mult(&x, &mut y).unwrap();
    assert_eq!(y.norm_max().unwrap(), 0.0);
    // Diagonal 1, 2, …, 2, 1 and 2(n−1) entries −1: exact in floating point.
    assert_eq!(matrix.trace().unwrap(), 2.0 * (n as f64 - 1.0));
    matrix.diagonal(&mut x).unwrap();
    let begin = matrix.row_range().start;
    for (place, value) in x.read().unwrap().iter().enumerate() {
        let i = begin as usize + place;
        assert_eq!(*value, if i == 0 || i == n - 1 { 1.0 } else { 2.0 });
    }
    let squares = 2.0 + 4.0 * (n as f64 - 2.0) + 2.0 * (n as f64 - 1.0);
    assert!((matrix.norm_frobenius().unwrap() - squares.sqrt()).abs() < 1e-14 * squares);
    let rows = matrix.row_range();
    for i in rows {
        let row = matrix.row(i).unwrap();
        let expected: Vec<Int> = (i - 1..=i + 1).filter(|j| (0..n as Int).contains(j)).collect();
        assert_eq!(row.columns(), expected);
        assert_eq!(row.values().iter().sum::<f64>(), 0.0);
    }
}

fn an_entry_without_room_is_an_error(session: &Session) {
    let one = vec![1; LOCAL];
    let none = vec![0; LOCAL];
    let mut matrix = Matrix::aij(&session.world(), (LOCAL, LOCAL), &one, &none).unwrap();
    let first = matrix.row_range().start;
    matrix.set_values(&[first], &[first], &[1.0], Insert::Replace).unwrap();
    assert!(matrix.set_values(&[first], &[first + 1], &[1.0], Insert::Replace).is_err());
}

fn rows_and_columns_are_zeroed(session: &Session) {
    let mut matrix = springs(session);
    let before = matrix.entries().unwrap();
    let first = matrix.row_range().start;
    matrix.zero_rows_columns(&[first], 5.0).unwrap();
    assert_eq!(matrix.entries().unwrap(), before);
    let row = matrix.row(first).unwrap();
    for (j, value) in row.columns().iter().zip(row.values()) {
        assert_eq!(*value, if *j == first { 5.0 } else { 0.0 });
    }
    drop(row);
    let next = matrix.row(first + 1).unwrap();
    let column = next.columns().iter().position(|j| *j == first).unwrap();
    assert_eq!(next.values()[column], 0.0);
}

fn sums_and_copies(session: &Session) {
    let a = springs(session);
    let mut b = a.duplicate().unwrap();
    b.axpy(2.0, &a).unwrap();
    assert_eq!(b.trace().unwrap(), 3.0 * a.trace().unwrap());
    b.copy_from(&a).unwrap();
    assert_eq!(b.trace().unwrap(), a.trace().unwrap());
    b.destroy().unwrap();
}

fn symbolic_factorisation_counts_the_factor(session: &Session) {
    let mut matrix = springs(session);
    matrix.declare_positive_definite().unwrap();
    let n = matrix.size().0 as f64;
    let estimate = estimate_cholesky(&matrix).unwrap();
    // There is none where PETSc is without MUMPS: then it does not know the package (error 92).
    let mut solver = Ksp::new(&session.world(), "by_mumps_", &matrix).unwrap();
    let mut x = Vector::new(&session.world(), LOCAL).unwrap();
    let is_refused = matches!(solver.solve(&x.duplicate().unwrap(), &mut x), Err(Error::Petsc { code: 92, .. }));
    assert_eq!((estimate.is_none(), has_mumps(session).unwrap()), (is_refused, !is_refused));
    let Some(estimate) = estimate else { return };
    // A chain has a factor with at most n diagonal and n − 1 other entries without fill; fronts store a little more.
    assert!((2.0 * n - 1.0..6.0 * n).contains(&estimate.entries), "{estimate:?}");
    assert!(estimate.operations > n, "{estimate:?}");
}
