//! Steps chosen by the error of the acceleration history.
//!
//! A twin takes every second step with double the size. Both are of second order, so a third of the difference between the two
//! accelerations is the error of the finer one; half of it is taken, since the impact's own discontinuities lower the order that is
//! seen. This is an estimate of the whole error so far, not of one step's: what waves lose on their way to the edges and back shows
//! only when they return. While the first contact episode lasts, nothing is told; where it shows too large an error the
//! run begins anew with smaller steps.
//!
//! Steps are powers of two times a base, so that few factorisations serve. Out of contact they grow with the clearance;
//! a step that would lead into contact is taken again in smaller ones, so that contact begins and ends in the smallest.

use std::ops::ControlFlow;

use petsc_wrap::{Comm, Vector};

use crate::body::Solid;
use crate::contact::hertz;
use crate::error::Result;

use super::Count;
use super::gate::Gate;
use super::ladder::Ladder;
use super::setting::Setting;
use super::step::Step;
use super::trajectory::{Trajectory, at};

/// Levels of the ladder's steps in contact, out of it, and the largest, well away from the body.
const LEVELS: [usize; 3] = [0, 1, 3];

/// First guess: the step in contact times times a half-space's contact time and the root of the tolerance.
const FIRST: f64 = 0.12;

/// Of the tolerance, what a restart aims at.
const AIM: f64 = 0.6;

/// Of the peak so far, what the acceleration has to fall below for the peak to be over.
const PAST: f64 = 0.8;

/// The order that is seen: two, but for the beginning and the end of contact.
const ORDER: f64 = 1.7;

/// What a controlled run is made of beside the body.
pub struct Controlled<'a> {
    pub comm: &'a Comm,
    pub setting: &'a Setting,
    pub ladder: &'a mut Ladder,
    pub gate: &'a mut Gate,
    pub count: &'a mut Count,
    /// End of the run, s.
    pub end: f64,
    /// Wanted error of the acceleration over its peak.
    pub tolerance: f64,
}

/// The fine and the coarse trajectory, and how they differ.
struct Pair {
    fine: Trajectory,
    coarse: Trajectory,
    /// Largest acceleration and largest difference of the two so far, m/s².
    peak: f64,
    difference: f64,
    /// Range so far of aᵀu, less the motion of a free body as a whole, m.
    surface: [f64; 2],
    /// What gives that motion of a free body from u, along the direction of travel.
    mean: Option<Vector>,
}

/// What a first guess of the step in contact is, s.
pub(super) fn first_step(setting: &Setting, tolerance: f64, end: f64) -> f64 {
    let contact = hertz::contact_time(setting.law.hertz.stiffness, setting.mass, setting.speed);
    (FIRST * tolerance.sqrt() * contact).min(end / 2.0)
}

