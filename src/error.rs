//! What can go wrong, and the exit status that says so.

use std::path::{Path, PathBuf};

/// An error with one message for the user.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// The solve failed.
    #[error("{0}")]
    Solve(String),
    /// A file could not be read or written.
    #[error("{}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What failed and why.
        reason: String,
    },
}

/// Result with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// A file that could not be read or written.
    pub fn io(path: &Path, reason: impl std::fmt::Display) -> Self {
        Self::Io { path: path.to_owned(), reason: reason.to_string() }
    }

    /// Exit status: 2 the scene or the command line is wrong, 3 the solve failed, 4 input or output failed.
    pub fn status(&self) -> i32 {
        match self {
            Self::Usage(_) => 2,
            Self::Solve(_) => 3,
            Self::Io { .. } => 4,
        }
    }
}
