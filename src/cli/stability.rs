//! `ricochet stability`: writes a table and a map of the stable ranges of the schemes for a scene.

use petsc_wrap::Comm;

use crate::agree::decided;
use crate::error::{Error, INTERRUPTED, Result};
use crate::figure::map::{Cell, Map, Row, Value, draw};
use crate::mesh::Mesh;
use crate::record::folder::Folder;
use crate::scene::Scene;
use crate::study::stability::{STEPS_PER_CONTACT, Study};
use crate::study::table::{COLUMNS, csv, gist, theory};
use crate::study::{Verdict, label, stability as study};

use super::interrupt::{Ending, Interrupt};
use super::load::{Loaded, load};
use super::progress::Items;
use super::{Stability, say, tell, warn_of_unused_options};

/// Files of a study.
const RESULTS: [&str; 3] = ["stability.csv", "stability.svg", "stability.png"];

/// Studies a scene and writes the results; returns the exit status. Collective.
///
/// # Errors
/// Any [`Error`].
pub fn stability(comm: &Comm, arguments: &Stability) -> Result<i32> {
    if let Some(budget) = arguments.budget.filter(|budget| budget.is_nan() || *budget < 0.0) {
        return Err(Error::Usage(format!("--budget {budget}: expected a number of seconds, 0 or more")));
    }
    let Loaded { scene, source, .. } = load(comm, &arguments.scene)?;
    // Checked before minutes of work whose result could not be written.
    let mut folder = None;
    decided(comm, || {
        let made = folder.insert(Folder::create(&arguments.output)?);
        let there = std::fs::read_to_string(arguments.output.join(RESULTS[0])).unwrap_or_default();
        made.check_ours(&RESULTS, there.starts_with(COLUMNS))
    })?;
    let interrupt = Interrupt::new(Ending::AtOnce);
    let found = find(comm, &scene, arguments.budget, &interrupt).map_err(|error| error.in_scene(&source))?;
    decided(comm, || match (&folder, &found) {
        (Some(folder), Some(study)) => write(folder, study, &scene),
        _ => Ok(()),
    })?;
    if comm.is_root() {
        if let Some(study) = &found {
            gist(study).iter().for_each(|line| say(format_args!("{line}")));
            say(format_args!("{}: stability.csv, .svg, .png", arguments.output.display()));
        }
        warn_of_unused_options(comm)?;
    }
    let is_interrupted = found.as_ref().is_none_or(|study| study.is_interrupted);
    if is_interrupted && comm.is_root() {
        let what = if found.is_some() { "what was done so far is written" } else { "nothing was done so far" };
        tell(format_args!("interrupted: {what}"));
    }
    Ok(if is_interrupted { INTERRUPTED } else { 0 })
}

fn find(comm: &Comm, scene: &Scene, budget: Option<f64>, interrupt: &Interrupt) -> Result<Option<Study>> {
    let mesh = Mesh::new(comm, &scene.body)?;
    let mut progress: Option<Items> = None;
    let mut told = |now: study::Progress| {
        // From here on, there are runs to be written.
        interrupt.set(Ending::InOrder);
        if comm.is_root() {
            progress.get_or_insert_with(|| Items::new(now.planned, "runs")).over(1);
        }
    };
    let found = study::stability(&mesh, scene, budget, &mut || interrupt.is_raised(comm), &mut told);
    progress.iter().for_each(Items::finish);
    found
}

fn write(folder: &Folder, study: &Study, scene: &Scene) -> Result<()> {
    folder.put_bytes("stability.csv", csv(study))?;
    let map = map(study, scene);
    ["stability.svg", "stability.png"].into_iter().try_for_each(|name| folder.put(name, |path| draw(&map, path)))
}

/// The map of a study.
fn map(study: &Study, scene: &Scene) -> Map {
    let rows = study.rows.iter().map(|row| Row {
        label: label(row.scheme),
        note: format!("stable {}", theory(row)),
        limit: row.limit,
        cells: row
            .runs
            .iter()
            .filter(|run| run.verdict != Verdict::LeftOut)
            .map(|run| {
                let value = |number: f64| match run.verdict {
                    Verdict::Grows(_) => Value::Unbounded,
                    Verdict::Refused(_) => Value::Missing,
                    _ => Value::Number(number),
                };
                Cell {
                    step: run.step,
                    values: vec![value(run.measured.energy_error), value(run.measured.first_error)],
                    is_good: run.verdict == Verdict::Holds,
                }
            })
            .collect(),
    });
    let mut marks = vec![(study.contact / STEPS_PER_CONTACT, format!("{STEPS_PER_CONTACT} steps a contact"))];
    marks.extend(scene.time.step.map(|step| (step, "the scene's step".to_owned())));
    Map {
        title: title(study, scene),
        panels: vec!["energy error / initial energy".into(), "force error / peak, first contact".into()],
        rows: rows.collect(),
        contact: study.contact,
        marks,
        good: format!("both within {:e}", study.tolerance),
    }
}

/// Title of the map. It says how many of the planned runs are missing.
fn title(study: &Study, scene: &Scene) -> String {
    match (study.left_out(), scene.title.trim()) {
        (0, title) => title.to_owned(),
        (count, "") => format!("{count} of {} runs left out", study.planned()),
        (count, title) => format!("{title} ({count} of {} runs left out)", study.planned()),
    }
}
