//! The largest natural frequency of a body, which bounds the time step of conditionally stable schemes
//! ([`critical_frequency`](crate::scheme::critical_frequency): 2/ω_max for the central difference).

mod pencil;

use nalgebra::{DMatrix, SymmetricEigen};
use petsc_wrap::{Vector, VectorView};

use super::Body;
use crate::error::Result;

use pencil::Pencil;

/// Intended relative error of ω_max²; it corresponds to 0.5% of ω_max.
const TOLERANCE: f64 = 0.01;

/// Probability of a larger error, over the random starts of Lanczos' method.
const RISK: f64 = 1e-3;

/// Largest number of basis vectors: more than [`enough`] requires for any body whose unknowns are numbered with 32
/// bits.
const MAX_VECTORS: usize = 120;

/// Mass matrix of a scheme.
#[derive(Clone, Copy)]
pub enum Inertia<'a> {
    /// Lumped: diagonal of M, kg.
    Lumped(&'a Vector),
    /// Consistent: M of the body.
    Consistent,
}

/// An impactor that stays in contact with the body. It adds F′ â âᵀ with â = (−a, 1) to K, and one mass to M.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearContact {
    /// Tangent stiffness F′ of the contact, N/m.
    pub tangent: f64,
    /// Mass m0 of the impactor, kg.
    pub mass: f64,
}

/// Lower and upper estimate of ω_max, rad/s; both are 0 if no unknown is free to move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestFrequency {
    /// Lower bound of ω_max: the square root of the largest Ritz value θ.
    pub ritz: f64,
    /// √(θ + residual): an eigenvalue lies within the residual of θ.
    pub bound: f64,
    /// Number of basis vectors.
    pub vectors: usize,
}

/// Computes ω_max of K x = ω² M x. K contains the body and its elastic supports. Constrained unknowns are excluded.
/// Pads count as pressed everywhere, because pressing stiffens them. Damping is left out. Collective.
///
/// The method is Lanczos' method in the inner product of M, with each vector orthogonalised against all others twice
/// (B. N. Parlett, The Symmetric Eigenvalue Problem, 1998, chapters 6 and 13). The start is pseudo-random and equal on
/// any number of ranks. The iteration stops when the residual is below 1% of θ and the basis is large enough. Large
/// enough means: for a random start, θ falls short of ω_max² by more than 1% with a probability below 10⁻³, whatever
/// the spectrum (J. Kuczyński & H. Woźniakowski, Estimating the largest eigenvalue by the power and Lanczos algorithms
/// with a random start, SIAM J. Matrix Anal. Appl. 13, 1992). This takes 50 to 90 vectors.
///
/// # Errors
/// If a PETSc call fails.
pub fn largest_frequency(
    body: &mut Body,
    inertia: Inertia,
    contact: Option<LinearContact>,
) -> Result<LargestFrequency> {
    let mut pencil = Pencil::new(body, inertia, contact)?;
    let dimension = pencil.dimension()?;
    // Next vector of the basis before normalisation, and its product with M.
    let (mut x, mut momentum) = (pencil.vector()?, pencil.vector()?);
    let mut q = pencil.random(&mut x)?;
    let mut q_momentum = pencil.mass((&x, q), &mut momentum)?;
    let mut length = (x.dot(&momentum)? + q * q_momentum).sqrt();
    let (mut basis, mut basis_q) = (Vec::new(), Vec::new());
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    // Largest diagonal entry.
    let mut scale = 0.0_f64;
    let mut found = LargestFrequency { ritz: 0.0, bound: 0.0, vectors: 0 };
    while basis.len() < MAX_VECTORS.min(dimension) {
        let mut last = x.duplicate()?;
        last.axpy(1.0 / length, &x)?;
        let last_q = q / length;
        q_momentum = pencil.stiffness((&last, last_q), &mut momentum)?;
        q = pencil.solve_mass((&momentum, q_momentum), &mut x)?;
        basis.push(last);
        basis_q.push(last_q);
        let mut entry = 0.0;
        for _ in 0..2 {
            let vectors: Vec<&VectorView> = basis.iter().map(|vector: &Vector| &**vector).collect();
            let mut shares = momentum.dots(&vectors)?;
            shares.iter_mut().zip(&basis_q).for_each(|(share, basis_q)| *share = -(*share + q_momentum * basis_q));
            x.add_combination(&shares.iter().copied().zip(vectors).collect::<Vec<_>>())?;
            q += shares.iter().zip(&basis_q).map(|(share, basis_q)| share * basis_q).sum::<f64>();
            q_momentum = pencil.mass((&x, q), &mut momentum)?;
            entry -= shares[shares.len() - 1];
        }
        diagonal.push(entry);
        // Rounding may make this product with M negative.
        length = (x.dot(&momentum)? + q * q_momentum).max(0.0).sqrt();
        scale = scale.max(entry);
        let vectors = basis.len();
        // The basis spans all motions that the start vector can reach.
        let whole = vectors == dimension || length <= f64::EPSILON.sqrt() * scale;
        if whole || vectors >= enough(dimension) {
            let (theta, share) = largest_ritz_value(&diagonal, &beside);
            let residual = length * share;
            found = LargestFrequency { ritz: theta.sqrt(), bound: (theta + residual).sqrt(), vectors };
            if whole || residual <= TOLERANCE * theta {
                break;
            }
        }
        beside.push(length);
    }
    for vector in basis.into_iter().chain([x, momentum]) {
        vector.destroy()?;
    }
    Ok(found)
}

