//! One impact on a body in modal coordinates: its linear part exact, contacts begun and ended where they are, steps by the error.
//!
//! A step h resolves frequencies up to a few over h. Faster modes answer the force as springs do, so that no step is unstable:
//! which modes those are goes with the largest step. A run in steps chosen by the error is made twice, in steps of which one's
//! largest is half of the other's, and the difference is the estimate of the error, by the steps and by the modes left out.

mod answer;
mod energy_balance;
mod hit;
mod lift;
mod motion;
mod reading;
mod stage;
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
use super::reading::{Reading, Readout};
use super::step::{Contact, Energy, Motion as ImpactorMotion, Step};
use super::{Count, Errors, ImpactParameters, Plan, TimeIntegration};
use crate::impact::step::at;
use answer::{FreeBody, State};
use energy_balance::{EnergyBalance, Vibration, coordinates};
use hit::HitTension;
use motion::Motion;
pub use motion::Steps;
use reading::{FacesOfSteps, Reader};
pub use trace::Trace;

/// Modes up to this over the largest step take part in the motion.
const RESOLVED: f64 = 3.0;

/// Largest step, as a part of the contact time on a half-space, for an error of 1; it goes with the third root of the error.
const FIRST: f64 = 0.15;

/// First guess of the peak force, as a part of that on a half-space.
const OF_HALF_SPACE: f64 = 0.3;

/// Errors over the difference from steps twice as long, and from steps half as long. The force has an order of 3 at least (3.7 was measured over
/// three contacts). The largest tension is that of the steps, and lies between two of them: of order 2.
const OF_FORCE: f64 = 1.0 / 7.0;
const OF_FORCE_BY_HALVES: f64 = 8.0 / 7.0;
const OF_TENSION: f64 = 1.0 / 3.0;
const OF_TENSION_BY_HALVES: f64 = 4.0 / 3.0;

/// Halvings of the largest step at most.
const REFINEMENTS: usize = 14;

/// Part of the tolerance that the steps may take.
pub const OF_STEPS: f64 = 0.3;

/// Steps between two questions whether to go on.
const ASK_EVERY: usize = 1024;

/// Steps of one run at most.
const MOST_STEPS: usize = 10_000_000;

/// An impact on a modal body, which it owns or borrows.
pub struct ModalImpact<B> {
    body: B,
    parameters: ImpactParameters,
    end: f64,
    /// Given step, s.
    step: Option<f64>,
    initial: Initial,
    tolerance: f64,
    measure: Measure,
    contact_time: f64,
    gate: Gate,
    has_energies: bool,
    readout: Option<Readout>,
    /// The force of the last run, and its steps.
    last: Option<(Trace, Steps)>,
    /// What the runs have cost so far.
    pub count: Count,
}

/// A run that is done.
struct Done {
    trace: Trace,
    steps: Vec<Observed>,
    sizes: Steps,
    /// What is still to be read of the steps.
    faces: Option<FacesOfSteps>,
}

impl<B: Borrow<ModalBody>> ModalImpact<B> {
    /// An impactor and the times of a scene, on a body.
    pub fn new(scene: &Scene, body: B) -> Self {
        let impactor = &scene.impactor;
        Self {
            parameters: parameters(impactor, body.borrow()),
            body,
            end: scene.time.end,
            step: scene.time.step,
            initial: scene.time.initial,
            tolerance: OF_STEPS * scene.tolerance,
            measure: scene.measure,
            contact_time: impactor.contact_time(),
            gate: Gate::new(scene),
            has_energies: true,
            readout: None,
            last: None,
            count: Count::default(),
        }
    }

    /// Impactor and contact.
    pub fn parameters(&self) -> &ImpactParameters {
        &self.parameters
    }

    /// Runs before a closure, as [`TimeIntegration::run_watched`].
    ///
    /// # Errors
    /// As there.
    pub fn run(&mut self, mut observe: impl FnMut(&Step) -> Result<ControlFlow<()>>) -> Result<ControlFlow<()>> {
        self.observed(&mut observe)
    }

