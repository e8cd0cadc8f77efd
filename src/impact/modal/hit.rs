//! Stresses that serve to estimate the error of the largest stress: opposite the impact point at every step, and at
//! watched places.

use nalgebra::DMatrix;

use crate::body::Modes;
use crate::form::stress::largest_in_plane;

use super::motion::Motion;
use super::trace::Trace;

/// Number of steps whose stresses are computed together.
const AT_ONCE: usize = 64;

/// Least number of times in a run at which stresses at watched places are read.
const READINGS: f64 = 400.0;

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

/// Linear forms on the real and the imaginary parts z of the modes, in rows.
struct FormsOfModes {
    /// `None` if only the imaginary parts contribute.
    real: Option<DMatrix<f64>>,
    imaginary: DMatrix<f64>,
}

/// The forms on z for stresses that are given for the displacements of the modes.
fn forms_of_modes(modes: &Modes, moving: &DMatrix<f64>) -> FormsOfModes {
    if let Some([places, _]) = &modes.forms.damped {
        let stresses = places.times_from_left(moving);
        return FormsOfModes { real: Some(stresses.map(|z| z.re)), imaginary: stresses.map(|z| -z.im) };
    }
    let frequencies = &modes.forms.frequencies;
    let mut imaginary = moving.columns(0, frequencies.len()).into_owned();
    for (mut column, frequency) in imaginary.column_iter_mut().zip(frequencies) {
        column /= *frequency;
    }
    FormsOfModes { real: None, imaginary }
}

impl HitTension {
    /// Builds the forms from the modes of a body; `None` if the body has no such stresses. `multiplicity` is the number of
    /// equal parts of the whole body.
    pub fn new(modes: &Modes, multiplicity: f64) -> Option<Self> {
        let (shapes, local) = modes.hit_stress.as_ref()?;
        let forms = forms_of_modes(modes, &shapes.moving);
        let stresses = [0, 1, 2].map(|i| {
            let row = |form: &DMatrix<f64>| form.row(i).iter().copied().collect();
            let [way, of_load] = &shapes.free;
            Reading {
                real: forms.real.as_ref().map_or_else(Vec::new, row),
                imaginary: row(&forms.imaginary),
                others: [way[i], of_load[i], shapes.residual[i], shapes.rest[i]],
            }
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

/// Largest stresses opposite the impact point and at watched places
/// ([`Evaluator::watched_stresses`](crate::space::evaluate::Evaluator::watched_stresses)) over the times of a run.
pub struct WatchedStresses {
    /// Three rows for each place, of which the first is opposite the impact point; one column for each of the values of a step.
    rows: DMatrix<f64>,
    has_damped_modes: bool,
    /// Values of the steps that are not read yet, and whether each is in the first contact.
    values: Vec<f64>,
    is_first: Vec<bool>,
    /// Time between two readings after the first contact, and the time of the last one, s.
    interval: f64,
    last: f64,
}

impl WatchedStresses {
    /// Stresses of a body with these modes in a run up to `end` (s); `None` if it has no watched places. `multiplicity` is the
    /// number of equal parts of the whole body.
    pub fn new(modes: &Modes, multiplicity: f64, end: f64) -> Option<Self> {
        let (shapes, local) = modes.hit_stress.as_ref().filter(|(shapes, _)| shapes.moving.nrows() > 3)?;
        let watched = shapes.moving.nrows();
        let mut of_force = shapes.residual.clone();
        (0..3).for_each(|i| of_force[i] += multiplicity * local[i]);
        let forms = forms_of_modes(modes, &shapes.moving);
        let has_damped_modes = forms.real.is_some();
        let mut blocks: Vec<DMatrix<f64>> = forms.real.into_iter().chain([forms.imaginary]).collect();
        let [way, of_load] = &shapes.free;
        blocks.extend(
            [way, of_load, &of_force, &shapes.rest]
                .map(|column| DMatrix::from_column_slice(watched, 1, column.as_slice())),
        );
        let columns = blocks.iter().map(DMatrix::ncols).sum();
        let mut rows = DMatrix::zeros(watched, columns);
        let mut first = 0;
        for block in blocks {
            rows.columns_mut(first, block.ncols()).copy_from(&block);
            first += block.ncols();
        }
        let (values, is_first) = (Vec::new(), Vec::new());
        Some(Self { rows, has_damped_modes, values, is_first, interval: end / READINGS, last: f64::NEG_INFINITY })
    }

    /// Reads a step, if one is due: each one in a contact, fewer otherwise.
    pub fn read(&mut self, motion: &Motion, trace: &mut Trace) {
        let (state, is_first) = (&motion.state, motion.state.time <= trace.first_end());
        if !is_first && motion.force == 0.0 && state.time < self.last + self.interval {
            return;
        }
        self.last = state.time;
        let others = [state.way, 0.5 * state.time * state.time, motion.force, state.settled];
        let count = (self.rows.ncols() - others.len()) / if self.has_damped_modes { 2 } else { 1 };
        if self.has_damped_modes {
            self.values.extend(state.modes[..count].iter().map(|z| z.re));
        }
        self.values.extend(state.modes[..count].iter().map(|z| z.im));
        self.values.extend(others);
        self.is_first.push(is_first);
        if self.is_first.len() == AT_ONCE {
            self.finish(trace);
        }
    }

    /// Passes the stresses of the steps that are left to the trace.
    pub fn finish(&mut self, trace: &mut Trace) {
        let values = DMatrix::from_column_slice(self.rows.ncols(), self.is_first.len(), &self.values);
        let stresses = &self.rows * values;
        for (stresses, is_first) in stresses.column_iter().zip(&self.is_first) {
            // The stresses on the other face of a plate that bends are opposite. The face that is hit is not watched at the hit.
            let largest = |(place, stress): (usize, &[f64])| {
                let [a, b, ab] = [stress[0], stress[1], stress[2]];
                let opposite = if place == 0 { f64::NEG_INFINITY } else { largest_in_plane([-a, -b, -ab]) };
                largest_in_plane([a, b, ab]).max(opposite)
            };
            trace.push_watched(stresses.as_slice().chunks_exact(3).enumerate().map(largest), *is_first);
        }
        self.values.clear();
        self.is_first.clear();
    }
}
