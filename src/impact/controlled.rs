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
use super::checkpoint::{Carrier, Checkpoint};
use super::gate::Gate;
use super::ladder::Ladder;
use super::observer::{Observed, Observer};
use super::pair::Pair;
use super::reading::Reader;
use super::setting::Setting;
use super::state::Moment;
use super::trajectory::{Trajectory, at};

/// Levels of the ladder's steps in contact, out of it, and the largest, well away from the body.
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
    pub setting: &'a Setting,
    pub ladder: &'a mut Ladder,
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
    pair: Pair,
    /// Until when (s) the smallest steps are taken.
    careful: f64,
}

impl Resumed {
    /// The moment.
    pub(super) fn moment(&self) -> &Moment {
        &self.pair.fine.now
    }
}

/// What a first guess of the step in contact is, s.
///
/// # Errors
/// A fault of `time.end` where the run would take too many of them.
pub(super) fn first_step(setting: &Setting, tolerance: f64, end: f64) -> Result<f64> {
    let contact = setting.law.force_law.contact_time(setting.mass, setting.speed);
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
        let (mut pair, mut careful) = (Pair::new(body, self.setting)?, 0.0);
        self.carry(&mut pair, &mut careful, body, &mut Carrier::from(checkpoint))?;
        Ok(Resumed { pair, careful })
    }

    /// Runs to the end or until the observer breaks off, from a moment of an earlier run where there is one; returns which, and the fine
    /// trajectory. Collective.
    pub(super) fn run(
        mut self,
        body: &mut Body,
        resumed: Option<Resumed>,
        observer: &mut dyn Observer,
    ) -> Result<(ControlFlow<()>, Trajectory)> {
        if let Some(Resumed { mut pair, careful }) = resumed {
            let flow = self.advance_to_end(&mut pair, careful, body, &mut None, observer)?;
            return Ok((flow, pair.fine));
        }
        let mut pair = Pair::new(body, self.setting)?;
        let start = pair.fine.observed(body, self.setting, self.reader)?;
        if self.gate.tell(&start, observer)?.is_break() {
            return Ok((ControlFlow::Break(()), pair.fine));
        }
        // Steps that are not told yet, while the first episode may still be taken back.
        let mut held = Some(Vec::new());
        let ended = self.advance_to_end(&mut pair, 0.0, body, &mut held, observer);
        // What was computed is kept, whatever has ended the run.
        for step in held.into_iter().flatten() {
            let _ = self.gate.tell(&step, observer)?;
        }
        Ok((ended?, pair.fine))
    }

    /// To a checkpoint or from it, when the first contact stands.
    fn carry(&mut self, pair: &mut Pair, careful: &mut f64, body: &Body, carrier: &mut Carrier) -> Result<()> {
        pair.carry(carrier)?;
        carrier.number("careful", careful)?;
        carrier.within("ladder", |carrier| self.ladder.carry(carrier, body))?;
        self.gate.carry(carrier)?;
        self.count.carry(carrier)
    }

    /// `careful` is until when (s) the smallest steps are taken, after a larger one led into contact.
    fn advance_to_end(
        &mut self,
        pair: &mut Pair,
        mut careful: f64,
        body: &mut Body,
        held: &mut Option<Vec<Observed>>,
        observer: &mut dyn Observer,
    ) -> Result<ControlFlow<()>> {
        let mut saved = Pair::new(body, self.setting)?;
        let (part, seen) = SEEN[self.order - 1];
        let mut restarts = 0;
        while !self.is_over(pair) {
            if held.is_some() && observer.is_interrupted() {
                return Ok(ControlFlow::Break(()));
            }
            let level = if pair.fine.time < careful { LEVELS[0] } else { self.level(pair) };
            if level > LEVELS[0] {
                saved.copy_from(pair)?;
            }
            let before = pair.fine.time;
            let advanced = self.advance(pair, level, body);
            let failed = matches!(&advanced, Err(Error::Solve(_) | Error::Unstable(_)));
            if level > LEVELS[0] && (failed || pair.is_touching() || pair.has_touched) {
                careful = before + 2.0 * self.ladder.step(level);
                pair.copy_from(&saved)?;
                continue;
            }
            if let (true, Some(steps)) = (failed && restarts < MOST_RESTARTS, held.as_mut()) {
                restarts += 1;
                steps.clear();
                careful = 0.0;
                *pair = self.again(body, 0.5)?;
                continue;
            }
            let mut told = advanced?;
            pair.compare(self.setting, &told)?;
            let error = pair.difference().map(|difference| part * difference);
            self.count.error = error;
            if let Some(steps) = held {
                // Relative to a peak that is still to come the error means nothing.
                let past_peak = pair.fine.acceleration(self.setting) < PAST * pair.peak;
                let complete = self.is_over(pair) || (past_peak && !pair.is_touching());
                if let Some(error) = error.filter(|error| (past_peak || complete) && *error > self.tolerance) {
                    restarts += 1;
                    if restarts > MOST_RESTARTS {
                        let message = format!(
                            "the error of the first contact stays at {error:.1e} of its peak, above accuracy.tolerance = {:e}, \
                             down to steps of {:.1e} s",
                            self.tolerance,
                            self.ladder.step(LEVELS[0])
                        );
                        return Err(at(Error::Solve(message), pair.fine.steps, pair.fine.time));
                    }
                    steps.clear();
                    careful = 0.0;
                    *pair = self.again(body, (AIM * self.tolerance / error).powf(1.0 / seen).clamp(0.1, 0.8))?;
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
                self.settle(pair, careful, body, (flow.is_break(), observer))?;
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
        pair: &mut Pair,
        mut careful: f64,
        body: &Body,
        (interrupted, observer): (bool, &mut dyn Observer),
    ) -> Result<()> {
        observer.settled(interrupted, &mut || {
            let mut checkpoint = Checkpoint::default();
            self.carry(pair, &mut careful, body, &mut Carrier::to(&mut checkpoint))?;
            Ok(checkpoint)
        })
    }

    /// The beginning again, in steps smaller by a factor. Collective.
    fn again(&mut self, body: &mut Body, factor: f64) -> Result<Pair> {
        let base = factor * self.ladder.step(LEVELS[0]);
        tracing::info!(base, "the first contact again, in smaller steps");
        if self.end / base > MOST_STEPS {
            return Err(Error::Solve(format!(
                "accuracy.tolerance = {:e} asks for steps below {base:.1e} s, more than {MOST_STEPS:.0e} to the end",
                self.tolerance
            )));
        }
        self.ladder.rebase(base)?;
        let pair = Pair::new(body, self.setting)?;
        self.comm.collect_garbage()?;
        Ok(pair)
    }

    fn is_over(&self, pair: &Pair) -> bool {
        // A part of a step that rounding leaves is none.
        pair.fine.time >= self.end - 1e-9 * self.ladder.step(LEVELS[0])
    }

    /// The level of the next steps: the larger ones where the impactor is off and will be after them.
    fn level(&self, pair: &Pair) -> usize {
        if pair.is_touching() {
            return LEVELS[0];
        }
        let clearance = -pair.fine.now.approach.max(pair.coarse.now.approach);
        let rate = pair.fine.now.rate;
        // Farther away than twice what the surface has moved to and fro, contact is not near.
        let far = clearance > 2.0 * (pair.surface[1] - pair.surface[0]);
        let stays_off = |level: usize| {
            let way = rate * 2.0 * self.ladder.step(level);
            way < 0.5 * clearance && pair.fine.time + 2.0 * self.ladder.step(level) <= self.end
        };
        let candidates = if far { &LEVELS[..] } else { &LEVELS[..2] };
        candidates.iter().rev().copied().find(|level| stays_off(*level)).unwrap_or(LEVELS[0])
    }

    /// Two steps of the fine trajectory, which are returned, and one of the coarse.
    fn advance(&mut self, pair: &mut Pair, level: usize, body: &mut Body) -> Result<Vec<Observed>> {
        let mut told = Vec::with_capacity(2);
        pair.has_touched = false;
        for _ in 0..2 {
            self.step(&mut pair.fine, level, body)?;
            told.push(pair.fine.observed(body, self.setting, self.reader)?);
            pair.has_touched |= pair.fine.now.approach > 0.0;
        }
        self.step(&mut pair.coarse, level + 1, body)?;
        Ok(told)
    }

    /// A step of a trajectory at a level.
    fn step(&mut self, trajectory: &mut Trajectory, level: usize, body: &mut Body) -> Result<()> {
        let stepper = self.ladder.at(level, body)?;
        let time = trajectory.time + stepper.step();
        self.count.iterations += trajectory.advance(stepper, time, body, self.setting)?;
        self.count.solves += 1;
        Ok(())
    }
}
