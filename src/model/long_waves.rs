//! Whether a plate's basis is to know its long waves alone, and up to which frequency.

use std::f64::consts::TAU;

use crate::body::InfinitePlate;
use crate::scene::{Reduction, Scene, SupportKind};

use super::OF_BASIS;

/// The time in which the force on a plate rises times the frequency up to which a basis must know its waves, for an error of
/// [`MEASURED`], by the difference to a basis of two thirds of the vectors; errors were measured to fall with the power [`ORDER`] of the
/// frequency.
const OF_RISE: f64 = 0.385;
const MEASURED: f64 = 5e-3;

/// The power of the number of vectors with which their error falls.
pub(super) const ORDER: f64 = 2.4;

/// Vectors from which on a plate's short waves are kept apart. With all waves a pane's basis takes three times as many.
const SHORT_WAVES_APART: usize = 100;

/// The long waves that a basis knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LongWaves {
    /// Up to this frequency, rad/s.
    pub frequency: f64,
    /// So many vectors.
    pub vectors: usize,
}

impl LongWaves {
    /// Those that a scene needs of a plate, for so many vectors at most; `None` where its basis is to know all waves.
    ///
    /// (What foundations pull at, and schemes in the body's unknowns, know no waves that go off.)
    pub fn of(scene: &Scene, plate: &InfinitePlate, most: usize) -> Option<Self> {
        let is_bound = scene.supports.iter().any(|support| matches!(support.kind, SupportKind::Pad { .. }));
        if !scene.time.modal || is_bound || scene.body.reduction != Reduction::Auto {
            return None;
        }
        let of_error = (MEASURED / (OF_BASIS * scene.tolerance)).powf(1.0 / ORDER);
        let frequency = TAU * OF_RISE * of_error / plate.rise(scene.impactor.stiffness, scene.impactor.speed);
        let vectors = plate.vectors(frequency);
        let is_long = (SHORT_WAVES_APART..=most).contains(&vectors) && !plate.is_near_edge(frequency);
        is_long.then_some(Self { frequency, vectors })
    }
}
