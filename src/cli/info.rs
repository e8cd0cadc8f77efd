//! `ricochet info`: what a result holds and where it comes from.

use std::path::Path;

use crate::error::Result;
use crate::record::checkpoint::is_there;
use crate::record::provenance::{Cost, Provenance};
use crate::record::read::{History, history, origin};
use crate::record::sweep::{Quantity, Status, Sweep, is_sweep};

use super::{Info, say, short};

/// Prints it.
///
/// # Errors
/// [`crate::Error::Io`] where the file is no result that can be read.
pub fn info(arguments: &Info) -> Result<()> {
    let path = &arguments.result;
    let sweep = if is_sweep(path)? { Some(Sweep::read(path)?) } else { None };
    if arguments.scene {
        let text = match &sweep {
            Some(sweep) => sweep.header.scene.clone(),
            None => origin(path)?.0.scene,
        };
        say(format_args!("{}", text.trim_end()));
        return Ok(());
    }
    match sweep {
        Some(sweep) => of_sweep(&sweep),
        None => {
            let (provenance, cost, complete) = origin(path)?;
            of_run(path, (&provenance, &cost, complete), &history(path)?);
        }
    }
    Ok(())
}

fn of_run(path: &Path, (provenance, cost, complete): (&Provenance, &Cost, bool), history: &History) {
    let Provenance { title, version, commit, petsc_version, petsc_options, ranks, model, reduction, unknowns, .. } =
        provenance;
    let options = if petsc_options.is_empty() { "no options" } else { petsc_options };
    say(format_args!("title      {title}"));
    say(format_args!(
        "program    ricochet {version} ({commit}), PETSc {petsc_version} with {options}, {}",
        ranks_of(*ranks)
    ));
    say(format_args!("model      {model}, {unknowns} unknowns, reduction {reduction}"));
    let end = history.time.last().copied().unwrap_or_default();
    let state = match complete {
        true => "complete".to_owned(),
        false if is_there(path, provenance.run_id) => {
            format!("not complete; it goes on with --restart {}", path.display())
        }
        false => "not complete, without a checkpoint".to_owned(),
    };
    say(format_args!("series     {} rows to t = {} s, {state}", history.time.len(), short(end)));
    let peak = history.acceleration.iter().copied().fold(0.0, f64::max);
    let at = history.acceleration.iter().position(|a| *a == peak).map_or(0.0, |row| history.time[row]);
    say(format_args!("peak       {} m/s² at {} ms", short(peak), short(1e3 * at)));
    for ((start, end), impulse) in history.contacts.iter().zip(&history.impulses) {
        say(format_args!("contact    {} to {} ms, {} N s", short(1e3 * start), short(1e3 * end), short(*impulse)));
    }
    if !cost.error_estimate.is_nan() {
        say(format_args!("error      estimated {:.1e} of the peak over the whole history", cost.error_estimate));
    }
    if !cost.total.is_nan() {
        let Cost { model, setup, steps, total, solves, newton_iterations, .. } = cost;
        say(format_args!(
            "cost       {total:.3} s (model {model:.3}, setup {setup:.3}, steps {steps:.3}), {solves} solves and {newton_iterations} Newton iterations"
        ));
    }
}

fn of_sweep(sweep: &Sweep) {
    let header = &sweep.header;
    say(format_args!("title      {}", header.title));
    say(format_args!(
        "program    ricochet {} ({}), PETSc {}, {}",
        header.version,
        header.commit,
        header.petsc_version,
        ranks_of(header.ranks)
    ));
    for key in &header.keys {
        say(format_args!("varied     {} [{}], {} values", key.path, key.units, key.values.count()));
    }
    let count = |status: Status| sweep.status.iter().filter(|one| **one == status).count();
    say(format_args!(
        "members    {} done, {} failed, {} refused, {} missing{}",
        count(Status::Done),
        count(Status::Failed),
        count(Status::Refused),
        count(Status::Missing),
        header.shard.map_or(String::new(), |(i, n)| format!("; part {i} of {n}"))
    ));
    let peaks = sweep.quantity(Quantity::PeakAcceleration);
    let done = || sweep.status.iter().zip(peaks).filter(|(status, _)| **status == Status::Done).map(|(_, peak)| *peak);
    if let (Some(low), Some(high)) = (done().reduce(f64::min), done().reduce(f64::max)) {
        say(format_args!("peaks      {} to {} m/s²", short(low), short(high)));
    }
}

fn ranks_of(ranks: usize) -> String {
    if ranks == 1 { "1 rank".to_owned() } else { format!("{ranks} ranks") }
}
