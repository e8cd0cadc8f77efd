//! Computes a member of a sweep and keeps its status, peak values and contacts.

use std::rc::Rc;
use std::time::Instant;

use petsc_wrap::Comm;

use super::bodies::Bodies;
use super::member::simulate;
use crate::error::{Error, Result};
use crate::record::episodes::Episodes;
use crate::record::sweep::{Member, Quantity, Status};
use crate::scene::{Scene, Source};

/// A member to compute.
#[derive(Debug, Clone)]
pub struct Task {
    /// Number of the member.
    pub index: usize,
    /// Scene of the member.
    pub scene: Scene,
    /// Text of the scene, for messages.
    pub source: Source,
    /// Whether the member's time series is stored.
    pub has_series: bool,
}

/// Computes a member; `None` if interrupted. A failed member is a result too. Collective on `comm`.
///
/// # Errors
/// If no member can be computed: errors of usage (such as options that PETSc does not understand), of files or of the
/// output.
pub fn digest(
    comm: &Comm,
    task: &Task,
    bodies: &mut Bodies<'_>,
    interrupted: Rc<dyn Fn() -> bool>,
) -> Result<Option<Member>> {
    let begin = Instant::now();
    let mut member = Member::new(task.index, task.has_series);
    let mut episodes = Episodes::default();
    let outcome = simulate(comm, (task.index, &task.scene), bodies, interrupted, |step, read| {
        episodes.push(step);
        member.push(step, read, task.scene.output.every);
    });
    let mut member = match outcome {
        Ok(None) => return Ok(None),
        Ok(Some(outcome)) => {
            member.set_contacts(&episodes);
            member.set(Quantity::ErrorEstimate, outcome.error_estimate);
            member.set(Quantity::FirstContactError, outcome.first_error);
            member.set(Quantity::DeflectionErrorEstimate, outcome.deflection_error);
            member.set(Quantity::DeflectionOverThickness, outcome.deflection_over_thickness);
            member.set_tension(&outcome.tension);
            member.set(Quantity::Unknowns, outcome.unknowns as f64);
            member.status = Status::Done;
            member
        }
        // Other ranks may be computing other members, so the error is marked as one of this rank alone.
        Err(error @ (Error::Usage(_) | Error::Io { .. } | Error::Output(_))) => {
            return Err(Error::Alone(Box::new(error)));
        }
        Err(error) => {
            let status = if error.status() == 2 { Status::Refused } else { Status::Failed };
            member.fail(status, error.in_scene(&task.source).to_string())
        }
    };
    member.set(Quantity::WallTime, begin.elapsed().as_secs_f64());
    Ok(Some(member))
}
