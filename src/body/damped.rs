//! The modes of a body with dampers: eigenvectors of its first-order equations.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use super::Mode;
use crate::error::{Error, Result};

/// Condition number of the eigenvectors above which a damped body has no modal form to trust.
pub const CONDITION: f64 = 1e9;

/// A damped body.
pub struct Damped {
    /// The coordinates.
    pub modes: Vec<Mode>,
    /// x and v from them.
    pub shapes: [DMatrix<Complex<f64>>; 2],
    /// b of forces on x.
    pub inputs: DMatrix<Complex<f64>>,
}

/// The eigenvectors of (s x, v)˙ = [0 s; −ω²/s −C] (s x, v), s = ω where there is one.
///
/// # Errors
/// [`Error::Solve`] where they are not independent.
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
    // Of a conjugate pair one, counted twice; real ones once.
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
    Ok(Damped { modes: chosen.iter().enumerate().map(mode).collect(), shapes: [places, speeds], inputs })
}

/// Unit eigenvectors of an upper triangle, by columns.
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
            // Equal eigenvalues: a vector at the rounding's size, which the condition number shows.
            let gap = if gap.norm() < f64::EPSILON * size { Complex::new(f64::EPSILON * size, 0.0) } else { gap };
            vectors[(i, k)] = sum / gap;
        }
        let length = vectors.column(k).norm();
        vectors.column_mut(k).unscale_mut(length);
    }
    vectors
}
