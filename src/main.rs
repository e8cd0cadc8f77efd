//! The program `ricochet`: starts MPI and PETSc, runs the command, and turns an error into one message and an exit
//! status.

use std::process::exit;
use std::time::Duration;

use clap::Parser;
use petsc_wrap::Session;
use ricochet::cli::terminal::{self, Verbosity};
use ricochet::cli::{self, Cli, Command, tell};
use ricochet::error::Error;

fn main() {
    petsc_wrap::keep_freed_memory();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // Every rank gets the same message. One of them prints it.
        Err(error) if cli::is_root_by_environment() => error.exit(),
        Err(error) => {
            // A request for help is also returned as an error. Nobody waits for it.
            if error.exit_code() != 0 {
                let_root_tell();
            }
            exit(error.exit_code())
        }
    };
    terminal::set_verbosity(match (cli.quiet, cli.verbose) {
        (true, _) => Verbosity::Quiet,
        (_, 0) => Verbosity::Usual,
        (_, 1) => Verbosity::Verbose,
        _ => Verbosity::Debug,
    });
    cli::log_to_stderr();
    match &cli.command {
        // Under mpirun, only one rank runs these commands.
        Command::Plot(_)
        | Command::Report(_)
        | Command::Info(_)
        | Command::Completions(_)
        | Command::Schema
        | Command::Man(_)
            if !cli::is_root_by_environment() =>
        {
            exit(0)
        }
        Command::Plot(plot) => {
            conclude(None, cli::plot::plot(&plot.results, &plot.output, plot.quantity.as_deref()).map(|()| 0))
        }
        Command::Info(info) => conclude(None, cli::info::info(info).map(|()| 0)),
        Command::Report(report) => conclude(None, cli::report::report(report).map(|()| 0)),
        Command::Completions(completions) => conclude(None, cli::text::completions(completions).map(|()| 0)),
        Command::Schema => conclude(None, cli::text::schema().map(|()| 0)),
        Command::Man(man) => conclude(None, cli::text::man(man).map(|()| 0)),
        Command::Run(run) => under_petsc(&run.scene.petsc, |session| cli::run::run(&session.world(), run)),
        Command::Stability(stability) => {
            under_petsc(&stability.scene.petsc, |session| cli::stability::stability(&session.world(), stability))
        }
        Command::Chart(chart) => under_petsc(&chart.scene.petsc, |session| cli::chart::chart(&session.world(), chart)),
        Command::Sweep(sweep) => under_petsc(&sweep.scene.petsc, |session| cli::sweep::sweep(&session.world(), sweep)),
        Command::Limit(limit) => under_petsc(&limit.scene.petsc, |session| cli::limit::limit(&session.world(), limit)),
        Command::Check(check) => {
            under_petsc(&check.scene.petsc, |session| cli::check::check(&session.world(), check).map(|()| 0))
        }
    }
}

fn under_petsc(options: &[String], work: impl FnOnce(&Session) -> Result<i32, Error>) {
    if let Some(message) = cli::refused_for_petsc(options) {
        conclude(None, Err(Error::Usage(message)));
    }
    cli::environment::set();
    cli::interrupt::install();
    match Session::start(options) {
        Some(Ok(session)) => {
            let result = work(&session);
            conclude(Some(session), result);
        }
        Some(Err(error @ petsc_wrap::Error::NotLoaded(_))) => conclude(None, Err(Error::from(error))),
        // Before a scene is read, PETSc can refuse nothing but its options.
        Some(Err(error)) => conclude(None, Err(Error::Usage(format!("PETSc refuses its options: {error}")))),
        None => unreachable!("MPI is initialised here alone"),
    }
}

/// Waits while rank 0 prints the error. mpirun ends all ranks when the first one exits; on a busy machine this may be
/// before rank 0 has printed anything.
fn let_root_tell() {
    std::thread::sleep(Duration::from_secs(2));
}

/// Ends the program. If all ranks have the error, one of them prints it and all end in order. If a single rank has it,
/// that rank prints it and ends the others.
fn conclude(session: Option<Session>, result: Result<i32, Error>) -> ! {
    let result = result.and_then(|status| cli::check_stdout().map(|()| status));
    let Err(error) = result else {
        if let Some(Err(error)) = session.map(Session::finish) {
            tell(format_args!("ricochet: PETSc did not end in order: {error}"));
        }
        exit(result.unwrap_or_default());
    };
    let report = error.report(terminal::has_colours());
    let status = error.status();
    let root = session.as_ref().map_or_else(cli::is_root_by_environment, |session| session.world().is_root());
    match session {
        // After a failed write, HDF5 crashes in its exit handler. Therefore even a single rank exits without the
        // handlers.
        Some(session) if !error.is_everywhere() && (session.world().size() > 1 || error.status() == 4) => {
            if session.world().size() == 1 {
                cli::print_report(&report);
                // There are no other ranks to end, and MPI would report that it ended some.
                session.leave(status);
            }
            if !root {
                let_root_tell();
            }
            cli::print_report(&report);
            session.abort(status);
        }
        session => {
            if root {
                cli::print_report(&report);
            } else if session.is_none() {
                let_root_tell();
            }
            if let (Some(session), Error::Unwritten(_)) = (&session, &error) {
                if !root {
                    let_root_tell();
                }
                // After a failed write, HDF5 crashes in its exit handler, and also when MPI finalises.
                session.leave(status);
            }
            drop(error);
            // An error while PETSc finalises matters less than this error.
            drop(session.map(Session::finish));
            exit(status);
        }
    }
}
