//! Command line: definition of the arguments, and one file for each subcommand.

mod bench;
pub mod chart;
pub mod check;
pub mod checkpoint_writer;
mod collect;
pub mod environment;
mod follow;
pub mod info;
pub mod interrupt;
pub mod limit;
mod load;
mod members;
pub mod notes;
mod petsc;
pub mod plot;
mod progress;
mod provenance;
mod recording;
pub mod report;
mod restart;
pub mod run;
pub mod stability;
pub mod summary;
pub mod sweep;
pub mod terminal;
pub mod text;

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use clap::{ArgAction, Args, Parser, Subcommand};
use serde::Serialize;

use crate::error::{Error, Result, visible};
use crate::study::sweep::Shard;

pub use petsc::refused as refused_for_petsc;
use petsc::warn_of_unused as warn_of_unused_options;
use terminal::Verbosity;

/// Version and commit.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("RICOCHET_COMMIT"), ")");

/// Low-velocity impact on elastic plates and bodies.
///
/// Start with `ricochet check SCENE.toml`, then `ricochet run SCENE.toml` and `ricochet plot RESULT.h5 -o FIGURE.png`. Runs alone or under mpirun.
#[derive(Debug, Parser)]
#[command(version = VERSION, about, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print more on standard error; -vv for debug output
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
    /// Print only warnings and errors on standard error
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compute an impact and write its history to an HDF5 file
    Run(Run),
    /// Validate a scene and say what will be solved, and what it costs
    Check(Check),
    /// Print what a result holds and where it comes from
    Info(Info),
    /// Draw the impactor's acceleration, or another quantity, against time, one curve a result; or a sweep over its keys
    Plot(Plot),
    /// Write a report on a run, to hand in: one HTML page with scene, model, history, contacts, tension, errors and origin
    Report(Report),
    /// Show where each time integration scheme holds on a scene and where it fails: schemes × steps
    Stability(Stability),
    /// Chart speed against accuracy on a scene: models × reductions × schemes × steps × meshes, in place of those of the scene
    Chart(Chart),
    /// Compute a scene for many values of its keys, and write the peaks and contacts of all members to an HDF5 file
    Sweep(Sweep),
    /// Find the lowest value of a key at which the largest tension just reaches the strength, which the scene gives
    Limit(Limit),
    /// Print a script that completes commands and options in a shell
    Completions(Completions),
    /// Print a JSON schema of scenes, for editors that check them
    Schema,
    /// Write the manual's pages
    Man(Man),
}

/// `ricochet completions`
#[derive(Debug, Args)]
pub struct Completions {
    /// Shell
    pub shell: clap_complete::Shell,
}

/// `ricochet man`
#[derive(Debug, Args)]
pub struct Man {
    /// Folder for ricochet.1 and a page for each command; made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Scene of a command, and options for PETSc.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// Scene file (TOML), - for standard input, or a result, whose scene is computed again
    #[arg(value_name = "SCENE")]
    pub file: PathBuf,
    /// Override a key of the scene, such as time.step=1e-6 or support.0.stiffness=1e9 (entries count from 0; repeatable)
    #[arg(long = "set", value_name = "KEY=VALUE", allow_hyphen_values = true)]
    pub overrides: Vec<String>,
    /// For a result as the scene: use the options for PETSc that it was made with. They are left out by default, since such options can
    /// write files
    #[arg(long, conflicts_with = "petsc")]
    pub stored_options: bool,
    /// Options for PETSc, unchanged, e.g. -- -log_view -snes_monitor
    #[arg(last = true, value_name = "PETSC OPTIONS")]
    pub petsc: Vec<String>,
}