impl Controlled<'_> {
    /// Runs to the end or until `observe` breaks off; returns which, and the fine trajectory. Collective.
    pub(super) fn run(
        mut self,
        body: &mut Solid,
        mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>,
    ) -> Result<(ControlFlow<()>, Trajectory)> {
        let mut pair = Pair::new(self.comm, body, self.setting)?;
        let mut saved = Pair::new(self.comm, body, self.setting)?;
        let start = pair.fine.observed(body, self.setting)?;
        self.gate.open(&start);
        let mut flow = observe(&start)?;
        // Steps that are not told yet, while the first episode may still be taken back.
        let mut held = Some(Vec::new());
        // Until when the smallest steps are taken, after a larger one led into contact.
        let mut careful = 0.0;
        while flow.is_continue() && !self.is_over(&pair) {
            let level = if pair.fine.time < careful { LEVELS[0] } else { self.level(&pair, body)? };
            if level > LEVELS[0] {
                saved.copy_from(&pair)?;
            }
            let mut told = self.advance(&mut pair, level, body)?;
            if level > LEVELS[0] && (pair.is_touching() || told[0].contact.force > 0.0) {
                careful = pair.fine.time;
                pair.copy_from(&saved)?;
                continue;
            }
            pair.compare(self.setting, &told)?;
            self.count.error = pair.error();
            if let Some(steps) = &mut held {
                // Relative to a peak that is still to come the error means nothing.
                let past_peak = pair.fine.acceleration(self.setting) < PAST * pair.peak;
                if let Some(error) = pair.error().filter(|error| past_peak && *error > self.tolerance) {
                    let factor = (AIM * self.tolerance / error).powf(1.0 / ORDER).clamp(0.1, 0.8);
                    tracing::info!(error, time = pair.fine.time, factor, "the first contact again, in smaller steps");
                    let base = factor * self.ladder.step(LEVELS[0]);
                    self.ladder.rebase(base)?;
                    steps.clear();
                    (pair, careful) = (Pair::new(self.comm, body, self.setting)?, 0.0);
                    self.comm.collect_garbage()?;
                    continue;
                }
                steps.append(&mut told);
                if (past_peak && !pair.is_touching()) || self.is_over(&pair) {
                    told = held.take().unwrap_or_default();
                }
            }
            for step in &told {
                self.gate.check(step).map_err(|error| at(error, step.number, step.time))?;
                if flow.is_continue() {
                    flow = observe(step)?;
                }
            }
        }
        Ok((flow, pair.fine))
    }

    fn is_over(&self, pair: &Pair) -> bool {
        // A part of a step that rounding leaves is none.
        pair.fine.time >= self.end - 1e-9 * self.ladder.step(LEVELS[0])
    }

    /// The level of the next steps: the larger ones where the impactor is off and will be after them. Collective.
    fn level(&self, pair: &Pair, body: &Solid) -> Result<usize> {
        if pair.is_touching() {
            return Ok(LEVELS[0]);
        }
        let clearance = -pair.fine.now.approach.max(pair.coarse.now.approach);
        let rate = pair.fine.now.rate(body)?;
        // Farther away than twice what the surface has moved to and fro, contact is not near.
        let far = clearance > 2.0 * (pair.surface[1] - pair.surface[0]);
        let stays_off = |level: usize| {
            let way = rate * 2.0 * self.ladder.step(level);
            way < 0.5 * clearance && pair.fine.time + 2.0 * self.ladder.step(level) <= self.end
        };
        let candidates = if far { &LEVELS[..] } else { &LEVELS[..2] };
        Ok(candidates.iter().rev().copied().find(|level| stays_off(*level)).unwrap_or(LEVELS[0]))
    }

    /// Two steps of the fine trajectory, which are returned, and one of the coarse.
    fn advance(&mut self, pair: &mut Pair, level: usize, body: &mut Solid) -> Result<Vec<Step>> {
        let mut told = Vec::with_capacity(2);
        for _ in 0..2 {
            self.step(&mut pair.fine, level, body)?;
            told.push(pair.fine.observed(body, self.setting)?);
        }
        self.step(&mut pair.coarse, level + 1, body)?;
        Ok(told)
    }

    /// A step of a trajectory at a level.
    fn step(&mut self, trajectory: &mut Trajectory, level: usize, body: &mut Solid) -> Result<()> {
        let stepper = self.ladder.at(level, body)?;
        let time = trajectory.time + stepper.step();
        self.count.iterations += trajectory.advance(stepper, time, body, self.setting)?;
        self.count.solves += 1;
        Ok(())
    }
}

impl Pair {
    fn new(comm: &Comm, body: &mut Solid, setting: &Setting) -> Result<Self> {
        let [fine, coarse] = [Trajectory::new(comm, body, setting)?, Trajectory::new(comm, body, setting)?];
        let mean = if body.is_free()? { Some(mean_displacement(body)?) } else { None };
        Ok(Self { fine, coarse, peak: 0.0, difference: 0.0, surface: [0.0; 2], mean })
    }

    fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.fine.copy_from(&other.fine)?;
        self.coarse.copy_from(&other.coarse)
    }

    fn is_touching(&self) -> bool {
        self.fine.now.approach.max(self.coarse.now.approach) >= 0.0
    }

    /// Takes what the steps told and how the two differ after them. Collective.
    fn compare(&mut self, setting: &Setting, told: &[Step]) -> Result<()> {
        for step in told {
            self.peak = self.peak.max(step.impactor.acceleration);
        }
        let now = &self.fine.now;
        let whole = self.mean.as_ref().map_or(Ok(0.0), |mean| mean.dot(&now.state.u))?;
        let surface = now.surface - whole;
        self.surface = [self.surface[0].min(surface), self.surface[1].max(surface)];
        let difference = self.fine.acceleration(setting) - self.coarse.acceleration(setting);
        self.difference = self.difference.max(difference.abs());
        Ok(())
    }

    /// The estimated error of the fine acceleration over its peak, once there is a peak.
    fn error(&self) -> Option<f64> {
        (self.peak > 0.0).then(|| 0.5 * self.difference / self.peak)
    }
}

/// M t / tᵀM t for the translation t: the mean displacement of a body along it. Collective.
fn mean_displacement(body: &Solid) -> Result<Vector> {
    let mut mean = body.load.duplicate()?;
    body.apply_mass(&body.translation, &mut mean)?;
    mean.scale(1.0 / mean.dot(&body.translation)?)?;
    Ok(mean)
}