    /// All steps are there before the first is told: those up to an interruption are told to their end.
    fn observed(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        let Done { trace, mut steps, sizes, faces } = self.done(true, observer)?;
        self.last = Some((trace, sizes));
        if let (Some(faces), Some(readout)) = (faces, &self.readout) {
            faces.read(readout, &mut steps);
        }
        let mut flow = ControlFlow::Continue(());
        for step in &steps {
            if self.gate.tell(step, observer)?.is_break() {
                flow = ControlFlow::Break(());
            }
        }
        Ok(flow)
    }

    /// Leaves the energies of the steps at zero, which take a good part of the time, but where the scene has an energy gate.
    #[must_use]
    pub fn without_energies(self) -> Self {
        Self { has_energies: self.gate.is_set(), ..self }
    }

    /// The force of the last run, with the steps it took.
    pub fn force(&self) -> Option<&(Trace, Steps)> {
        self.last.as_ref()
    }

    /// The force alone, in the given steps or those of the scene; with the steps it took.
    ///
    /// # Errors
    /// As [`ModalImpact::run`].
    pub fn trace(&mut self, steps: Option<Steps>) -> Result<(Trace, Steps)> {
        self.trace_watched(steps, &mut |_: &Step| Ok(ControlFlow::Continue(())))
    }

    /// The same before somebody who may break it off: then the force is that up to there.
    ///
    /// # Errors
    /// As [`ModalImpact::run`].
    pub fn trace_watched(&mut self, steps: Option<Steps>, observer: &mut dyn Observer) -> Result<(Trace, Steps)> {
        let done = match steps {
            Some(steps) => self.once(steps, false, observer)?,
            None => self.done(false, observer)?,
        };
        Ok((done.trace, done.sizes))
    }

    /// A run in the scene's steps; with them as observers see them, or with the force alone.
    fn done(&mut self, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        match self.step {
            Some(step) => {
                let guess = Steps { largest: step, defect: None, peak: self.guess() };
                let done = self.once(guess, observed, observer)?;
                let peak = done.trace.peak();
                // A contact that is harder than thought is stiffer, too.
                if peak <= guess.peak {
                    Ok(done)
                } else {
                    self.once(Steps { peak: 1.1 * peak, ..guess }, observed, observer)
                }
            }
            None => self.controlled(observed, observer),
        }
    }

    /// A force that a contact may reach, N.
    fn guess(&self) -> f64 {
        OF_HALF_SPACE * self.parameters.hardest()
    }

    /// Halves the steps until the tolerance is met in the first contact.
    fn controlled(&mut self, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        let contact = self.contact_time;
        let resolving = RESOLVED / self.body.borrow().stiffened();
        let mut largest = (2.0 * FIRST * self.tolerance.cbrt() * contact).min(0.5 * self.end).min(resolving);
        // What a step may be off by goes with its length as the error does.
        let defect = |largest: f64, peak: f64| peak * (largest / (FIRST * contact)).powi(3).min(0.1);
        let guess = self.guess();
        let coarse = Steps { largest, defect: Some(defect(largest, guess)), peak: guess };
        let mut coarse = self.once(coarse, false, observer)?;
        // The first run is no more than a measure. A later one counts as soon as a finer one shows that its steps are short enough: twice the step
        // may be too long for the order of convergence. Observers see the second run, which counts as a rule, and of others only the one that does.
        // (Trials, which nobody observes, keep the finer steps and are compared between their nodes, too: bases and cells are judged by such differences.)
        for refinement in 0..REFINEMENTS {
            largest *= 0.5;
            let peak = coarse.trace.peak();
            let peak = if peak > 0.0 { peak } else { guess };
            let steps = Steps { largest, defect: Some(defect(largest, peak)), peak: 1.1 * peak };
            let fine = self.once(steps, observed && refinement == 0, observer)?;
            let difference = match observed {
                true => fine.trace.difference_at_steps(&coarse.trace),
                false => fine.trace.difference(&coarse.trace),
            };
            let by_halves = errors(difference, OF_FORCE_BY_HALVES, OF_TENSION_BY_HALVES);
            let by_doubles = errors(difference, OF_FORCE, OF_TENSION);
            let is_met = |error: &Errors| error.of(self.measure) <= self.tolerance;
            if observed && refinement > 0 && is_met(&by_halves) && !observer.is_interrupted() {
                self.count_errors(by_halves);
                return if refinement > 1 { self.once(coarse.sizes, true, observer) } else { Ok(coarse) };
            }
            if is_met(&by_doubles) || observer.is_interrupted() {
                self.count_errors(by_doubles);
                return if observed && refinement > 0 { self.once(fine.sizes, true, observer) } else { Ok(fine) };
            }
            coarse = fine;
        }
        Err(Error::Solve(format!(
            "steps below {largest:.1e} s do not bring the error under accuracy.tolerance = {:e}",
            self.tolerance
        )))
    }

