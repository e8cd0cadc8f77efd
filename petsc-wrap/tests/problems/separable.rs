//! Nonlinear equations with one unknown each: g(x_i) = 0.

use petsc_wrap::{Insert, MatrixView, VectorView};

/// Writes f_i = g(x_i).
pub fn residual(x: &VectorView, f: &mut VectorView, g: fn(f64) -> f64) -> petsc_wrap::Result<()> {
    let x = x.read()?;
    for (f, x) in f.write()?.iter_mut().zip(x.iter()) {
        *f = g(*x);
    }
    Ok(())
}

/// Writes the diagonal matrix of g′(x_i).
pub fn jacobian(x: &VectorView, matrix: &mut MatrixView, slope: fn(f64) -> f64) -> petsc_wrap::Result<()> {
    for (i, x) in x.range().zip(x.read()?.iter()) {
        matrix.set_values(&[i], &[i], &[slope(*x)], Insert::Replace)?;
    }
    matrix.assemble()?;
    matrix.declare_positive_definite()
}
