//! Computes a member of a sweep.

use std::rc::Rc;

use petsc_wrap::Comm;

use super::bodies::Bodies;
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{Probe, Reading, Until, joined};
use crate::model::watch;
use crate::model::{Linearity, Model, ModelContext, Simulation};
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
    if scene.time.modal && !scene.output.has_points() {
        return match bodies.simulate(index, scene, &interrupted, &mut |step| observe(step, &[])) {
            Err(Error::Interrupted) => Ok(None),
            computed => computed,
        };
    }
    let of_theory = bodies.error_of_theory(scene);
    let scene = &bodies.named(scene.clone());
    let model = match Model::made(&ModelContext::new(comm, &watch::Until(comm, &*interrupted)), scene) {
        Err(Error::Interrupted) => return Ok(None),
        model => model?,
    };
    let unknowns = model.unknowns + 1;
    let first_error =
        model.error_before_steps().total().map_or(f64::NAN, |errors| errors.joined(of_theory).first_contact);
    let linearity = Linearity::new(scene, model.theory, model.dynamics.patch().as_ref());
    let mut deflection_over_thickness = f64::NAN;
    let mut simulation = Simulation::new(scene, model)?;
    let (mut tension, strengths) = (LargestTension::default(), strengths(&scene.strength, simulation.faces()));
    let mut contacts = Episodes::default();
    let flow = simulation.run_watched(&mut Until {
        interrupted: &*interrupted,
        take: |step: &Step, reading: &Reading| {
            if let Some(linearity) = &linearity {
                deflection_over_thickness =
                    deflection_over_thickness.max(linearity.over_thickness(linearity.deflection(step)));
            }
            tension.take(step.time, &reading.faces, &strengths);
            contacts.push(step);
            observe(step, &reading.probes);
        },
    })?;
    let estimate = simulation.error();
    let errors = estimate.total().map(|errors| errors.joined(of_theory));
    let error_estimate = errors.map_or(f64::NAN, |errors| errors.history);
    let of_tension = estimate.of_tension().joined(of_theory);
    tension = tension.with_error(&of_tension, scene, contacts.all().first().map(|first| first.end));
    let deflection_error = joined(estimate.of_deflection(), of_theory.deflection);
    let outcome =
        Computed { error_estimate, first_error, deflection_error, deflection_over_thickness, unknowns, tension };
    Ok(flow.is_continue().then_some(outcome))
}