    fn count_errors(&mut self, error: Errors) {
        self.count.error = Some(error.history);
        self.count.stress_error = Some(error.stress).filter(|error| !error.is_nan());
    }

    /// The modes that move in some steps.
    ///
    /// # Errors
    /// As [`ModalBody::modes`].
    pub fn modes(&self, steps: &Steps) -> Result<Rc<Modes>> {
        let Law { force_law, compliance, .. } = &self.parameters.law;
        let tangent = force_law.steepest(force_law.indentation(steps.peak));
        // Rounded down, so that impacts whose tolerances differ by little move in the same modes.
        let accuracy = self.tolerance.log2().floor().exp2();
        let closed = Closed { tangent, compliance: *compliance, mass: self.parameters.mass, accuracy, end: self.end };
        let body: &ModalBody = self.body.borrow();
        let resolved = RESOLVED / steps.largest;
        match steps.defect {
            Some(_) => body.modes_of_chosen_steps(body.faster() * resolved, &closed),
            None => body.modes(resolved, &closed),
        }
    }

    /// One run; with the steps as observers see them, or with the force alone.
    fn once(&mut self, steps: Steps, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        let (parameters, modes) = (self.parameters.clone(), self.modes(&steps)?);
        // The springs of the modes left out are in the law.
        let law = Law { compliance: parameters.law.compliance - modes.residual, ..parameters.law.clone() };
        let ImpactParameters { mass, speed, gap, weight, .. } = parameters;
        let state = match self.initial {
            Initial::Rest => State::start(&modes, speed),
            Initial::Equilibrium => {
                modes.require_equilibrium()?;
                State::equilibrium(&modes, speed)
            }
        };
        // The gap is that to the surface as the loads leave it.
        let gap = gap - state.surface(&modes);
        let impactor = FreeBody { mass, gravity: weight / mass, speed, gap };
        let mut motion = Motion::new(&modes, law.clone(), impactor, steps, state);
        let of_hit = HitTension::new(&modes, parameters.copies);
        let mut done = Done { trace: Trace::default(), steps: Vec::new(), sizes: steps, faces: None };
        let mut energy_balance = (self.has_energies && observed).then(EnergyBalance::default);
        let mut reader = self.readout.as_ref().filter(|_| observed).map(|readout| Reader::new(readout, &modes));
        let mut see = |number: usize, motion: &Motion, energy_balance: Option<&mut EnergyBalance>| {
            let with_energy = energy_balance.map(|balance| (balance, coordinates(&modes, &motion.state)));
            let places = with_energy.as_ref().map(|(_, (places, _))| places.clone());
            let step = seen(number, motion, (&modes, &parameters), with_energy);
            let read = |reader: &mut Reader| reader.read(&step, motion, places);
            let reading = reader.as_mut().map_or_else(Reading::default, read);
            Observed { step, reading }
        };
        if observed {
            done.steps.push(see(0, &motion, energy_balance.as_mut()));
        }
        let mut number = 0;
        // What is left but for rounding is nothing.
        while self.end - motion.state.time > 1e-12 * self.end {
            number += 1;
            let before = energy_balance.as_ref().map(|_| law.potential(motion.approach));
            let taken = motion.advance(self.end).map_err(|error| at(error, number, motion.state.time))?;
            let time = motion.state.time;
            let shown = motion.approach - modes.residual * motion.force;
            // Bodies that are apart are within any law.
            if shown > 0.0 {
                let rate = motion.rate() - modes.residual * motion.rise();
                parameters.admit(shown, rate).map_err(|error| at(error, number, time))?;
            }
            if number > MOST_STEPS {
                return Err(Error::Solve(format!("more than {MOST_STEPS} steps up to t = {time:.6e} s")));
            }
            if number % ASK_EVERY == 0 && observer.is_interrupted() {
                break;
            }
            done.trace.push(time - taken.step, taken.step, taken.force);
            if let Some(tension) = of_hit.as_ref().filter(|_| time <= done.trace.needs_tension_until()) {
                done.trace.push_tension(time, tension.at(&motion));
            }
            if observed {
                if let (Some(energy_balance), Some(before)) = (&mut energy_balance, before) {
                    energy_balance.account(&taken, &law, law.potential(motion.approach) - before);
                }
                done.steps.push(see(number, &motion, energy_balance.as_mut()));
            }
        }
        self.count.solves += motion.solves;
        self.count.iterations += motion.iterations;
        done.faces = reader.and_then(Reader::finish);
        Ok(done)
    }
}

