//! Terminal output: colours, bars, and verbosity.

use std::io::{self, IsTerminal};
use std::sync::OnceLock;

/// Amount of output of a command on standard error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verbosity {
    /// Only warnings and errors.
    Quiet,
    /// Also progress and notes.
    Usual,
    /// Also decisions of the program.
    Verbose,
    /// All messages.
    Debug,
}

static VERBOSITY: OnceLock<Verbosity> = OnceLock::new();

/// Sets the verbosity. Only the first call has an effect.
pub fn set_verbosity(verbosity: Verbosity) {
    VERBOSITY.get_or_init(|| verbosity);
}

/// Verbosity; [`Verbosity::Usual`] if it has not been set.
pub fn verbosity() -> Verbosity {
    VERBOSITY.get().copied().unwrap_or(Verbosity::Usual)
}

/// Whether colours are used on standard error: on a terminal that is not dumb, unless NO_COLOR is set (no-color.org).
pub fn has_colours() -> bool {
    is_interactive() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Whether progress bars are drawn.
pub fn has_bars() -> bool {
    is_interactive() && verbosity() > Verbosity::Quiet
}

/// Whether standard error is a terminal that can be redrawn.
fn is_interactive() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}
