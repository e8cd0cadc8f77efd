//! Time integration in steps of controlled size: the error of the acceleration history is estimated by step doubling.
//!
//! A second (coarse) trajectory takes one step of double size for every two steps of the fine trajectory. For a scheme
//! of second order the error of the fine trajectory is a third of the difference of their accelerations. Half of the
//! difference is taken, because the discontinuities of the impact reduce the observed order. For a scheme of first
//! order all of the difference is taken. This estimates the accumulated error, not the error of one step: errors of
//! waves on their way to the edges and back show only when the waves return. During the first contact no step is passed
//! to the observer. If the error becomes too large there, the run starts again with smaller steps.
//!
//! Steps are powers of two times a base step, so that few factorisations are needed. Out of contact they grow with the
//! clearance. A step that would lead into contact is repeated in smaller steps, so that contact begins and ends in the
//! smallest ones.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::Fault;

use super::SteppedImpact;
use super::step_doubling::StepDoubling;
use super::trajectory::Trajectory;
use crate::impact::checkpoint::{Checkpoint, Visitor};
use crate::impact::observer::{Observed, Observer};
use crate::impact::parameters::ImpactParameters;
use crate::impact::step::at;

/// Levels of the steps in contact, out of contact, and far away from the body: a step is 2^level times the base step.
const LEVELS: [usize; 3] = [0, 1, 3];

/// First guess of the step in contact for a tolerance of 1, relative to the contact time on a half-space. The step is
/// proportional to the square root of the tolerance.
const FIRST_STEP_FACTOR: f64 = 0.12;

/// Fraction of the tolerance that a restart aims at.
const AIM: f64 = 0.6;

/// Fraction of the peak so far below which the acceleration has to fall for the peak to be over.
const PAST: f64 = 0.8;

/// For schemes of first and of second order: the fraction of the difference that is the error, and the observed order.
/// The beginning and the end of contact reduce the observed order.
const SEEN: [(f64, f64); 2] = [(1.0, 0.9), (0.5, 1.7)];

/// Largest number of restarts of the first contact; each one reduces the steps by a factor of 0.8 or less.
const MOST_RESTARTS: usize = 12;

/// Smallest number of steps of a run. A run ends with a pair of steps and may pass its end by one.
const MIN_STEPS: f64 = 20.0;

/// Limit of the number of steps of a run.
const MOST_STEPS: f64 = 1e7;

/// First guess of the step in contact, s.
///
/// # Errors
/// A fault of `time.end` if the run would take too many steps.
pub(super) fn first_step(parameters: &ImpactParameters, tolerance: f64, end: f64) -> Result<f64> {
    let contact = parameters.contact_time;
    let step = (FIRST_STEP_FACTOR * tolerance.sqrt() * contact).min(end / MIN_STEPS);
    if end / step <= MOST_STEPS {
        return Ok(step);
    }
    let message = format!(
        "a contact of {contact:.1e} s asks for steps of {step:.1e} s, and the run for {:.1e} of them",
        end / step
    );
    Err(Fault::new("time.end", message, "an earlier end, a larger accuracy.tolerance, or a `time.step`").into())
}

impl SteppedImpact {
    /// Restores the state of a checkpoint. Collective.
    pub(super) fn restored_doubling(&mut self, checkpoint: &Checkpoint) -> Result<StepDoubling> {
        let mut doubling = StepDoubling::new(&mut self.body, &self.parameters)?;
        self.visit_doubling(&mut doubling, &mut Visitor::restore(checkpoint))?;
        Ok(doubling)
    }

    /// Runs in steps of controlled size to the end or until the observer breaks off, and returns which of the two. The
    /// run starts from `resumed`, if it is given. Collective.
    pub(super) fn run_in_controlled_steps(
        &mut self,
        resumed: Option<StepDoubling>,
        observer: &mut dyn Observer,
    ) -> Result<ControlFlow<()>> {
        // Steps that are not passed to the observer yet, because the first contact may be repeated.
        let mut held = resumed.is_none().then(Vec::new);
        let mut flow = ControlFlow::Continue(());
        let mut doubling = match resumed {
            Some(doubling) => doubling,
            None => {
                let doubling = StepDoubling::new(&mut self.body, &self.parameters)?;
                let start = doubling.fine.observed(&self.body, &self.parameters, &mut self.reader)?;
                flow = self.gate.tell(&start, observer)?;
                doubling
            }
        };
        if flow.is_continue() {
            let ended = self.advance_to_end(&mut doubling, &mut held, observer);
            // All computed steps are passed on, whatever has ended the run.
            for step in held.into_iter().flatten() {
                let _ = self.gate.tell(&step, observer)?;
            }
            flow = ended?;
        }
        self.trajectory = doubling.fine;
        Ok(flow)
    }

    /// Saves the run to a checkpoint or restores it; only after the first contact has been accepted.
    fn visit_doubling(&mut self, doubling: &mut StepDoubling, visitor: &mut Visitor) -> Result<()> {
        doubling.visit(visitor)?;
        visitor.within("ladder", |visitor| self.step_sizes.visit(visitor, &self.body))?;
        self.gate.visit(visitor)?;
        self.count.visit(visitor)
    }

