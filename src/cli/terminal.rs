//! What may be written on the terminal: colours, bars, and how much.

use std::io::{self, IsTerminal};
use std::sync::OnceLock;

/// How much a command says on standard error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verbosity {
    /// Warnings and errors.
    Quiet,
    /// Progress and notes too.
    Usual,
    /// What is decided on the way too.
    Verbose,
    /// All.
    Debug,
}

static VERBOSITY: OnceLock<Verbosity> = OnceLock::new();

/// Sets how much is said, once.
pub fn set_verbosity(verbosity: Verbosity) {
    VERBOSITY.get_or_init(|| verbosity);
}

/// How much is said.
pub fn verbosity() -> Verbosity {
    VERBOSITY.get().copied().unwrap_or(Verbosity::Usual)
}

/// Whether standard error takes colours: a terminal that is not dumb, without NO_COLOR (no-color.org).
pub fn has_colours() -> bool {
    is_interactive() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Whether bars of progress are drawn.
pub fn has_bars() -> bool {
    is_interactive() && verbosity() > Verbosity::Quiet
}

/// Whether standard error can be drawn on again: a terminal that is not dumb.
fn is_interactive() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}
