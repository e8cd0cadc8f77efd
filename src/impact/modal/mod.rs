//! An impact on a body in modal coordinates: exact linear propagation, located beginnings and ends of contacts, error
//! control.
//!
//! A step h resolves frequencies up to a few over h. Faster modes respond to the force quasi-statically, as springs, so
//! every step size is stable. The largest step therefore decides which modes move. A run with error control is computed
//! at least twice, with largest steps that differ by a factor of two. The difference estimates the error of the steps
//! and of the modes left out.

mod controlled;
mod energy_balance;
mod hit;
mod internal_force;
mod motion;
mod reading;
mod recorder;
mod stage;
mod step_response;
mod trace;

use std::borrow::Borrow;
use std::ops::ControlFlow;
use std::rc::Rc;

use crate::body::{Closed, ModalBody, Modes};
use crate::contact::Law;
use crate::error::{Error, Result};
use crate::scene::{Impactor, Initial, Measure, Scene, Vec3};

use super::checkpoint::Checkpoint;
use super::gate::Gate;
use super::observer::{Observed, Observer};
use super::reading::Readout;
use super::step::Step;
use super::{Count, ImpactParameters, Plan, TimeIntegration};
use crate::impact::step::at;
pub use controlled::KnownForce;
use hit::{HitTension, WatchedStresses};
use motion::Motion;
pub use motion::Steps;
use reading::{FacesOfSteps, FacesReading};
use recorder::Recorder;
use step_response::{FreeBody, State};
pub use trace::Trace;

/// Largest ω h of a mode that takes part in the motion, where h is the largest step.
const LARGEST_PHASE_PER_STEP: f64 = 3.0;

/// First guess of the peak force, relative to the peak force on a half-space.
const FIRST_PEAK_FACTOR: f64 = 0.3;

/// Share of the tolerance that the time steps may use.
pub const TIME_STEP_SHARE: f64 = 0.3;

/// Largest difference between the force and a straight line between two recorded steps, relative to the peak and to the
/// tolerance of the time steps.
const STRAIGHT_SHARE: f64 = 1.0 / 3.0;

/// Number of steps that are computed, or read, between two calls of [`Observer::is_interrupted`].
const ASK_EVERY: usize = 1024;

/// Largest number of steps of one run.
const MOST_STEPS: usize = 10_000_000;

/// An impact on a modal body; the body is owned or borrowed.
pub struct ModalImpact<B> {
    body: B,
    parameters: ImpactParameters,
    end: f64,
    /// Step size of the scene, s; `None` for steps with error control.
    step: Option<f64>,
    initial: Initial,
    tolerance: f64,
    measure: Measure,
    gate: Gate,
    has_energies: bool,
    readout: Option<Readout>,
    /// Contact force of the last run, and its time steps.
    last: Option<(Trace, Steps)>,
    /// Contact forces of the same scene and body that are known already.
    known: Vec<KnownForce>,
    /// Whether all modes take part, in a run without a contact.
    takes_all_modes: bool,
    /// Cost of the runs so far.
    pub count: Count,
}

/// Result of a run.
struct Done {
    trace: Trace,
    steps: Vec<Observed>,
    sizes: Steps,
    /// Data of all steps from which the stresses on the faces are still to be evaluated.
    faces: Option<FacesOfSteps>,
}

impl<B: Borrow<ModalBody>> ModalImpact<B> {
    /// Sets up the impactor and the times of a scene with a body.
    pub fn new(scene: &Scene, body: B) -> Self {
        let impactor = &scene.impactor;
        Self {
            parameters: parameters(impactor, body.borrow()),
            body,
            end: scene.time.end,
            step: scene.time.step,
            initial: scene.time.initial,
            tolerance: TIME_STEP_SHARE * scene.tolerance,
            measure: scene.measure,
            gate: Gate::new(scene),
            has_energies: true,
            readout: None,
            last: None,
            known: Vec::new(),
            takes_all_modes: false,
            count: Count::default(),
        }
    }

    /// Parameters of impactor and contact.
    pub fn parameters(&self) -> &ImpactParameters {
        &self.parameters
    }

