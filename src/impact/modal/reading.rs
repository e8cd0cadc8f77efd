//! Reads values from a body in modal coordinates: probes and fields at each step, stresses on faces for all steps of a
//! run at once.

use nalgebra::{DMatrix, DVector, DVectorView};

use crate::body::{Modes, Shapes};
use crate::impact::observer::Observed;
use crate::impact::reading::{ProbeForms, Reading, Readout, contact};
use crate::space::evaluate::{
    ContactNow, ContactSize, Coordinates, FaceStresses, LineStresses, Map, STEPS_TOGETHER, TensionMap, TensionSearch,
    products_of_steps,
};

use super::recorder::Moment;

/// Reads the steps of one run.
pub struct Reader<'a> {
    modes: &'a Modes,
    /// The linear forms of the probes, expressed in the modes.
    probes: Option<(Shapes, &'a ProbeForms)>,
    /// Interval in steps at which all coordinates are read for fields.
    fields: Option<usize>,
    faces: Option<FacesOfSteps>,
    contact: ContactSize,
    /// Whether this rank is the one that reads.
    is_here: bool,
}

/// Data of all steps for the stresses on the faces. The stresses are evaluated after the run has been accepted.
pub struct FacesOfSteps {
    stresses: StressesOfSteps,
    /// Weights of the steps so far, one step after the other.
    weights: Vec<f64>,
}

/// Stresses at the sampled points for a unit value of each of a step's weights.
enum StressesOfSteps {
    /// Dense matrix with a column for each weight.
    All(DMatrix<f64>),
    OnLines(LineStresses),
    /// Stresses in terms of the body's coordinates on its basis. These columns map Re z, Im z and the other weights of
    /// a step to the coordinates.
    OnBasis(DMatrix<f64>),
}

impl StressesOfSteps {
    /// Builds the map from the modes; `None` if another rank reads.
    fn new(faces: &FaceStresses, modes: &Modes) -> Option<Self> {
        let Shapes { moving, free: [way, of_load], residual, rest } = &modes.shapes;
        if faces.dense().is_some() && moving.nrows() == moving.ncols() && moving.is_identity(0.0) {
            return Some(Self::OnBasis(columns_on_basis(modes)));
        }
        let others = [way, of_load, residual, rest];
        let mut shapes = moving.clone().resize_horizontally(moving.ncols() + others.len(), 0.0);
        others.into_iter().enumerate().for_each(|(i, column)| shapes.set_column(moving.ncols() + i, column));
        if let Some(lines) = faces.on_lines() {
            return Some(Self::OnLines(lines.mapped(&shapes)));
        }
        let (count, entries) = faces.dense()?;
        Some(Self::All(DMatrix::from_row_slice(entries.len() / count.max(1), count, entries) * shapes))
    }

    /// Number of values of a step from which the stresses are computed.
    fn inputs(&self) -> usize {
        match self {
            Self::All(stresses) => stresses.ncols(),
            Self::OnLines(lines) => lines.coordinates(),
            Self::OnBasis(columns) => columns.nrows(),
        }
    }

    /// Returns a search over all steps, if the faces support it.
    fn search<'a>(&'a self, faces: &'a FaceStresses) -> Option<TensionSearch<'a>> {
        match self {
            Self::All(stresses) => {
                TensionSearch::new(faces, stresses.ncols(), stresses.transpose().as_slice().to_vec())
            }
            Self::OnLines(lines) => TensionSearch::on_lines(faces, lines),
            Self::OnBasis(_) => TensionSearch::on_basis(faces),
        }
    }

    /// Stresses of some steps, step by step.
    fn apply(&self, faces: &FaceStresses, weights: &[f64]) -> Vec<f64> {
        match (self, faces.dense()) {
            (Self::OnBasis(_), Some((count, rows))) => products_of_steps(rows, count, weights),
            (Self::All(stresses), _) => {
                let count = stresses.ncols();
                (stresses * DMatrix::from_column_slice(count, weights.len() / count.max(1), weights)).data.into()
            }
            (Self::OnLines(lines), _) => {
                weights.chunks_exact(lines.coordinates()).flat_map(|of_step| lines.apply(of_step)).collect()
            }
            (Self::OnBasis(_), None) => faces.map.apply(weights),
        }
    }
}

