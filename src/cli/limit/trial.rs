//! One run of the search: computes the ratio of tension to strength.

use std::rc::Rc;

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::agree::of_root;
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{Cause, Errors, Reading, Until};
use crate::model::watch::{Stage, Watch as _};
use crate::model::{self, Linearity, Model, ModelContext, Simulation};
use crate::record::episodes::Episodes;
use crate::record::stress::{LargestTension, StrengthVerdict, strengths};
use crate::scene::{self, Scene, Source, Vec3};
use crate::space::evaluate::FaceTension;

use super::super::follow::Follower;
use super::super::interrupt::Interrupt;
use super::super::notes::{Verdict, missing_faces, verdict};
use super::super::summary::Summary;

/// A value of the key, with the result of its run.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Trial {
    /// Value of the key.
    pub value: f64,
    /// Result of the run.
    #[serde(flatten)]
    pub utilisation: Utilisation,
}

/// Largest ratio of tension to strength in a run, with its place and time.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
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
    /// Estimated error of the tension, or of the acceleration in the first contact if it is larger; NaN without an
    /// estimate of the tension.
    pub error_estimate: f64,
    /// Reason why there is no estimate, as a clause; empty if there is one.
    pub without_estimate: String,
    /// Warnings that `ricochet run` would print for this scene, and those about the largest ratio.
    pub warnings: Vec<String>,
}

impl Utilisation {
    /// Verdict on the strength.
    pub fn verdict(&self) -> StrengthVerdict {
        StrengthVerdict::of(self.ratio, 1.0, self.error_estimate)
    }
}

/// Takes a step into account in the largest ratio so far.
fn take(
    most: &mut Option<Utilisation>,
    step: &Step,
    tensions: &[FaceTension],
    faces: &[String],
    strengths: &[Option<f64>],
) {
    for ((tension, face), strength) in tensions.iter().zip(faces).zip(strengths) {
        let Some(strength) = *strength else { continue };
        let ratio = tension.largest / strength;
        if ratio.is_nan() || most.as_ref().is_some_and(|most| most.ratio >= ratio) {
            continue;
        }
        *most = Some(Utilisation {
            ratio,
            face: face.clone(),
            tension: tension.largest,
            strength,
            time: step.time,
            point: tension.point,
            ..Utilisation::default()
        });
    }
}

/// Theory and cells that all runs of a search share, so that the tension is a continuous function of the value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Discretisation {
    theory: scene::Model,
    /// Size of the cells relative to the rule of thumb.
    cell_size: f64,
    /// Estimated error of the theory, if it was selected.
    pub(super) of_theory: Errors,
}

impl Discretisation {
    /// The scene with this theory and these cells.
    pub(super) fn of(&self, scene: &Scene) -> Scene {
        let body = scene::Body { model: self.theory, ..scene.body.clone() };
        Scene { body, cell_factor: scene.cell_factor * self.cell_size, ..scene.clone() }
    }
}

/// Runs a scene and returns its largest ratio of tension to strength, and its discretisation: the given one, or the one that
/// was selected. Collective.
///
/// # Errors
/// Same as a run; [`Error::Usage`] if no face has a strength.
pub(super) fn trial(
    comm: &Comm,
    (scene, source): (&Scene, &Source),
    given: Option<&Discretisation>,
    interrupt: &Rc<Interrupt>,
) -> Result<(Utilisation, Discretisation)> {
    let follower = Follower::new(comm, interrupt.clone());
    let shared = given.map(|given| given.of(scene));
    let scene = shared.as_ref().unwrap_or(scene);
    let context = ModelContext { keeps_cells: given.is_some(), ..ModelContext::new(comm, &follower) };
    let mut model = Model::made(&context, scene).map_err(|error| error.in_scene(source))?;
    let own = || Discretisation {
        theory: model.theory,
        cell_size: model.cell_size,
        of_theory: model.error.of(Cause::Theory).unwrap_or_default(),
    };
    let discretisation = given.copied().unwrap_or_else(own);
    if given.is_some() {
        model.error = model.error.with(Cause::Theory, discretisation.of_theory);
    }
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
    let (mut summary, mut most, mut peak_force) = (Summary::default().following(linearity), None, 0.0_f64);
    let mut contacts = Episodes::default();
    let flow = impact.run_watched(&mut Until {
        interrupted: &|| interrupt.is_raised(comm),
        take: |step: &Step, reading: &Reading| {
            summary.step(step);
            contacts.push(step);
            peak_force = peak_force.max(step.contact.force);
            take(&mut most, step, &reading.faces, &faces, &strengths);
        },
    })?;
    if flow.is_break() {
        return Err(Error::Interrupted);
    }
    let first_end = contacts.all().first().map(|first| first.end);
    let estimate = impact.error();
    warnings.extend(summary.warning());
    warnings.extend(summary.warning_of_end());
    let most = most.map(|most| {
        let largest = LargestTension { value: most.tension, time: most.time, point: most.point, ..Default::default() };
        let LargestTension { error_estimate, without_estimate, .. } =
            largest.with_error(&estimate.of_tension(), scene, first_end);
        let of_acceleration = estimate.total().map_or(f64::NAN, |errors| errors.first_contact);
        let ratio = "the largest ratio of tension to strength";
        match (without_estimate.as_str(), without_estimate.strip_prefix("it is ")) {
            ("", _) => {}
            (_, Some(place)) => warnings.push(format!("{ratio} is {place}: its error is not estimated")),
            (why, None) => warnings.push(format!("the error of {ratio} is not estimated: {why}")),
        }
        let error_estimate = if without_estimate.is_empty() { of_acceleration.max(error_estimate) } else { f64::NAN };
        Utilisation { peak_force, error_estimate, without_estimate, warnings, ..most }
    });
    drop(impact);
    comm.collect_garbage()?;
    let none = || Error::Solve("no tension was found on a face that has a strength".to_owned());
    Ok((of_root(comm, Some(most)).ok_or_else(none)?, discretisation))
}

/// Message for a theory without faces.
pub(super) fn without_faces(theory: scene::Model) -> String {
    format!(
        "the theory \"{}\" is a formula and has no faces, so no strength is reached there: choose body.model = \"mindlin\" or \"solid\"",
        model::name(theory)
    )
}
