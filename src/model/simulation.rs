//! A model under its impactor, whichever way it moves.

use std::ops::ControlFlow;

use crate::body::ModalBody;
use crate::contact::Patch;
use crate::error::Result;
use crate::impact::checkpoint::Checkpoint;
use crate::impact::step::Step;
use crate::impact::{Count, Impact, ModalImpact, Observer, Plan, Readout, Tape};
use crate::scene::Scene;

use super::{Dynamics, Gauges, Model, Readings};

/// An impact that is ready to run.
pub struct Simulation {
    kind: Kind,
    /// Estimated error by basis and theory over the whole history.
    of_model: Option<f64>,
    /// What that is of.
    judged: Vec<&'static str>,
    patch: Option<Patch>,
    gauges: Option<Gauges>,
}

enum Kind {
    Stepped(Box<Impact>),
    Modal {
        body: ModalBody,
        scene: Box<Scene>,
        count: Count,
        interrupted: Box<dyn Fn() -> bool>,
        readout: Option<Box<(Readout, Tape)>>,
    },
}

impl Simulation {
    /// The scene's impact on a model of its body. Collective.
    ///
    /// # Errors
    /// A fault of the scene where an explicit step is not stable; PETSc's.
    pub fn new(scene: &Scene, model: Model) -> Result<Self> {
        let (of_model, patch, judged) = (model.error.map(|(_, all)| all), model.dynamics.patch(), model.judged);
        let kind = match model.dynamics {
            Dynamics::Stepped(body) => Kind::Stepped(Box::new(Impact::new(scene, *body)?)),
            Dynamics::Modal(body) => Kind::Modal {
                body,
                scene: Box::new(scene.clone()),
                count: Count::default(),
                interrupted: Box::new(|| false),
                readout: None,
            },
        };
        Ok(Self { kind, of_model, judged, patch, gauges: model.gauges })
    }

    /// Has a run read the body as its scene wants; `None` where it wants nothing. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn read(&mut self) -> Result<Option<Readings>> {
        let Some(Gauges { readout: wanted, sampler, .. }) = self.gauges.take() else { return Ok(None) };
        let tape = Tape::default();
        match &mut self.kind {
            Kind::Stepped(impact) => impact.set_readout(&wanted, tape.clone())?,
            Kind::Modal { readout, .. } => *readout = Some(Box::new((wanted, tape.clone()))),
        }
        Ok(Some(Readings { tape, sampler }))
    }

    /// Has a run ask now and then whether it is to end early. The answer must be the same on all ranks; all of them ask.
    pub fn set_interrupt(&mut self, asked: impl Fn() -> bool + 'static) {
        match &mut self.kind {
            Kind::Stepped(impact) => impact.set_interrupt(asked),
            Kind::Modal { interrupted, .. } => *interrupted = Box::new(asked),
        }
    }

    /// Has the next run go on from a checkpoint of the same scene. One in modal coordinates has none: it is done anew. Collective.
    ///
    /// # Errors
    /// As [`Impact::resume`].
    pub fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        match &mut self.kind {
            Kind::Stepped(impact) => impact.resume(checkpoint),
            Kind::Modal { .. } => Ok(()),
        }
    }

    /// Where this rank's nodes lie, m; `None` for a body without a mesh.
    pub fn nodes(&self) -> Option<&[[f64; 3]]> {
        match &self.kind {
            Kind::Stepped(impact) => impact.body().nodes.as_deref(),
            Kind::Modal { .. } => None,
        }
    }

    /// [`Self::run`] before an observer who may keep checkpoints. Collective.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_watched(&mut self, observer: &mut impl Observer) -> Result<ControlFlow<()>> {
        match &mut self.kind {
            Kind::Stepped(impact) => impact.run_watched(observer),
            Kind::Modal { .. } => self.run(|step| observer.step(step)),
        }
    }

    /// Runs to the end, or until `observe` breaks off, in modal coordinates with the steps that were computed by then; tells which. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] with step and time, [`crate::Error::Unstable`]; the observer's; PETSc's.
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        match &mut self.kind {
            Kind::Stepped(impact) => impact.run(observe),
            Kind::Modal { body, scene, count, interrupted, readout } => {
                let mut impact = ModalImpact::new(scene, body).interrupted_by(&**interrupted);
                if let Some(wanted) = readout {
                    impact = impact.read_by(&wanted.0, wanted.1.clone());
                }
                // All steps are there before the first is told: those up to an interruption are told to their end.
                let mut flow = ControlFlow::Continue(());
                let run = impact.run(|step| {
                    if observe(step)?.is_break() {
                        flow = ControlFlow::Break(());
                    }
                    Ok(ControlFlow::Continue(()))
                });
                *count = impact.count;
                run.map(|_| flow)
            }
        }
    }

    /// Steps of one size or chosen ones; `None` for modal coordinates in steps chosen by the error.
    pub fn plan(&self) -> Option<Plan> {
        match &self.kind {
            Kind::Stepped(impact) => Some(*impact.plan()),
            Kind::Modal { scene, .. } => scene.time.step.map(|step| Plan::Equal { step }),
        }
    }

    /// Number of steps to the end, where it is known.
    pub fn steps(&self) -> Option<usize> {
        match &self.kind {
            Kind::Stepped(impact) => impact.steps(),
            Kind::Modal { .. } => None,
        }
    }

    /// What the runs have cost so far.
    pub fn count(&self) -> Count {
        match &self.kind {
            Kind::Stepped(impact) => impact.count,
            Kind::Modal { count, .. } => *count,
        }
    }

    /// What [`Self::error`] is the sum of.
    pub fn judged(&self) -> Vec<&'static str> {
        let steps = self.count().error.map(|_| "steps");
        let patch = self.patch.map(|_| "patch");
        self.judged.iter().copied().chain(steps).chain(patch).collect()
    }

    /// Estimated error of the acceleration over its peak, over the whole history: by steps, basis, theory and patch, as far as each is
    /// estimated; `None` where nothing is.
    pub fn error(&self) -> Option<f64> {
        let (steps, model) = (self.count().error, self.of_model);
        if steps.is_none() && model.is_none() {
            return None;
        }
        Some(steps.unwrap_or(0.0) + model.unwrap_or(0.0) + self.patch.map_or(0.0, |patch| patch.error()))
    }
}
