//! The force on one basis after the other, in the same steps: then forces differ by the bases alone.

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::body::{Body, FEW_MODES, ModalBody, Projection};
use crate::error::Result;
use crate::impact::step::Step;
use crate::impact::{ModalImpact, Reading, SteppedImpact, Steps, Trace, Until};
use crate::scene::Scene;

use super::watch::{Stage, Watch};

/// How many times the vectors of the basis for which steps were chosen a basis may have before they are chosen again: its own modes may ask for shorter ones.
const VECTORS_BEFORE_NEW_STEPS: usize = 2;

/// Steps are replaced where a basis asks for a largest step below this part of theirs.
const SHORTER_BELOW: f64 = 0.75;

/// What the force of an impact is computed with on several bases.
pub(super) struct Trials<'a> {
    comm: &'a Comm,
    scene: &'a Scene,
    watch: &'a dyn Watch,
    chosen: Option<Chosen>,
}

/// Steps in modal coordinates that bases share.
#[derive(Clone, Copy)]
struct Chosen {
    steps: Steps,
    /// How many vectors the basis had that they were last chosen for.
    vectors: usize,
}

/// The force on a basis.
#[derive(Default)]
pub(super) struct Trial {
    pub force: Trace,
    /// In which steps of modal coordinates.
    pub steps: Option<Steps>,
    /// The body in modal coordinates, where the force was computed in them.
    pub modal: Option<ModalBody>,
}

impl<'a> Trials<'a> {
    /// None so far.
    pub fn new(comm: &'a Comm, scene: &'a Scene, watch: &'a dyn Watch) -> Self {
        Self { comm, scene, watch, chosen: None }
    }

    /// The force on a basis, in the steps chosen before. Small bases choose their own: all their modes move in any steps, which do not show what larger bases
    /// need. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] where the impact is not solved; PETSc's.
    pub fn force(&mut self, projection: &Projection) -> Result<Trial> {
        let trial = self.force_in(self.chosen.map(|chosen| chosen.steps), projection)?;
        let vectors = projection.vectors();
        if self.chosen.is_none() && vectors > FEW_MODES {
            self.chosen = trial.steps.map(|steps| Chosen { steps, vectors });
        }
        Ok(trial)
    }

    /// The force on a basis in given steps, or in its own: as the first rank has it, with this rank's body, before somebody who may break it off. Collective.
    ///
    /// # Errors
    /// As [`Trials::force`].
    pub fn force_in(&self, steps: Option<Steps>, projection: &Projection) -> Result<Trial> {
        let trial = self.watch.shared(self.force_here(steps, projection));
        // A rank that has broken off has a part of the force: all of them end here.
        self.watch.at(Stage::Trial)?;
        trial
    }

    /// The force on a basis of many more vectors than that for which the steps were chosen, in steps of its own, where it asks for shorter ones: longer steps
    /// leave out the modes in which it differs from smaller bases. The shorter ones are then the steps that bases share. Collective.
    ///
    /// # Errors
    /// As [`Trials::force`].
    pub fn in_shorter_steps(&mut self, projection: &Projection) -> Result<Option<Trial>> {
        let (vectors, before) = (projection.vectors(), self.chosen);
        let is_due = |before: Chosen| vectors > VECTORS_BEFORE_NEW_STEPS * before.vectors;
        // Other ranks than the first may have no steps of their own.
        if self.scene.time.step.is_some() || !self.watch.decided(before.is_some_and(is_due)) {
            return Ok(None);
        }
        let trial = self.force_in(None, projection)?;
        let largest = |steps: Option<Steps>| steps.map_or(f64::INFINITY, |steps| steps.largest);
        let before = before.map(|before| before.steps);
        let is_shorter = self.watch.decided(largest(trial.steps) < SHORTER_BELOW * largest(before));
        let steps = if is_shorter { trial.steps } else { before };
        self.chosen = steps.map(|steps| Chosen { steps, vectors });
        Ok(is_shorter.then_some(trial))
    }
    /// The force as this rank computes it: by the scene's own scheme, whose steps pass the body's vibrations differently; in modal coordinates in these steps,
    /// with the body in these.
    fn force_here(&self, steps: Option<Steps>, projection: &Projection) -> Result<Trial> {
        let Self { comm, scene, watch, .. } = *self;
        let take = |_: &Step, _: &Reading| {};
        if scene.time.modal {
            let body = ModalBody::of(projection);
            let mut impact = ModalImpact::new(scene, &body).without_energies();
            let (force, taken) =
                impact.trace_watched(steps, &mut Until { interrupted: &|| watch.is_raised_here(), take })?;
            drop(impact);
            return Ok(Trial { force, steps: Some(taken), modal: Some(body) });
        }
        let mut force = Trace::default();
        let mut last: Option<(f64, f64)> = None;
        let reduced = Body::of(&comm.session().alone(), &projection.system())?;
        let _ = SteppedImpact::new(scene, reduced)?.run(|step| {
            let (time, now) = (step.time, step.contact.force);
            if let Some((before, was)) = last.replace((time, now)) {
                force.push(before, time - before, [was, 0.5 * (was + now), now]);
            }
            Ok(if watch.is_raised_here() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
        Ok(Trial { force, steps, modal: None })
    }
}
