//! How a body's modes move it, and where its energy is.

use nalgebra::{Complex, DMatrix, DVector};

use super::relaxing_modes::RelaxingForms;
use super::row_blocks::RowBlocks;

/// A body's coordinates y on its basis, from those of its modes: with x of the vibrations, ∫∫F of the free motions, and F,
///
/// y = moving x + free₀ ∫∫F dt dt + free₁ t²/2 + residual F.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shapes {
    /// A column for each vibration.
    pub moving: DMatrix<f64>,
    /// Σ φ e and Σ f e over the free motions e.
    pub free: [DVector<f64>; 2],
    /// Σ φ e/ω² over what is left out: its static answer to the force.
    pub residual: DVector<f64>,
    /// Σ f e/ω² over what is left out: its static answer to the loads.
    pub rest: DVector<f64>,
}

/// Quadratic forms of the energies, with what they need of the real coordinates x, in which M = 1 and K is diagonal.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Forms {
    /// ω², 1/s².
    pub squares: DVector<f64>,
    /// ω, rad/s; not zero, so that one may divide by it.
    pub frequencies: DVector<f64>,
    /// A factor F of K = FᵀF of the supports, with as many rows as it has independent springs.
    pub support: RowBlocks,
    /// ∫ k ū of the supports.
    pub support_load: DVector<f64>,
    /// ½ ∫ k ū·ū, J.
    pub support_offset: f64,
    /// f.
    pub load: DVector<f64>,
    /// Energy of what the loads do to the modes that are left out, J.
    pub rest: f64,
    /// x and v from z, with dampers or relaxation: Re(X z), Re(V z).
    pub damped: Option<[DMatrix<Complex<f64>>; 2]>,
    /// What takes the place of ω² in the energy of a body that relaxes.
    pub relaxing: Option<RelaxingForms>,
    /// Whether waves go off for good: their energy counts as dissipated.
    pub is_open: bool,
}

impl Shapes {
    /// The same of linear forms on y, a row each.
    pub fn mapped(&self, forms: &DMatrix<f64>) -> Self {
        Self {
            moving: forms * &self.moving,
            free: self.free.each_ref().map(|free| forms * free),
            residual: forms * &self.residual,
            rest: forms * &self.rest,
        }
    }

    /// Of a body without a basis.
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
