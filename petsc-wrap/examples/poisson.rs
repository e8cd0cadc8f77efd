//! −u″ = 1 on (0, 1), u = 0 at the ends, by finite differences and conjugate gradients.
//!
//! u = x (1 − x)/2 is a parabola, for which second differences are exact.
//!
//!     mpirun -n 2 cargo run --example poisson -- -ksp_monitor -pc_type bjacobi

use petsc_wrap::{Insert, Int, Ksp, Matrix, Session, Tolerances, Vector};

/// Number of inner nodes on each rank.
const LOCAL: usize = 50;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options: Vec<String> = std::env::args().skip(1).collect();
    let session = Session::start(&options).ok_or("MPI has been started before")??;
    let world = session.world();
    let n = LOCAL * world.size();
    let h = 1.0 / (n as f64 + 1.0);

    // A row has up to three entries in this rank's columns, and up to one on each side in another rank's.
    let mut matrix = Matrix::aij(&world, (LOCAL, LOCAL), &[3; LOCAL], &[2; LOCAL])?;
    for i in matrix.row_range() {
        let columns: Vec<Int> = (i - 1..=i + 1).filter(|j| (0..n as Int).contains(j)).collect();
        let values: Vec<f64> = columns.iter().map(|j| if *j == i { 2.0 } else { -1.0 }).collect();
        matrix.set_values(&[i], &columns, &values, Insert::Replace)?;
    }
    matrix.assemble()?;
    matrix.declare_positive_definite()?;

    let mut solver = Ksp::new(&world)?;
    solver.set_operators(&matrix, &matrix)?;
    solver.set_type("cg")?;
    solver.pc()?.set_type("jacobi")?;
    solver.set_tolerances(Tolerances { relative: Some(1e-12), ..Default::default() })?;
    solver.set_from_options()?;
    let mut right = Vector::new(&world, LOCAL)?;
    right.fill(h * h)?;
    let mut u = right.duplicate()?;
    solver.solve(&right, &mut u)?;

    let mut error = u.duplicate()?;
    for (i, value) in u.range().zip(error.write()?.iter_mut()) {
        let x = h * (i + 1) as f64;
        *value = -x * (1.0 - x) / 2.0;
    }
    error.axpy(1.0, &u)?;
    let error = error.norm_max()?;
    if world.is_root() {
        println!("{n} unknowns, {} iterations, largest error {error:.1e}", solver.iterations()?);
    }
    // The residual, 1e-12, times the condition number, (2/πh)², which is some thousands.
    assert!(error < 1e-8);
    Ok(())
}
