//! A fault of the scene that shows only when it is built.

use serde::{Deserialize, Serialize};

/// A key found wrong by the mesh or the body; [`Source::error`](super::Source::error) makes it point into the text.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[error("{key}: {message}")]
pub struct Fault {
    /// Dotted path of the key.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub help: String,
    /// Whether every rank has found it; otherwise the others are still at work.
    pub everywhere: bool,
}

impl Fault {
    /// A fault that every rank has found.
    pub fn new(key: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { key: key.into(), message: message.into(), help: help.into(), everywhere: true }
    }

    /// The same, found by this rank alone.
    pub fn on_one_rank(self) -> Self {
        Self { everywhere: false, ..self }
    }
}