    /// Runs with a closure as the observer; see [`TimeIntegration::run_watched`].
    ///
    /// # Errors
    /// Same as [`TimeIntegration::run_watched`].
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        self.run_watched(&mut observe)
    }

    /// Reads the tensions on the faces in the steps. An interruption leaves the steps that have been read; after an
    /// interruption of the computation, all computed steps are read. Every rank calls this, because the ranks agree on
    /// interruptions; one of them has the faces.
    fn read_faces(&self, faces: Option<&FacesOfSteps>, steps: &mut Vec<Observed>, observer: &mut dyn Observer) {
        let Some(readout) = self.readout.as_ref().filter(|readout| readout.faces.is_some()) else { return };
        let mut reading = faces.and_then(|faces| FacesReading::new(faces, readout, steps.len()));
        let (mut read, was_interrupted) = (0, steps.len() > ASK_EVERY && observer.is_interrupted());
        while read < steps.len() {
            if read > 0 && !was_interrupted && observer.is_interrupted() {
                steps.truncate(read);
                break;
            }
            let end = steps.len().min(read + ASK_EVERY);
            if let Some(reading) = &mut reading {
                reading.read(&mut steps[read..end]);
            }
            read = end;
        }
        if let (Some(reading), Some(last)) = (reading, steps.last_mut()) {
            last.reading.map = reading.map;
        }
    }

    /// Leaves the energies of the steps at zero, since they take a large part of the computing time; no effect if the
    /// scene has an energy gate.
    #[must_use]
    pub fn without_energies(self) -> Self {
        Self { has_energies: self.gate.is_set(), ..self }
    }

    /// Computes only the contact force, in the given time steps or those of the scene; returns it with the time steps
    /// used.
    ///
    /// # Errors
    /// Same as [`ModalImpact::run`].
    pub fn trace(&mut self, steps: Option<Steps>) -> Result<(Trace, Steps)> {
        self.trace_watched(steps, &mut |_: &Step| Ok(ControlFlow::Continue(())))
    }

    /// Same as [`Self::trace`] with an observer that may interrupt the run; the force then ends at the interruption.
    ///
    /// # Errors
    /// Same as [`ModalImpact::run`].
    pub fn trace_watched(&mut self, steps: Option<Steps>, observer: &mut dyn Observer) -> Result<(Trace, Steps)> {
        let done = match steps {
            Some(steps) => self.once(steps, false, observer)?,
            None => self.done(false, observer)?,
        };
        Ok((done.trace, done.sizes))
    }

    /// Runs in the time steps of the scene. If `observed`, the steps are stored for observers; otherwise only the
    /// force.
    fn done(&mut self, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        match self.step {
            Some(step) => {
                let guess = Steps { largest: step, defect: None, peak: self.guess() };
                let done = self.once(guess, observed, observer)?;
                if let Some(done) = self.moved_by_loads(&done, guess, observed, observer)? {
                    return Ok(done);
                }
                let peak = done.trace.peak();
                // A larger force than expected means a stiffer contact, which needs other modes.
                if peak <= guess.peak {
                    Ok(done)
                } else {
                    self.once(Steps { peak: 1.1 * peak, ..guess }, observed, observer)
                }
            }
            None => self.controlled(observed, observer),
        }
    }

    /// First guess of the peak force, N.
    fn guess(&self) -> f64 {
        FIRST_PEAK_FACTOR * self.parameters.force_bound()
    }

    /// Returns the modes that take part in the motion for given time steps.
    ///
    /// # Errors
    /// Same as [`ModalBody::modes`].
    pub fn modes(&self, steps: &Steps) -> Result<Rc<Modes>> {
        let Law { force_law, compliance, .. } = &self.parameters.law;
        let tangent = force_law.steepest(force_law.indentation(steps.peak));
        // Rounded down to a power of two, so that impacts with slightly different tolerances use the same modes.
        let accuracy = self.tolerance.log2().floor().exp2();
        let closed = Closed { tangent, compliance: *compliance, mass: self.parameters.mass, accuracy, end: self.end };
        let body: &ModalBody = self.body.borrow();
        let resolved = LARGEST_PHASE_PER_STEP / steps.largest;
        match steps.defect {
            _ if self.takes_all_modes => body.all_modes(&closed),
            Some(_) => body.modes_of_chosen_steps(body.cutoff_ratio() * resolved, &closed),
            None => body.modes(resolved, &closed),
        }
    }

    /// Computes one run in given time steps. If `observed`, the steps are stored for observers; otherwise only the
    /// force.
    fn once(&mut self, steps: Steps, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        let (parameters, modes) = (self.parameters.clone(), self.modes(&steps)?);
        // The compliance of the modes left out is part of the contact law.
        let law = Law { compliance: parameters.law.compliance - modes.residual, ..parameters.law.clone() };
        let ImpactParameters { mass, speed, gap, weight, .. } = parameters;
        let state = match self.initial {
            Initial::Rest => State::start(&modes, speed),
            Initial::Equilibrium => {
                modes.require_equilibrium()?;
                State::equilibrium(&modes, speed)
            }
        };
        // The gap is measured from the surface as displaced by the loads.
        let gap = gap - state.surface(&modes);
        let impactor = FreeBody { mass, gravity: weight / mass, speed, gap };
        // Readers of the rows draw straight lines between them.
        let straight = steps.defect.filter(|_| observed).map(|_| STRAIGHT_SHARE * self.tolerance * steps.peak);
        let mut motion = Motion::new(&modes, law.clone(), impactor, steps, state).with_straight_steps(straight);
        let of_hit = HitTension::new(&modes, parameters.multiplicity);
        let mut done = Done { trace: Trace::default(), steps: Vec::new(), sizes: steps, faces: None };
        let mut recorder =
            observed.then(|| Recorder::new(&modes, &parameters, self.has_energies, self.readout.as_ref()));
        if let Some(recorder) = &mut recorder {
            recorder.record(0, &motion);
        }
        let deflection = |motion: &Motion| {
            let surface = motion.state.impactor[0] - gap - motion.approach;
            surface + modes.residual * motion.force + motion.state.settled * modes.rest
        };
        done.trace.push_deflection(0.0, deflection(&motion), 0.0);
        let mut watched = WatchedStresses::new(&modes, parameters.multiplicity, self.end);
        if let Some(watched) = &mut watched {
            watched.read(&motion, &mut done.trace);
        }
        let mut number = 0;
        // A remaining time within rounding of the end counts as zero.
        while self.end - motion.state.time > 1e-12 * self.end {
            number += 1;
            let before = motion.approach;
            let taken = motion.advance(self.end).map_err(|error| at(error, number, motion.state.time))?;
            let time = motion.state.time;
            let shown = motion.approach - modes.residual * motion.force;
            // While the bodies are apart, the law is always valid.
            if shown > 0.0 || motion.force > 0.0 {
                let rate = motion.rate() - modes.residual * motion.rise();
                parameters.admit(shown, rate, motion.force).map_err(|error| at(error, number, time))?;
            }
            if number > MOST_STEPS {
                return Err(Error::Solve(format!("more than {MOST_STEPS} steps up to t = {time:.6e} s")));
            }
            if number % ASK_EVERY == 0 && observer.is_interrupted() {
                break;
            }
            done.trace.push(time - taken.step, taken.step, taken.force);
            done.trace.push_deflection(time, deflection(&motion), motion.state.impactor[0]);
            if let Some(tension) = of_hit.as_ref().filter(|_| time <= done.trace.needs_tension_until()) {
                done.trace.push_tension(time, tension.at(&motion));
            }
            if let Some(watched) = &mut watched {
                watched.read(&motion, &mut done.trace);
            }
            if let Some(recorder) = &mut recorder {
                recorder.account(&taken, &motion, before);
                recorder.record(number, &motion);
            }
        }
        if let Some(watched) = &mut watched {
            watched.finish(&mut done.trace);
        }
        self.count.solves += motion.solves;
        self.count.iterations += motion.iterations;
        if let Some(recorder) = recorder {
            (done.steps, done.faces) = recorder.finish();
        }
        Ok(done)
    }
}

