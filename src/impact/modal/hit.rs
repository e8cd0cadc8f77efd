//! The tension under the hit on the other face, step by step: by it the error of stresses is estimated.

use nalgebra::RowDVector;

use crate::body::Modes;
use crate::form::stress::largest_in_plane;

use super::motion::Motion;

/// What reads the tension of a motion; it is read at each step of each run, so that nothing is made for it there.
pub struct HitTension {
    /// σ_a, σ_b and σ_ab.
    stresses: [Reading; 3],
    /// What they lack for 1 N on the modelled part, Pa.
    local: [f64; 3],
}

/// A linear form on the state of a motion.
struct Reading {
    /// On Re z and Im z of the modes; the first is empty where it has no part.
    real: Vec<f64>,
    imaginary: Vec<f64>,
    /// On ∫∫F dt dt, t²/2, F and the loads' own displacements.
    others: [f64; 4],
}

impl HitTension {
    /// Of a body's modes, where it is read, for so many parts of the whole.
    pub fn new(modes: &Modes, copies: f64) -> Option<Self> {
        let (shapes, local) = modes.hit_stress.as_ref()?;
        let stresses = [0, 1, 2].map(|i| {
            let row: RowDVector<f64> = shapes.moving.row(i).into_owned();
            let [way, of_load] = &shapes.free;
            let others = [way[i], of_load[i], shapes.residual[i], shapes.rest[i]];
            let (real, imaginary) = match &modes.forms.damped {
                None => {
                    let places = row.iter().zip(&modes.forms.frequencies).map(|(x, frequency)| x / frequency);
                    (Vec::new(), places.collect())
                }
                Some([places, _]) => {
                    let of_z = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
                        (0..places.ncols()).map(|k| (0..row.len()).map(|i| row[i] * of(i, k)).sum()).collect()
                    };
                    (of_z(&|i, k| places[(i, k)].re), of_z(&|i, k| -places[(i, k)].im))
                }
            };
            Reading { real, imaginary, others }
        });
        Some(Self { stresses, local: local.map(|stress| copies * stress) })
    }

    /// The tension, Pa.
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
