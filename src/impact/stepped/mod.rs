//! An impact integrated in the unknowns of a body, in time steps of equal or of controlled size.

mod condensed;
mod controlled;
mod energy_balance;
mod equilibrium;
mod explicit;
mod foundation;
mod full;
mod implicit;
mod initial;
mod line_search;
mod pad_condensed;
mod plan;
mod relaxation;
mod stable_step;
mod state;
mod step_doubling;
mod step_sizes;
mod trajectory;

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::body::Body;
use crate::error::{Error, Result};
use crate::scene::{Initial, Scene, Vec3};
use crate::scheme::Implicit;

use crate::impact::checkpoint::{Checkpoint, Visitor};
use crate::impact::gate::Gate;
use crate::impact::observer::Observer;
use crate::impact::parameters::ImpactParameters;
use crate::impact::reading::{Reader, Readout};
use crate::impact::step::Step;
use crate::impact::time_integration::{Count, TimeIntegration};

pub use implicit::Method;
pub use plan::{Plan, steps};
pub use stable_step::stable_step;
pub use state::{Impactor, State};
use step_doubling::StepDoubling;
use step_sizes::StepSizes;
use trajectory::Trajectory;

/// Newton residual that counts as zero, relative to the upper bound of the contact force on a half-space.
const FORCE_TOLERANCE: f64 = 1e-10;

/// Largest relative difference of aᵀu for which a recomputed basis counts as the same as the checkpoint's: the rounding
/// of a sum of two thousand terms. Measured for bases recomputed on another number of ranks: with 20 and 40 vectors the
/// difference was 5e-9 and 1e-7 and changed the later acceleration by 1e-4 of its peak. With 10 vectors the bases
/// agreed to rounding; the difference was 4e-15 and the acceleration changed by 1e-13.
const SAME_BASIS: f64 = 1e-12;

/// Finds the equilibrium of a body under its loads, if the scene starts from it. Collective.
///
/// # Errors
/// A fault of `time.initial` if there is no equilibrium; if a PETSc call fails.
pub fn settle(scene: &Scene, body: &mut Body) -> Result<()> {
    body.equilibrium = match scene.time.initial {
        Initial::Rest => None,
        Initial::Equilibrium => {
            let parameters = ImpactParameters::new(&scene.impactor, body);
            // In equilibrium the viscoelastic parts are fully relaxed.
            let relaxations = std::mem::take(&mut body.terms.relaxations);
            let rest = equilibrium::find(&body.comm().clone(), body, &parameters);
            body.terms.relaxations = relaxations;
            Some(rest?)
        }
    };
    Ok(())
}

/// A body and an impactor, ready for a run.
pub struct SteppedImpact {
    comm: Comm,
    body: Body,
    parameters: ImpactParameters,
    step_sizes: StepSizes,
    gate: Gate,
    end: f64,
    plan: Plan,
    /// Allowed error of the acceleration over its peak, for steps of controlled size.
    tolerance: f64,
    trajectory: Trajectory,
    /// Order of accuracy of the scheme, 1 or 2.
    order: usize,
    resumed: Resumed,
    reader: Option<Reader>,
    /// Cost of the runs so far.
    pub count: Count,
}

/// Starting point of the next run.
enum Resumed {
    /// The initial state.
    No,
    /// The state reached, for steps of equal size.
    Equal,
    /// A state of a run in steps of controlled size.
    Chosen(Box<StepDoubling>),
}

impl SteppedImpact {
    /// Sets up the impact of a scene on its body, in its initial state. Collective.
    ///
    /// # Errors
    /// A fault of the scene if an explicit step is not stable or if there is no equilibrium; if a PETSc call fails.
    pub fn new(scene: &Scene, mut body: Body) -> Result<Self> {
        let (comm, end) = (&body.comm().clone(), scene.time.end);
        settle(scene, &mut body)?;
        let mut parameters = ImpactParameters::new(&scene.impactor, &body);
        if let Some(rest) = &body.equilibrium {
            // The gap is measured from the surface as displaced by the loads.
            parameters.gap -= body.terms.contact.force.dot(rest)?;
        }
        let plan = Plan::new(scene, &mut body, &parameters)?;
        let newton_tolerance = FORCE_TOLERANCE * parameters.force_bound();
        let (methods, base) = ((scene.time.scheme, scene.solver.newton), plan.step());
        let mut step_sizes = StepSizes::new(comm, parameters.clone(), methods, newton_tolerance, base);
        // Set up here, so that wrong PETSc options are found before any output is written.
        step_sizes.at(0, &body)?;
        Ok(Self {
            step_sizes,
            gate: Gate::new(scene),
            end,
            plan,
            tolerance: scene.tolerance,
            trajectory: Trajectory::new(&mut body, &parameters)?,
            comm: comm.clone(),
            body,
            parameters,
            order: Implicit::new(scene.time.scheme).map_or(2, |scheme| scheme.order()),
            resumed: Resumed::No,
            reader: None,
            count: Count::default(),
        })
    }

