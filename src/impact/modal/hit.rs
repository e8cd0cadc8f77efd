//! Tension on the face opposite the impact point, at every step; it serves to estimate the error of the stresses.

use crate::body::Modes;
use crate::form::stress::largest_in_plane;

use super::motion::Motion;

/// Linear forms for the tension opposite the impact point. They are prepared once, because every step of every run
/// evaluates them.
pub struct HitTension {
    /// Stress components σ_a, σ_b and σ_ab.
    stresses: [Reading; 3],
    /// Correction of these components for 1 N on the modelled part, Pa.
    local: [f64; 3],
}

/// A linear form on the state of the motion, Pa.
struct Reading {
    /// Coefficients of Re z and Im z of the modes; `real` is empty if only Im z contributes.
    real: Vec<f64>,
    imaginary: Vec<f64>,
    /// Coefficients of ∫∫F dt dt, t²/2, F and the static displacement under the loads.
    others: [f64; 4],
}

impl HitTension {
    /// Builds the forms from the modes of a body; `None` if the body has no such stresses. `multiplicity` is the number of
    /// equal parts of the whole body.
    pub fn new(modes: &Modes, multiplicity: f64) -> Option<Self> {
        let (shapes, local) = modes.hit_stress.as_ref()?;
        let of_places = modes.forms.damped.as_ref().map(|[places, _]| places.times_from_left(&shapes.moving));
        let stresses = [0, 1, 2].map(|i| {
            let [way, of_load] = &shapes.free;
            let others = [way[i], of_load[i], shapes.residual[i], shapes.rest[i]];
            let (real, imaginary) = match &of_places {
                None => {
                    let row = shapes.moving.row(i);
                    let places = row.iter().zip(&modes.forms.frequencies).map(|(x, frequency)| x / frequency);
                    (Vec::new(), places.collect())
                }
                Some(stresses) => {
                    let row = stresses.row(i);
                    (row.iter().map(|z| z.re).collect(), row.iter().map(|z| -z.im).collect())
                }
            };
            Reading { real, imaginary, others }
        });
        Some(Self { stresses, local: local.map(|stress| multiplicity * stress) })
    }

    /// The largest tensile stress in the plane of the face, Pa.
    pub fn at(&self, motion: &Motion) -> f64 {
        let (state, force) = (&motion.state, motion.force);
        let others = [state.way, 0.5 * state.time * state.time, force, state.settled];
        largest_in_plane([0, 1, 2].map(|i| {
            let Reading { real, imaginary, others: of_others } = &self.stresses[i];
            let moving: f64 = state.modes.iter().zip(imaginary).map(|(z, x)| x * z.im).sum();
            let damped: f64 = state.modes.iter().zip(real).map(|(z, x)| x * z.re).sum();
            let rest: f64 = others.iter().zip(of_others).map(|(w, x)| x * w).sum();
            moving + damped + rest + force * self.local[i]
        }))
    }
}
