//! Decides whether a plate's basis resolves its long waves only, and up to which frequency.

use std::f64::consts::TAU;

use crate::body::InfinitePlate;
use crate::scene::{Reduction, Scene};

use super::BASIS_SHARE;

/// Highest frequency that a basis must resolve, times the rise time of the force on a plate, for an error of
/// [`MEASURED`]. Measured by the difference from a basis with two thirds of the vectors. The error was measured to fall
/// with the frequency to the power [`ORDER`].
const FREQUENCY_TIMES_RISE: f64 = 0.385;
const MEASURED: f64 = 5e-3;

/// Order of convergence in ω_c.
pub(super) const ORDER: f64 = 2.4;

/// Least number of vectors from which a plate's short waves are treated separately. With all waves the basis of a pane
/// needs three times as many vectors.
const SHORT_WAVES_APART: usize = 100;

/// The same for a laminate, whose modes take longer to compute. On nine laminates that need 40 to 100 vectors, the
/// speed-up was 0.8 to 6, and the errors were 0.3 to 0.75 of their estimates. On six that need 20 to 40 vectors, the errors were up to
/// 0.85 of their estimates.
const SHORT_WAVES_APART_IN_LAMINATE: usize = 40;

/// The long waves that a basis resolves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LongWaves {
    /// Highest frequency ω_c of the modes in the basis, rad/s.
    pub frequency: f64,
    /// Number of basis vectors.
    pub vectors: usize,
}

impl LongWaves {
    /// The long waves that a scene needs of a plate, with at most `most` vectors; `None` if the basis must resolve all
    /// waves.
    ///
    /// On foundation pads, and for schemes in the body's unknowns, outgoing waves cannot be treated separately.
    pub fn of(scene: &Scene, plate: &InfinitePlate, most: usize) -> Option<Self> {
        if !scene.time.modal || scene.is_on_pads() || scene.body.reduction != Reduction::Auto {
            return None;
        }
        let of_error = (MEASURED / (BASIS_SHARE * scene.tolerance)).powf(1.0 / ORDER);
        let frequency = TAU * FREQUENCY_TIMES_RISE * of_error
            / plate.rise(scene.impactor.stiffness, scene.impactor.contact_speed());
        let vectors = plate.vectors(frequency);
        let least = match scene.body.composition.uniform() {
            Some(_) => SHORT_WAVES_APART,
            None => SHORT_WAVES_APART_IN_LAMINATE,
        };
        if vectors < least || plate.is_near_edge(frequency) {
            return None;
        }
        (vectors <= most).then_some(Self { frequency, vectors })
    }
}
