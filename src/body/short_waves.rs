//! Short waves of a plate, in addition to the modes of its long waves.

use nalgebra::DVector;

use super::infinite_plate::weight;
use super::{Mode, Projection};

/// Coordinates that represent the short waves of a plate, and the weights of the modes.
pub struct ShortWaves {
    /// First-order coordinates of the short waves.
    pub coordinates: Vec<Mode>,
    /// Static compliance of the waves that are faster than any contact, m/N.
    pub static_compliance: f64,
    /// Weights √g of the modes.
    pub weights: DVector<f64>,
    /// Number of lowest modes with a nonzero weight.
    pub kept: usize,
    /// Vᵀa without the weights.
    pub force: DVector<f64>,
}

impl ShortWaves {
    /// Returns the short waves left out by modes with these ω² and this Vᵀa; `None` if the projection has no infinite
    /// plate.
    pub fn new(projection: &Projection, squares: &DVector<f64>, force: &DVector<f64>) -> Option<Self> {
        let plate = projection.infinite_plate.as_ref()?;
        let cutoff = plate.known(projection.vectors());
        let weights = squares.map(|square| weight(square.max(0.0).sqrt(), cutoff).sqrt());
        let kept = weights.iter().filter(|weight| **weight > 0.0).count();
        Some(Self {
            coordinates: plate.short_waves(cutoff),
            static_compliance: plate.static_compliance(cutoff),
            weights,
            kept,
            force: force.clone(),
        })
    }
}
