//! Errors of the program, and the exit statuses that belong to them.

use std::path::{Path, PathBuf};

use miette::{GraphicalReportHandler, GraphicalTheme};
use serde::{Deserialize, Serialize};

use crate::scene::{Fault, SceneError, Source};

/// Exit status if a signal ended the work.
pub const INTERRUPTED: i32 = 130;

/// An error with one message for the user.
#[derive(Debug, thiserror::Error, Serialize, Deserialize)]
pub enum Error {
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// The scene is wrong in a way that is found only when the mesh or the body is built.
    #[error(transparent)]
    Fault(Box<Fault>),
    /// An error that the other ranks do not know.
    #[error(transparent)]
    Alone(Box<Error>),
    /// The solve failed.
    #[error("{0}")]
    Solve(String),
    /// The time integration gained or lost more energy than the gate allows.
    #[error("{0}")]
    Unstable(String),
    /// A signal or a time limit ended the work before there was a result.
    #[error("interrupted: no result was written")]
    Interrupted,
    /// The result cannot be written. All ranks know.
    #[error("{0}")]
    Output(String),
    /// Writing a result failed. All ranks know. HDF5 must not be used any more.
    #[error("{0}")]
    Unwritten(String),
    /// A file could not be read or written.
    #[error("{}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What failed and why.
        reason: String,
    },
    /// The scene is wrong. Variants that are not sent to other ranks come last: a message contains the number of its
    /// variant, which skipped variants would shift.
    #[error(transparent)]
    #[serde(skip)]
    Scene(Box<SceneError>),
    /// PETSc failed unexpectedly.
    #[error(transparent)]
    #[serde(skip)]
    Petsc(petsc_wrap::Error),
}

/// Result with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error for a file that could not be read or written.
    pub fn io(path: &Path, reason: impl std::fmt::Display) -> Self {
        Self::Io { path: path.to_owned(), reason: reason.to_string() }
    }

    /// Exit status: 2 if the scene or the command line is wrong, 3 if the solve failed, 4 if input or output failed,
    /// 130 if interrupted.
    pub fn status(&self) -> i32 {
        match self {
            Self::Alone(error) => error.status(),
            Self::Usage(_) | Self::Scene(_) | Self::Fault(_) => 2,
            Self::Solve(_) | Self::Unstable(_) | Self::Petsc(_) => 3,
            Self::Io { .. } | Self::Output(_) | Self::Unwritten(_) => 4,
            Self::Interrupted => INTERRUPTED,
        }
    }

    /// Converts the error to one that all ranks return.
    #[must_use]
    pub fn of_all_ranks(self) -> Self {
        match self {
            Self::Io { .. } => Self::Output(self.to_string()),
            Self::Petsc(error) => Self::Solve(error.to_string()),
            Self::Alone(error) => error.of_all_ranks(),
            Self::Fault(fault) => Self::Fault(Box::new(Fault { everywhere: true, ..*fault })),
            other => other,
        }
    }

    /// The error as it is sent to another rank. Variants that cannot be sent become others with the same message and
    /// status.
    #[must_use]
    pub fn as_told(&self) -> Self {
        let message = self.to_string();
        match self {
            Self::Usage(_) | Self::Scene(_) => Self::Usage(message),
            Self::Fault(fault) => Self::Fault(fault.clone()),
            Self::Alone(error) => error.as_told(),
            Self::Solve(_) | Self::Petsc(_) => Self::Solve(message),
            Self::Unstable(_) => Self::Unstable(message),
            Self::Interrupted => Self::Interrupted,
            Self::Output(_) | Self::Io { .. } => Self::Output(message),
            Self::Unwritten(_) => Self::Unwritten(message),
        }
    }

    /// Whether every rank returns the error, so that all ranks can end in order.
    pub fn is_everywhere(&self) -> bool {
        match self {
            Self::Usage(_) | Self::Scene(_) | Self::Solve(_) | Self::Unstable(_) | Self::Output(_) => true,
            Self::Interrupted | Self::Unwritten(_) => true,
            Self::Fault(fault) => fault.everywhere,
            Self::Alone(_) | Self::Io { .. } | Self::Petsc(_) => false,
        }
    }

    /// Converts a [`Fault`] to an error with a place in the text of the scene. Other errors are returned unchanged.
    pub fn in_scene(self, source: &Source) -> Self {
        match self {
            Self::Fault(fault) => {
                let error = source.error(&fault.key, fault.message, fault.help).into();
                if fault.everywhere { error } else { Self::Alone(Box::new(error)) }
            }
            other => other,
        }
    }

    /// The whole message for standard error, including the newline: one line, and for a scene an excerpt with the error
    /// marked. `colours` is for a terminal; without it the text has no escape codes.
    pub fn report(&self, colours: bool) -> String {
        let plain = self.rendered(GraphicalTheme::unicode_nocolor());
        let shown = visible(&plain);
        if colours && shown == plain { self.rendered(GraphicalTheme::unicode()) } else { shown }
    }

    fn rendered(&self, theme: GraphicalTheme) -> String {
        let error = match self {
            Self::Alone(error) => return error.rendered(theme),
            Self::Scene(error) => error,
            Self::Interrupted => return format!("{self}\n"),
            _ => return format!("error: {self}\n"),
        };
        let mut text = String::new();
        // Lines are not wrapped, so that messages can be searched for.
        GraphicalReportHandler::new_themed(theme)
            .with_wrap_lines(false)
            .with_context_lines(1)
            .render_report(&mut text, error.as_ref())
            .map_or_else(|_| format!("error: {self}\n"), |()| text)
    }
}