impl<'a> Reader<'a> {
    pub fn new(readout: &'a Readout, modes: &'a Modes) -> Self {
        let of_modes = |forms: &'a ProbeForms| match &forms.map {
            Map::Dense(count, rows) => {
                let rows = DMatrix::from_row_slice(forms.map.len(), *count, rows);
                Some((modes.shapes.mapped(&rows), forms))
            }
            // Another rank reads the probes.
            Map::Sparse(_) => None,
        };
        let probes = readout.probes.as_ref().and_then(of_modes);
        let fields = readout.fields.as_ref().filter(|(_, columns)| !columns.is_empty());
        let faces = readout.faces.as_ref().and_then(|faces| {
            let stresses = StressesOfSteps::new(faces, modes)?;
            Some(FacesOfSteps { stresses, weights: Vec::new() })
        });
        Self {
            modes,
            probes,
            fields: fields.map(|(every, _)| *every),
            faces,
            contact: readout.contact.clone(),
            is_here: readout.is_here(),
        }
    }

    /// Whether [`Self::read`] needs the vibrations.
    pub fn needs_vibrations(&self) -> bool {
        let is_on_basis = |faces: &FacesOfSteps| matches!(faces.stresses, StressesOfSteps::OnBasis(_));
        let of_faces = self.faces.as_ref().is_some_and(|faces| !is_on_basis(faces));
        self.is_here && (of_faces || self.probes.is_some() || self.fields.is_some())
    }

    /// Reads a step, with the displacements x and velocities v of the vibrations if they are needed.
    pub fn read(&mut self, moment: &Moment, vibration: [DVectorView<'_, f64>; 2]) -> Reading {
        let mut reading = Reading::default();
        if !self.is_here {
            return reading;
        }
        if let Some(faces) = &mut self.faces {
            let state = &moment.state;
            if let StressesOfSteps::OnBasis(_) = faces.stresses {
                // The weights of all steps are multiplied by the columns together, after the run.
                faces.weights.extend(state.modes.iter().map(|z| z.re));
                faces.weights.extend(state.modes.iter().map(|z| z.im));
            } else {
                faces.weights.extend_from_slice(vibration[0].as_slice());
            }
            faces.weights.extend([state.way, 0.5 * state.time * state.time, moment.force, state.settled]);
        }
        if let Some((shapes, forms)) = &self.probes {
            let [moved, rates] = values(shapes, moment, vibration);
            reading.probes = forms.probes((moved.as_slice(), rates.as_slice()), &contact(&self.contact, &moment.step));
        }
        if self.fields.is_some_and(|every| moment.step.number.is_multiple_of(every)) {
            let all = values(&self.modes.shapes, moment, vibration);
            reading.coordinates = Some(all.map(|values| values.as_slice().to_vec()));
        }
        reading
    }

    /// Returns the data of all steps for the stresses on the faces.
    pub fn finish(self) -> Option<FacesOfSteps> {
        self.faces
    }
}

/// Evaluates the stresses on the faces, a portion of the steps at a time.
pub struct FacesReading<'a> {
    stresses: &'a StressesOfSteps,
    /// Weights of the steps that have not been read yet.
    weights: &'a [f64],
    /// Number of weights of a step.
    of_step: usize,
    faces: &'a FaceStresses,
    readout: &'a Readout,
    search: Option<TensionSearch<'a>>,
    /// Largest tensions of the steps read so far.
    pub map: TensionMap,
}