impl<B: Borrow<ModalBody>> TimeIntegration for ModalImpact<B> {
    fn plan(&self) -> Option<Plan> {
        self.step.map(|step| Plan::Equal { step })
    }

    /// Not known: a contact begins and ends between the steps of a size.
    fn steps(&self) -> Option<usize> {
        None
    }

    fn count(&self) -> Count {
        self.count
    }

    fn nodes(&self) -> Option<&[Vec3]> {
        None
    }

    fn set_readout(&mut self, readout: Readout) -> Result<()> {
        self.readout = Some(readout);
        Ok(())
    }

    /// Has no checkpoints: it is done anew.
    fn resume(&mut self, _: &Checkpoint) -> Result<()> {
        Ok(())
    }

    fn run_watched(&mut self, observer: &mut dyn Observer) -> Result<ControlFlow<()>> {
        self.observed(observer)
    }
}

/// The errors of a run, as parts of its difference from another one.
fn errors(difference: Errors, of_force: f64, of_tension: f64) -> Errors {
    Errors { stress: of_tension * difference.stress, ..of_force * difference }
}

fn parameters(impactor: &Impactor, body: &ModalBody) -> ImpactParameters {
    ImpactParameters::of(impactor, body.copies, body.compliance)
}

/// The moment as observers see it.
fn seen(
    number: usize,
    motion: &Motion,
    (modes, parameters): (&Modes, &ImpactParameters),
    energy_balance: Option<(&mut EnergyBalance, Vibration)>,
) -> Step {
    let (state, force) = (&motion.state, motion.force);
    let approach = motion.approach - modes.residual * force;
    // δ = δ_modes − r F.
    let law = motion.law();
    Step {
        number,
        time: state.time,
        impactor: ImpactorMotion {
            position: state.impactor[0],
            velocity: state.impactor[1],
            acceleration: force / parameters.mass,
        },
        contact: Contact {
            force: parameters.copies * force,
            indentation: law.indentation(motion.approach, force),
            surface_displacement: state.surface(modes) + modes.residual * force + state.settled * modes.rest,
            approach,
            rate: motion.rate() - modes.residual * motion.rise(),
        },
        energy: energy_balance.map_or(Energy::default(), |(energy_balance, vibration)| {
            let potential = law.potential(motion.approach) - 0.5 * modes.residual * force * force;
            energy_balance.energy((modes, parameters), state, &vibration, (force, potential, motion.absent_energy()))
        }),
    }
}
