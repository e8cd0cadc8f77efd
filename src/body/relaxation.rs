//! The relaxing part of a body's stiffness.

use nalgebra::DMatrix;
use petsc_wrap::Matrix;

use super::Body;
use crate::error::Result;
use crate::material::{Decay, Maxwell};

/// Σ G_i D (u − z_i) beside the elastic K: all terms of a chain have the same D.
pub struct Relaxation {
    /// D, m: the stiffness of the distortion of the relaxing parts for a shear modulus of 1 Pa.
    pub distortion: Matrix,
    /// The terms; G∞ is in the elastic K.
    pub chain: Maxwell,
}

/// The same on a basis that is orthonormal in M.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectedRelaxation {
    /// VᵀDV, 1/(Pa s²).
    pub distortion: DMatrix<f64>,
    /// The terms; G∞ is in the elastic VᵀKV.
    pub chain: Maxwell,
}

impl Relaxation {
    /// Σ G_i φ_i of a step (s), Pa: the shear modulus that a strain over the step meets.
    pub fn stiffness(&self, step: f64) -> f64 {
        self.chain.terms.iter().map(|term| term.modulus * Decay::new(step, term.time).taken).sum()
    }
}

impl ProjectedRelaxation {
    /// The same with another D.
    pub(super) fn on(&self, of: impl Fn(&DMatrix<f64>) -> DMatrix<f64>) -> Self {
        Self { distortion: of(&self.distortion), chain: self.chain.clone() }
    }
}

impl Body {
    /// S(s) = K + G̃(s) D + s C + s² M with the held unknowns taken out: what the Laplace transform of the motion is under, at a rate s (1/s). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn operator_at_rate(&self, rate: f64) -> Result<Matrix> {
        let mut matrix = self.combination(rate, rate * rate)?;
        for Relaxation { distortion, chain } in &self.relaxations {
            matrix.axpy(chain.transformed_terms(rate), distortion)?;
        }
        self.without_held(matrix)
    }
}