impl<'a> FacesReading<'a> {
    /// Begins with the first of some steps; `None` if the readout has no faces.
    pub fn new(of_steps: &'a FacesOfSteps, readout: &'a Readout, steps: usize) -> Option<Self> {
        let faces = readout.faces.as_ref()?;
        let FacesOfSteps { stresses, weights } = of_steps;
        let (search, of_step) = (stresses.search(faces), weights.len() / steps.max(1));
        Some(Self { stresses, weights, of_step, faces, readout, search, map: TensionMap::default() })
    }

    /// Stores the largest tensions on the faces in the next steps.
    pub fn read(&mut self, steps: &mut [Observed]) {
        let (weights, rest) = self.weights.split_at(steps.len() * self.of_step);
        self.weights = rest;
        let contacts: Vec<ContactNow> = steps.iter().map(|step| contact(&self.readout.contact, &step.step)).collect();
        let all = match self.stresses {
            StressesOfSteps::OnBasis(columns) => Coordinates::Of { columns, states: weights },
            _ => Coordinates::Given(weights),
        };
        if let Some(search) = &self.search {
            let found = search.tensions(all, &contacts, self.readout.least_tension);
            let times: Vec<f64> = steps.iter().map(|step| step.step.time).collect();
            self.map.take(&found.map(&times));
            steps.iter_mut().zip(found.steps).for_each(|(step, found)| step.reading.faces = found);
        } else {
            let all = all.all();
            let weights = all.chunks(STEPS_TOGETHER * self.stresses.inputs().max(1));
            let together = steps.chunks_mut(STEPS_TOGETHER).zip(contacts.chunks(STEPS_TOGETHER)).zip(weights);
            for ((steps, contacts), weights) in together {
                let stresses = self.stresses.apply(self.faces, weights);
                let of_steps = stresses.chunks_exact((stresses.len() / steps.len()).max(1));
                for ((step, contact), stresses) in steps.iter_mut().zip(contacts).zip(of_steps) {
                    let (found, of_step) = self.faces.tensions(stresses, contact, step.step.time);
                    self.map.take(&of_step);
                    step.reading.faces = found;
                }
            }
        }
    }
}

/// Coordinates of the body on its basis, one column for a unit value of Re z and of Im z of each mode, of ∫∫F dt dt,
/// t²/2, F and the static displacement under the loads.
fn columns_on_basis(modes: &Modes) -> DMatrix<f64> {
    let Shapes { free: [way, of_load], residual, rest, .. } = &modes.shapes;
    let count = modes.modes.len();
    let mut columns = DMatrix::zeros(way.len(), 2 * count + 4);
    match &modes.forms.damped {
        Some([places, _]) => {
            let places = places.dense();
            columns.columns_mut(0, count).zip_apply(&places, |column, place| *column = place.re);
            columns.columns_mut(count, count).zip_apply(&places, |column, place| *column = -place.im);
        }
        None => {
            let frequencies = modes.forms.frequencies.iter();
            frequencies.enumerate().for_each(|(i, frequency)| columns[(i, count + i)] = frequency.recip());
        }
    }
    [way, of_load, residual, rest]
        .into_iter()
        .enumerate()
        .for_each(|(i, more)| columns.set_column(2 * count + i, more));
    columns
}

/// Values of the forms `shapes` and their time derivatives, including the static response of the modes left out.
fn values(shapes: &Shapes, moment: &Moment, [x, v]: [DVectorView<'_, f64>; 2]) -> [DVector<f64>; 2] {
    let Moment { state, force, rise, .. } = moment;
    let t = state.time;
    let value = |moving: DVectorView<'_, f64>, [way, of_load, force]: [f64; 3]| {
        let mut sum = &shapes.moving * moving;
        sum.axpy(way, &shapes.free[0], 1.0);
        sum.axpy(of_load, &shapes.free[1], 1.0);
        sum.axpy(force, &shapes.residual, 1.0);
        sum
    };
    let mut values = value(x, [state.way, 0.5 * t * t, *force]);
    values.axpy(state.settled, &shapes.rest, 1.0);
    [values, value(v, [state.impulse, t, *rise])]
}
