//! A scene file on all ranks.

use std::path::Path;

use petsc_wrap::Comm;

use crate::agree::{agree, broadcast};
use crate::error::{Error, Result};
use crate::scene::{Scene, Source};

/// Reads a scene on rank 0 and parses it on all, so that all of them get the same data or the same error. Collective.
pub fn load(comm: &Comm, path: &Path, overrides: &[String]) -> Result<(Scene, Source)> {
    let read = if comm.is_root() { Scene::text(path) } else { Ok(String::new()) };
    let text = agree(comm, read).map_err(Error::Usage)?;
    Scene::from_text(path, &broadcast(comm, 0, text), overrides)
}
