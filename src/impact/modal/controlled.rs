//! Error control of an impact in modal coordinates: the time steps are halved until the contact force changes by less
//! than the tolerance.

use std::borrow::Borrow;

use crate::body::ModalBody;
use crate::error::{Error, Result};

use super::{Done, LARGEST_PHASE_PER_STEP, ModalImpact, Steps, Trace};
use crate::impact::Errors;
use crate::impact::observer::Observer;

/// Largest step for a tolerance of 1, relative to the contact time on a half-space. The step is proportional to the
/// cube root of the tolerance.
const FIRST_STEP_FACTOR: f64 = 0.15;

/// Ratios of the error to the difference from a run with steps twice as long, and from a run with steps half as long.
/// For the force they assume order 3 (measured over three contacts: 3.7). For the tension they assume order 2, since
/// its largest value is read at the steps while the true maximum lies between two of them.
const FORCE_ERROR_FACTOR: f64 = 1.0 / 7.0;
const FORCE_ERROR_FACTOR_BY_HALVES: f64 = 8.0 / 7.0;
const TENSION_ERROR_FACTOR: f64 = 1.0 / 3.0;
const TENSION_ERROR_FACTOR_BY_HALVES: f64 = 4.0 / 3.0;

/// Largest number of halvings of the largest step.
const REFINEMENTS: usize = 14;

/// Least number of steps in which the motion of a body without a contact is read.
const STEPS_WITHOUT_CONTACT: f64 = 1000.0;

/// Contact force of a run, and its time steps.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct KnownForce {
    /// The force.
    pub trace: Trace,
    /// Time steps of the run.
    pub steps: Steps,
}

impl<B: Borrow<ModalBody>> ModalImpact<B> {
    /// Sets contact forces that were computed before ([`Self::take_known`]), which error control need not compute
    /// again. They must be of the same scene and body: only the steps are compared.
    #[must_use]
    pub fn with_known(self, known: Vec<KnownForce>) -> Self {
        Self { known, ..self }
    }

    /// Returns the contact forces in all time steps that error control tried in [`Self::trace`].
    pub fn take_known(&mut self) -> Vec<KnownForce> {
        std::mem::take(&mut self.known)
    }

    /// Halves the time steps until the tolerance is met in the first contact.
    pub(super) fn controlled(&mut self, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        let contact = self.parameters.contact_time;
        let resolving = LARGEST_PHASE_PER_STEP / self.body.borrow().stiffened();
        let mut largest =
            (2.0 * FIRST_STEP_FACTOR * self.tolerance.cbrt() * contact).min(0.5 * self.end).min(resolving);
        // The allowed defect within a step is proportional to the cube of the step size, as the error is.
        let defect = |largest: f64, peak: f64| peak * (largest / (FIRST_STEP_FACTOR * contact)).powi(3).min(0.1);
        let guess = self.guess();
        let coarse = Steps { largest, defect: Some(defect(largest, guess)), peak: guess };
        let mut coarse = self.known_or_once(coarse, false, observer)?;
        // Without a contact the motion is exact in steps of any length. They need to be short only for reading.
        let to_read = Steps { largest: largest.min(self.end / STEPS_WITHOUT_CONTACT), ..coarse.sizes };
        if let Some(done) = self.moved_by_loads(&coarse, to_read, observed, observer)? {
            return Ok(done);
        }
        // The first run only serves for comparison. A later run is accepted as the coarser one as soon as a finer run
        // shows that its steps are short enough, because a doubled step may be too long for the assumed order of
        // convergence. Observers receive the second run, unless its force is known already; it is accepted in most
        // cases. Of the other runs, only the accepted one is repeated for them.
        // (Trial runs have no observer. They return the finer run and are also compared between the steps, because
        // their differences are used to estimate the errors of bases and cells.)
        for refinement in 0..REFINEMENTS {
            largest *= 0.5;
            let peak = coarse.trace.peak();
            let peak = if peak > 0.0 { peak } else { guess };
            let steps = Steps { largest, defect: Some(defect(largest, peak)), peak: 1.1 * peak };
            let fine = self.known_or_once(steps, observed && refinement == 0, observer)?;
            let difference = match observed {
                true => fine.trace.difference_at_steps(&coarse.trace),
                false => fine.trace.difference(&coarse.trace),
            };
            let by_halves = errors(difference, FORCE_ERROR_FACTOR_BY_HALVES, TENSION_ERROR_FACTOR_BY_HALVES);
            let by_doubles = errors(difference, FORCE_ERROR_FACTOR, TENSION_ERROR_FACTOR);
            let is_met = |error: &Errors| error.of(self.measure) <= self.tolerance;
            if observed && refinement > 0 && is_met(&by_halves) && !observer.is_interrupted() {
                self.count_errors(by_halves, &coarse.trace);
                return self.shown(coarse, observer);
            }
            if is_met(&by_doubles) || observer.is_interrupted() {
                self.count_errors(by_doubles, &fine.trace);
                return if observed { self.shown(fine, observer) } else { Ok(fine) };
            }
            coarse = fine;
        }
        Err(Error::Solve(format!(
            "the error of the time steps stays above {:.1e}, their share of the tolerance, even with steps of {largest:.1e} s",
            self.tolerance
        )))
    }

    /// Returns the run in given time steps with its force alone, if the force is known; otherwise computes it as
    /// [`Self::once`] does.
    fn known_or_once(&mut self, steps: Steps, observed: bool, observer: &mut dyn Observer) -> Result<Done> {
        if let Some(KnownForce { trace, steps }) = self.known.iter().find(|known| known.steps == steps) {
            return Ok(Done { trace: trace.clone(), sizes: *steps, steps: Vec::new(), faces: None });
        }
        let done = self.once(steps, observed, observer)?;
        if !observed {
            self.known.push(KnownForce { trace: done.trace.clone(), steps });
        }
        Ok(done)
    }

    /// Returns an accepted run with the steps for observers, for which it is repeated unless it has them.
    fn shown(&mut self, done: Done, observer: &mut dyn Observer) -> Result<Done> {
        if done.steps.is_empty() { self.once(done.sizes, true, observer) } else { Ok(done) }
    }

    fn count_errors(&mut self, error: Errors, trace: &Trace) {
        // Without a contact there is nothing to estimate.
        self.count.error = Some(error.history).filter(|_| trace.has_contact());
        let known = |error: f64| Some(error).filter(|error| !error.is_nan());
        self.count.stress_error = known(error.stress);
        self.count.stress_history_error = known(error.stress_history);
        self.count.deflection_error = Some(error.deflection).filter(|error| !error.is_nan());
    }

    /// Repeats a run without a contact with all modes if loads move the body: the modes that the steps do not resolve
    /// respond to the contact force alone. `None` if there are no loads, or if there is a contact.
    pub(super) fn moved_by_loads(
        &mut self,
        done: &Done,
        steps: Steps,
        observed: bool,
        observer: &mut dyn Observer,
    ) -> Result<Option<Done>> {
        if done.trace.has_contact() || !self.body.borrow().is_loaded() {
            return Ok(None);
        }
        self.takes_all_modes = true;
        let done = self.once(steps, observed, observer);
        self.takes_all_modes = false;
        Ok(Some(done?).filter(|done| !done.trace.has_contact()))
    }
}

/// Errors of a run, as fractions of its difference from another run.
fn errors(difference: Errors, of_force: f64, of_tension: f64) -> Errors {
    let Errors { stress, stress_history, .. } = of_tension * difference;
    Errors { stress, stress_history, ..of_force * difference }
}
