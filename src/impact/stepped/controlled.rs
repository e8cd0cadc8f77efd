//! Steps chosen by the error of the acceleration history.
//!
//! A twin takes every second step with double the size. Of a scheme of second order a third of the difference between the two
//! accelerations is the error of the finer one; half of it is taken, since the impact's own discontinuities lower the order that is
//! seen. Of a scheme of first order all of it is. This is an estimate of the whole error so far, not of one step's: what waves lose on their way to the edges and back shows
//! only when they return. While the first contact episode lasts, nothing is told; where it shows too large an error the
//! run begins anew with smaller steps.
//!
//! Steps are powers of two times a base, so that few factorisations serve. Out of contact they grow with the clearance;
//! a step that would lead into contact is taken again in smaller ones, so that contact begins and ends in the smallest.

use std::ops::ControlFlow;

use petsc_wrap::Comm;

use crate::body::Body;
use crate::error::{Error, Result};
use crate::scene::Fault;

use super::Count;
use super::state::Moment;
use super::step_doubling::StepDoubling;
use super::step_sizes::StepSizes;
use super::trajectory::Trajectory;
use crate::impact::checkpoint::{Checkpoint, Visitor};
use crate::impact::gate::Gate;
use crate::impact::observer::{Observed, Observer};
use crate::impact::parameters::ImpactParameters;
use crate::impact::reading::Reader;
use crate::impact::step::at;

/// Levels of the levels' steps in contact, out of it, and the largest, well away from the body.
const LEVELS: [usize; 3] = [0, 1, 3];

/// First guess: the step in contact times times a half-space's contact time and the root of the tolerance.
const FIRST: f64 = 0.12;

/// Of the tolerance, what a restart aims at.
const AIM: f64 = 0.6;

/// Of the peak so far, what the acceleration has to fall below for the peak to be over.
const PAST: f64 = 0.8;

/// For schemes of first and of second order: the part of the difference that is the error, and the order that is seen, which the
/// beginning and the end of contact lower.
const SEEN: [(f64, f64); 2] = [(1.0, 0.9), (0.5, 1.7)];

/// How often the first contact may be taken again: each time the steps shrink to 0.8 or less.
const MOST_RESTARTS: usize = 12;

/// Steps of a run at least: it ends with a pair of them, and may pass its end by one.
const LEAST: f64 = 20.0;

/// More steps than anyone waits for.
const MOST_STEPS: f64 = 1e7;

/// What a controlled run is made of beside the body.
pub struct Controlled<'a> {
    pub comm: &'a Comm,
    pub parameters: &'a ImpactParameters,
    pub step_sizes: &'a mut StepSizes,
    pub gate: &'a mut Gate,
    pub count: &'a mut Count,
    pub reader: &'a mut Option<Reader>,
    /// End of the run, s.
    pub end: f64,
    /// Wanted error of the acceleration over its peak.
    pub tolerance: f64,
    /// Order of the scheme, 1 or 2.
    pub order: usize,
}

/// A moment that a run goes on from.
pub struct Resumed {
    doubling: StepDoubling,
    /// Until when (s) the smallest steps are taken.
    careful: f64,
}

impl Resumed {
    /// The moment.
    pub(super) fn moment(&self) -> &Moment {
        &self.doubling.fine.now
    }
}

/// What a first guess of the step in contact is, s.
///
/// # Errors
/// A fault of `time.end` where the run would take too many of them.
pub(super) fn first_step(parameters: &ImpactParameters, tolerance: f64, end: f64) -> Result<f64> {
    let contact = parameters.law.force_law.contact_time(parameters.mass, parameters.speed);
    let step = (FIRST * tolerance.sqrt() * contact).min(end / LEAST);
    if end / step <= MOST_STEPS {
        return Ok(step);
    }
    let message = format!(
        "a contact of {contact:.1e} s asks for steps of {step:.1e} s, and the run for {:.1e} of them",
        end / step
    );
    Err(Fault::new("time.end", message, "an earlier end, a larger accuracy.tolerance, or a `time.step`").into())
}

