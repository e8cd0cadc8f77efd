//! What is read of the body at every step, besides the surface under the impactor.

use std::rc::Rc;

use petsc_wrap::{Gather, Int, Vector};

use crate::body::Body;
use crate::error::Result;
use crate::form::stress::principal;
use crate::scene::Vec3;
use crate::space::evaluate::{ContactNow, ContactSize, FaceStresses, FaceTension, LocalPoint, Map, TensionMap};

use super::step::Step;
use super::stepped::State;

/// What is to be read, in the coordinates in which a body moves. One rank has all of it, the others nothing.
#[derive(Clone, Default)]
pub struct Readout {
    /// Where there are probes.
    pub probes: Option<ProbeForms>,
    /// Where there are fields, after how many steps, and the coordinates: all of them.
    pub fields: Option<(usize, Vec<Int>)>,
    /// Where the largest tension is looked for; a rank that does not read has no faces.
    pub faces: Option<Rc<FaceStresses>>,
    /// How wide the contact is.
    pub contact: ContactSize,
    /// Where the largest tension of all steps is wanted alone, the one (Pa) below which no step counts.
    pub least_tension: Option<f64>,
}

/// What probes are made of.
#[derive(Clone)]
pub struct ProbeForms {
    /// The coordinates that they need.
    pub columns: Vec<Int>,
    /// Nine forms on these a probe: displacement, m, and stress, Pa.
    pub map: Map,
    /// What stresses near the hit lack, probe by probe.
    pub local: Vec<Option<LocalPoint>>,
}

impl Readout {
    /// Names of the faces whose largest tension is read, in their order.
    pub fn face_names(&self) -> Vec<String> {
        self.faces.iter().flat_map(|all| &all.faces).map(|face| face.name.clone()).collect()
    }

    /// The points of these faces, m.
    pub fn face_points(&self) -> Vec<Vec<Vec3>> {
        self.faces.iter().flat_map(|all| &all.faces).map(|face| face.points.clone()).collect()
    }

    /// Whether it is this rank that has it.
    pub(super) fn is_here(&self) -> bool {
        let probes = self.probes.as_ref().is_some_and(|probes| !probes.map.is_empty());
        let faces = self.faces.as_ref().is_some_and(|faces| !faces.faces.is_empty());
        probes || faces || self.fields.as_ref().is_some_and(|(_, columns)| !columns.is_empty())
    }
}

/// What a probe reads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Probe {
    /// m.
    pub displacement: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// The largest first, tension positive, Pa.
    pub principal_stress: Vec3,
}

/// What was read at one step; empty where nothing is wanted, and on the ranks that do not read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Of each probe.
    pub probes: Vec<Probe>,
    /// The largest tension on each face.
    pub faces: Vec<FaceTension>,
    /// The tensions at all points of the faces, of this step or also of those since the last step that has some: a run in modal coordinates
    /// tells the largest of all its steps with the last one.
    pub map: TensionMap,
    /// All coordinates and their rates, where the step's fields are wanted.
    pub coordinates: Option<[Vec<f64>; 2]>,
}

/// Reads a body that is stepped in its unknowns.
pub struct Reader {
    probes: Option<(Gather, ProbeForms)>,
    fields: Option<(usize, Gather)>,
    faces: Option<(Gather, Rc<FaceStresses>)>,
    contact: ContactSize,
    /// Whether this rank is the one that reads.
    is_here: bool,
}

impl Reader {
    /// Of a body. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn new(body: &Body, readout: &Readout) -> Result<Self> {
        let gather = |columns: &[Int]| Gather::new(&body.load, columns);
        Ok(Self {
            probes: match &readout.probes {
                Some(probes) => Some((gather(&probes.columns)?, probes.clone())),
                None => None,
            },
            fields: match &readout.fields {
                Some((every, columns)) => Some((*every, gather(columns)?)),
                None => None,
            },
            faces: match &readout.faces {
                Some(faces) => Some((gather(&faces.columns)?, faces.clone())),
                None => None,
            },
            contact: readout.contact,
            is_here: readout.is_here(),
        })
    }

    /// Reads a step's state. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

/// The contact at a step.
pub(super) fn contact(size: &ContactSize, step: &Step) -> ContactNow {
    size.now(step.contact.force, step.contact.indentation)
}

impl ProbeForms {
    /// What probes read of the values of their nine forms, and of the rates of these, under the contact.
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
