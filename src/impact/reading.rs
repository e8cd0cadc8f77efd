//! Values that are read from the body at every step: probes, fields and the tensions on faces.

use std::rc::Rc;

use petsc_wrap::{Gather, Int, Vector};

use crate::body::Body;
use crate::error::Result;
use crate::form::stress::principal;
use crate::scene::Vec3;
use crate::space::evaluate::{ContactNow, ContactSize, FaceStresses, FaceTension, LocalPoint, Map, TensionMap};

use super::step::Step;
use super::stepped::State;

/// Specifies the values to be read, in the coordinates in which a body moves. The rank that reads has all of it, the
/// others have empty entries.
#[derive(Clone, Default)]
pub struct Readout {
    /// The probes, if there are any.
    pub probes: Option<ProbeForms>,
    /// If fields are written: the interval between them in steps, and the indices of all coordinates.
    pub fields: Option<(usize, Vec<Int>)>,
    /// Faces on which the largest tension is searched; no faces on a rank that does not read.
    pub faces: Option<Rc<FaceStresses>>,
    /// Size of the contact area.
    pub contact: ContactSize,
    /// If only the largest tension of all steps is needed: the tension (Pa) below which a step need not be searched.
    pub least_tension: Option<f64>,
}

/// Linear forms of the probes.
#[derive(Clone)]
pub struct ProbeForms {
    /// Indices of the coordinates that the forms need.
    pub columns: Vec<Int>,
    /// Nine forms of these coordinates for each probe: three for the displacement, m, and six for the stress, Pa.
    pub map: Map,
    /// Correction of the stress near the impact point for each probe.
    pub local: Vec<Option<LocalPoint>>,
}

impl Readout {
    /// Names of the faces whose largest tension is read, in their order.
    pub fn face_names(&self) -> Vec<String> {
        self.faces.iter().flat_map(|all| &all.faces).map(|face| face.name.clone()).collect()
    }

    /// Points of these faces, m.
    pub fn face_points(&self) -> Vec<Vec<Vec3>> {
        self.faces.iter().flat_map(|all| &all.faces).map(|face| face.points.clone()).collect()
    }

    /// Whether this rank is the one that reads.
    pub(super) fn is_here(&self) -> bool {
        let probes = self.probes.as_ref().is_some_and(|probes| !probes.map.is_empty());
        let faces = self.faces.as_ref().is_some_and(|faces| !faces.faces.is_empty());
        probes || faces || self.fields.as_ref().is_some_and(|(_, columns)| !columns.is_empty())
    }
}

/// Values read by a probe.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Probe {
    /// Displacement, m.
    pub displacement: Vec3,
    /// Velocity, m/s.
    pub velocity: Vec3,
    /// Principal stresses in descending order, tension positive, Pa.
    pub principal_stress: Vec3,
}

/// Values read at one step; empty if nothing is to be read, and on the ranks that do not read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Values of each probe.
    pub probes: Vec<Probe>,
    /// The largest tension on each face.
    pub faces: Vec<FaceTension>,
    /// Tensions at all points of the faces: at this step, or the largest since the last step with a map. A run in modal
    /// coordinates stores the largest of all its steps with its last step.
    pub map: TensionMap,
    /// All coordinates and their time derivatives, if the fields of this step are to be written.
    pub coordinates: Option<[Vec<f64>; 2]>,
}

/// Reads a body that is integrated in its own unknowns.
pub struct Reader {
    probes: Option<(Gather, ProbeForms)>,
    fields: Option<(usize, Gather)>,
    faces: Option<(Gather, Rc<FaceStresses>)>,
    contact: ContactSize,
    /// Whether this rank is the one that reads.
    is_here: bool,
}

impl Reader {
    /// Sets up the reading of a body. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn new(body: &Body, readout: &Readout) -> Result<Self> {
        let gather = |columns: &[Int]| Gather::new(&body.terms.load, columns);
        let of_probes = |probes: &ProbeForms| Ok::<_, crate::Error>((gather(&probes.columns)?, probes.clone()));
        let of_fields = |(every, columns): &(usize, Vec<Int>)| Ok::<_, crate::Error>((*every, gather(columns)?));
        let of_faces = |faces: &Rc<FaceStresses>| Ok::<_, crate::Error>((gather(&faces.columns)?, faces.clone()));
        Ok(Self {
            probes: readout.probes.as_ref().map(of_probes).transpose()?,
            fields: readout.fields.as_ref().map(of_fields).transpose()?,
            faces: readout.faces.as_ref().map(of_faces).transpose()?,
            contact: readout.contact.clone(),
            is_here: readout.is_here(),
        })
    }

    /// Reads the state of a step. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn read(&mut self, step: &Step, state: &State) -> Result<Reading> {
        let fetched = |gather: &mut Gather, of: &Vector| Ok::<_, crate::Error>(gather.fetch(of)?.to_vec());
        let mut reading = Reading::default();
        let contact = contact(&self.contact, step);
        if let Some((gather, forms)) = &mut self.probes {
            let [u, v] = [fetched(gather, &state.u)?, fetched(gather, &state.v)?];
            reading.probes = forms.probes((&forms.map.apply(&u), &forms.map.apply(&v)), &contact);
        }
        if let Some((gather, faces)) = &mut self.faces {
            let u = fetched(gather, &state.u)?;
            if !faces.faces.is_empty() {
                (reading.faces, reading.map) = faces.tensions(&faces.map.apply(&u), &contact, step.time);
            }
        }
        if let Some((every, gather)) = &mut self.fields
            && step.number.is_multiple_of(*every)
        {
            reading.coordinates = Some([fetched(gather, &state.u)?, fetched(gather, &state.v)?]);
        }
        Ok(if self.is_here { reading } else { Reading::default() })
    }
}

/// Force and radius of the contact at a step.
pub(super) fn contact(size: &ContactSize, step: &Step) -> ContactNow {
    size.now(step.contact.force, step.contact.indentation)
}

impl ProbeForms {
    /// Values of the probes from their nine forms and the time derivatives of the forms; `contact` is needed for the
    /// stresses near the impact point.
    pub(super) fn probes(&self, (values, rates): (&[f64], &[f64]), contact: &ContactNow) -> Vec<Probe> {
        let one = |((value, rate), local): ((&[f64], &[f64]), &Option<LocalPoint>)| {
            let mut stress = [value[3], value[4], value[5], value[6], value[7], value[8]];
            if let Some(local) = local.as_ref().filter(|_| contact.force > 0.0) {
                stress.iter_mut().zip(local.stress(contact)).for_each(|(sum, more)| *sum += more);
            }
            Probe {
                displacement: [value[0], value[1], value[2]],
                velocity: [rate[0], rate[1], rate[2]],
                principal_stress: principal(stress),
            }
        };
        values.chunks_exact(9).zip(rates.chunks_exact(9)).zip(&self.local).map(one).collect()
    }
}
