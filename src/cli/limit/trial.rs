//! One run of the search: computes the ratio of tension to strength.

use std::rc::Rc;

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::agree::of_root;
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{Errors, Reading, Until};
use crate::model::watch::{Stage, Watch as _};
use crate::model::{self, Linearity, Model, Simulation};
use crate::record::episodes::Episodes;
use crate::record::stress::strengths;
use crate::scene::{self, Scene, Source, Vec3};
use crate::space::evaluate::FaceTension;

use super::super::follow::Follower;
use super::super::interrupt::Interrupt;
use super::super::notes::{Verdict, missing_faces, near_clamped_edge, verdict};
use super::super::short;
use super::super::summary::{Summary, is_outside_first_contact};

/// A value of the key, with the result of its run.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    /// Value of the key.
    pub value: f64,
    /// Result of the run.
    pub utilisation: Utilisation,
}

/// Largest ratio of tension to strength in a run, with its place and time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Utilisation {
    /// Ratio of tension to strength.
    pub ratio: f64,
    /// Name of the face.
    pub face: String,
    /// Tension, Pa.
    pub tension: f64,
    /// Strength of the face, Pa.
    pub strength: f64,
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub point: Vec3,
    /// Peak contact force of the whole run, N.
    pub peak_force: f64,
    /// Estimated error of the acceleration over its peak, or of the tension if it is larger; NaN without an estimate. In
    /// the first contact if the largest ratio is reached there, otherwise over the whole history.
    pub error_estimate: f64,
    /// Warnings that `ricochet run` would print for this scene, and those about the largest ratio.
    pub warnings: Vec<String>,
}

impl Utilisation {
    /// State before the first step.
    fn new() -> Self {
        let none = f64::NAN;
        Self {
            ratio: none,
            face: String::new(),
            tension: none,
            strength: none,
            time: none,
            point: [none; 3],
            peak_force: 0.0,
            error_estimate: none,
            warnings: Vec::new(),
        }
    }

    /// Takes a step into account.
    fn take(&mut self, step: &Step, tensions: &[FaceTension], faces: &[String], strengths: &[Option<f64>]) {
        self.peak_force = self.peak_force.max(step.contact.force);
        for ((tension, face), strength) in tensions.iter().zip(faces).zip(strengths) {
            let Some(strength) = *strength else { continue };
            let ratio = tension.largest / strength;
            // False for NaN, the initial value.
            if ratio.is_nan() || self.ratio >= ratio {
                continue;
            }
            self.face.clone_from(face);
            (self.ratio, self.tension, self.strength) = (ratio, tension.largest, strength);
            (self.time, self.point) = (step.time, tension.point);
        }
    }
}

/// Runs a scene and returns its largest ratio of tension to strength. Collective.
///
/// # Errors
/// Same as a run; [`Error::Usage`] if no face has a strength.
pub(super) fn trial(comm: &Comm, (scene, source): (&Scene, &Source), interrupt: &Rc<Interrupt>) -> Result<Utilisation> {
    let follower = Follower::new(comm, interrupt.clone());
    let model = Model::watched(comm, scene, &follower).map_err(|error| error.in_scene(source))?;
    let mut warnings = Vec::new();
    if let Some(Verdict { message, is_useless }) = verdict(&model, scene) {
        if is_useless {
            return Err(Error::Solve(format!("{message}. The result would be of no use")));
        }
        warnings.push(message);
    }
    let theory = model.theory;
    let linearity = Linearity::new(scene, theory, model.dynamics.patch().as_ref());
    follower.at(Stage::Steps)?;
    let mut impact = Simulation::new(scene, model).map_err(|error| error.in_scene(source))?;
    drop(follower);
    let faces = of_root(comm, comm.is_root().then(|| impact.faces().to_vec()));
    let strengths = strengths(&scene.strength, &faces);
    if faces.is_empty() {
        return Err(Error::Usage(without_faces(theory)));
    }
    if strengths.iter().all(Option::is_none) {
        let faces = faces.join(", ");
        return Err(Error::Usage(format!("no face of the body has a strength: its faces are {faces}")));
    }
    warnings.extend(missing_faces(scene, &faces).map(|remark| remark.text));
    let (mut summary, mut most) = (Summary::default().following(linearity), Utilisation::new());
    let mut contacts = Episodes::default();
    let flow = impact.run_watched(&mut Until {
        interrupted: &|| interrupt.is_raised(comm),
        take: |step: &Step, reading: &Reading| {
            summary.step(step);
            contacts.push(step);
            most.take(step, &reading.faces, &faces, &strengths);
        },
    })?;
    if flow.is_break() {
        return Err(Error::Interrupted);
    }
    let first_end = contacts.all().first().map(|first| first.end);
    let is_outside = is_outside_first_contact(most.time, first_end);
    // The maximum ignores NaN if the error of the stress is not estimated.
    let error = |errors: Errors| if is_outside { errors.history } else { errors.first_contact }.max(errors.stress);
    most.error_estimate = impact.error().total().map_or(f64::NAN, error);
    warnings.extend(summary.warning());
    warnings.extend(summary.warning_of_end());
    if scene.is_at_clamped_edge(most.point) {
        warnings.push(
            "the largest ratio of tension to strength is at a clamped edge, where the stresses of a solid do not converge as cells get smaller: the error of its tension is not \
             estimated"
                .to_owned(),
        );
    } else if let Some(distance) = scene.hit_near_clamped_edge() {
        warnings.push(near_clamped_edge(distance));
    }
    if is_outside && (first_end.is_none() || !most.error_estimate.is_nan()) {
        let when = if first_end.is_some() { "after the first contact" } else { "without a contact" };
        warnings.push(format!(
            "the largest ratio of tension to strength is reached at {} ms, {when}; errors of tensions are estimated in the first contact only, so \
             the uncertainty of the limit may be larger than stated",
            short(1e3 * most.time)
        ));
    }
    most.warnings = warnings;
    drop(impact);
    comm.collect_garbage()?;
    let most = of_root(comm, comm.is_root().then_some(most));
    if most.ratio.is_nan() {
        return Err(Error::Solve("no tension was found on a face that has a strength".to_owned()));
    }
    Ok(most)
}

/// Message for a theory without faces.
pub(super) fn without_faces(theory: scene::Model) -> String {
    format!(
        "the theory \"{}\" is a formula and has no faces, so no strength is reached there: choose body.model = \"mindlin\" or \"solid\"",
        model::name(theory)
    )
}
