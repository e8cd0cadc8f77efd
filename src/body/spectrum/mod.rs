//! The largest natural frequency of a body, which bounds the step of a scheme that is not stable at every step
//! ([`critical_frequency`](crate::scheme::critical_frequency): 2/ω_max for the central difference).

mod pencil;

use nalgebra::{DMatrix, SymmetricEigen};
use petsc_wrap::Vector;

use super::Body;
use crate::error::Result;

use pencil::Pencil;

/// Relative error of ω_max² that is aimed at: 0.5% of ω_max.
const TOLERANCE: f64 = 0.01;

/// Probability of a larger error, over the starts of Lanczos' method.
const RISK: f64 = 1e-3;

/// Vectors of the basis at most: more than [`enough`] asks for any body whose unknowns 32 bits can number.
const MOST: usize = 120;

/// Which M a scheme has.
#[derive(Clone, Copy)]
pub enum Inertia<'a> {
    /// Its diagonal, kg.
    Lumped(&'a Vector),
    /// The body's.
    Consistent,
}

/// An impactor that stays on the body: K + F′ â âᵀ with â = (−a, 1), and a mass more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearContact {
    /// F′, N/m.
    pub tangent: f64,
    /// m0, kg.
    pub mass: f64,
}

/// ω_max between two numbers, rad/s; both are 0 where nothing is free to move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestFrequency {
    /// Not above ω_max: the root of the largest Ritz value θ.
    pub ritz: f64,
    /// √(θ + residual): an eigenvalue lies within the residual of θ.
    pub bound: f64,
    /// Vectors of the basis.
    pub vectors: usize,
}

/// ω_max of K x = ω² M x, K that of the body and its elastic supports; held unknowns are out, and pads count as if pressed
/// everywhere, since pressing stiffens them. Damping is left out. Collective.
///
/// Lanczos' method in the inner product of M, each vector made orthogonal to all others twice (B. N. Parlett, The Symmetric
/// Eigenvalue Problem, 1998, chapters 6 and 13), from a start that looks random and is the same on any number of ranks. It stops
/// once the residual is below 1% of θ and the basis is so large that, for a random start, θ falls short of ω_max² by more than
/// 1% with a probability below 10⁻³, whatever the spectrum (J. Kuczyński & H. Woźniakowski, Estimating the largest eigenvalue by
/// the power and Lanczos algorithms with a random start, SIAM J. Matrix Anal. Appl. 13, 1992): at 50 to 90 vectors.
///
/// # Errors
/// PETSc's.
pub fn largest_frequency(
    body: &mut Body,
    inertia: Inertia,
    contact: Option<LinearContact>,
) -> Result<LargestFrequency> {
    let mut pencil = Pencil::new(body, inertia, contact)?;
    let dimension = pencil.dimension()?;
    // The next vector of the basis before it is normalised, and its product with M.
    let (mut x, mut momentum) = (pencil.vector()?, pencil.vector()?);
    let mut q = pencil.random(&mut x)?;
    let mut q_momentum = pencil.mass((&x, q), &mut momentum)?;
    let mut length = (x.dot(&momentum)? + q * q_momentum).sqrt();
    let (mut basis, mut basis_q) = (Vec::new(), Vec::new());
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    // Size of the diagonal's entries.
    let mut scale = 0.0_f64;
    let mut found = LargestFrequency { ritz: 0.0, bound: 0.0, vectors: 0 };
    while basis.len() < MOST.min(dimension) {
        let mut last = x.duplicate()?;
        last.axpy(1.0 / length, &x)?;
        let last_q = q / length;
        q_momentum = pencil.stiffness((&last, last_q), &mut momentum)?;
        q = pencil.solve_mass((&momentum, q_momentum), &mut x)?;
        basis.push(last);
        basis_q.push(last_q);
        let mut entry = 0.0;
        for _ in 0..2 {
            let mut shares = momentum.dots(&basis)?;
            shares.iter_mut().zip(&basis_q).for_each(|(share, basis_q)| *share = -(*share + q_momentum * basis_q));
            x.add_combination(&shares, &basis)?;
            q += shares.iter().zip(&basis_q).map(|(share, basis_q)| share * basis_q).sum::<f64>();
            q_momentum = pencil.mass((&x, q), &mut momentum)?;
            entry -= shares[shares.len() - 1];
        }
        diagonal.push(entry);
        // A product with M that is nothing but rounding may be negative.
        length = (x.dot(&momentum)? + q * q_momentum).max(0.0).sqrt();
        scale = scale.max(entry);
        let vectors = basis.len();
        // The basis holds all that the start can reach.
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

/// Vectors that give [`TOLERANCE`] up to [`RISK`]: 1.648 √n exp(−(2k − 1) √ε) bounds the risk of an error ε after k of them.
fn enough(dimension: usize) -> usize {
    let exponent = (1.648 * (dimension as f64).sqrt() / RISK).ln() / TOLERANCE.sqrt();
    (0.5 * (exponent + 1.0)).ceil() as usize
}

/// Largest eigenvalue of a symmetric tridiagonal matrix, and the size of the last entry of its unit eigenvector.
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
            assert!(enough(n) < MOST);
        }
    }
}
