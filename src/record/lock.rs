//! Lock that allows only one run at a time to write a result.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::error::{Error, Result};
use crate::record::{checkpoint, fields, target};

/// Locks that this process holds: each lock file and its result.
static HELD: Mutex<Vec<[PathBuf; 2]>> = Mutex::new(Vec::new());

/// Removes what a process leaves behind that ends without its destructors: locks, and results without a row. Errors are
/// ignored.
pub fn abandon_all() {
    let Ok(held) = HELD.try_lock() else { return };
    for [lock, result] in &*held {
        remove_parts(result);
        let _ = fs::remove_file(lock);
    }
}

/// Removes unfinished files of a result, of its checkpoint and of its fields. Errors are ignored.
fn remove_parts(result: &Path) {
    target::remove_parts(result);
    target::remove_parts(&checkpoint::beside(result));
    fields::paths(result).iter().for_each(|path| target::remove_parts(path));
}

/// File in the folder of a result, locked while a run writes the result. The system releases the lock when the process
/// ends in any way.
pub struct Lock {
    path: PathBuf,
    /// Keeps the lock while it is open.
    _file: File,
}

impl Lock {
    /// Takes the lock of the result at `path`.
    ///
    /// # Errors
    /// [`Error::Io`] if another run has the lock, if no file can be created there, or if the name is reserved for the
    /// fields or the checkpoint of another result.
    pub fn take(path: &Path) -> Result<Self> {
        let name = target::resolved(path).file_name().unwrap_or_default().to_string_lossy().into_owned();
        let of_others = fields::ENDINGS.into_iter().chain([checkpoint::ENDING]);
        if let Some(ending) = of_others.into_iter().find(|ending| name.ends_with(&format!(".{ending}"))) {
            let reason =
                format!("is a name for what goes with a result (.{ending}): the result needs another one, as with .h5");
            return Err(Error::io(path, reason));
        }
        let beside = target::beside(&target::resolved(path), "lock")?;
        loop {
            let file = OpenOptions::new()
                .write(true)
                .create(true)
                .truncate(false)
                .open(&beside)
                .map_err(|error| Error::io(path, format!("cannot be created: {error}")))?;
            let is_locked = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => {
                    return Err(Error::io(path, "is being written by another run, which is not finished with it"));
                }
                // File systems without locks: other runs cannot be detected.
                Err(TryLockError::Error(error)) => {
                    tracing::debug!("no lock beside {}: {error}", path.display());
                    false
                }
            };
            // The previous owner may have removed the file between opening and locking it here.
            let of = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
            let (held, there) = (file.metadata().map(of), fs::metadata(&beside).map(of));
            if let (Ok(held), Ok(there)) = (held, there)
                && held == there
            {
                if is_locked {
                    remove_parts(path);
                }
                if let Ok(mut held) = HELD.lock() {
                    held.push([beside.clone(), path.to_owned()]);
                }
                return Ok(Self { path: beside, _file: file });
            }
        }
    }
}

impl Drop for Lock {
    /// Removes the lock file. No other process can have it locked. Errors are ignored.
    fn drop(&mut self) {
        if let Ok(mut held) = HELD.lock() {
            held.retain(|[lock, _]| *lock != self.path);
        }
        let _ = fs::remove_file(&self.path);
    }
}
