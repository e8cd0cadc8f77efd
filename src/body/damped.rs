//! Modes of a body with dampers: eigenvectors of the first-order equations of motion.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use super::{BlockMatrix, Mode};
use crate::error::{Error, Result};

/// Largest condition number of the eigenvectors for which the modal form of a damped body is accepted.
pub const CONDITION: f64 = 1e9;

/// Modal form of a damped body.
pub struct Damped {
    /// First-order modal coordinates z.
    pub modes: Vec<Mode>,
    /// Matrices of x and v from the coordinates, Re(X z) and Re(V z).
    pub shapes: [BlockMatrix; 2],
    /// Inputs b of forces on x.
    pub inputs: BlockMatrix,
}

/// Computes the modes from the eigenvectors of (s x, v)˙ = [0 s; −ω²/s −C] (s x, v), where s = ω, or a value from the
/// damping if that is larger.
///
/// # Errors
/// [`Error::Solve`] if the eigenvectors are not independent.
pub fn damped(
    squares: &DVector<f64>,
    damping: &DMatrix<f64>,
    force: &DVector<f64>,
    load: &DVector<f64>,
) -> Result<Damped> {
    let n = squares.len();
    let scales: Vec<f64> = (0..n).map(|i| squares[i].sqrt().max(damping[(i, i)]).max(f64::MIN_POSITIVE)).collect();
    let real = |x: f64| Complex::new(x, 0.0);
    let mut matrix = DMatrix::zeros(2 * n, 2 * n);
    for i in 0..n {
        matrix[(i, n + i)] = real(scales[i]);
        matrix[(n + i, i)] = real(-squares[i] / scales[i]);
        for j in 0..n {
            matrix[(n + i, n + j)] = real(-damping[(i, j)]);
        }
    }
    let (unitary, triangle) = Schur::new(matrix).unpack();
    let vectors = &unitary * triangular_eigenvectors(&triangle);
    let inverse = vectors.clone().try_inverse().filter(|inverse| inverse.norm() * vectors.norm() < CONDITION);
    let Some(inverse) = inverse else {
        return Err(Error::Solve(
            "the dampers leave the body without independent modes (critical damping): another damping, or another time.scheme".into(),
        ));
    };
    let size = triangle.diagonal().iter().map(|z| z.norm()).fold(0.0, f64::max);
    // Of each conjugate pair, one is kept and counted twice; real ones are counted once.
    let chosen: Vec<(usize, f64)> = (0..2 * n)
        .filter_map(|k| match triangle[(k, k)].im {
            im if im.abs() <= 1e-12 * size => Some((k, 1.0)),
            im if im > 0.0 => Some((k, 2.0)),
            _ => None,
        })
        .collect();
    let along = |k: usize, v: &DVector<f64>| (0..n).map(|i| inverse[(k, n + i)] * v[i]).sum::<Complex<f64>>();
    let places = DMatrix::from_fn(n, chosen.len(), |i, c| vectors[(i, chosen[c].0)] * (chosen[c].1 / scales[i]));
    let speeds = DMatrix::from_fn(n, chosen.len(), |i, c| vectors[(n + i, chosen[c].0)] * chosen[c].1);
    let mode = |(c, &(k, _)): (usize, &(usize, f64))| Mode {
        rate: triangle[(k, k)],
        input: along(k, force),
        load: along(k, load),
        output: (0..n).map(|i| places[(i, c)] * force[i]).sum(),
    };
    let inputs = DMatrix::from_fn(chosen.len(), n, |c, i| inverse[(chosen[c].0, n + i)]);
    let modes = chosen.iter().enumerate().map(mode).collect();
    Ok(Damped { modes, shapes: [places, speeds].map(BlockMatrix::whole), inputs: BlockMatrix::whole(inputs) })
}

/// Returns the unit eigenvectors of an upper triangular matrix, as columns.
fn triangular_eigenvectors(triangle: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let n = triangle.nrows();
    let size = triangle.camax();
    let mut vectors = DMatrix::zeros(n, n);
    for k in 0..n {
        let value = triangle[(k, k)];
        vectors[(k, k)] = Complex::new(1.0, 0.0);
        for i in (0..k).rev() {
            let sum: Complex<f64> = (i + 1..=k).map(|j| triangle[(i, j)] * vectors[(j, k)]).sum();
            let gap = value - triangle[(i, i)];
            // Equal eigenvalues: the vector is accurate to rounding only. The condition number detects this case.
            let gap = if gap.norm() < f64::EPSILON * size { Complex::new(f64::EPSILON * size, 0.0) } else { gap };
            vectors[(i, k)] = sum / gap;
        }
        let length = vectors.column(k).norm();
        vectors.column_mut(k).unscale_mut(length);
    }
    vectors
}
