//! Computes a member of a sweep.

use std::rc::Rc;

use petsc_wrap::Comm;

use super::bodies::Bodies;
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{ErrorEstimate, Probe, Reading, Steps, Trace, Until};
use crate::model::{Simulation, watch};
use crate::record::episodes::Episodes;
use crate::record::stress::{LargestTension, strengths};
use crate::scene::Scene;

/// Results of an impact simulation in addition to its steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Computed {
    /// Estimated error of the acceleration history over its peak; NaN if there is no estimate.
    pub error_estimate: f64,
    /// Estimated error in the first contact over the peak, as far as it is known before the first step.
    pub first_error: f64,
    /// Estimated error of the deflection under the impactor over its largest value; NaN if there is no estimate.
    pub deflection_error: f64,
    /// Largest deflection under the impactor over the thickness; NaN if it is not known.
    pub deflection_over_thickness: f64,
    /// Number of unknowns, including the impactor's.
    pub unknowns: usize,
    /// Largest tension on all faces.
    pub tension: LargestTension,
}

/// Computes the impact of a scene to its end, on a stored body if there is one. `observe` is called with each accepted
/// step and the readings of the scene's probes. `interrupted` is asked at intervals whether to stop, and must not
/// revoke a stop; the result is then `None`. Collective on `comm`.
///
/// # Errors
/// Same as a run: a fault of the scene, a step that is not solved, the energy gate, or a failed PETSc call.
pub fn simulate(
    comm: &Comm,
    (index, scene): (usize, &Scene),
    bodies: &mut Bodies<'_>,
    interrupted: Rc<dyn Fn() -> bool>,
    mut observe: impl FnMut(&Step, &[Probe]),
) -> Result<Option<Computed>> {
    // Shared bodies have no probes or fields.
    let computed = if scene.time.modal && !scene.output.has_points() {
        bodies.simulate(index, scene, &interrupted, &mut |step| observe(step, &[]))
    } else {
        let watch = watch::Until(comm, &*interrupted);
        let named = &bodies.named(scene.clone());
        let simulation = bodies.make(scene, &watch).and_then(|model| Simulation::new(named, model));
        simulation.and_then(|mut simulation| run(named, &mut simulation, &*interrupted, None, observe))
    };
    if let Err(Error::Interrupted) = computed { Ok(None) } else { computed }
}

/// Estimates the error of a model from the contact force of an impact and its time steps.
pub(super) type Judge<'a> = &'a mut dyn FnMut(&(Trace, Steps)) -> Result<ErrorEstimate>;

/// Computes the impact of a member to its end. A `judge` replaces the estimated error of the model.
pub(super) fn run(
    scene: &Scene,
    simulation: &mut Simulation,
    interrupted: &dyn Fn() -> bool,
    judge: Option<Judge<'_>>,
    mut observe: impl FnMut(&Step, &[Probe]),
) -> Result<Option<Computed>> {
    let linearity = simulation.linearity();
    let (mut tension, strengths) = (LargestTension::default(), strengths(&scene.strength, simulation.faces()));
    let (mut contacts, mut deflection_over_thickness) = (Episodes::default(), f64::NAN);
    let take = |step: &Step, reading: &Reading| {
        if let Some(linearity) = &linearity {
            let deflection = linearity.over_thickness(linearity.deflection(step));
            deflection_over_thickness = deflection_over_thickness.max(deflection);
        }
        tension.take(step.time, &reading.faces, &strengths);
        contacts.push(step);
        observe(step, &reading.probes);
    };
    if simulation.run_watched(&mut Until { interrupted, take })?.is_break() {
        return Ok(None);
    }
    if let Some((judge, force)) = judge.zip(simulation.force()) {
        let error = judge(force)?;
        simulation.set_error_of_model(error);
    }
    let estimate = simulation.error();
    let first_end = contacts.all().first().map(|first| first.end);
    Ok(Some(Computed {
        error_estimate: estimate.total().map_or(f64::NAN, |errors| errors.history),
        first_error: simulation.error_before_steps().total().map_or(f64::NAN, |errors| errors.first_contact),
        deflection_error: estimate.of_deflection(),
        deflection_over_thickness,
        unknowns: simulation.unknowns(),
        tension: tension.with_error(&estimate.of_tension(), scene, first_end),
    }))
}
