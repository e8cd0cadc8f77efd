//! Time integration in modal coordinates, step by step, with the beginning and the end of each contact located in time.

use crate::body::Modes;
use crate::contact::Law;
use crate::error::{Error, Result};
use crate::solve::root::RootSearch;

use super::internal_force::{ForceInStep, InternalForceState};
use super::stage::{ContactStep, Stage, solve_damped};
use super::step_response::{FreeBody, SAMPLE_POINTS, State, StepResponse, SurfaceRate};

/// Largest number of halvings of the step.
const LEVELS: usize = 40;

/// Change of the time, relative to the step, at which the search for the beginning or the end of a contact ends.
const CONTACT_TIME_CHANGE: f64 = 1e-11;

/// Choice of the time steps.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Steps {
    /// Largest step, s.
    pub largest: f64,
    /// Allowed difference between the contact law and the quadratic force within a step, N; `None` for steps of one
    /// size.
    pub defect: Option<f64>,
    /// Expected peak force, N. The contact stiffness at this force decides how many modes the steps resolve.
    pub peak: f64,
}

/// One accepted step.
pub struct Taken {
    /// Step size, s.
    pub step: f64,
    /// Contact force F at the beginning, middle and end of the step, N.
    pub force: [f64; 3],
    /// Approach δ at the beginning of the step and at [`SAMPLE_POINTS`], m.
    pub approach: [f64; 5],
    /// Numerical energy of the internal force in the step, J; computed only for bodies with dampers.
    pub made: f64,
}

/// Motion of the body and the impactor.
pub struct Motion<'a> {
    modes: &'a Modes,
    surface_rate: SurfaceRate,
    law: Law,
    impactor: FreeBody,
    steps: Steps,
    /// Allowed difference between the force at the middle of a step and the straight line between its ends, N; `None` for
    /// any.
    straight: Option<f64>,
    /// Response tables, by the number of halvings of the largest step.
    tables: Vec<Option<StepResponse>>,
    level: usize,
    /// Force values (N) and size (s) of the last step; `None` after the end of a contact.
    last: Option<([f64; 3], f64)>,
    touching: bool,
    /// Whether the contact has no step yet. Its first step must not be its last: its force is zero at both ends, so a
    /// contact of one step would not be visible in the output.
    begun: bool,
    /// Whether an apparent contact has just proved to have no force.
    grazing: bool,
    /// Whether the body has been at rest so far.
    rests: bool,
    /// Force that the linear stiffness of the modes does not contain, if there is one.
    internal: Option<InternalForceState<'a>>,
    /// Number of halvings from which on the internal force converges.
    coarsest: usize,
    /// State reached: modal coordinates, rigid-body motion and impactor.
    pub state: State,
    /// Contact force F on the modelled part, N.
    pub force: f64,
    /// Approach δ_modes, m: computed without the static displacement of the modes left out.
    pub approach: f64,
    /// Number of steps tried.
    pub solves: usize,
    /// Number of Newton iterations.
    pub iterations: usize,
}

impl<'a> Motion<'a> {
    /// Starts the motion at t = 0; `law` is the contact law in terms of δ_modes.
    pub fn new(modes: &'a Modes, law: Law, impactor: FreeBody, steps: Steps, state: State) -> Self {
        let is_unloaded = modes.free.load == 0.0 && modes.modes.iter().all(|mode| mode.load.norm_sqr() == 0.0);
        Self {
            modes,
            surface_rate: SurfaceRate::new(modes),
            law,
            impactor,
            steps,
            straight: None,
            tables: (0..=LEVELS).map(|_| None).collect(),
            level: 0,
            last: None,
            touching: false,
            begun: false,
            grazing: false,
            rests: state.settled > 0.0 || is_unloaded,
            internal: InternalForceState::new(modes, &state),
            coarsest: 0,
            force: 0.0,
            approach: -impactor.gap - state.surface(modes),
            state,
            solves: 0,
            iterations: 0,
        }
    }

    /// Bounds the difference (N) between the force in a step and the straight line between the step's ends.
    #[must_use]
    pub fn with_straight_steps(self, straight: Option<f64>) -> Self {
        Self { straight, ..self }
    }

    /// Rate of δ_modes, m/s.
    pub fn rate(&self) -> f64 {
        self.state.impactor[1] - self.surface_rate.at(&self.state, self.force)
    }

    /// Contact law in terms of δ_modes.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Energy of the internal force, J.
    pub fn internal_energy(&self) -> f64 {
        self.internal.as_ref().map_or(0.0, |internal| internal.energy(&self.state))
    }

