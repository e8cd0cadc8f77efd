//! Prints texts about the program itself: completions for shells, a schema for editors, and manual pages.

use clap::CommandFactory;

use crate::error::{Error, Result};
use crate::record::folder::Folder;
use crate::scene;

use super::{Cli, Completions, Man, check_stdout, say, say_json};

/// Prints completions for a shell.
///
/// # Errors
/// [`Error::Io`] if they cannot be written.
pub fn completions(arguments: &Completions) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "ricochet", &mut script);
    say(format_args!("{}", String::from_utf8_lossy(&script).trim_end()));
    check_stdout()
}

/// Prints the JSON schema of scenes.
///
/// # Errors
/// [`Error::Io`] if it cannot be written.
pub fn schema() -> Result<()> {
    say_json(&scene::schema());
    check_stdout()
}

/// Writes the manual: one page for the program and one for each command.
///
/// # Errors
/// [`Error::Io`] if the folder or a page cannot be written.
pub fn man(arguments: &Man) -> Result<()> {
    let folder = Folder::create(&arguments.output)?;
    let mut program = Cli::command();
    program.build();
    let mut names = Vec::new();
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    for (name, command) in [("ricochet".to_owned(), program.clone())]
        .into_iter()
        .chain(commands.map(|command| (format!("ricochet-{}", command.get_name()), command.clone())))
    {
        let mut page = Vec::new();
        let file = format!("{name}.1");
        let rendered = clap_mangen::Man::new(command).title(name).render(&mut page);
        rendered.map_err(|error| Error::io(&arguments.output, error))?;
        let there = std::fs::read_to_string(arguments.output.join(&file)).unwrap_or_default();
        if !there.is_empty() && !there.contains(".TH ricochet") {
            return Err(Error::io(&arguments.output.join(&file), "is no page of this manual, so it is not replaced"));
        }
        folder.put_bytes(&file, &page)?;
        names.push(file);
    }
    say(format_args!("{}: {}", arguments.output.display(), names.join(", ")));
    Ok(())
}