    /// Integrates to the end.
    fn advance_to_end(
        &mut self,
        doubling: &mut StepDoubling,
        held: &mut Option<Vec<Observed>>,
        observer: &mut dyn Observer,
    ) -> Result<ControlFlow<()>> {
        let mut saved = StepDoubling::new(&mut self.body, &self.parameters)?;
        let (part, seen) = SEEN[self.order - 1];
        let mut restarts = 0;
        while !self.is_over(doubling) {
            if held.is_some() && observer.is_interrupted() {
                return Ok(ControlFlow::Break(()));
            }
            let level = if doubling.fine.time < doubling.careful { LEVELS[0] } else { self.level(doubling) };
            if level > LEVELS[0] {
                saved.copy_from(doubling)?;
            }
            let before = doubling.fine.time;
            let advanced = self.advance(doubling, level);
            let failed = matches!(&advanced, Err(Error::Solve(_) | Error::Unstable(_)));
            if level > LEVELS[0] && (failed || doubling.is_touching() || doubling.has_touched) {
                doubling.careful = before + 2.0 * self.step_sizes.step(level);
                doubling.copy_from(&saved)?;
                continue;
            }
            if let (true, Some(steps)) = (failed && restarts < MOST_RESTARTS, held.as_mut()) {
                restarts += 1;
                steps.clear();
                *doubling = self.again(0.5)?;
                continue;
            }
            let mut told = advanced?;
            doubling.compare(&self.parameters, &told)?;
            let error = doubling.difference().map(|difference| part * difference);
            self.count.error = error;
            if let Some(steps) = held {
                // Before the peak is reached, an error relative to the largest acceleration so far has no meaning.
                let past_peak = doubling.fine.acceleration(&self.parameters) < PAST * doubling.peak;
                let complete = self.is_over(doubling) || (past_peak && !doubling.is_touching());
                if let Some(error) = error.filter(|error| (past_peak || complete) && *error > self.tolerance) {
                    restarts += 1;
                    if restarts > MOST_RESTARTS {
                        let message = format!(
                            "the error of the first contact stays at {error:.1e} of its peak, above accuracy.tolerance = {:e}, \
                             down to steps of {:.1e} s",
                            self.tolerance,
                            self.step_sizes.step(LEVELS[0])
                        );
                        return Err(at(Error::Solve(message), doubling.fine.steps, doubling.fine.time));
                    }
                    steps.clear();
                    *doubling = self.again((AIM * self.tolerance / error).powf(1.0 / seen).clamp(0.1, 0.8))?;
                    continue;
                }
                steps.append(&mut told);
                if complete {
                    told = held.take().unwrap_or_default();
                }
            }
            let mut flow = ControlFlow::Continue(());
            for step in &told {
                // All accepted steps are passed on, even if the observer breaks off before the last one.
                if self.gate.tell(step, observer)?.is_break() {
                    flow = ControlFlow::Break(());
                }
            }
            if held.is_none() {
                observer.settled(flow.is_break(), &mut || {
                    let mut checkpoint = Checkpoint::default();
                    self.visit_doubling(doubling, &mut Visitor::save(&mut checkpoint))?;
                    Ok(checkpoint)
                })?;
            }
            if flow.is_break() {
                return Ok(flow);
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Restarts from the initial state, in steps smaller by a factor. Collective.
    fn again(&mut self, factor: f64) -> Result<StepDoubling> {
        let base = factor * self.step_sizes.step(LEVELS[0]);
        tracing::info!(base, "the first contact again, in smaller steps");
        if self.end / base > MOST_STEPS {
            return Err(Error::Solve(format!(
                "accuracy.tolerance = {:e} asks for steps below {base:.1e} s, more than {MOST_STEPS:.0e} to the end",
                self.tolerance
            )));
        }
        self.step_sizes.rebase(base)?;
        let doubling = StepDoubling::new(&mut self.body, &self.parameters)?;
        self.comm.collect_garbage()?;
        Ok(doubling)
    }

    fn is_over(&self, doubling: &StepDoubling) -> bool {
        // The remaining time counts as zero if it is within rounding.
        doubling.fine.time >= self.end - 1e-9 * self.step_sizes.step(LEVELS[0])
    }

    /// Level of the next steps: larger steps if the impactor is away from the body and remains so during them.
    fn level(&self, doubling: &StepDoubling) -> usize {
        if doubling.is_touching() {
            return LEVELS[0];
        }
        let clearance = -doubling.fine.now.approach.max(doubling.coarse.now.approach);
        let rate = doubling.fine.now.rate;
        // Contact is not near if the clearance is more than twice the range of the surface's motion.
        let far = clearance > 2.0 * (doubling.surface[1] - doubling.surface[0]);
        let stays_off = |level: usize| {
            let way = rate * 2.0 * self.step_sizes.step(level);
            way < 0.5 * clearance && doubling.fine.time + 2.0 * self.step_sizes.step(level) <= self.end
        };
        let candidates = if far { &LEVELS[..] } else { &LEVELS[..2] };
        candidates.iter().rev().copied().find(|level| stays_off(*level)).unwrap_or(LEVELS[0])
    }

    /// Takes two steps of the fine trajectory, which are returned, and one step of the coarse one.
    fn advance(&mut self, doubling: &mut StepDoubling, level: usize) -> Result<Vec<Observed>> {
        let mut told = Vec::with_capacity(2);
        doubling.has_touched = false;
        for _ in 0..2 {
            self.step(&mut doubling.fine, level)?;
            told.push(doubling.fine.observed(&self.body, &self.parameters, &mut self.reader)?);
            doubling.has_touched |= doubling.fine.now.approach > 0.0;
        }
        self.step(&mut doubling.coarse, level + 1)?;
        Ok(told)
    }

    /// Advances a trajectory by one step of a level.
    fn step(&mut self, trajectory: &mut Trajectory, level: usize) -> Result<()> {
        let time = trajectory.time + self.step_sizes.step(level);
        let stepper = self.step_sizes.at(level, &self.body)?;
        self.count.iterations += trajectory.advance(stepper, time, &mut self.body, &self.parameters)?;
        self.count.solves += 1;
        Ok(())
    }
}