    /// Rate of the contact force, Ḟ, N/s.
    pub fn rise(&self) -> f64 {
        match self.last {
            _ if self.force == 0.0 => 0.0,
            // With damping, Ḟ depends on δ̈; it follows from the force's quadratic over the last step.
            Some(([a, b, c], step)) if self.law.damping > 0.0 => (a - 4.0 * b + 3.0 * c) / step,
            _ => self.law.tangent_at(self.law.indentation(self.approach, self.force)) * self.rate(),
        }
    }

    /// Takes a step that does not pass `end` (s).
    ///
    /// # Errors
    /// [`Error::Solve`] if no step is small enough.
    pub fn advance(&mut self, end: f64) -> Result<Taken> {
        // A contact may be found and lost again before a step is accepted.
        for _ in 0..8 {
            let left = end - self.state.time;
            let taken = if self.touching { self.step_in_contact(left)? } else { self.step_in_flight(left)? };
            if let Some(taken) = taken {
                return Ok(taken);
            }
        }
        Err(Error::Solve("it is not found whether there is contact".into()))
    }

    /// Returns the response table of a step; its size is the step of the present level or `left` (s), whichever is
    /// shorter.
    fn table(&mut self, left: f64) -> StepResponse {
        let step = self.steps.largest * 0.5_f64.powi(self.level as i32);
        // The last step takes all of the remaining time, so that rounding does not leave a tiny further step.
        if step > left * (1.0 - 1e-9) {
            return StepResponse::new(self.modes, &self.impactor, left);
        }
        let (modes, impactor) = (self.modes, self.impactor);
        self.tables[self.level].take().unwrap_or_else(|| StepResponse::new(modes, &impactor, step))
    }

    fn put_back(&mut self, table: StepResponse) {
        if table.step == self.steps.largest * 0.5_f64.powi(self.level as i32) {
            self.tables[self.level] = Some(table);
        }
    }

    /// Half the time of the impactor's flight to a body at rest, s; `None` if steps of this size are not needed or not possible.
    fn approach_of_rest(&self, left: f64) -> Option<f64> {
        let (speed, weight) = (self.state.impactor[1], self.impactor.gravity);
        let square = speed * speed - 2.0 * weight * self.approach;
        let half = -self.approach / (speed + square.sqrt());
        (self.rests && self.steps.defect.is_some() && half > self.steps.largest && half < left).then_some(half)
    }

    /// Takes a step without contact; `None` if contact begins immediately.
    fn step_in_flight(&mut self, left: f64) -> Result<Option<Taken>> {
        if let Some(half) = self.approach_of_rest(left) {
            let table = StepResponse::new(self.modes, &self.impactor, half);
            let (free, in_step) = self.flight(&table).ok_or_else(not_followed)?;
            return Ok(Some(self.take(&table, [0.0; 3], free, in_step)));
        }
        self.level = self.coarsest;
        let (table, free, in_step) = loop {
            let table = self.table(left);
            self.solves += 1;
            if let Some((free, in_step)) = self.flight(&table) {
                break (table, free, in_step);
            }
            self.put_back(table);
            self.level += 1;
            self.coarsest = self.level;
            if self.level > LEVELS {
                return Err(not_followed());
            }
        };
        let Some(sample) = free.iter().position(|approach| *approach > 0.0) else {
            let taken = self.take(&table, [0.0; 3], free, in_step);
            self.put_back(table);
            return Ok(Some(taken));
        };
        if std::mem::take(&mut self.grazing) && sample == 0 {
            // δ rises so little that the force remains zero up to the first point of [`SAMPLE_POINTS`].
            let until = SAMPLE_POINTS[0] * table.step;
            self.put_back(table);
            let table = StepResponse::new(self.modes, &self.impactor, until);
            let (free, in_step) = self.flight(&table).ok_or_else(not_followed)?;
            return Ok(Some(self.take(&table, [0.0; 3], free, in_step)));
        }
        (self.touching, self.begun, self.rests) = (true, true, false);
        self.force = self.law.damped(self.approach, self.rate()).force;
        // Contact begins with small steps, since F ∝ t^{3/2} is not close to a quadratic.
        self.level = if self.steps.defect.is_some() { 3 } else { 0 }.max(self.coarsest);
        let before = if sample == 0 { 0.0 } else { SAMPLE_POINTS[sample - 1] * table.step };
        let after = SAMPLE_POINTS[sample] * table.step;
        self.put_back(table);
        if sample == 0 && self.approach >= 0.0 {
            return Ok(None);
        }
        let above = if sample == 0 { self.approach } else { free[sample - 1] };
        let slope = (free[sample] - above) / (after - before);
        let search = RootSearch {
            bracket: [before, after],
            guess: before - above / slope,
            slope,
            change: CONTACT_TIME_CHANGE * after,
        };
        let touch = search.root(|time| self.flown(time));
        if touch <= 0.0 {
            return Ok(None);
        }
        let table = StepResponse::new(self.modes, &self.impactor, touch);
        let (free, in_step) = self.flight(&table).ok_or_else(not_followed)?;
        let taken = self.take(&table, [0.0; 3], free, in_step);
        (self.approach, self.force) = (0.0, 0.0);
        Ok(Some(taken))
    }

