//! Prepares the readout of a body: probes, stresses on faces and fields, in the coordinates in which the body moves.

use std::rc::Rc;

use petsc_wrap::{Comm, Int};

use crate::agree::agree;
use crate::error::Result;
use crate::impact::{ProbeForms, Readout};
use crate::scene::{Fault, Scene};
use crate::space::evaluate::{
    ContactSize, Evaluator, FaceStresses, FieldSampler, Form, Forms, LocalPoint, Map, renumbered,
};

/// The quantities read at each step, and the sampler that makes fields of them.
pub struct Gauges {
    /// The quantities that a run reads at each step.
    pub readout: Readout,
    /// Makes fields of the readings; on rank 0, if the scene asks for fields.
    pub(super) sampler: Option<FieldSampler>,
}

impl Gauges {
    /// Prepares the readout of a body in its unknowns, or in the coordinates of the given basis vectors. Only rank 0
    /// has these vectors and the evaluator. Collective.
    ///
    /// # Errors
    /// A fault of `output.probes` if a point is outside the body; or if a PETSc call fails.
    pub fn new(
        comm: &Comm,
        scene: &Scene,
        evaluator: Option<Evaluator>,
        unknowns: usize,
        basis: Option<Vec<Vec<f64>>>,
    ) -> Result<Self> {
        let evaluator = evaluator.filter(|_| comm.is_root());
        let all: Vec<Int> = if evaluator.is_some() { (0..unknowns as Int).collect() } else { Vec::new() };
        let (forms, local) = agree(comm, forms(scene, evaluator.as_ref()))?;
        // A reduced body has one coordinate per basis vector, on every rank.
        let all = match &basis {
            Some(basis) if evaluator.is_some() => (0..basis.len() as Int).collect(),
            _ => all,
        };
        let basis = basis.as_deref();
        let probes = (!scene.output.probes.is_empty()).then(|| match basis {
            Some(_) if evaluator.is_some() => {
                ProbeForms { columns: all.clone(), map: Map::new(forms.into_iter(), basis), local }
            }
            _ => {
                let (columns, map) = on_their_own(forms);
                ProbeForms { columns, map, local }
            }
        });
        let faces = evaluator.as_ref().filter(|_| scene.output.stress);
        let mut faces = faces.map_or_else(FaceStresses::default, |evaluator| evaluator.faces(scene, basis));
        let contact = ContactSize::new(scene);
        let sampler = evaluator.filter(|_| scene.output.fields.is_some());
        let sampler = sampler.map(|evaluator| FieldSampler::new(&evaluator, contact.clone(), basis));
        faces.columns = all.clone();
        let readout = Readout {
            probes,
            fields: scene.output.fields.map(|every| (every, all)),
            faces: scene.output.stress.then(|| Rc::new(faces)),
            contact,
            least_tension: None,
        };
        Ok(Self { readout, sampler })
    }
}

/// Nine linear forms per probe (three displacements, six stresses), and the local stresses to add near the impact
/// point. Empty on ranks without the evaluator.
fn forms(
    scene: &Scene,
    evaluator: Option<&Evaluator>,
) -> std::result::Result<(Vec<Form>, Vec<Option<LocalPoint>>), Fault> {
    let (mut all, mut locals) = (Vec::new(), Vec::new());
    let Some(evaluator) = evaluator else { return Ok((all, locals)) };
    for (number, probe) in scene.output.probes.iter().enumerate() {
        let Some(Forms { displacement, stress, local }) = evaluator.at(probe.point) else {
            let message = format!("the point of probe {:?} is outside of the body", probe.name);
            let help = "a point within the body or on its surface";
            return Err(Fault::new(format!("output.probes.{number}.point"), message, help));
        };
        all.extend(displacement.into_iter().chain(stress));
        locals.push(local);
    }
    Ok((all, locals))
}

/// The coordinates that some forms need, ascending, and the forms in these coordinates.
fn on_their_own(mut forms: Vec<Form>) -> (Vec<Int>, Map) {
    let needed = renumbered(&mut forms);
    (needed.into_iter().map(|unknown| unknown as Int).collect(), Map::new(forms.into_iter(), None))
}
