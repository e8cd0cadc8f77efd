//! Folder of results. Each file in it appears complete or not at all.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::record::target;

/// Folder that exists and is writable.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Creates the folder and its missing parent folders.
    ///
    /// # Errors
    /// [`Error::Io`] if the folder cannot be created, or if no file can be created in it.
    pub fn create(path: &Path) -> Result<Self> {
        let folder = Self { path: path.to_owned() };
        let probe = folder.part("probe".as_ref());
        fs::create_dir_all(path)
            .and_then(|()| fs::write(&probe, ""))
            .and_then(|()| fs::remove_file(&probe))
            .map_err(|e| Error::io(path, format!("is no folder that can be written to: {e}")))?;
        Ok(folder)
    }

    /// Checks that no foreign file with a name in `results` would be replaced. `are_ours` says whether existing files
    /// of these names are from this program.
    ///
    /// # Errors
    /// [`Error::Io`] with the name of the foreign file.
    pub fn check_ours(&self, results: &[&str], are_ours: bool) -> Result<()> {
        match results.iter().find(|there| !are_ours && self.path.join(there).exists()) {
            Some(there) => self.refuse(&format!("has a file {there} that is not of this program")),
            None => Ok(()),
        }
    }

    /// Writes `text`, which identifies the results of the folder, to the file `name`. Results of different texts
    /// therefore do not mix. Foreign files are not replaced, see [`Self::check_ours`].
    ///
    /// # Errors
    /// [`Error::Io`] if the folder has results of another text or a foreign file, or if writing fails.
    pub fn claim(&self, (name, text): (&str, &str), results: &[&str], are_ours: bool) -> Result<()> {
        match fs::read_to_string(self.path.join(name)) {
            Ok(there) if there == text => return Ok(()),
            Ok(_) => return self.refuse(&format!("holds results of another scene, as {name} shows")),
            Err(_) => self.check_ours(results, are_ours)?,
        }
        self.put_bytes(name, text)
    }

    fn refuse(&self, why: &str) -> Result<()> {
        Err(Error::io(&self.path, format!("{why}: choose another folder")))
    }

    /// Folder that contains the file `path`.
    pub fn of(path: &Path) -> Self {
        Self { path: target::folder(path).to_owned() }
    }

    /// Creates a file with `write`, then renames it to `name`, which replaces an older file. Until then the file has a
    /// temporary name with the same ending.
    ///
    /// # Errors
    /// Same as `write`; [`Error::Io`] if the file cannot be renamed.
    pub fn put(&self, name: impl AsRef<OsStr>, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let (part, path) = (self.part(name.as_ref()), self.path.join(name.as_ref()));
        let done = write(&part).and_then(|()| fs::rename(&part, &path).map_err(|e| Error::io(&path, e)));
        if done.is_err() {
            // The present error says more than an error of the removal.
            let _ = fs::remove_file(&part);
        }
        done
    }

    /// Creates a file with this content, like [`Self::put`].
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn put_bytes(&self, name: impl AsRef<OsStr>, bytes: impl AsRef<[u8]>) -> Result<()> {
        self.put(name, |path| fs::write(path, bytes).map_err(|e| Error::io(path, e)))
    }

    fn part(&self, name: &OsStr) -> PathBuf {
        let mut part = OsString::from(format!(".{}.", std::process::id()));
        part.push(name);
        self.path.join(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_appear_whole_or_not_at_all() {
        let above = tempfile::tempdir().unwrap();
        let path = above.path().join("a/b");
        let folder = Folder::create(&path).unwrap();
        folder.put_bytes("x.csv", "first").unwrap();
        let failed = folder.put("x.csv", |part| {
            fs::write(part, "sec").unwrap();
            Err(Error::Output("full".into()))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read_to_string(path.join("x.csv")).unwrap(), "first");
        assert_eq!(fs::read_dir(&path).unwrap().count(), 1);
        // A folder cannot be created where a file exists.
        let error = Folder::create(&path.join("x.csv")).unwrap_err();
        assert_eq!(error.status(), 4);
        assert!(error.to_string().contains("x.csv: is no folder that can be written to"), "{error}");
    }
}