    /// Approach δ at [`SAMPLE_POINTS`] of a step without contact, m, with the internal force; `None` if it is not found.
    fn flight(&self, table: &StepResponse) -> Option<([f64; 4], Option<ForceInStep>)> {
        let free = table.free(&self.state, self.impactor.gap);
        match &self.internal {
            None => Some((free, None)),
            Some(internal) => {
                let (free, in_step) = internal.solve(table, &self.state, free, |free| Some((free, [0.0; 3])))?;
                Some((free, Some(in_step)))
            }
        }
    }

    /// Approach δ after a time (s) without contact, m.
    fn flown(&self, time: f64) -> f64 {
        if self.internal.is_none() || time <= 0.0 {
            return self.state.flown(self.modes, &self.impactor, time);
        }
        let table = StepResponse::new(self.modes, &self.impactor, time);
        self.flight(&table).map_or(f64::NAN, |(free, _)| free[3])
    }

    /// Takes a step in contact; `None` if the contact has ended already.
    fn step_in_contact(&mut self, left: f64) -> Result<Option<Taken>> {
        loop {
            let table = self.table(left);
            self.solves += 1;
            let stage = self.solve(&table, self.guess(table.step), false);
            if let Some((Stage { iterations, .. }, _)) = stage {
                self.iterations += iterations;
            }
            let level = self.level;
            let worst = self.steps.defect.unwrap_or(f64::INFINITY);
            let straight = self.straight.unwrap_or(f64::INFINITY);
            let stage = stage.filter(|(stage, _)| stage.defect <= worst && stage.bend() <= straight);
            let Some((stage, in_step)) = stage else {
                self.put_back(table);
                self.level += 1;
                if self.level > LEVELS {
                    return Err(Error::Solve("the contact's force is not found at any step".into()));
                }
                continue;
            };
            if self.approach <= 0.0 && stage.approach[0] <= 0.0 {
                self.put_back(table);
                self.end_contact();
                self.grazing = true;
                return Ok(None);
            }
            if let Some(sample) = stage.approach.iter().position(|approach| *approach <= 0.0) {
                if self.begun && self.level < LEVELS {
                    self.put_back(table);
                    self.level += 1;
                    continue;
                }
                let before = if sample == 0 { 0.0 } else { SAMPLE_POINTS[sample - 1] * table.step };
                let (length, table_step) = (SAMPLE_POINTS[sample] * table.step, table.step);
                self.put_back(table);
                let guess = zero(&stage.approach, self.approach, sample) * table_step;
                if let Some(taken) = self.release((before, length), guess) {
                    return Ok(Some(taken));
                }
                self.level += 1;
                if self.level > LEVELS {
                    return Err(Error::Solve("the end of the contact is not found".into()));
                }
                continue;
            }
            let taken = self.take(&table, stage.force, stage.approach, in_step);
            self.put_back(table);
            self.begun = false;
            // The defect is proportional to the cube of the step and the bend to its square: doubling the step multiplies
            // them by eight and by four.
            if self.steps.defect.is_some() && stage.defect < worst / 12.0 && stage.bend() < straight / 6.0 {
                self.level = level.saturating_sub(1);
            }
            return Ok(Some(taken));
        }
    }

