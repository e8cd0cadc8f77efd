//! The tension under the hit on the other face, step by step: by it the error of stresses is estimated.

use nalgebra::{Complex, DMatrix};

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
        let of_places = modes.forms.damped.as_ref().map(|[places, _]| on_modes(&shapes.moving, places));
        let stresses = [0, 1, 2].map(|i| {
            let [way, of_load] = &shapes.free;
            let others = [way[i], of_load[i], shapes.residual[i], shapes.rest[i]];
            let (real, imaginary) = match &of_places {
                None => {
                    let row = shapes.moving.row(i);
                    let places = row.iter().zip(&modes.forms.frequencies).map(|(x, frequency)| x / frequency);
                    (Vec::new(), places.collect())
                }
                Some(sums) => (sums.iter().map(|sum| sum[i].re).collect(), sums.iter().map(|sum| -sum[i].im).collect()),
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

/// Three rows times the places of each mode, all sums side by side.
fn on_modes(rows: &DMatrix<f64>, places: &DMatrix<Complex<f64>>) -> Vec<[Complex<f64>; 3]> {
    let of_mode = |column: nalgebra::DVectorView<Complex<f64>>| {
        let mut sums = [Complex::new(0.0, 0.0); 3];
        for (row, place) in rows.column_iter().zip(column.iter()) {
            (0..3).for_each(|i| sums[i] += place * row[i]);
        }
        sums
    };
    places.column_iter().map(of_mode).collect()
}
