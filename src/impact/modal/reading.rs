//! What is read of a body in modal coordinates.

use nalgebra::{DMatrix, DVector};

use crate::body::{Modes, Shapes};
use crate::impact::reading::{Reading, Readout, probes};
use crate::space::evaluate::Map;

use super::ledger::coordinates;
use super::motion::Motion;

/// Reads the steps of one run.
pub struct Reader<'a> {
    modes: &'a Modes,
    /// What the probes' forms are of the modes.
    probes: Option<Shapes>,
    /// After how many steps all coordinates are wanted.
    fields: Option<usize>,
    /// Whether this rank is the one that reads.
    is_here: bool,
}

impl<'a> Reader<'a> {
    pub fn new(readout: &Readout, modes: &'a Modes) -> Self {
        let of_modes = |(_, map): &(_, Map)| match map {
            Map::Dense(count, rows) => Some(modes.shapes.mapped(&DMatrix::from_row_slice(map.len(), *count, rows))),
            // Another rank reads.
            Map::Sparse(_) => None,
        };
        let probes = readout.probes.as_ref().and_then(of_modes);
        let fields = readout.fields.as_ref().filter(|(_, columns)| !columns.is_empty());
        Self { modes, probes, fields: fields.map(|(every, _)| *every), is_here: readout.is_here() }
    }

    /// Reads a step.
    pub fn read(&self, number: usize, motion: &Motion) -> Reading {
        let mut reading = Reading::default();
        if !self.is_here {
            return reading;
        }
        if let Some(shapes) = &self.probes {
            let [values, rates] = self.values(shapes, motion);
            reading.probes = probes(values.as_slice(), rates.as_slice());
        }
        if self.fields.is_some_and(|every| number.is_multiple_of(every)) {
            let values = self.values(&self.modes.shapes, motion);
            reading.coordinates = Some(values.map(|values| values.as_slice().to_vec()));
        }
        reading
    }

    /// Values and their rates, with the static answer of the modes that are left out.
    fn values(&self, shapes: &Shapes, motion: &Motion) -> [DVector<f64>; 2] {
        let (state, force) = (&motion.state, motion.force);
        let (x, v) = coordinates(self.modes, state);
        let rise = motion.rise();
        let t = state.time;
        let value = |moving: &DVector<f64>, [way, of_load, force]: [f64; 3]| {
            let mut sum = &shapes.moving * moving;
            sum.axpy(way, &shapes.free[0], 1.0);
            sum.axpy(of_load, &shapes.free[1], 1.0);
            sum.axpy(force, &shapes.residual, 1.0);
            sum
        };
        let mut values = value(&x, [state.way, 0.5 * t * t, force]);
        values.axpy(state.settled, &shapes.rest, 1.0);
        [values, value(&v, [state.impulse, t, rise])]
    }
}
