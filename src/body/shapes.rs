//! Displacements of a body in its modes, and its energies.

use nalgebra::{DMatrix, DVector};

use super::BlockMatrix;
use super::coupled_modes::RelaxingForms;
use super::row_blocks::RowBlocks;

/// Basis coordinates y of a body from its modal coordinates: x of the vibrations, ∫∫F of the free motions, and F,
///
/// y = moving x + free₀ ∫∫F dt dt + free₁ t²/2 + residual F.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shapes {
    /// One column for each vibration.
    pub moving: DMatrix<f64>,
    /// Σ φ e and Σ f e over the free motions e.
    pub free: [DVector<f64>; 2],
    /// Static response of the left-out modes to the force, Σ φ e/ω².
    pub residual: DVector<f64>,
    /// Static response of the left-out modes to the loads, Σ f e/ω².
    pub rest: DVector<f64>,
}

/// Quadratic forms of the energies in the real coordinates x, in which M = 1 and K is diagonal.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Forms {
    /// ω², 1/s².
    pub squares: DVector<f64>,
    /// ω, rad/s; positive, so that divisions by it are finite.
    pub frequencies: DVector<f64>,
    /// Factor F of the support stiffness K = FᵀF, with one row for each independent spring.
    pub support: RowBlocks,
    /// ∫ k ū of the supports.
    pub support_load: DVector<f64>,
    /// ½ ∫ k ū·ū, J.
    pub support_offset: f64,
    /// Modal loads f.
    pub load: DVector<f64>,
    /// Energy of the left-out modes in equilibrium with the loads, J.
    pub rest: f64,
    /// Matrices of x = Re(X z) and v = Re(V z), with dampers or relaxation.
    pub damped: Option<[BlockMatrix; 2]>,
    /// Replaces ω² in the energy of a viscoelastic body.
    pub relaxing: Option<RelaxingForms>,
    /// Whether there are outgoing waves: their energy counts as dissipated.
    pub is_open: bool,
}

impl Shapes {
    /// Applies linear forms on y, one in each row.
    pub fn mapped(&self, forms: &DMatrix<f64>) -> Self {
        Self {
            moving: forms * &self.moving,
            free: self.free.each_ref().map(|free| forms * free),
            residual: forms * &self.residual,
            rest: forms * &self.rest,
        }
    }

    /// Returns the shapes of a body without a basis.
    pub fn none() -> Self {
        Self::zero(0)
    }

    pub fn zero(coordinates: usize) -> Self {
        let zero = DVector::zeros(coordinates);
        let free = [zero.clone(), zero.clone()];
        Self { moving: DMatrix::zeros(coordinates, 0), free, residual: zero.clone(), rest: zero }
    }
}

impl Forms {
    pub fn none() -> Self {
        let empty = DVector::zeros(0);
        Self {
            squares: empty.clone(),
            frequencies: empty.clone(),
            support: RowBlocks::default(),
            support_load: empty.clone(),
            support_offset: 0.0,
            load: empty,
            rest: 0.0,
            damped: None,
            relaxing: None,
            is_open: false,
        }
    }
}
