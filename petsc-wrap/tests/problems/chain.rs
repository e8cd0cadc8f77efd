//! A chain of springs: a linear system with a known solution.

use petsc_wrap::{Insert, Int, Ksp, Matrix, Session, Vector};

/// Number of unknowns on each rank.
pub const LOCAL: usize = 40;

/// tridiag(−1, 2, −1), with the value `ends` in the first and last diagonal entry.
pub fn laplacian(session: &Session, ends: f64) -> Matrix {
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

/// Largest error of a solve whose exact solution is known: the sines of the numbers of the unknowns.
pub fn error_of_solve(session: &Session, ksp: &mut Ksp, matrix: &Matrix) -> f64 {
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