    /// Takes the step that ends the contact: δ and the force are zero at its end. Its size is sought roughly between
    /// the times `before` and `length` (s). `None` if it is not found.
    fn release(&mut self, (before, length): (f64, f64), guess: f64) -> Option<Taken> {
        let solved = |motion: &Self, step: f64| {
            let table = StepResponse::new(motion.modes, &motion.impactor, step);
            // Near the end of a contact δ(t) is concave: at the middle of the step at least half of it is left.
            let first = [motion.guess(step)[0].max(0.5 * motion.approach), 0.0];
            let stage = motion.solve(&table, first, true);
            (table, stage)
        };
        let below = |step: f64| match solved(self, step).1 {
            Some((stage, _)) => -stage.approach[3],
            None => f64::NAN,
        };
        // δ at the beginning of the step may itself be zero.
        let low = match self.approach > 0.0 {
            true => 0.0,
            false => Some(before).filter(|before| *before > 0.0 && below(*before) < 0.0)?,
        };
        // A shorter step has a different force, so δ may become zero slightly later than in the longer step.
        let high = [1.0, 1.1, 1.3, 1.7].map(|part| part * length).into_iter().find(|end| below(*end) > 0.0)?;
        let search =
            RootSearch { bracket: [low, high], guess, slope: -self.rate(), change: CONTACT_TIME_CHANGE * length };
        let step = search.root(below);
        let (table, stage) = solved(self, step);
        let (Stage { force, approach, .. }, in_step) = stage?;
        let taken = self.take(&table, force, approach, in_step);
        self.end_contact();
        Some(taken)
    }

    /// Solves for the forces over a step, from a guess of δ at its middle and its end (m). If `held`, the contact force
    /// at the end of the step is zero.
    fn solve(&self, table: &StepResponse, guess: [f64; 2], held: bool) -> Option<(Stage, Option<ForceInStep>)> {
        let contact = |free: [f64; 4]| {
            if self.law.damping > 0.0 {
                return solve_damped(&self.law, table, (self.approach, free), self.force, guess, held);
            }
            ContactStep { law: &self.law, response: table, free, first: self.force, guess, held }.solve()
        };
        let free = table.free(&self.state, self.impactor.gap);
        match &self.internal {
            None => Some((contact(free)?, None)),
            Some(internal) => {
                let with_force = |free: [f64; 4]| contact(free).map(|stage| (stage, stage.force));
                let (stage, in_step) = internal.solve(table, &self.state, free, with_force)?;
                Some((stage, Some(in_step)))
            }
        }
    }

    fn end_contact(&mut self) {
        self.touching = false;
        (self.force, self.last) = (0.0, None);
        self.approach = self.approach.min(0.0);
    }

    /// First guess of δ at the middle and the end of a step, m: linear extrapolation with the present rate.
    fn guess(&self, step: f64) -> [f64; 2] {
        let linear = [0.5, 1.0].map(|tau| self.approach + tau * step * self.rate());
        if self.last.is_none() { linear.map(|x| x.max(0.0)) } else { linear }
    }

    fn take(
        &mut self,
        table: &StepResponse,
        force: [f64; 3],
        approach: [f64; 4],
        in_step: Option<ForceInStep>,
    ) -> Taken {
        table.advance(&mut self.state, self.modes, &self.impactor, force);
        let made = in_step.as_ref().map_or(0.0, |in_step| in_step.made);
        if let (Some(internal), Some(in_step)) = (&mut self.internal, in_step) {
            internal.advance(table, &mut self.state, in_step);
        }
        let all = [self.approach, approach[0], approach[1], approach[2], approach[3]];
        (self.force, self.approach, self.last) = (force[2], approach[3], Some((force, table.step)));
        if self.law.damping > 0.0 && self.touching {
            // A step finds δ̇ at its end from a polynomial. Its error would remain in the first force of the next step, however
            // short that is, so the next step begins with the rate of the state reached.
            self.force = self.law.damped(self.approach, self.rate()).force;
        }
        Taken { step: table.step, force, approach: all, made }
    }
}

/// Error for an internal force that does not converge at any step size.
fn not_followed() -> Error {
    Error::Solve("the forces of the pads are not found at any step".into())
}

/// Estimates where δ becomes zero, as a fraction of the step. `sample` is the first point of [`SAMPLE_POINTS`] at which δ is not
/// positive. The estimate is the zero of the parabola through this value and the two values before it.
fn zero(approach: &[f64; 4], begin: f64, sample: usize) -> f64 {
    let value = |k: usize| if k == 0 { begin } else { approach[k - 1] };
    // The points of [`SAMPLE_POINTS`] are quarters of the step.
    let last = sample + 1;
    let (c, b, a) = (
        value(last),
        value(last - 1),
        if last >= 2 { value(last - 2) } else { return 0.25 * begin / (begin - approach[0]) },
    );
    // In quarters of the step before the last point.
    let (slope, bend) = (0.5 * (4.0 * b - 3.0 * c - a), 0.5 * (a - 2.0 * b + c));
    let back = -2.0 * c / (slope + (slope * slope - 4.0 * bend * c).max(0.0).sqrt());
    0.25 * (last as f64 - back.clamp(0.0, 1.0))
}