    /// Plan of the time steps.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The body under the impactor.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// Returns the body, for another impact on it.
    pub fn into_body(self) -> Body {
        self.body
    }

    /// State of body and impactor at the time reached.
    pub fn state(&self) -> &State {
        &self.trajectory.now.state
    }

    /// Replaces the initial state, for steps of equal size. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn set_state(&mut self, state: State) -> Result<()> {
        self.trajectory.set_state(state, &mut self.body, &self.parameters)
    }

    /// Runs with a closure as the observer; see [`TimeIntegration::run_watched`].
    ///
    /// # Errors
    /// Same as [`TimeIntegration::run_watched`].
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        self.run_watched(&mut observe)
    }

    fn run_in_equal_steps(&mut self, resumed: Resumed, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let mut flow = ControlFlow::Continue(());
        if matches!(resumed, Resumed::No) {
            (self.trajectory.time, self.trajectory.steps) = (0.0, 0);
            let start = self.trajectory.observed(&self.body, &self.parameters, &mut self.reader)?;
            flow = self.gate.tell(&start, observer)?;
        }
        let size = self.step_sizes.step(0);
        for number in self.trajectory.steps + 1..=steps(self.end, size) {
            if flow.is_break() {
                break;
            }
            let Self { body, parameters, trajectory, gate, count, step_sizes, reader, .. } = self;
            let time = number as f64 * size;
            count.iterations += trajectory.advance(step_sizes.at(0, body)?, time, body, parameters)?;
            count.solves += 1;
            flow = gate.tell(&trajectory.observed(body, parameters, reader)?, observer)?;
            observer.settled(flow.is_break(), &mut || {
                let mut checkpoint = Checkpoint::default();
                self.visit(&mut Visitor::save(&mut checkpoint))?;
                Ok(checkpoint)
            })?;
        }
        Ok(flow)
    }

    /// Saves a run in equal steps to a checkpoint or restores it.
    fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        let Self { body, trajectory, step_sizes, gate, count, .. } = self;
        trajectory.visit(visitor)?;
        visitor.within("ladder", |visitor| step_sizes.visit(visitor, body))?;
        gate.visit(visitor)?;
        count.visit(visitor)
    }
}

impl TimeIntegration for SteppedImpact {
    fn plan(&self) -> Option<Plan> {
        Some(self.plan)
    }

    fn steps(&self) -> Option<usize> {
        match self.plan {
            Plan::Equal { step } => Some(steps(self.end, step)),
            Plan::Controlled { .. } => None,
        }
    }

    fn count(&self) -> Count {
        self.count
    }

    fn nodes(&self) -> Option<&[Vec3]> {
        self.body.nodes.as_deref()
    }

    fn set_readout(&mut self, readout: Readout) -> Result<()> {
        self.reader = Some(Reader::new(&self.body, &readout)?);
        Ok(())
    }

    /// Returns [`Error::Output`] for a checkpoint of another kind of run or on another basis.
    fn resume(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        self.resumed = if matches!(self.plan, Plan::Controlled { .. }) {
            Resumed::Chosen(Box::new(self.restored_doubling(checkpoint)?))
        } else {
            self.visit(&mut Visitor::restore(checkpoint))?;
            Resumed::Equal
        };
        let moment = match &self.resumed {
            Resumed::Chosen(doubling) => &doubling.fine.now,
            _ => &self.trajectory.now,
        };
        // The last vectors of a basis depend on rounding, which differs with the number of ranks.
        if self.body.nodes.is_none() && moment.misfit(&self.body)? > SAME_BASIS {
            let message = "the recomputed basis differs from the checkpoint's (was it written on another number of ranks?): run without --restart to begin anew";
            return Err(Error::Output(message.to_owned()));
        }
        Ok(())
    }

    fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let resumed = std::mem::replace(&mut self.resumed, Resumed::No);
        match (self.plan, resumed) {
            (Plan::Equal { .. }, resumed) => self.run_in_equal_steps(resumed, observer),
            (_, Resumed::Chosen(doubling)) => self.run_in_controlled_steps(Some(*doubling), observer),
            _ => self.run_in_controlled_steps(None, observer),
        }
    }
}
