//! A folder of results, each of which appears whole or not at all.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::record::target;

/// A folder that is there and can be written to.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder, and those above it, where they are not there yet.
    ///
    /// # Errors
    /// [`Error::Io`] where that cannot be done, or no file can be made in it.
    pub fn create(path: &Path) -> Result<Self> {
        let folder = Self { path: path.to_owned() };
        let probe = folder.part("probe".as_ref());
        fs::create_dir_all(path)
            .and_then(|()| fs::write(&probe, ""))
            .and_then(|()| fs::remove_file(&probe))
            .map_err(|e| Error::io(path, format!("is no folder that can be written to: {e}")))?;
        Ok(folder)
    }

    /// Refuses to replace files of others that have the names of `results`; `are_ours` tells whether those that are there are this program's.
    ///
    /// # Errors
    /// [`Error::Io`] with what is there.
    pub fn check_ours(&self, results: &[&str], are_ours: bool) -> Result<()> {
        match results.iter().find(|there| !are_ours && self.path.join(there).exists()) {
            Some(there) => self.refuse(&format!("has a file {there} that is not of this program")),
            None => Ok(()),
        }
    }

    /// Keeps in the file `name` the text that the folder's results are of, so that those of another text do not mix with them; files of
    /// others stay, as by [`Self::check_ours`].
    ///
    /// # Errors
    /// [`Error::Io`] with what is there.
    pub fn claim(&self, (name, text): (&str, &str), results: &[&str], are_ours: bool) -> Result<()> {
        match fs::read_to_string(self.path.join(name)) {
            Ok(there) if there == text => return Ok(()),
            Ok(_) => return self.refuse(&format!("holds results of another scene, as {name} shows")),
            Err(_) => self.check_ours(results, are_ours)?,
        }
        self.put(name, |path| fs::write(path, text).map_err(|e| Error::io(path, e)))
    }

    fn refuse(&self, why: &str) -> Result<()> {
        Err(Error::io(&self.path, format!("{why}: choose another folder")))
    }

    /// The folder that the file `path` is in.
    pub fn of(path: &Path) -> Self {
        Self { path: target::folder(path).to_owned() }
    }

    /// Has `write` make a file, which then takes its name in place of an older one. Until then it has another name with the
    /// same ending.
    ///
    /// # Errors
    /// Those of `write`; [`Error::Io`] when the file cannot take its name.
    pub fn put(&self, name: impl AsRef<OsStr>, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let (part, path) = (self.part(name.as_ref()), self.path.join(name.as_ref()));
        let done = write(&part).and_then(|()| fs::rename(&part, &path).map_err(|e| Error::io(&path, e)));
        if done.is_err() {
            // The error in hand says more than one of the removal would.
            let _ = fs::remove_file(&part);
        }
        done
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
        folder.put("x.csv", |part| fs::write(part, "first").map_err(|e| Error::io(part, e))).unwrap();
        let failed = folder.put("x.csv", |part| {
            fs::write(part, "sec").unwrap();
            Err(Error::Output("full".into()))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read_to_string(path.join("x.csv")).unwrap(), "first");
        assert_eq!(fs::read_dir(&path).unwrap().count(), 1);
        // Where a file stands, there is no folder.
        let error = Folder::create(&path.join("x.csv")).unwrap_err();
        assert_eq!(error.status(), 4);
        assert!(error.to_string().contains("x.csv: is no folder that can be written to"), "{error}");
    }
}