/// Text in which control characters, such as those that change the title of a terminal, clear it, or turn the direction
/// of letters, are written as `\u{1b}`; lines and tabs stay.
pub fn visible(text: &str) -> String {
    let is_turned = |letter: char| matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_kept = |letter: char| !(letter.is_control() || is_turned(letter)) || matches!(letter, '\n' | '\t');
    let text = text.replace("\r\n", "\n");
    text.chars()
        .map(|letter| if is_kept(letter) { letter.into() } else { letter.escape_default().to_string() })
        .collect()
}

impl From<petsc_wrap::Error> for Error {
    /// An option that PETSc does not accept is an error in the command line. Every rank finds it, because all have the
    /// same options. A lack of memory is said in words.
    fn from(error: petsc_wrap::Error) -> Self {
        /// PETSc's error codes for unknown names of a type and of a factorisation package.
        const UNKNOWN: [i32; 2] = [86, 92];
        match error {
            petsc_wrap::Error::Petsc { code, message, frames, .. }
                if UNKNOWN.contains(&code)
                    || frames.first().is_some_and(|f| f.function.starts_with("PetscOptions")) =>
            {
                Self::Usage(format!("a PETSc option is wrong: {message}"))
            }
            petsc_wrap::Error::Petsc { frames, .. }
                if frames.first().is_some_and(|f| f.function.starts_with("PetscMalloc")) =>
            {
                let message = "the process got no more memory: a coarser mesh needs less, and so do more ranks on other machines; \
                               ulimit and batch jobs may limit it";
                Self::Alone(Box::new(Self::Solve(message.into())))
            }
            other => Self::Petsc(other),
        }
    }
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<Fault> for Error {
    fn from(fault: Fault) -> Self {
        Self::Fault(Box::new(fault))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agree::{decoded, encoded};

    /// The error received by another rank has the same kind, status and message.
    #[test]
    fn errors_survive_their_way_between_ranks() {
        let all = [
            Error::Usage("usage".into()),
            Fault::new("key", "fault", "help").into(),
            Error::Alone(Box::new(Error::Unstable("alone".into()))),
            Error::Solve("solve".into()),
            Error::Unstable("unstable".into()),
            Error::Interrupted,
            Error::Output("output".into()),
            Error::Unwritten("unwritten".into()),
            Error::io(Path::new("file"), "io"),
        ];
        for error in all {
            let told: Error = decoded(&encoded(&error.as_told()));
            assert_eq!((told.status(), told.to_string()), (error.status(), error.to_string()));
            assert!(told.is_everywhere());
        }
    }
}