impl<B: Borrow<ModalBody>> TimeIntegration for ModalImpact<B> {
    fn plan(&self) -> Option<Plan> {
        self.step.map(|step| Plan::Equal { step })
    }

    /// Always `None`: a contact begins and ends between the regular steps, which adds steps.
    fn steps(&self) -> Option<usize> {
        None
    }

    fn count(&self) -> Count {
        self.count
    }

    fn force(&self) -> Option<&(Trace, Steps)> {
        self.last.as_ref()
    }

    fn nodes(&self) -> Option<&[Vec3]> {
        None
    }

    fn set_readout(&mut self, readout: Readout) -> Result<()> {
        self.readout = Some(readout);
        Ok(())
    }

    /// Does nothing: a modal run has no checkpoints and starts from the beginning.
    fn resume(&mut self, _: &Checkpoint) -> Result<()> {
        Ok(())
    }

    /// All steps are computed before the first is passed on. After an interruption or a break of the observer, all steps
    /// computed and read so far are still passed on.
    fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let Done { trace, mut steps, sizes, faces } = self.done(true, observer)?;
        self.last = Some((trace, sizes));
        self.read_faces(faces.as_ref(), &mut steps, observer);
        let mut flow = ControlFlow::Continue(());
        for step in &steps {
            if self.gate.tell(step, observer)?.is_break() {
                flow = ControlFlow::Break(());
            }
        }
        Ok(flow)
    }
}

fn parameters(impactor: &Impactor, body: &ModalBody) -> ImpactParameters {
    ImpactParameters::of(impactor, body.multiplicity, (body.compliance, body.footprint))
}
