//! The file that a result is written to: whether it can be, and how it takes the place of an older one.

use crate::error::{Error, Result};
use crate::record::sweep::is_one as is_sweep;
use hdf5_metno as hdf5;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// What a file is, as far as it may be replaced: only by one of its own kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The result of a run.
    Run,
    /// A sweep, which is continued.
    Sweep,
    /// The fields of a run.
    Fields,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Run => "the result of a run",
            Self::Sweep => "a sweep",
            Self::Fields => "the fields of a run",
        }
    }

    /// What a file of this program is, by what it must have.
    fn of(file: &hdf5::File) -> Option<Self> {
        if is_sweep(file) {
            Some(Self::Sweep)
        } else if file.group("series").is_ok() && file.attr("run_id").is_ok() {
            Some(Self::Run)
        } else {
            // A run links to its fields: this is what is left.
            file.group("VTKHDF").is_ok().then_some(Self::Fields)
        }
    }
}

/// Tells whether a result of this kind can be written to `path`, without touching a file that is there.
///
/// # Errors
/// [`Error::Io`] with the reason: the folder is missing or not writable; the path is a folder, a device, a read-only
/// file, a file of another kind, or a result that a run is still writing.
pub fn check_writable(path: &Path, kind: Kind) -> Result<()> {
    let part = part(&resolved(path))?;
    if part.to_str().is_none() {
        return Err(Error::io(path, "is no name for a result: HDF5 wants text in UTF-8"));
    }
    if let Ok(there) = fs::metadata(path) {
        check_replaceable(path, &there, kind)?;
    }
    OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .open(&part)
        .and_then(|_| fs::remove_file(&part))
        .map_err(|e| Error::io(path, format!("cannot be created: {e}")))
}

/// The file that `path` is or links to, whether that is there or not: a link stays a link.
pub fn resolved(path: &Path) -> PathBuf {
    /// More links in a row than any system follows.
    const MOST: usize = 64;
    let mut file = path.to_owned();
    for _ in 0..MOST {
        match fs::read_link(&file) {
            // A relative link starts at the folder that it is in.
            Ok(target) => file = folder(&file).join(target),
            Err(_) if file == path => return file,
            Err(_) => return fs::canonicalize(&file).unwrap_or(file),
        }
    }
    path.to_owned()
}

/// A file that goes with the result at `path`, by its ending: `plate.checkpoint.h5` with `plate.h5`, `k.1e7.checkpoint.h5` with `k.1e7`.
/// Results with different names, which have locks of their own, share none.
pub(super) fn companion(path: &Path, ending: &str) -> PathBuf {
    let path = resolved(path);
    let mut name = path.file_name().map(OsString::from).unwrap_or_default();
    if let Some(stem) = name.to_str().and_then(|name| name.strip_suffix(".h5")) {
        name = stem.into();
    }
    name.push(".");
    name.push(ending);
    path.with_file_name(name)
}

/// Renames a part to its final name. The file that it replaces may be the only copy of its data, so the part is on the disk
/// before.
pub(super) fn replace_with_part(part: &Path, path: &Path) -> io::Result<()> {
    if path.try_exists()? {
        synced(part)?;
        fs::rename(part, path)?;
        return synced(folder(path));
    }
    fs::rename(part, path)
}

/// Has what was written to a file, or the names in a folder, outlive a loss of power.
pub(super) fn synced(path: &Path) -> io::Result<()> {
    File::open(path)?.sync_all()
}

/// Whether two paths lead to one file.
pub fn is_same(one: &Path, other: &Path) -> bool {
    let of = |path| fs::canonicalize(path).ok();
    of(one).is_some_and(|one| of(other) == Some(one))
}

/// The folder that a file is in.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The file in which a new result is begun, beside `path` (resolved): an older result stays whole until the new one
/// has its first row. (H5Fcreate would cut the older file before it finds out that somebody else has it open.)
pub(super) fn part(path: &Path) -> Result<PathBuf> {
    beside(path, &format!("{}.part", std::process::id()))
}

/// A hidden file beside `path` (resolved) with another ending.
pub(super) fn beside(path: &Path, ending: &str) -> Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| Error::io(path, "is not the name of a file"))?;
    let folder = folder(path);
    if !folder.is_dir() {
        let reason = format!("there is no folder {}", folder.display());
        return Err(Error::io(path, reason));
    }
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{ending}"));
    Ok(folder.join(hidden))
}

/// Removes what runs that were killed have begun beside `path`; for who alone may write there. An error is no harm.
pub(super) fn remove_parts(path: &Path) {
    let path = resolved(path);
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return };
    for entry in fs::read_dir(folder(&path)).into_iter().flatten().flatten() {
        let file = entry.file_name();
        let process = file.to_str().and_then(|file| file.strip_prefix(&format!(".{name}."))?.strip_suffix(".part"));
        if process.is_some_and(|process| !process.is_empty() && process.bytes().all(|byte| byte.is_ascii_digit())) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether what is at `path` is of this kind and may be replaced.
fn check_replaceable(path: &Path, there: &fs::Metadata, kind: Kind) -> Result<()> {
    if there.is_dir() {
        return Err(Error::io(path, "is a folder"));
    }
    if !there.is_file() {
        return Err(Error::io(path, "is not a regular file"));
    }
    if there.permissions().readonly() {
        return Err(Error::io(path, "is read-only"));
    }
    OpenOptions::new().write(true).open(path).map_err(|e| Error::io(path, format!("cannot be replaced: {e}")))?;
    // Opening takes HDF5's shared lock, which a writer elsewhere excludes; a writer in this process shows in the mode.
    match hdf5::File::open(path) {
        Ok(file) if file.is_read_only() => match Kind::of(&file) {
            Some(there) if there == kind => Ok(()),
            Some(there) => {
                Err(Error::io(path, format!("is {}, so it is not replaced by {}", there.name(), kind.name())))
            }
            None => Err(Error::io(path, "is an HDF5 file of another program, so it is not replaced")),
        },
        Ok(_) => Err(Error::io(path, IN_USE)),
        Err(e) if is_locked(&e) => Err(Error::io(path, IN_USE)),
        Err(e) => {
            let reason = format!("is no readable HDF5 file, so it is not replaced ({e})");
            Err(Error::io(path, reason))
        }
    }
}

const IN_USE: &str = "is open for writing: another run is not finished with it";

/// Whether an open failed because another program holds the file.
pub(super) fn is_locked(error: &hdf5::Error) -> bool {
    error.stack().is_some_and(|frames| frames.iter().any(|f| f.desc().contains("lock file")))
}