/// `ricochet run`
#[derive(Debug, Args)]
pub struct Run {
    /// Scene, and options for PETSc.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Result file, overwritten if it is an earlier run; by default the scene's name with the ending .h5 in the current folder. Required for
    /// standard input or a result
    #[arg(short, long, value_name = "OUT.h5")]
    pub output: Option<PathBuf>,
    /// Continue the interrupted run of this result from the checkpoint beside it; in modal coordinates it begins again
    #[arg(long, value_name = "OUT.h5")]
    pub restart: Option<PathBuf>,
    /// Overwrite an interrupted run that has a checkpoint, and run even if the estimated error in the first contact exceeds half of
    /// the peak
    #[arg(long)]
    pub force: bool,
}

/// `ricochet check`
#[derive(Debug, Args)]
pub struct Check {
    /// Scene, and options for PETSc.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Build the model and estimate its errors, however long it takes
    #[arg(long)]
    pub full: bool,
    /// Print the facts as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `ricochet info`
#[derive(Debug, Args)]
pub struct Info {
    /// Result file, of a run or of a sweep
    #[arg(value_name = "OUT.h5")]
    pub result: PathBuf,
    /// Print the text of its scene, and nothing else
    #[arg(long)]
    pub scene: bool,
    /// Print the facts as one JSON object
    #[arg(long, conflicts_with = "scene")]
    pub json: bool,
}

/// `ricochet plot`
#[derive(Debug, Args)]
pub struct Plot {
    /// Result files
    #[arg(required = true, value_name = "OUT.h5")]
    pub results: Vec<PathBuf>,
    /// Figure; its ending says what it is: .svg or .png
    #[arg(short, long, value_name = "FIG.svg")]
    pub output: PathBuf,
    /// What to draw: acceleration (default), force, deflection, stress (largest tension on each face); of runs also velocity,
    /// position, indentation, energy, stress_map, stress_map/FACE, or a dataset below /series such as probe/NAME/displacement; of a
    /// sweep also a dataset below /members
    #[arg(long, value_name = "NAME")]
    pub quantity: Option<String>,
}

/// `ricochet report`
#[derive(Debug, Args)]
pub struct Report {
    /// Result file of a run
    #[arg(value_name = "OUT.h5")]
    pub result: PathBuf,
    /// Write the page to this file, which ends in .html; it needs no other file and no network
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: PathBuf,
}

/// `ricochet stability`
#[derive(Debug, Args)]
pub struct Stability {
    /// Scene, and options for PETSc.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Folder for stability.csv, .svg and .png; made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// About how long the runs may take, after the references that they are measured by, s: the finest steps are left out; by default none
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub budget: Option<f64>,
}

/// `ricochet sweep`
#[derive(Debug, Args)]
pub struct Sweep {
    /// Scene, and options for PETSc.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Result file; a sweep that is there already is continued
    #[arg(short, long, value_name = "OUT.h5")]
    pub output: PathBuf,
    /// A key of the scene and its values: a range of N numbers, both ends included, or a list; given more than once, a grid
    #[arg(long, required = true, value_name = "KEY=A..B:N | KEY=A,B,C", allow_hyphen_values = true)]
    pub vary: Vec<String>,
    /// Space all ranges logarithmically
    #[arg(long)]
    pub log: bool,
    /// Keep the series of every member, as a run has them
    #[arg(long)]
    pub series: bool,
    /// Compute only part i of n (members i, i+n, i+2n, …) and write OUT.i-of-n.h5; a sweep without --shard merges the parts
    #[arg(long, value_name = "i/n")]
    pub shard: Option<Shard>,
}

/// `ricochet limit`
#[derive(Debug, Args)]
pub struct Limit {
    /// Scene, and options for PETSc.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Search this range of a numeric key for its lowest limit, such as impactor.speed=0.1..10 or body.size.2=0.004..0.04
    #[arg(long, value_name = "KEY=A..B", allow_hyphen_values = true)]
    pub vary: String,
    /// Write the run at the limit to this file, as `ricochet run` does
    #[arg(short, long, value_name = "OUT.h5")]
    pub output: Option<PathBuf>,
    /// Print the facts as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `ricochet chart`
#[derive(Debug, Args)]
pub struct Chart {
    /// Scene, and options for PETSc.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Folder for work-precision.csv, .svg, .png and summary.md, and for the runs, which are not done again; made where it is missing
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Methods to include, separated by commas, such as mindlin,solid/newmark,auto; default: all
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    pub only: Vec<String>,
    /// About how long the runs may take, and the references as long again, s
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, allow_hyphen_values = true)]
    pub budget: f64,
    /// Result, or table of time and acceleration, to measure errors by; by default the solid is refined
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Table of other programs' runs: name, setting, seconds (or build and run), error (or series)
    #[arg(long = "with", value_name = "FILE.csv")]
    pub with: Vec<PathBuf>,
}

