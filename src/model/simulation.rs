//! Runs an impact on a model, in unknowns or in modal coordinates.

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::contact::Patch;
use crate::error::Result;
use crate::impact::checkpoint::Checkpoint;
use crate::impact::step::Step;
use crate::impact::{
    Cause, Count, ErrorEstimate, Errors, ModalImpact, Observer, Plan, Readout, SteppedImpact, Steps, TimeIntegration,
    Trace,
};
use crate::scene::{Model as Theory, Scene, Vec3};
use crate::space::evaluate::FieldSampler;

use super::{Dynamics, Gauges, Linearity, Model, led};

/// An impact simulation that is ready to run.
pub struct Simulation {
    integration: Box<dyn TimeIntegration>,
    /// Ranks of which the first computes the run; `None` if all ranks take each step together.
    led: Option<Comm>,
    /// Work that the first of these ranks has done.
    count: Option<Count>,
    /// Estimated error by basis, discretisation and theory.
    of_model: ErrorEstimate,
    /// Same as [`Model::is_untouched`].
    is_untouched: bool,
    patch: Option<Patch>,
    linearity: Option<Linearity>,
    /// Number of unknowns of the body before any reduction, and of the impactor.
    unknowns: usize,
    sampler: Option<FieldSampler>,
    /// Names of the faces whose largest tension is read; on rank 0.
    faces: Vec<String>,
    /// Points of these faces at which tension is read, m.
    face_points: Vec<Vec<Vec3>>,
}

impl Simulation {
    /// The impact of a scene on the model made for it, with the readout that the scene asks for. Collective.
    ///
    /// # Errors
    /// A fault of the scene if an explicit time step is unstable; or if a PETSc call fails.
    pub fn new(scene: &Scene, model: Model) -> Result<Self> {
        let patch = model.dynamics.patch();
        let is_led = matches!(model.dynamics, Dynamics::Modal(_)) && model.comm.size() > 1;
        let integration: Box<dyn TimeIntegration> = match model.dynamics {
            Dynamics::Stepped(body) => Box::new(SteppedImpact::new(scene, *body)?),
            Dynamics::Modal(body) => {
                let scene = Scene { tolerance: model.tolerance, ..scene.clone() };
                Box::new(ModalImpact::new(&scene, body).with_known(model.known))
            }
        };
        let (readout, sampler) = model.gauges.map(|Gauges { readout, sampler }| (readout, sampler)).unzip();
        let bare = Self::of((scene, model.theory, model.unknowns), integration, model.error, patch, readout)?;
        let led = Some(model.comm).filter(|_| is_led);
        Ok(Self { led, is_untouched: model.is_untouched, sampler: sampler.flatten(), ..bare })
    }

    /// The impact of a scene with the estimated error of its model. Collective.
    pub(super) fn of(
        (scene, theory, unknowns): (&Scene, Theory, usize),
        mut integration: Box<dyn TimeIntegration>,
        of_model: ErrorEstimate,
        patch: Option<Patch>,
        readout: Option<Readout>,
    ) -> Result<Self> {
        let (mut faces, mut face_points) = (Vec::new(), Vec::new());
        if let Some(readout) = readout {
            (faces, face_points) = (readout.face_names(), readout.face_points());
            integration.set_readout(readout)?;
        }
        Ok(Self {
            integration,
            led: None,
            count: None,
            of_model,
            is_untouched: false,
            linearity: Linearity::new(scene, theory, patch.as_ref()),
            patch,
            unknowns: unknowns + 1,
            sampler: None,
            faces,
            face_points,
        })
    }

    /// Hands out the sampler that makes fields of readings, once; on rank 0, if the scene asks for fields.
    pub fn take_sampler(&mut self) -> Option<FieldSampler> {
        self.sampler.take()
    }

    /// Names of the faces whose largest tension is read, in the order of [`crate::impact::Reading::faces`]; on rank 0.
    pub fn faces(&self) -> &[String] {
        &self.faces
    }

    /// Points at which tension is read on each of the faces, m: the points of [`crate::impact::Reading::map`]; on rank
    /// 0.
    pub fn face_points(&self) -> &[Vec<Vec3>] {
        &self.face_points
    }

    /// Makes the next run continue from a checkpoint of the same scene. A run in modal coordinates has no checkpoints
    /// and is repeated. Collective.
    ///
    /// # Errors
    /// Same as [`TimeIntegration::resume`].
    pub fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        self.integration.resume(checkpoint)
    }

    /// Positions of this rank's nodes, m; `None` for a body without a mesh.
    pub fn nodes(&self) -> Option<&[Vec3]> {
        self.integration.nodes()
    }

    /// Runs the impact with an observer. Collective.
    ///
    /// # Errors
    /// Same as [`TimeIntegration::run_watched`].
    pub fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let Some(comm) = &self.led else { return self.integration.run_watched(observer) };
        let (flow, count) = led::run(comm, &mut *self.integration, observer)?;
        self.count = Some(count);
        Ok(flow)
    }

    /// Runs the impact and calls a closure at each step. Collective.
    ///
    /// # Errors
    /// Same as [`TimeIntegration::run_watched`].
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        self.run_watched(&mut observe)
    }

    /// Whether time steps are constant or adaptive; `None` for modal coordinates with adaptive steps.
    pub fn plan(&self) -> Option<Plan> {
        self.integration.plan()
    }

    /// Number of steps to the end, if known.
    pub fn steps(&self) -> Option<usize> {
        self.integration.steps()
    }

    /// Work done by the runs so far.
    pub fn count(&self) -> Count {
        self.count.unwrap_or_else(|| self.integration.count())
    }

    /// Whether the deflection is within the range of a linear model; `None` if that is not known.
    pub fn linearity(&self) -> Option<Linearity> {
        self.linearity
    }

    /// Number of unknowns of the body before any reduction, and of the impactor.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Contact force of the last run and its time steps, in modal coordinates.
    pub fn force(&self) -> Option<&(Trace, Steps)> {
        self.integration.force()
    }

    /// Replaces the estimated error by basis, discretisation and theory.
    pub fn set_error_of_model(&mut self, of_model: ErrorEstimate) {
        self.of_model = of_model;
    }

    /// Estimated error without that of the time steps.
    pub fn error_before_steps(&self) -> ErrorEstimate {
        self.of_model.clone().with_patch(self.patch.as_ref())
    }

    /// Estimated error by basis, discretisation, theory, time steps and patch, as far as each is known. Empty if only
    /// the error of the patch is known.
    pub fn error(&self) -> ErrorEstimate {
        let Count { error, stress_error, stress_history_error, deflection_error, .. } = self.count();
        let error = match error {
            Some(history) if !self.is_untouched => {
                let known = |error: Option<f64>| error.unwrap_or(f64::NAN);
                let of_steps = Errors {
                    first_contact: 0.0,
                    history,
                    stress: known(stress_error),
                    stress_history: known(stress_history_error),
                    deflection: known(deflection_error),
                };
                self.of_model.clone().with(Cause::Steps, of_steps)
            }
            _ => self.of_model.clone(),
        };
        if error.total().is_none() { error } else { error.with_patch(self.patch.as_ref()) }
    }
}
