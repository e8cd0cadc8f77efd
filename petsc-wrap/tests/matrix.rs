//! Tests of matrices, on one to three ranks.

use std::process::ExitCode;

use petsc_wrap::{Error, Factor, Insert, Int, Matrix, NullSpace, Row, Session, Vector, estimate_cholesky};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
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
            ("an_unsafe_shape_is_refused", an_unsafe_shape_is_refused),
            ("a_fault_of_one_rank_is_refused_on_all", a_fault_of_one_rank_is_refused_on_all),
            ("what_is_not_assembled_is_refused", what_is_not_assembled_is_refused),
            ("other_types_are_refused", other_types_are_refused),
            ("other_layouts_are_refused", other_layouts_are_refused),
            ("other_entries_are_refused", other_entries_are_refused),
            ("components_share_entries_that_stay", components_share_entries_that_stay),
            ("rows_are_copies", rows_are_copies),
            ("symbolic_factorisation_counts_the_factor", symbolic_factorisation_counts_the_factor),
        ],
    )
}

/// Number of rows on each rank in these tests.
const LOCAL: usize = 4;

/// A chain of springs with blocks [1 −1; −1 1]. Each block is declared and set by one rank.
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

/// The same matrix on one rank, created from its rows; and a diagonal matrix on all ranks.
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
        assert_eq!(row, Row { columns: columns[range.clone()].to_vec(), values: values[range].to_vec() });
    }
    let twice = matrix.with_values(&offsets, &columns, &values.map(|value| 2.0 * value)).unwrap();
    assert_eq!((twice.trace().unwrap(), matrix.trace().unwrap()), (8.0, 4.0));
    assert!(Matrix::csr(&session.alone(), &[0, 1], &[1], &[1.0]).is_err());
    // Constants are in read-only memory.
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
        assert_eq!(row.columns, expected);
        assert_eq!(row.values.iter().sum::<f64>(), 0.0);
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
    for (j, value) in row.columns.iter().zip(&row.values) {
        assert_eq!(*value, if *j == first { 5.0 } else { 0.0 });
    }
    let next = matrix.row(first + 1).unwrap();
    let column = next.columns.iter().position(|j| *j == first).unwrap();
    assert_eq!(next.values[column], 0.0);
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

/// An assembled diagonal matrix of ones, with `local` rows and columns on this rank.
fn ones(session: &Session, local: usize) -> Matrix {
    let world = session.world();
    let mut matrix = Matrix::aij(&world, (local, local), &vec![1; local], &vec![0; local]).unwrap();
    for i in matrix.row_range() {
        matrix.set_values(&[i], &[i], &[1.0], Insert::Replace).unwrap();
    }
    matrix.assemble().unwrap();
    matrix
}

fn is_invalid<T>(outcome: petsc_wrap::Result<T>) -> bool {
    matches!(outcome, Err(Error::Invalid { .. }))
}

/// Invalid shapes are refused. Without debugging PETSc checks none of these: it would allocate with negative counts,
/// divide by zero and overflow.
fn an_unsafe_shape_is_refused(session: &Session) {
    let alone = session.alone();
    assert!(is_invalid(Matrix::aij(&alone, (2, 2), &[1, -1], &[0, 0])));
    assert!(is_invalid(Matrix::aij(&alone, (2, 2), &[1, 1], &[0, -1])));
    assert!(matches!(Matrix::of_pairs(&alone, (usize::MAX, 1), vec![], vec![]), Err(Error::TooLarge { .. })));
    // Columns that are out of order, and a column that is repeated.
    assert!(is_invalid(Matrix::csr(&alone, &[0, 2, 3], &[1, 0, 1], &[1.0; 3])));
    assert!(is_invalid(Matrix::csr(&alone, &[0, 2, 3], &[0, 0, 1], &[1.0; 3])));
    let mut matrix = ones(session, 4);
    assert!(is_invalid(matrix.set_block_size(0)));
    assert!(is_invalid(matrix.upper_triangle(0)));
    assert!(is_invalid(matrix.upper_triangle(3)));
    assert!(is_invalid(ones(session, 4).by_component(0)));
    assert!(matches!(ones(session, 4).by_component(usize::MAX), Err(Error::TooLarge { .. })));
    assert!(ones(session, 4).by_component(Int::MAX as usize).is_err());
    // Two rows and four columns.
    let mut wide = Matrix::aij(&alone, (2, 4), &[1, 1], &[0, 0]).unwrap();
    wide.assemble().unwrap();
    assert!(is_invalid(wide.zero_rows_columns(&[0], 1.0)) && is_invalid(wide.trace()));
    assert!(is_invalid(wide.upper_triangle(1)) && is_invalid(wide.diagonal(&mut Vector::new(&alone, 2).unwrap())));
    assert!(is_invalid(estimate_cholesky(&wide)));
    assert!(is_invalid(NullSpace::rigid_body(&mut Vector::new(&alone, 4).unwrap())));
}