/// Returns the number of vectors that gives [`TOLERANCE`] up to [`RISK`]. The risk of an error ε after k vectors is at
/// most 1.648 √n exp(−(2k − 1) √ε).
fn enough(dimension: usize) -> usize {
    let exponent = (1.648 * (dimension as f64).sqrt() / RISK).ln() / TOLERANCE.sqrt();
    (0.5 * (exponent + 1.0)).ceil() as usize
}

/// Returns the largest eigenvalue of a symmetric tridiagonal matrix, and the absolute value of the last entry of its
/// unit eigenvector.
fn largest_ritz_value(diagonal: &[f64], beside: &[f64]) -> (f64, f64) {
    let mut matrix = DMatrix::from_diagonal(&diagonal.to_vec().into());
    for (i, &value) in beside.iter().enumerate() {
        matrix[(i, i + 1)] = value;
        matrix[(i + 1, i)] = value;
    }
    let eigen = SymmetricEigen::new(matrix);
    let (largest, value) = eigen.eigenvalues.argmax();
    (value, eigen.eigenvectors[(diagonal.len() - 1, largest)].abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// tridiag(−1, 2, −1) has the eigenvalues 4 sin²(jπ/2(n+1)) and vectors sin(ijπ/(n+1)).
    #[test]
    fn largest_ritz_value_of_a_chain_of_springs() {
        let n = 30;
        let (value, share) = largest_ritz_value(&vec![2.0; n], &vec![-1.0; n - 1]);
        let angle = std::f64::consts::PI / (n + 1) as f64;
        // Rounding of a symmetric eigenproblem of norm 4.
        assert!((value - 4.0 * (0.5 * n as f64 * angle).sin().powi(2)).abs() < 1e-13);
        let last = (n as f64 * n as f64 * angle).sin().abs() / (0.5 * (n + 1) as f64).sqrt();
        assert!((share - last).abs() < 1e-13);
    }

    #[test]
    fn bases_are_just_large_enough_and_not_cut_short() {
        for n in [10, 1000, 1_000_000, i32::MAX as usize] {
            let risk = |k: usize| 1.648 * (n as f64).sqrt() * (-TOLERANCE.sqrt() * (2 * k - 1) as f64).exp();
            assert!(risk(enough(n)) <= RISK && risk(enough(n) - 1) > RISK);
            assert!(enough(n) < MAX_VECTORS);
        }
    }
}
