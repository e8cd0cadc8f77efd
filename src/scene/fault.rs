//! Errors of a scene that are found when the mesh or the body is built.

use serde::{Deserialize, Serialize};

/// A wrong key, found while building the mesh or the body. [`Source::error`](super::Source::error) turns it into an
/// error with a place in the text.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[error("{key}: {message}")]
pub struct Fault {
    /// Dotted path of the key.
    pub key: String,
    /// Description of the error.
    pub message: String,
    /// Hint how to correct the error.
    pub help: String,
    /// Whether all ranks have found the error. Otherwise the other ranks are still working.
    pub everywhere: bool,
}

impl Fault {
    /// An error found by all ranks.
    pub fn new(key: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into(), help: help.into(), everywhere: true }
    }

    /// The same error, found by this rank only.
    pub fn on_one_rank(self) -> Self {
        Self { everywhere: false, ..self }
    }
}