/// No rank waits for one whose arguments are refused.
fn a_fault_of_one_rank_is_refused_on_all(session: &Session) {
    let world = session.world();
    let (rank, n) = (world.rank() as Int, world.size() as Int);
    let here = |bad: Int, good: Int| if world.is_root() { bad } else { good };
    assert!(Matrix::csr(&world, &[0, 1], &[here(n, rank)], &[1.0]).is_err());
    assert!(Matrix::csr(&world, &[0, 2], &[here(0, -1), 0], &[1.0; 2]).is_err());
    assert!(Matrix::of_pairs(&world, (1, 1), vec![rank], vec![here(n, rank)]).is_err());
    assert!(Matrix::of_pairs(&world, (1, 1), vec![here(-1, rank)], vec![rank]).is_err());
    assert!(Matrix::aij(&world, (1, 1), &[here(-1, 1)], &[0]).is_err());
    let mut matrix = ones(session, 1);
    assert!(matrix.zero_rows_columns(&[here(n, rank)], 1.0).is_err());
    matrix.zero_rows_columns(&[rank], 2.0).unwrap();
    assert_eq!(matrix.trace().unwrap(), 2.0 * n as f64);
}

/// Matrices that are not assembled are refused. They have room between their entries, where PETSc has not written the
/// columns.
fn what_is_not_assembled_is_refused(session: &Session) {
    let open = || {
        let mut matrix = Matrix::aij(&session.world(), (2, 2), &[2, 2], &[0, 0]).unwrap();
        let first = matrix.row_range().start;
        matrix.set_values(&[first], &[first], &[1.0], Insert::Replace).unwrap();
        matrix
    };
    let mut matrix = open();
    assert!(!matrix.is_assembled().unwrap());
    let (x, mut y) = (Vector::new(&session.world(), 2).unwrap(), Vector::new(&session.world(), 2).unwrap());
    let first = matrix.row_range().start;
    let other = ones(session, 2);
    assert!(matrix.mult(&x, &mut y).is_err() && matrix.duplicate().is_err());
    assert!(is_invalid(matrix.row(first)) && is_invalid(matrix.upper_triangle(1)) && is_invalid(matrix.trace()));
    assert!(is_invalid(matrix.copy_from(&other)) && is_invalid(matrix.axpy(1.0, &other)));
    assert!(is_invalid(ones(session, 2).copy_from(&matrix)) && is_invalid(ones(session, 2).axpy(1.0, &matrix)));
    assert!(is_invalid(matrix.diagonal(&mut y)) && is_invalid(matrix.zero_rows_columns(&[first], 1.0)));
    assert!(is_invalid(estimate_cholesky(&matrix)) && is_invalid(open().by_component(2)));
    assert!(is_invalid(matrix.with_values(&[0, 1, 1], &[first], &[1.0])));
}

/// Other matrix types are refused. PETSc would call functions that these types do not have, or misread their data.
fn other_types_are_refused(session: &Session) {
    let mut matrix = ones(session, 2);
    let first = matrix.row_range().start;
    let others = [matrix.upper_triangle(1).unwrap(), ones(session, 1).by_component(2).unwrap()];
    for mut other in others {
        assert_eq!(other.size(), matrix.size());
        assert!(is_invalid(other.row(first)) && is_invalid(other.upper_triangle(1)) && is_invalid(other.trace()));
        assert!(is_invalid(matrix.copy_from(&other)) && is_invalid(other.copy_from(&matrix)));
        assert!(is_invalid(matrix.axpy(1.0, &other)) && is_invalid(other.axpy(1.0, &matrix)));
        assert!(is_invalid(other.with_values(&[0, 1, 2], &[first, first + 1], &[1.0; 2])));
        assert!(is_invalid(other.zero_rows_columns(&[first], 1.0)) && is_invalid(other.set_block_size(1)));
        assert!(is_invalid(other.set_values(&[first], &[first], &[1.0], Insert::Replace)));
        assert!(is_invalid(estimate_cholesky(&other)));
        assert!(is_invalid(other.by_component(2)));
    }
    assert_eq!(matrix.trace().unwrap(), matrix.size().0 as f64);
}

fn other_layouts_are_refused(session: &Session) {
    let world = session.world();
    let matrix = ones(session, 3);
    let fitting = || Vector::new(&world, 3).unwrap();
    // Other sizes; on several ranks, the same size with another distribution; and the same number of entries on this
    // rank alone.
    let moved = if world.is_root() { 3 * world.size() } else { 0 };
    for local in [2, moved] {
        if world.size() == 1 && local == 3 {
            continue;
        }
        let (mut vector, other) = (Vector::new(&world, local).unwrap(), ones(session, local));
        assert!(is_invalid(matrix.mult(&vector, &mut fitting())) && is_invalid(matrix.mult(&fitting(), &mut vector)));
        assert!(is_invalid(matrix.diagonal(&mut vector)));
        assert!(is_invalid(ones(session, 3).copy_from(&other)) && is_invalid(ones(session, 3).axpy(1.0, &other)));
    }
    if world.size() > 1 {
        let mut alone = Vector::new(&session.alone(), 3).unwrap();
        assert!(is_invalid(matrix.mult(&fitting(), &mut alone)) && is_invalid(matrix.diagonal(&mut alone)));
    }
    // Multigrid reads one entry of these vectors for each row of the matrix.
    let motions = NullSpace::rigid_body(&mut fitting()).unwrap();
    assert!(is_invalid(ones(session, 6).set_near_null_space(&motions)));
    ones(session, 3).set_near_null_space(&motions).unwrap();
}

