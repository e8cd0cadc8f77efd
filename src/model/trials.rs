//! The force on one basis after the other, in the same steps: then forces differ by the bases alone.

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::body::{Body, FEW_MODES, ModalBody, Projection};
use crate::error::Result;
use crate::impact::step::Step;
use crate::impact::{ModalImpact, Reading, SteppedImpact, Steps, Trace, Until};
use crate::scene::Scene;

use super::watch::{Stage, Watch};

/// A basis with this many times the vectors of that on which steps were chosen has modes of its own that may ask for shorter ones.
const MANY_MORE: usize = 2;

/// The largest step that a basis asks for, over that of the steps so far, from which on these serve it.
const AS_LONG: f64 = 0.75;

/// What the force of an impact is computed with on several bases.
pub(super) struct Trials<'a> {
    pub comm: &'a Comm,
    pub scene: &'a Scene,
    pub watch: &'a dyn Watch,
    chosen: Option<Chosen>,
}

/// Steps in modal coordinates that all bases share.
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
    /// The body in modal coordinates, on this rank where it was the one to compute the force.
    pub modal: Option<ModalBody>,
}

impl<'a> Trials<'a> {
    /// None so far.
    pub fn new(comm: &'a Comm, scene: &'a Scene, watch: &'a dyn Watch) -> Self {
        Self { comm, scene, watch, chosen: None }
    }

    /// The force on a basis; in steps of its own where all modes of a small one move, which tells nothing of the steps that others need. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] where the impact is not solved; PETSc's.
    pub fn force(&mut self, projection: &Projection) -> Result<Trial> {
        let Self { comm, scene, watch, chosen } = self;
        let mut steps = chosen.map(|chosen| chosen.steps);
        let (force, modal) = shared_force(comm, scene, projection, &mut steps, *watch)?;
        let vectors = projection.vectors();
        if chosen.is_none() && vectors > FEW_MODES {
            *chosen = steps.map(|steps| Chosen { steps, vectors });
        }
        Ok(Trial { force, steps, modal })
    }

    /// The force on a basis in steps of its own, where the basis has many more vectors than that for which steps were chosen, and they turn out too
    /// long for it: longer steps leave out the modes that set it apart. From then on these are the steps. Collective.
    ///
    /// # Errors
    /// As [`Trials::force`].
    pub fn in_shorter_steps(&mut self, projection: &Projection) -> Result<Option<Trial>> {
        let vectors = projection.vectors();
        let Some(before) = self.chosen.filter(|chosen| vectors > MANY_MORE * chosen.vectors) else { return Ok(None) };
        self.chosen = None;
        let trial = self.force(projection)?;
        let largest = |steps: Option<Steps>| steps.map_or(f64::INFINITY, |steps| steps.largest);
        if self.watch.decided(largest(trial.steps) < AS_LONG * before.steps.largest) {
            return Ok(Some(trial));
        }
        self.chosen = Some(Chosen { vectors, ..before });
        Ok(None)
    }
}

/// The force on a basis, by the scene's own scheme, whose steps pass the body's vibrations differently; in modal coordinates by the same
/// steps on each basis, with the body in these.
fn force(
    comm: &Comm,
    scene: &Scene,
    projection: &Projection,
    steps: &mut Option<Steps>,
    watch: &dyn Watch,
) -> Result<(Trace, Option<ModalBody>)> {
    let take = |_: &Step, _: &Reading| {};
    if scene.time.modal {
        let body = ModalBody::of(projection);
        let mut impact = ModalImpact::new(scene, &body).without_energies();
        let (trace, taken) =
            impact.trace_watched(*steps, &mut Until { interrupted: &|| watch.is_raised_here(), take })?;
        *steps = Some(taken);
        drop(impact);
        return Ok((trace, Some(body)));
    }
    let mut trace = Trace::default();
    let mut last: Option<(f64, f64)> = None;
    let reduced = Body::of(&comm.session().alone(), &projection.system())?;
    let _ = SteppedImpact::new(scene, reduced)?.run(|step| {
        let (time, force) = (step.time, step.contact.force);
        if let Some((before, was)) = last.replace((time, force)) {
            trace.push(before, time - before, [was, 0.5 * (was + force), force]);
        }
        Ok(if watch.is_raised_here() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok((trace, None))
}

/// [`force`] as the first rank has it, with this rank's body, before somebody who may break it off. Collective.
pub(super) fn shared_force(
    comm: &Comm,
    scene: &Scene,
    projection: &Projection,
    steps: &mut Option<Steps>,
    watch: &dyn Watch,
) -> Result<(Trace, Option<ModalBody>)> {
    let mut modal = None;
    let trace = force(comm, scene, projection, steps, watch).map(|(trace, body)| {
        modal = body;
        trace
    });
    let trace = watch.shared(trace);
    // A rank that has broken off has a part of the force: all of them end here.
    watch.at(Stage::Trial)?;
    Ok((trace?, modal))
}
