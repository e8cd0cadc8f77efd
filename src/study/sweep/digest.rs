//! What is kept of a member: how it ended, its peaks and its contacts.

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
    /// Its number.
    pub index: usize,
    /// Its scene.
    pub scene: Scene,
    /// The text of its scene.
    pub source: Source,
    /// Whether its series is kept.
    pub has_series: bool,
}

/// Computes a member; `None` where it was interrupted. A member that fails is a result too. Collective on `comm`.
///
/// # Errors
/// What no member can be computed with: options that PETSc does not understand.
pub fn digest(
    comm: &Comm,
    task: &Task,
    bodies: &mut Bodies<'_>,
    interrupted: Rc<dyn Fn() -> bool>,
) -> Result<Option<Member>> {
    let begin = Instant::now();
    let mut member = Member::new(task.index, task.has_series);
    let mut episodes = Episodes::new(task.scene.impactor.mass);
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
            member.set(Quantity::DeflectionOverThickness, outcome.deflection);
            member.set_tension(&outcome.tension);
            member.set(Quantity::Unknowns, outcome.unknowns as f64);
            member.status = Status::Done;
            member
        }
        // Another rank may be at another member.
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
