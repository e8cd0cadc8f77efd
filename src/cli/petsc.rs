//! Checks the options for PETSc on the command line.

use clap::CommandFactory;
use petsc_wrap::{Comm, options};

use crate::error::Result;

use super::Cli;

/// Error message for the words after `--`; `None` if they are accepted.
pub fn refused(words: &[String]) -> Option<String> {
    // PETSc would take such a word for the value of an option of this program.
    if let Some(word) = words.first().filter(|word| !word.starts_with('-')) {
        return Some(format!("expected a PETSc option such as -snes_monitor after `--`, got {word:?}"));
    }
    let program = Cli::command();
    let commands = program.get_subcommands().flat_map(clap::Command::get_arguments);
    let own: Vec<&str> = commands.chain(program.get_arguments()).filter_map(clap::Arg::get_long).collect();
    let is_own = |word: &&String| {
        let name = word.strip_prefix("--").map(|name| name.split('=').next().unwrap_or_default());
        *word == "-o" || name.is_some_and(|name| own.contains(&name))
    };
    if let Some(word) = words.iter().find(is_own) {
        return Some(format!("{word} stands after `--`, where PETSc's options are: write it before `--`"));
    }
    let files = words.windows(2).filter(|pair| pair[0] == "-options_file").map(|pair| &pair[1]);
    let unreadable = |file: &String| std::fs::read(file).err().map(|why| format!("-options_file {file}: {why}"));
    files.filter_map(unreadable).next()
}

/// Warns of options that PETSc has not used, since they may be misspelt.
pub(super) fn warn_of_unused(comm: &Comm) -> Result<()> {
    for name in options::unused(comm.session())? {
        tracing::warn!("PETSc has not used the option -{name}");
    }
    Ok(())
}
