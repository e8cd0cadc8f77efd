//! Short waves of a plate, in addition to the modes of its long waves.

use nalgebra::{Complex, DVector};

use super::infinite_plate::weight;
use super::{Mode, Projection};

/// Weight g of the vibrations that only stresses and displacements are read from. The contact force does not move them.
/// Coupled modes may move them through dampers or relaxation.
const READ_ONLY: f64 = 1e-12;

/// Damping ratio of these vibrations, if they are not coupled. They are sparser than the modes of the plate at their
/// frequencies, and would beat and repeat the impact. Measured on a pane: with 0.05 to 0.14, the tension under the
/// impactor has an error of 2% of its peak during the rise of the force; without these vibrations 5%, and without
/// damping 4%, and 2.5% later.
const DAMPING_RATIO: f64 = 0.1;

/// Coordinates that represent the short waves of a plate, and the weights of the modes.
pub struct ShortWaves {
    /// First-order coordinates of the short waves.
    pub coordinates: Vec<Mode>,
    /// Static compliance of the waves that are faster than any contact, m/N.
    pub static_compliance: f64,
    /// Weights √g of the modes.
    pub weights: DVector<f64>,
    /// Number of lowest modes that act on the impact point.
    pub acting: usize,
    /// Number of lowest modes that are kept, with those that are only read.
    pub kept: usize,
    /// Vᵀa without the weights.
    pub force: DVector<f64>,
}

impl ShortWaves {
    /// Returns the short waves left out by modes with these ω² and this Vᵀa; `None` if the projection has no infinite
    /// plate.
    pub fn new(projection: &Projection, squares: &DVector<f64>, force: &DVector<f64>) -> Option<Self> {
        let plate = projection.terms.infinite_plate.as_ref()?;
        let cutoff = plate.cutoff(projection.vectors());
        let weights = squares.map(|square| weight(square.max(0.0).sqrt(), cutoff));
        let acting = weights.iter().filter(|weight| **weight > 0.0).count();
        // The modes below ω_c contain the vibrations that tensions need. But relaxation changes their shapes, for which
        // the modes above are needed.
        let relaxes = projection.terms.relaxations.iter().any(|part| !part.chain.terms.is_empty());
        let (kept, least) = if relaxes { (weights.len(), READ_ONLY) } else { (acting, 0.0) };
        Some(Self {
            coordinates: plate.short_waves(cutoff),
            static_compliance: plate.static_compliance(cutoff),
            weights: weights.map(|weight| weight.max(least).sqrt()),
            acting,
            kept,
            force: force.clone(),
        })
    }

    /// Damps the vibrations that do not move the impact point. Their static response does not change. `numbers` are the
    /// numbers of the modes.
    pub fn damp(&self, modes: &mut [Mode], numbers: &[usize]) {
        let turned = (1.0 - DAMPING_RATIO * DAMPING_RATIO).sqrt();
        for (mode, _) in modes.iter_mut().zip(numbers).filter(|(_, number)| **number >= self.acting) {
            // x = Im z/ω at rest is φF/ω² again.
            mode.rate = Complex::new(-DAMPING_RATIO, turned) * mode.rate.im;
            mode.input /= turned;
        }
    }
}
