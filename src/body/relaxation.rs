//! The relaxing part of a body's stiffness.

use petsc_wrap::Matrix;

use crate::material::{Decay, Maxwell};

/// Σ G_i D (u − z_i) beside the elastic K: all terms of a chain have the same D.
pub struct Relaxation {
    /// D, m: the stiffness of the distortion of the relaxing parts for a shear modulus of 1 Pa.
    pub distortion: Matrix,
    /// The terms; G∞ is in the elastic K.
    pub chain: Maxwell,
}

impl Relaxation {
    /// Σ G_i φ_i of a step (s), Pa: the shear modulus that a strain over the step meets.
    pub fn stiffness(&self, step: f64) -> f64 {
        self.chain.terms.iter().map(|term| term.modulus * Decay::new(step, term.time).taken).sum()
    }
}
