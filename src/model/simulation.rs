//! A model under its impactor, whichever way it moves.

use std::ops::ControlFlow;

use crate::contact::Patch;
use crate::error::Result;
use crate::impact::checkpoint::Checkpoint;
use crate::impact::step::Step;
use crate::impact::{Cause, Count, ErrorEstimate, Errors, ModalImpact, Observer, Plan, SteppedImpact, TimeIntegration};
use crate::scene::{Scene, Vec3};
use crate::space::evaluate::FieldSampler;

use super::{Dynamics, Gauges, Model};

/// An impact that is ready to run.
pub struct Simulation {
    integration: Box<dyn TimeIntegration>,
    /// Estimated error by basis, cells and theory.
    of_model: ErrorEstimate,
    patch: Option<Patch>,
    sampler: Option<FieldSampler>,
    /// Names of the faces whose largest tension is read; on rank 0.
    faces: Vec<String>,
    /// Their points, m.
    face_points: Vec<Vec<Vec3>>,
}

impl Simulation {
    /// The scene's impact on a model of its body, which is read as the scene wants. Collective.
    ///
    /// # Errors
    /// A fault of the scene where an explicit step is not stable; PETSc's.
    pub fn new(scene: &Scene, model: Model) -> Result<Self> {
        let (of_model, patch) = (model.error, model.dynamics.patch());
        let mut integration: Box<dyn TimeIntegration> = match model.dynamics {
            Dynamics::Stepped(body) => Box::new(SteppedImpact::new(scene, *body)?),
            Dynamics::Modal(body) => Box::new(ModalImpact::new(scene, body)),
        };
        let (mut sampler, mut faces, mut face_points) = (None, Vec::new(), Vec::new());
        if let Some(Gauges { readout, sampler: of_fields, .. }) = model.gauges {
            (faces, face_points) = (readout.face_names(), readout.face_points());
            integration.set_readout(readout)?;
            sampler = of_fields;
        }
        Ok(Self { integration, of_model, patch, sampler, faces, face_points })
    }

    /// What makes fields of readings; on rank 0, where the scene wants fields. It is handed out once.
    pub fn take_sampler(&mut self) -> Option<FieldSampler> {
        self.sampler.take()
    }

    /// Names of the faces whose largest tension is read, in the order of [`crate::impact::Reading::faces`]; on rank 0.
    pub fn faces(&self) -> &[String] {
        &self.faces
    }

    /// Where tensions are read on each of them, m: the points of [`crate::impact::Reading::map`]; on rank 0.
    pub fn face_points(&self) -> &[Vec<Vec3>] {
        &self.face_points
    }

    /// Has the next run go on from a checkpoint of the same scene. One in modal coordinates has none: it is done anew. Collective.
    ///
    /// # Errors
    /// As [`TimeIntegration::resume`].
    pub fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        self.integration.resume(checkpoint)
    }

    /// Where this rank's nodes lie, m; `None` for a body without a mesh.
    pub fn nodes(&self) -> Option<&[Vec3]> {
        self.integration.nodes()
    }

    /// Runs before an observer. Collective.
    ///
    /// # Errors
    /// As [`TimeIntegration::run_watched`].
    pub fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        self.integration.run_watched(observer)
    }

    /// Runs before a closure. Collective.
    ///
    /// # Errors
    /// As [`TimeIntegration::run_watched`].
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        self.run_watched(&mut observe)
    }

    /// Steps of one size or chosen ones; `None` for modal coordinates in steps chosen by the error.
    pub fn plan(&self) -> Option<Plan> {
        self.integration.plan()
    }

    /// Number of steps to the end, where it is known.
    pub fn steps(&self) -> Option<usize> {
        self.integration.steps()
    }

    /// What the runs have cost so far.
    pub fn count(&self) -> Count {
        self.integration.count()
    }

    /// Estimated error by basis, cells, theory, steps and patch, as far as each is estimated; empty where nothing but the patch's is.
    pub fn error(&self) -> ErrorEstimate {
        let Count { error, stress_error, .. } = self.count();
        let error = match error {
            Some(history) => {
                let stress = stress_error.unwrap_or(f64::NAN);
                self.of_model.clone().with(Cause::Steps, Errors { first_contact: 0.0, history, stress })
            }
            None => self.of_model.clone(),
        };
        if error.total().is_none() { error } else { error.with_patch(self.patch.as_ref()) }
    }
}
