//! `ricochet run`: computes a scene and writes a result.

mod announcement;
mod output;
mod recorder;
mod solve;

use std::path::{Path, PathBuf};

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::agree::decided;
use crate::error::{Error, Result};
use crate::record::checkpoint;
use crate::record::lock::Lock;
use crate::record::target::is_same;

use super::Run;
use super::load::{Loaded, STANDARD_INPUT, load};
use super::restart::RestartState;
use super::{note, tell};
use output::check_own;
pub(super) use output::{Replaced, check_output};
pub(super) use solve::{Beginning, Written, solve};

/// Runs a scene; returns the exit status. Collective.
///
/// # Errors
/// Any [`Error`].
pub fn run(comm: &Comm, arguments: &Run) -> Result<i32> {
    let Loaded { scene, source, is_of_result } = load(comm, &arguments.scene)?;
    let file = &arguments.scene.file;
    let given = arguments.output.as_ref().or(arguments.restart.as_ref());
    // A pipe can be read only once, and has no useful name.
    let is_file_by_name = file.metadata().map_or(true, |there| there.is_file());
    let unnamed = match given {
        None if is_of_result => Some("the scene of a result"),
        None if file == Path::new(STANDARD_INPUT) => Some("a scene from standard input"),
        None if !is_file_by_name => Some("a scene from a pipe"),
        _ => None,
    };
    if let Some(what) = unnamed {
        return Err(Error::Usage(format!("{what} needs a name for its result: -o OUT.h5")));
    }
    let output = given.cloned().unwrap_or_else(|| default_output(file));
    let from = arguments.restart.as_deref().unwrap_or(&output);
    // On rank 0: the lock, held until the end, and the checkpoint from which the run continues.
    let (mut lock, mut moment) = (None, None);
    // Checked before minutes of work whose result could not be written.
    let start = decided(comm, || {
        let is_continued = arguments.restart.as_ref().is_some_and(|result| is_same(result, &output));
        let replaced = match (is_continued, arguments.force) {
            (true, _) => Replaced::ByItself,
            (_, true) => Replaced::Anyway,
            _ => Replaced::UnlessInterrupted,
        };
        check_output(&scene, &output, replaced)?;
        if given.is_none() && !arguments.force {
            check_own(&output, source.folder())?;
        }
        lock = Some(Lock::take(&output)?);
        let Some(result) = &arguments.restart else { return Ok(Start::Anew) };
        Ok(match RestartState::read((result, &output), (&scene, &source))? {
            RestartState::Complete => {
                tell(format_args!("{} is complete: there is nothing to continue", from.display()));
                // A run that was killed after its last row may have left a checkpoint.
                checkpoint::remove(from)?;
                Start::Nothing
            }
            RestartState::Beginning => {
                note(format_args!("note: {} has no checkpoint beside it: from the beginning", from.display()));
                Start::Anew
            }
            RestartState::Moment(there) => {
                moment = Some(there);
                Start::GoOn
            }
        })
    })?;
    let beginning = match start {
        Start::Nothing => return Ok(0),
        Start::Anew => Beginning::Anew,
        Start::GoOn => Beginning::Checkpoint { result: from, moment },
    };
    let written = Written { output: &output, force: arguments.force, has_summary: true, of_theory: None };
    let solved = solve(comm, (&scene, &source), beginning, &written);
    drop(lock);
    solved.map_err(|error| error.in_scene(&source))
}

/// Part of a scene that must be computed.
#[derive(Debug, Serialize, Deserialize)]
enum Start {
    /// Nothing: the result is complete.
    Nothing,
    /// The whole run.
    Anew,
    /// The steps after a checkpoint.
    GoOn,
}

fn default_output(scene: &Path) -> PathBuf {
    PathBuf::from(scene.with_extension("h5").file_name().unwrap_or("ricochet.h5".as_ref()))
}