/// Whether this is rank 0 or a single process, according to the launcher's environment. Can be called before MPI is
/// initialised.
pub fn is_root_by_environment() -> bool {
    ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"]
        .into_iter()
        .find_map(|name| std::env::var(name).ok())
        .is_none_or(|rank| rank == "0")
}

/// Prints a line on standard output. An error is kept for [`check_stdout`].
pub fn say(line: fmt::Arguments) {
    if let Err(error) = writeln!(io::stdout(), "{}", visible(&line.to_string())) {
        // A reader that has closed the pipe, as in `ricochet check … | head -1`, needs no more output.
        if error.kind() != io::ErrorKind::BrokenPipe {
            let _ = STDOUT_ERROR.set(error.to_string());
        }
    }
}

/// Prints facts as one JSON object on standard output; NaN becomes null.
fn say_json(facts: &impl Serialize) {
    // Names and numbers only: serialisation cannot fail.
    say(format_args!("{}", serde_json::to_string_pretty(facts).unwrap_or_default()));
}

/// First error while writing to standard output.
static STDOUT_ERROR: OnceLock<String> = OnceLock::new();

/// Checks that all output has been written to standard output.
///
/// # Errors
/// [`Error::Io`] if it could not be written, for example on a full disk.
pub fn check_stdout() -> Result<()> {
    STDOUT_ERROR
        .get()
        .map_or(Ok(()), |error| Err(Error::io(Path::new("standard output"), format!("cannot be written: {error}"))))
}

/// Prints a line on standard error. Errors are ignored.
pub fn tell(line: fmt::Arguments) {
    print_report(&visible(&line.to_string()));
}

/// Prints the text of [`Error::report`], which may have colours, on standard error. Errors are ignored.
pub fn print_report(report: &str) {
    // In one piece, so that lines of several ranks do not mix.
    let _ = io::stderr().write_all(format!("{}\n", report.trim_end()).as_bytes());
}

/// Prints a progress line or a note on standard error, unless `--quiet` is given.
pub fn note(line: fmt::Arguments) {
    if terminal::verbosity() > Verbosity::Quiet {
        tell(line);
    }
}

/// Formats a number with five digits, with a power of ten if it is very small or large.
fn short(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-2..1e6).contains(&size) {
        return format!("{value:.4e}");
    }
    let before = if size < 1.0 { 0 } else { size.log10().floor() as usize };
    format!("{value:.*}", 4_usize.saturating_sub(before))
}

/// Formats a coordinate, m. A value below 1e-9 is rounding of a sum, and shown as zero.
fn coordinate(value: f64) -> String {
    short(if value.abs() < 1e-9 { 0.0 } else { value })
}

/// Sets up the log on standard error: warnings, and more with `-v`, `-vv`, or `RICOCHET_LOG=info` or `debug`.
pub fn log_to_stderr() {
    let usual = match terminal::verbosity() {
        Verbosity::Quiet | Verbosity::Usual => "warn",
        Verbosity::Verbose => "ricochet=info,warn",
        Verbosity::Debug => "ricochet=debug,info",
    };
    let filter = tracing_subscriber::EnvFilter::try_from_env("RICOCHET_LOG")
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new(usual));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(terminal::has_colours())
        .without_time()
        .with_target(false)
        .init();
}
