//! `ricochet limit`: finds the lowest value of a key at which the largest tension reaches the strength.

mod report;
mod table;
mod trial;

use std::rc::Rc;

use petsc_wrap::Comm;

use crate::agree::decided;
use crate::error::{Error, Result};
use crate::record::lock::Lock;
use crate::scene::{Model, Scene, Source};
use crate::study::limit::{Range, search};
use crate::study::sweep::written;

use super::interrupt::{Ending, Interrupt};
use super::load::{Loaded, load};
use super::notes::Remark;
use super::run::{Beginning, Replaced, Written, check_output, solve};
use super::sweep::of_base;
use super::{Limit, note, notes, say_json, tell, warn_of_unused_options};
use report::Report;
use table::{header, line, with_unit};
use trial::{Discretisation, Trial, trial};

/// Searches for the limit; returns the exit status. It is also a valid answer that there is no limit in the range.
/// Collective.
///
/// # Errors
/// Any [`Error`].
pub fn limit(comm: &Comm, arguments: &Limit) -> Result<i32> {
    let range = Range::parse(&arguments.vary).map_err(Error::Usage)?;
    let Loaded { scene, source, .. } = load(comm, &arguments.scene).map_err(of_base)?;
    check(&scene, &range)?;
    // Values that do not give a valid scene are found before the first run.
    let has_output = arguments.output.is_some();
    for value in range.values() {
        at(&source, &range, value, has_output)?;
    }
    // On rank 0: held until the end.
    let mut lock = None;
    decided(comm, || {
        if let Some(output) = &arguments.output {
            check_output(&scene, output, Replaced::UnlessInterrupted)?;
            lock = Some(Lock::take(output)?);
        }
        let odd = notes::texts(odd_values((&scene, &source), &range)?);
        odd.iter().for_each(|warning| tell(format_args!("warning: {warning}")));
        note(format_args!("{}", header(&range)));
        Ok(())
    })?;
    let interrupt = Rc::new(Interrupt::new(Ending::AtOnce));
    let mut trials: Vec<Trial> = Vec::new();
    let run = |value: f64, discretisation: Option<&Discretisation>| {
        let (scene, source) = at(&source, &range, value, false)?;
        trial(comm, (&scene, &source), discretisation, &interrupt).map_err(|error| named(error, &range, value))
    };
    // Theory and cells are those of the end of the range with the larger tension, where errors count most. One of the ends
    // may have no result.
    let ends = match (run(range.from, None), run(range.to, None)) {
        (Err(Error::Interrupted), _) | (_, Err(Error::Interrupted)) => return Err(Error::Interrupted),
        (Err(error), Err(_)) => return Err(error),
        (low, high) => [low.ok(), high.ok()],
    };
    let larger = ends.into_iter().flatten().max_by(|one, other| one.0.ratio.total_cmp(&other.0.ratio));
    let discretisation = larger.map(|(_, discretisation)| discretisation);
    let mut ratio = |value: f64| {
        let (utilisation, _) = run(value, discretisation.as_ref())?;
        let ratio = utilisation.ratio;
        trials.push(Trial { value, utilisation });
        if let Some(last) = trials.last().filter(|_| comm.is_root()) {
            note(format_args!("{}", line(&range, trials.len(), last)));
        }
        Ok::<_, Error>(ratio)
    };
    let found = search(&range, scene.tolerance, &mut ratio)?;
    // The upper end of the range shows whether the ratio crosses 1 again. That it cannot be computed there is no error.
    if found.root.is_some() && found.samples.iter().all(|sample| sample.value < range.to) {
        match ratio(range.to) {
            Ok(_) | Err(Error::Solve(_) | Error::Unstable(_) | Error::Fault(_) | Error::Scene(_)) => {}
            Err(error) => return Err(error),
        }
    }
    let report = Report::new(&range, scene.tolerance, &found, &trials, arguments.output.as_deref());
    if let Some(report) = report.filter(|_| comm.is_root()) {
        if arguments.json {
            say_json(&report)
        } else {
            report.print()
        }
        report.remarks().iter().for_each(|remark| tell(format_args!("warning: {remark}")));
        warn_of_unused_options(comm)?;
    }
    let status = match (&found.root, &arguments.output) {
        (Some(root), Some(output)) => {
            let (scene, source) = at(&source, &range, root.at.value, true)?;
            let of_theory = discretisation.as_ref().map(|discretisation| discretisation.of_theory);
            let written = Written { output, force: false, has_summary: false, of_theory };
            let scene = discretisation.map_or(scene.clone(), |discretisation| discretisation.of(&scene));
            solve(comm, (&scene, &source), Beginning::Anew, &written).map_err(|error| error.in_scene(&source))?
        }
        (None, Some(output)) => {
            if comm.is_root() {
                note(format_args!("note: there is no limit in the range, so {} is not written", output.display()));
            }
            0
        }
        _ => 0,
    };
    drop(lock);
    Ok(status)
}

/// Remarks on values of the scene and of both ends of the range that are probably a mistake, one for each key. A range may
/// be in another unit too.
fn odd_values((scene, source): (&Scene, &Source), range: &Range) -> Result<Vec<Remark>> {
    let mut remarks = notes::of_values(scene, source);
    for end in [range.from, range.to] {
        let (scene, source) = at(source, range, end, false)?;
        for remark in notes::of_values(&scene, &source) {
            if remarks.iter().all(|known| known.kind != remark.kind) {
                remarks.push(remark);
            }
        }
    }
    Ok(remarks)
}

/// Refuses scenes without strength, and theories without faces.
fn check(scene: &Scene, range: &Range) -> Result<()> {
    let is_varied = range.key.starts_with("strength.");
    if !scene.strength.is_given() && !is_varied {
        let message = "a limit needs the strength of the material, for example [strength] tension = 45e6 in the scene, or --set strength.tension=45e6";
        return Err(Error::Usage(message.to_owned()));
    }
    if matches!(scene.body.model, Model::HalfSpace | Model::InfinitePlate) {
        return Err(Error::Usage(trial::without_faces(scene.body.model)));
    }
    Ok(())
}

/// The scene at a value; without `has_output` it has no fields and no probes, which the runs of the search do not keep. A probe
/// could also lie outside a thinner plate.
fn at(source: &Source, range: &Range, value: f64, has_output: bool) -> Result<(Scene, Source)> {
    let given = format!("{}={}", range.key, written(value));
    let without_probes = (!has_output).then(|| "output.probes=[]".to_owned());
    let all: Vec<String> = without_probes.into_iter().chain([given.clone()]).collect();
    let (mut scene, source) = Scene::varied(source, &all).map_err(|error| {
        // If the error concerns the key itself, the message already contains the value.
        if error.message().contains(&given) { error } else { error.remarked(&of_value(range, value)) }
    })?;
    scene.output.fields = scene.output.fields.filter(|_| has_output);
    Ok((scene, source))
}

/// Words for the value of a run, for messages.
fn of_value(range: &Range, value: f64) -> String {
    format!("at {} = {}", range.key, with_unit(&written(value), &range.key))
}

/// Adds the value of the run to the message of an error.
fn named(error: Error, range: &Range, value: f64) -> Error {
    let at_value = |message: String| format!("{message} ({})", of_value(range, value));
    match error {
        Error::Usage(message) => Error::Usage(at_value(message)),
        Error::Solve(message) => Error::Solve(at_value(message)),
        Error::Unstable(message) => Error::Unstable(at_value(message)),
        Error::Scene(error) => error.remarked(&of_value(range, value)).into(),
        Error::Alone(error) => Error::Alone(Box::new(named(*error, range, value))),
        other => other,
    }
}
