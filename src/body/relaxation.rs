//! The viscoelastic part of a body's stiffness.

use nalgebra::DMatrix;
use petsc_wrap::Matrix;

use super::Body;
use crate::error::Result;
use crate::material::{Decay, Maxwell};

/// Viscoelastic force Σ G_i D (u − z_i), in addition to the elastic K u. All terms of a Prony series have the same D.
pub struct Relaxation {
    /// Distortion stiffness D of the viscoelastic parts for a shear modulus of 1 Pa, m.
    pub distortion: Matrix,
    /// Prony series. Its G∞ is included in the elastic K.
    pub chain: Maxwell,
}

/// A viscoelastic part reduced to a basis that is orthonormal in M.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectedRelaxation {
    /// Reduced distortion stiffness VᵀDV, 1/(Pa s²).
    pub distortion: DMatrix<f64>,
    /// Prony series. Its G∞ is included in the elastic VᵀKV.
    pub chain: Maxwell,
}

impl Relaxation {
    /// Returns Σ G_i φ_i for a time step (s), Pa: the effective shear modulus for a strain that varies linearly over
    /// the step.
    pub fn stiffness(&self, step: f64) -> f64 {
        self.chain.terms.iter().map(|term| term.modulus * Decay::new(step, term.time).taken).sum()
    }
}

impl ProjectedRelaxation {
    /// Applies a map to D.
    pub(super) fn on(&self, of: impl Fn(&DMatrix<f64>) -> DMatrix<f64>) -> Self {
        Self { distortion: of(&self.distortion), chain: self.chain.clone() }
    }
}

impl Body {
    /// Assembles S(s) = K + G̃(s) D + s C + s² M without the constrained unknowns: the operator of the
    /// Laplace-transformed motion at a shift s (1/s). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn operator_at_rate(&self, rate: f64) -> Result<Matrix> {
        let mut matrix = self.combination(rate, rate * rate)?;
        for Relaxation { distortion, chain } in &self.relaxations {
            matrix.axpy(chain.transformed_terms(rate), distortion)?;
        }
        self.without_held(matrix)
    }
}