impl Controlled<'_> {
    /// The moment of a checkpoint. Collective.
    pub(super) fn resumed(&mut self, body: &mut Body, checkpoint: &Checkpoint) -> Result<Resumed> {
        let (mut doubling, mut careful) = (StepDoubling::new(body, self.parameters)?, 0.0);
        self.visit(&mut doubling, &mut careful, body, &mut Visitor::restore(checkpoint))?;
        Ok(Resumed { doubling, careful })
    }

    /// Runs to the end or until the observer breaks off, from a moment of an earlier run where there is one; returns which, and the fine
    /// trajectory. Collective.
    pub(super) fn run(
        mut self,
        body: &mut Body,
        resumed: Option<Resumed>,
        observer: &mut dyn Observer,
    ) -> Result<(ControlFlow<()>, Trajectory)> {
        if let Some(Resumed { mut doubling, careful }) = resumed {
            let flow = self.advance_to_end(&mut doubling, careful, body, &mut None, observer)?;
            return Ok((flow, doubling.fine));
        }
        let mut doubling = StepDoubling::new(body, self.parameters)?;
        let start = doubling.fine.observed(body, self.parameters, self.reader)?;
        if self.gate.tell(&start, observer)?.is_break() {
            return Ok((ControlFlow::Break(()), doubling.fine));
        }
        // Steps that are not told yet, while the first episode may still be taken back.
        let mut held = Some(Vec::new());
        let ended = self.advance_to_end(&mut doubling, 0.0, body, &mut held, observer);
        // What was computed is kept, whatever has ended the run.
        for step in held.into_iter().flatten() {
            let _ = self.gate.tell(&step, observer)?;
        }
        Ok((ended?, doubling.fine))
    }

    /// To a checkpoint or from it, when the first contact stands.
    fn visit(
        &mut self,
        doubling: &mut StepDoubling,
        careful: &mut f64,
        body: &Body,
        visitor: &mut Visitor,
    ) -> Result<()> {
        doubling.visit(visitor)?;
        visitor.number("careful", careful)?;
        visitor.within("ladder", |visitor| self.step_sizes.visit(visitor, body))?;
        self.gate.visit(visitor)?;
        self.count.visit(visitor)
    }

    /// `careful` is until when (s) the smallest steps are taken, after a larger one led into contact.
    fn advance_to_end(
        &mut self,
        doubling: &mut StepDoubling,
        mut careful: f64,
        body: &mut Body,
        held: &mut Option<Vec<Observed>>,
        observer: &mut dyn Observer,
    ) -> Result<ControlFlow<()>> {
        let mut saved = StepDoubling::new(body, self.parameters)?;
        let (part, seen) = SEEN[self.order - 1];
        let mut restarts = 0;
        while !self.is_over(doubling) {
            if held.is_some() && observer.is_interrupted() {
                return Ok(ControlFlow::Break(()));
            }
            let level = if doubling.fine.time < careful { LEVELS[0] } else { self.level(doubling) };
            if level > LEVELS[0] {
                saved.copy_from(doubling)?;
            }
            let before = doubling.fine.time;
            let advanced = self.advance(doubling, level, body);
            let failed = matches!(&advanced, Err(Error::Solve(_) | Error::Unstable(_)));
            if level > LEVELS[0] && (failed || doubling.is_touching() || doubling.has_touched) {
                careful = before + 2.0 * self.step_sizes.step(level);
                doubling.copy_from(&saved)?;
                continue;
            }
            if let (true, Some(steps)) = (failed && restarts < MOST_RESTARTS, held.as_mut()) {
                restarts += 1;
                steps.clear();
                careful = 0.0;
                *doubling = self.again(body, 0.5)?;
                continue;
            }
            let mut told = advanced?;
            doubling.compare(self.parameters, &told)?;
            let error = doubling.difference().map(|difference| part * difference);
            self.count.error = error;
            if let Some(steps) = held {
                // Relative to a peak that is still to come the error means nothing.
                let past_peak = doubling.fine.acceleration(self.parameters) < PAST * doubling.peak;
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
                    careful = 0.0;
                    *doubling = self.again(body, (AIM * self.tolerance / error).powf(1.0 / seen).clamp(0.1, 0.8))?;
                    continue;
                }
                steps.append(&mut told);
                if complete {
                    told = held.take().unwrap_or_default();
                }
            }
            let mut flow = ControlFlow::Continue(());
            for step in &told {
                // All that are accepted already are told before a break is heeded.
                if self.gate.tell(step, observer)?.is_break() {
                    flow = ControlFlow::Break(());
                }
            }
            if held.is_none() {
                self.settle(doubling, careful, body, (flow.is_break(), observer))?;
            }
            if flow.is_break() {
                return Ok(flow);
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Lets the observer have a checkpoint, and know whether the run ends with it.
    fn settle(
        &mut self,
        doubling: &mut StepDoubling,
        mut careful: f64,
        body: &Body,
        (interrupted, observer): (bool, &mut dyn Observer),
    ) -> Result<()> {
        observer.settled(interrupted, &mut || {
            let mut checkpoint = Checkpoint::default();
            self.visit(doubling, &mut careful, body, &mut Visitor::save(&mut checkpoint))?;
            Ok(checkpoint)
        })
    }

    /// The beginning again, in steps smaller by a factor. Collective.
    fn again(&mut self, body: &mut Body, factor: f64) -> Result<StepDoubling> {
        let base = factor * self.step_sizes.step(LEVELS[0]);
        tracing::info!(base, "the first contact again, in smaller steps");
        if self.end / base > MOST_STEPS {
            return Err(Error::Solve(format!(
                "accuracy.tolerance = {:e} asks for steps below {base:.1e} s, more than {MOST_STEPS:.0e} to the end",
                self.tolerance
            )));
        }
        self.step_sizes.rebase(base)?;
        let doubling = StepDoubling::new(body, self.parameters)?;
        self.comm.collect_garbage()?;
        Ok(doubling)
    }

    fn is_over(&self, doubling: &StepDoubling) -> bool {
        // A part of a step that rounding leaves is none.
        doubling.fine.time >= self.end - 1e-9 * self.step_sizes.step(LEVELS[0])
    }

    /// The level of the next steps: the larger ones where the impactor is off and will be after them.
    fn level(&self, doubling: &StepDoubling) -> usize {
        if doubling.is_touching() {
            return LEVELS[0];
        }
        let clearance = -doubling.fine.now.approach.max(doubling.coarse.now.approach);
        let rate = doubling.fine.now.rate;
        // Farther away than twice what the surface has moved to and fro, contact is not near.
        let far = clearance > 2.0 * (doubling.surface[1] - doubling.surface[0]);
        let stays_off = |level: usize| {
            let way = rate * 2.0 * self.step_sizes.step(level);
            way < 0.5 * clearance && doubling.fine.time + 2.0 * self.step_sizes.step(level) <= self.end
        };
        let candidates = if far { &LEVELS[..] } else { &LEVELS[..2] };
        candidates.iter().rev().copied().find(|level| stays_off(*level)).unwrap_or(LEVELS[0])
    }

    /// Two steps of the fine trajectory, which are returned, and one of the coarse.
    fn advance(&mut self, doubling: &mut StepDoubling, level: usize, body: &mut Body) -> Result<Vec<Observed>> {
        let mut told = Vec::with_capacity(2);
        doubling.has_touched = false;
        for _ in 0..2 {
            self.step(&mut doubling.fine, level, body)?;
            told.push(doubling.fine.observed(body, self.parameters, self.reader)?);
            doubling.has_touched |= doubling.fine.now.approach > 0.0;
        }
        self.step(&mut doubling.coarse, level + 1, body)?;
        Ok(told)
    }

    /// A step of a trajectory at a level.
    fn step(&mut self, trajectory: &mut Trajectory, level: usize, body: &mut Body) -> Result<()> {
        let stepper = self.step_sizes.at(level, body)?;
        let time = trajectory.time + stepper.step();
        self.count.iterations += trajectory.advance(stepper, time, body, self.parameters)?;
        self.count.solves += 1;
        Ok(())
    }
}
