//! Checks whether a result may be written to its file.

use std::path::Path;

use crate::error::{Error, Result};
use crate::record::target::{Kind, check_writable, is_same};
use crate::record::{checkpoint, fields, read};
use crate::scene::Scene;

/// Treatment of an earlier run in the file of a result.
pub(in crate::cli) enum Replaced {
    /// It is continued.
    ByItself,
    /// It is replaced.
    Anyway,
    /// It is replaced, unless it was interrupted and can be continued.
    UnlessInterrupted,
}

/// Checks that a run can be written, with its checkpoint and its fields.
///
/// # Errors
/// [`Error::Io`] if it cannot.
pub(in crate::cli) fn check_output(scene: &Scene, output: &Path, replaced: Replaced) -> Result<()> {
    check_writable(output, Kind::Run)?;
    if !matches!(replaced, Replaced::ByItself) {
        checkpoint::check_writable(output)?;
    }
    if matches!(replaced, Replaced::UnlessInterrupted) {
        check_not_interrupted(output)?;
    }
    if scene.output.fields.is_some() { fields::check_writable(output) } else { Ok(()) }
}

/// Refuses to replace a run that was interrupted and can be continued.
fn check_not_interrupted(output: &Path) -> Result<()> {
    if !output.exists() {
        return Ok(());
    }
    let (origin, _, complete) = read::origin(output)?;
    if complete || !checkpoint::is_there(output, origin.run_id) {
        return Ok(());
    }
    let shown = output.display();
    let reason =
        format!("holds an interrupted run with a checkpoint: --restart {shown} continues it, --force replaces it");
    Err(Error::io(output, reason))
}

/// Refuses to replace the result of a scene with the same name in another folder, if the user has not named the result.
pub(super) fn check_own(output: &Path, folder: &Path) -> Result<()> {
    if !output.exists() {
        return Ok(());
    }
    let other = read::provenance(output)?.folder;
    // If that folder no longer exists, nothing can be concluded.
    if !Path::new(&other).exists() || is_same(Path::new(&other), &Path::new(".").join(folder)) {
        return Ok(());
    }
    Err(Error::io(output, format!("holds the result of another scene, in {other}: -o names this one's result")))
}