/// A matrix with the same number of entries in other places is refused: PETSc would copy the values to the wrong
/// places.
fn other_entries_are_refused(session: &Session) {
    let alone = session.alone();
    let values = [1.0, 2.0, 3.0];
    let lower = Matrix::csr(&alone, &[0, 1, 3], &[0, 0, 1], &values).unwrap();
    let mut upper = Matrix::csr(&alone, &[0, 2, 3], &[0, 1, 1], &values).unwrap();
    assert!(is_invalid(upper.copy_from(&lower)));
    assert!(is_invalid(upper.with_values(&[0, 1, 3], &[0, 0, 1], &values)));
    assert_eq!(upper.row(0).unwrap().values, [1.0, 2.0]);
    // On several ranks, each rank has an entry in a column of the last rank, or of the first.
    let world = session.world();
    let couple = |column: Int| {
        let mut matrix = Matrix::aij(&world, (1, 1), &[1], &[1]).unwrap();
        let row = matrix.row_range().start;
        matrix.set_values(&[row], &[column], &[1.0], Insert::Replace).unwrap();
        matrix.assemble().unwrap();
        matrix
    };
    let (first, last) = (couple(0), couple(world.size() as Int - 1));
    let outcome = couple(0).copy_from(&last);
    assert_eq!(outcome.is_ok(), world.size() == 1);
    couple(0).copy_from(&first).unwrap();
    // If only a part of the entries were given, the others would keep their old values.
    let (all, first) = (springs(session), world.rank() as Int * LOCAL as Int);
    let rows: Vec<_> = all.row_range().map(|row| all.row(row).unwrap()).collect();
    let offsets: Vec<Int> = (0..=LOCAL as Int).collect();
    let diagonal: Vec<Int> = (first..first + LOCAL as Int).collect();
    assert!(rows.iter().all(|row| row.columns.len() > 1));
    assert!(is_invalid(all.with_values(&offsets, &diagonal, &[1.0; LOCAL])));
}

/// A product with one component is the matrix itself, and is made once. A product with more components keeps entries
/// that can no longer be changed.
fn components_share_entries_that_stay(session: &Session) {
    for components in [1, 2, 3] {
        let matrix = springs(session);
        let (rows, _) = matrix.size();
        let product = matrix.by_component(components).unwrap();
        assert_eq!(product.size(), (components * rows, components * rows));
        let mut x = Vector::new(&session.world(), components * LOCAL).unwrap();
        let mut y = x.duplicate().unwrap();
        x.fill(1.0).unwrap();
        product.mult(&x, &mut y).unwrap();
        assert_eq!(y.norm_max().unwrap(), 0.0);
        product.destroy().unwrap();
    }
}

/// Rows are copies: two rows of a distributed matrix can be held at once, though PETSc has one buffer for them, and
/// rows remain valid after a change of the matrix.
fn rows_are_copies(session: &Session) {
    let mut matrix = springs(session);
    let first = matrix.row_range().start;
    let (one, two) = (matrix.row(first).unwrap(), matrix.row(first + 1).unwrap());
    let other = matrix.duplicate().unwrap();
    matrix.axpy(1.0, &other).unwrap();
    drop(matrix);
    assert_eq!((one.values.iter().sum::<f64>(), two.values.iter().sum::<f64>()), (0.0, 0.0));
    assert_eq!(two.values, [-1.0, 2.0, -1.0]);
    assert!(other.row(first - 1).is_err());
}

fn symbolic_factorisation_counts_the_factor(session: &Session) {
    let mut matrix = springs(session);
    matrix.declare_positive_definite().unwrap();
    let n = matrix.size().0 as f64;
    let has_mumps = Factor::Cholesky.is_known(session, "mumps", "mpiaij").unwrap();
    assert_eq!(Factor::Cholesky.is_available("mumps", &matrix).unwrap(), has_mumps);
    assert!(!Factor::Lu.is_known(session, "no such package", "mpiaij").unwrap());
    let estimate = estimate_cholesky(&matrix).unwrap();
    assert_eq!(estimate.is_some(), has_mumps);
    let Some(estimate) = estimate else { return };
    // The factor of a chain without fill has n diagonal entries and n − 1 others. Frontal matrices store more: MUMPS from
    // 5.6 on takes so few rows as one front, which is half of a full matrix.
    assert!((2.0 * n - 1.0..=0.5 * n * (n + 1.0)).contains(&estimate.entries), "{estimate:?}");
    assert!(estimate.operations > n, "{estimate:?}");
}
