//! Computes the contact force on one basis after another in the same time steps, so that the forces differ by the bases
//! only.

use std::ops::ControlFlow;

use crate::agree::of_root;
use crate::body::{Body, FEW_MODES, ModalBody, Projection};
use crate::error::Result;
use crate::impact::step::Step;
use crate::impact::{KnownForce, ModalImpact, Reading, SteppedImpact, Steps, Trace, Until};
use crate::scene::Scene;

use super::context::ModelContext;
use super::watch::Stage;

/// Growth of the number of vectors after which time steps are chosen again. The modes of the larger basis may need
/// shorter ones.
const VECTORS_BEFORE_NEW_STEPS: usize = 2;

/// Time steps are replaced if a basis needs a largest step below this factor times the present one.
const SHORTER_BELOW: f64 = 0.75;

/// Computes the force of an impact on several bases.
pub(super) struct Trials<'a> {
    context: &'a ModelContext<'a>,
    scene: &'a Scene,
    chosen: Option<Chosen>,
}

/// Time steps in modal coordinates that bases share.
#[derive(Clone, Copy)]
struct Chosen {
    steps: Steps,
    /// Number of vectors of the basis for which the steps were last chosen.
    vectors: usize,
}

/// The contact force on a basis.
#[derive(Default)]
pub(super) struct Trial {
    pub force: Trace,
    /// Time steps of the force, in modal coordinates.
    pub steps: Option<Steps>,
    /// The body in modal coordinates, if the force was computed in them.
    pub modal: Option<ModalBody>,
    /// Forces in all time steps that were tried, if the basis chose its own in modal coordinates.
    pub known: Vec<KnownForce>,
}

impl<'a> Trials<'a> {
    /// Starts without chosen time steps.
    pub fn new(context: &'a ModelContext<'a>, scene: &'a Scene) -> Self {
        Self { context, scene, chosen: None }
    }

    /// The force on a basis, in the time steps chosen before. Small bases choose their own steps. All their modes can
    /// be integrated in any steps, so their steps do not show what larger bases need. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] if the impact cannot be solved; or if a PETSc call fails.
    pub fn force(&mut self, projection: &Projection) -> Result<Trial> {
        let trial = self.force_in(self.chosen.map(|chosen| chosen.steps), projection)?;
        let vectors = projection.vectors();
        if self.chosen.is_none() && vectors > FEW_MODES {
            self.chosen = trial.steps.map(|steps| Chosen { steps, vectors });
        }
        Ok(trial)
    }

    /// The force on a basis in given time steps, or in its own. It succeeds or fails as on the first rank; each rank
    /// has its own body. The watch may interrupt it. Collective.
    ///
    /// # Errors
    /// Same as [`Trials::force`].
    pub fn force_in(&self, steps: Option<Steps>, projection: &Projection) -> Result<Trial> {
        self.force_on(None, steps, projection)
    }

    /// Same as [`Self::force_in`]. `modal` is the body on the same basis in modal coordinates, if it is known. Collective.
    ///
    /// # Errors
    /// Same as [`Trials::force`].
    pub fn force_on(&self, modal: Option<ModalBody>, steps: Option<Steps>, projection: &Projection) -> Result<Trial> {
        let trial = self.context.watch.shared(self.force_here(modal, steps, projection));
        // An interrupted rank has only a part of the force, so all ranks end here.
        self.context.watch.at(Stage::Trial)?;
        let Trial { force, steps, known, modal } = trial?;
        // Further steps are chosen by this force, which must be the same on all ranks to the last digit.
        let (force, steps, known) = of_root(self.context.comm, Some((force, steps, known)));
        Ok(Trial { force, steps, modal, known })
    }

    /// Computes the force in the basis's own time steps, if it has many more vectors than the basis for which the steps
    /// were chosen. If these steps are shorter, their force replaces the given one, and all further bases use them.
    /// Longer steps leave out the modes in which this basis differs from smaller ones. Collective.
    ///
    /// # Errors
    /// Same as [`Trials::force`].
    pub fn shorten_steps(&mut self, projection: &Projection, trial: &mut Trial) -> Result<()> {
        let (vectors, before) = (projection.vectors(), self.chosen);
        let is_due = |before: Chosen| vectors > VECTORS_BEFORE_NEW_STEPS * before.vectors;
        // Other ranks than the first may have no chosen steps.
        if self.scene.time.step.is_some() || !self.context.watch.decided(before.is_some_and(is_due)) {
            return Ok(());
        }
        let mut own = self.force_on(trial.modal.take(), None, projection)?;
        let largest = |steps: Option<Steps>| steps.map_or(f64::INFINITY, |steps| steps.largest);
        let before = before.map(|before| before.steps);
        let is_shorter = self.context.watch.decided(largest(own.steps) < SHORTER_BELOW * largest(before));
        let steps = if is_shorter { own.steps } else { before };
        self.chosen = steps.map(|steps| Chosen { steps, vectors });
        if is_shorter {
            *trial = own;
        } else {
            (trial.modal, trial.known) = (own.modal.take(), own.known);
        }
        Ok(())
    }

    /// The force as computed by this rank. It uses the scene's own scheme, because schemes represent the body's
    /// vibrations differently. In modal coordinates it uses the given `steps` and returns the modal body too.
    fn force_here(&self, modal: Option<ModalBody>, steps: Option<Steps>, projection: &Projection) -> Result<Trial> {
        let Self { context: ModelContext { comm, watch, .. }, scene, .. } = *self;
        let take = |_: &Step, _: &Reading| {};
        if scene.time.modal {
            let body = modal.unwrap_or_else(|| ModalBody::of(projection));
            let mut impact = ModalImpact::new(scene, &body).without_energies();
            let (force, taken) =
                impact.trace_watched(steps, &mut Until { interrupted: &|| watch.is_raised_here(), take })?;
            let known = impact.take_known();
            drop(impact);
            return Ok(Trial { force, steps: Some(taken), modal: Some(body), known });
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
        Ok(Trial { force, steps, ..Trial::default() })
    }
}
