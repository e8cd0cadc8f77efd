//! Bratu's problem −u″ = eᵘ on (0, 1), u = 0 at the ends, by finite differences and Newton's method with PETSc's line
//! search.
//!
//! Its smaller solution is u = 2 ln(cosh(θ/4)/cosh((x − ½) θ/2)), where θ = √2 cosh(θ/4). The error of the finite
//! differences falls with h².
//!
//!     mpirun -n 2 cargo run --example bratu -- -snes_monitor

use petsc_wrap::{Comm, Gather, Insert, Int, Matrix, Session, Snes, SnesTolerances, Tolerances, Vector, VectorView};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options: Vec<String> = std::env::args().skip(1).collect();
    let session = Session::start(&options).ok_or("MPI has been started before")??;
    let world = session.world();
    let errors = [20, 40].map(|cells| error(&world, cells));
    let [coarse, fine] = errors;
    let (coarse, fine) = (coarse?, fine?);
    let order = (coarse / fine).log2();
    if world.is_root() {
        println!("largest errors {coarse:.3e} and {fine:.3e}: order {order:.2}");
    }
    // The next term of the error, of order h⁴, is smaller than the first by a factor of h².
    assert!((order - 2.0).abs() < 0.02);
    Ok(())
}

/// Largest error with this number of cells.
fn error(world: &Comm, cells: usize) -> petsc_wrap::Result<f64> {
    let (h, inner) = (1.0 / cells as f64, cells - 1);
    // The nodes are distributed as evenly as possible.
    let local = inner / world.size() + usize::from(world.rank() < inner % world.size());
    let mut u = Vector::new(world, local)?;
    let rows = u.range();
    let neighbours: Vec<Int> = (rows.start - 1..=rows.end).filter(|i| (0..inner as Int).contains(i)).collect();
    let mut gather = Gather::new(&u, &neighbours)?;
    // −u″ − eᵘ at this rank's nodes, times h².
    let mut residual = |u: &VectorView, f: &mut VectorView| -> petsc_wrap::Result<()> {
        let (near, mut f) = (gather.fetch(u)?, f.write()?);
        let at = |i: Int| neighbours.binary_search(&i).map_or(0.0, |place| near[place]);
        for (i, f) in u.range().zip(f.iter_mut()) {
            *f = 2.0 * at(i) - at(i - 1) - at(i + 1) - h * h * at(i).exp();
        }
        Ok(())
    };
    let jacobian = |u: &VectorView, j: &mut petsc_wrap::MatrixView| -> petsc_wrap::Result<()> {
        for (i, u) in u.range().zip(u.read()?.iter()) {
            let columns: Vec<Int> = (i - 1..=i + 1).filter(|k| (0..inner as Int).contains(k)).collect();
            let values: Vec<f64> = columns.iter().map(|k| if *k == i { 2.0 - h * h * u.exp() } else { -1.0 }).collect();
            j.set_values(&[i], &columns, &values, Insert::Replace)?;
        }
        j.assemble()
    };
    let mut solver = Snes::new(world)?;
    solver.set_jacobian(Matrix::aij(world, (local, local), &vec![3; local], &vec![2; local])?)?;
    solver.set_tolerances(SnesTolerances { relative: Some(1e-12), ..Default::default() })?;
    solver.ksp()?.set_tolerances(Tolerances { relative: Some(1e-10), ..Default::default() })?;
    solver.set_from_options()?;
    solver.solve(&mut u, |u, f| Ok(residual(u, f)?), |u, j, _| Ok(jacobian(u, j)?))?;

    let theta = (0..100).fold(1.0_f64, |theta, _| 2_f64.sqrt() * (theta / 4.0).cosh());
    let mut difference = u.duplicate()?;
    for (i, value) in rows.zip(difference.write()?.iter_mut()) {
        let x = h * (i + 1) as f64;
        *value = -2.0 * ((theta / 4.0).cosh() / ((x - 0.5) * theta / 2.0).cosh()).ln();
    }
    difference.axpy(1.0, &u)?;
    difference.norm_max()
}
