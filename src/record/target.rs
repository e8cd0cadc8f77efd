//! Output file of a result: checks that it is writable, and replaces an older file.

use crate::error::{Error, Result};
use crate::record::storage;
use crate::record::sweep::is_one as is_sweep;
use hdf5_metno as hdf5;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// Kind of a file. A file is replaced only by a file of the same kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Result of a run.
    Run,
    /// Sweep. An existing sweep is continued, not replaced.
    Sweep,
    /// Fields of a run.
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

    /// Kind of an open file, from its content; `None` if it is not a file of this program.
    fn of(file: &hdf5::File) -> Option<Self> {
        if is_sweep(file) {
            Some(Self::Sweep)
        } else if file.group("series").is_ok() && file.attr("run_id").is_ok() {
            Some(Self::Run)
        } else {
            // This check comes last, because the result of a run has a link `VTKHDF` to its fields.
            storage::has_group(file, "VTKHDF").then_some(Self::Fields)
        }
    }
}

/// Checks that a result of this kind can be written to `path`, without changing an existing file.
///
/// # Errors
/// [`Error::Io`] with the reason: the folder is missing or not writable; the path is not UTF-8; the path is a folder, a
/// device, a read-only file, a file of another kind, or a result that a run is still writing.
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

/// Resolves symbolic links: the file that `path` is or links to, whether it exists or not. A file is written there, so
/// the link itself remains.
pub fn resolved(path: &Path) -> PathBuf {
    /// Largest number of consecutive links followed, more than any system follows.
    const MAX_LINKS: usize = 64;
    let mut file = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&file) {
            // A relative link is relative to its folder.
            Ok(target) => file = folder(&file).join(target),
            Err(_) if file == path => return file,
            Err(_) => return fs::canonicalize(&file).unwrap_or(file),
        }
    }
    path.to_owned()
}

/// File in the folder of the result at `path` whose name has another ending: `plate.checkpoint.h5` for `plate.h5`,
/// `k.1e7.checkpoint.h5` for `k.1e7`. Results with different names have different locks, so they must not share such a
/// file.
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

/// Renames a temporary file to its final name. The replaced file may be the only copy of its data, so the temporary
/// file is on the disk before it replaces the older one.
pub(super) fn replace_with_part(part: &Path, path: &Path) -> io::Result<()> {
    if path.try_exists()? {
        synced(part)?;
        fs::rename(part, path)?;
        // Some file systems cannot sync a folder. The error is ignored.
        let _ = synced(folder(path));
        return Ok(());
    }
    fs::rename(part, path)
}

/// Makes the content of a file, or the names in a folder, survive a loss of power.
pub(super) fn synced(path: &Path) -> io::Result<()> {
    File::open(path)?.sync_all()
}

/// Whether two paths lead to the same existing file.
pub fn is_same(one: &Path, other: &Path) -> bool {
    let of = |path| fs::canonicalize(path).ok();
    of(one).is_some_and(|one| of(other) == Some(one))
}

/// Folder that contains a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Temporary file for a new result, or for a copy of a sweep's file, in the folder of `path` (resolved). An older result remains complete until the new
/// one has its first row. (H5Fcreate would cut the older file before it detects that another process has it open.)
pub(super) fn part(path: &Path) -> Result<PathBuf> {
    beside(path, &format!("{}.part", std::process::id()))
}

/// Writes the temporary file of `path` (resolved) with `write`; returns it with what `write` returns. After an error it is
/// removed.
pub(super) fn write_part<T>(path: &Path, write: impl FnOnce(&Path) -> Result<T>) -> Result<(PathBuf, T)> {
    let part = part(path)?;
    match write(&part) {
        Ok(written) => Ok((part, written)),
        Err(error) => {
            // This error says more than an error of the removal.
            let _ = fs::remove_file(&part);
            Err(error)
        }
    }
}

/// Hidden file in the folder of `path` (resolved), with another ending.
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

/// Removes temporary files that killed runs have left for `path`. Only the owner of the lock may call this. Errors are
/// ignored.
pub(super) fn remove_parts(path: &Path) {
    let path = resolved(path);
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return };
    let prefix = format!(".{name}.");
    for entry in fs::read_dir(folder(&path)).into_iter().flatten().flatten() {
        let file = entry.file_name();
        let process = file.to_str().and_then(|file| file.strip_prefix(&prefix)?.strip_suffix(".part"));
        if process.is_some_and(|process| !process.is_empty() && process.bytes().all(|byte| byte.is_ascii_digit())) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Checks that the file at `path` is of this kind and may be replaced.
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
    // Opening takes the shared lock of HDF5, which fails if another process writes the file. If this process writes it,
    // the file is not opened read-only.
    match storage::open(path) {
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

/// Whether opening failed because another process has locked the file.
pub(super) fn is_locked(error: &hdf5::Error) -> bool {
    error.stack().is_some_and(|frames| frames.iter().any(|f| f.desc().contains("lock file")))
}
