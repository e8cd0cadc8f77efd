//! A plate's short waves beside the modes of its long ones.

use nalgebra::DVector;

use super::infinite_plate::weight;
use super::{Mode, Projection};

/// What stands for a plate's short waves.
pub struct ShortWaves {
    /// Their coordinates.
    pub coordinates: Vec<Mode>,
    /// What those yield that are faster than any contact, m/N.
    pub static_compliance: f64,
    /// √g of the modes.
    pub weights: DVector<f64>,
    /// How many of the modes, the lowest first, have any.
    pub kept: usize,
    /// Vᵀa itself.
    pub force: DVector<f64>,
}

impl ShortWaves {
    /// Those that modes of these squares and this Vᵀa leave out, where a basis is to have it so.
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
