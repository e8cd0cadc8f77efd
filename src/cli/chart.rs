//! `ricochet chart`: charts speed against accuracy for a scene.

use std::path::PathBuf;
use std::rc::Rc;

use petsc_wrap::Comm;

use crate::agree::{decided, of_root};
use crate::error::{Error, INTERRUPTED, Result};
use crate::figure::precision::{Method as Line, Precision, Setting, draw};
use crate::record::folder::Folder;
use crate::scene::Scene;
use crate::study::chart::{
    Errors, Foreign, Ladder, Method, Point, Reference, TimedRun, check_same_impact, cleared, comparable, csv, foreign,
    history, refine, runs, settings_of, summary,
};
use crate::study::history::Difference;

use super::bench::Bench;
use super::interrupt::{Ending, Interrupt};
use super::load::{Loaded, load};
use super::progress::Items;
use super::{Chart, note, say, tell, warn_of_unused_options};

/// Files of a chart.
const RESULTS: [&str; 4] = ["work-precision.csv", "summary.md", "work-precision.svg", "work-precision.png"];
/// Name of the folder of its runs.
const RUNS: &str = "runs";

/// Charts a scene and writes the results; returns the exit status. Collective.
///
/// # Errors
/// Any [`Error`].
pub fn chart(comm: &Comm, arguments: &Chart) -> Result<i32> {
    if arguments.budget.is_nan() || arguments.budget <= 0.0 {
        return Err(Error::Usage(format!("--budget {}: expected a number of seconds above 0", arguments.budget)));
    }
    let Loaded { scene: given, source: given_source, .. } = load(comm, &arguments.scene)?;
    let (name, folder, text) = (given_source.name(), given_source.folder(), given_source.text());
    let (scene, source) = Scene::within(name, folder, text, &cleared(&given))?;
    let ladder = Ladder::new(&scene);
    let methods = selected(ladder.methods(), &arguments.only)?;
    let (peers, known) = read(comm, arguments, (&given, given_source.text()))?;

    let mut folder = None;
    decided(comm, || {
        let made = folder.insert(Folder::create(&arguments.output)?);
        let are_ours = arguments.output.join(RUNS).exists();
        made.claim(("chart.toml", given_source.text()), &RESULTS, are_ours)
    })?;
    let interrupt = Rc::new(Interrupt::new(Ending::Soon));
    let (asked, ranks) = (interrupt, comm.clone());
    let place = arguments.output.join(RUNS);
    let bench = Bench::new(comm, &source, &place, Rc::new(move || asked.is_raised(&ranks)))?;

    let all = methods.iter().map(|method| method.rungs.len()).sum();
    let mut progress = comm.is_root().then(|| Items::new(all, "runs"));
    let mut told = |over: usize| progress.iter_mut().for_each(|progress| progress.over(over));
    let mut timed = |name: &str, settings: &[String]| bench.outcome(name, settings, true);
    let runs = runs(&methods, arguments.budget, &mut timed, &mut told)?;
    progress.iter().for_each(Items::finish);
    let decide = |mine: bool| of_root(comm, Some(mine));
    let reference = match known {
        _ if runs.is_interrupted => None,
        Some(reference) => Some(reference),
        None => {
            if comm.is_root() {
                note(format_args!("{} runs; the solid is refined to measure them by", runs.done.len()));
            }
            let mut once = |name: &str, settings: &[String]| bench.outcome(name, settings, false);
            refine(&ladder, &runs.done, arguments.budget, &mut once, &decide)?
        }
    };
    let Some(reference) = reference else {
        if comm.is_root() {
            let kept = runs.done.len();
            tell(format_args!("interrupted: {kept} runs are kept; the same command continues"));
        }
        return Ok(INTERRUPTED);
    };
    decided(comm, || {
        let points = points(&methods, &runs.done, &peers, &reference);
        let title =
            if given.title.is_empty() { arguments.scene.file.display().to_string() } else { given.title.clone() };
        folder.map_or(Ok(()), |folder| write(&folder, &title, &points, &reference, &runs.left_out))
    })?;
    if comm.is_root() {
        say(format_args!("{}: work-precision.csv, .svg, .png, summary.md", arguments.output.display()));
        warn_of_unused_options(comm)?;
    }
    Ok(0)
}

/// Selects methods by name: one method (`solid`), all of a theory (`solid/*`), or all that contain a word (`newmark`).
fn selected(methods: Vec<Method>, only: &[String]) -> Result<Vec<Method>> {
    if only.is_empty() {
        return Ok(methods);
    }
    let is_named = |method: &Method, name: &str| match name.strip_suffix("/*") {
        Some(theory) => method.name.split('/').next() == Some(theory),
        None if methods.iter().any(|other| other.name == name) => method.name == name,
        None => method.name.split('/').any(|word| word == name),
    };
    if let Some(unknown) = only.iter().find(|name| !methods.iter().any(|method| is_named(method, name))) {
        let names: Vec<&str> = methods.iter().map(|method| method.name.as_str()).collect();
        return Err(Error::Usage(format!("--only {unknown}: no method of this scene; there are {}", names.join(", "))));
    }
    let found = methods.iter().filter(|method| only.iter().any(|name| is_named(method, name)));
    Ok(found.cloned().collect())
}

/// Reads the results of other programs and a given reference, on rank 0. Collective.
fn read(comm: &Comm, arguments: &Chart, (scene, text): (&Scene, &str)) -> Result<(Vec<Foreign>, Option<Reference>)> {
    let mass = scene.impactor.mass;
    let read = || -> Result<_> {
        let mut peers = Vec::new();
        for path in &arguments.with {
            peers.extend(foreign(path, mass)?);
        }
        let reference = |path: &PathBuf| {
            let found = comparable(path, history(path, mass)?)?;
            if path.extension().is_some_and(|extension| extension == "h5") {
                check_same_impact(path, scene, text)?;
            }
            Ok::<_, Error>(found)
        };
        Ok((peers, arguments.reference.as_ref().map(reference).transpose()?))
    };
    let (mut peers, mut history) = (Vec::new(), None);
    decided(comm, || {
        (peers, history) = read()?;
        Ok(())
    })?;
    let unknown = Difference { first: f64::NAN, whole: f64::NAN, tension: f64::NAN };
    let reference = arguments.reference.as_ref().map(|path| Reference {
        setting: path.display().to_string(),
        history: history.unwrap_or_default(),
        agreement: unknown,
    });
    Ok((peers, reference))
}

/// Points of all runs, sorted by method, and of the other programs.
fn points(methods: &[Method], runs: &[TimedRun], peers: &[Foreign], reference: &Reference) -> Vec<Point> {
    let own = |run: &TimedRun| {
        let timed = &run.timed;
        let tolerance = run.settings.iter().find_map(|setting| setting.strip_prefix("accuracy.tolerance="));
        let vectors = if timed.reduction == "none" { String::new() } else { format!(", {}", timed.reduction) };
        Point {
            method: run.method.clone(),
            setting: settings_of(&run.settings),
            auto: tolerance.filter(|_| run.method == "auto").and_then(|tolerance| tolerance.parse().ok()),
            is_foreign: false,
            seconds: [timed.build, timed.run],
            body: format!("{}, {} unknowns{vectors}", timed.model, timed.unknowns),
            solves: timed.solves,
            estimate: Some(timed.estimate).filter(|estimate| estimate.is_finite()),
            errors: Errors::of(&timed.history, &reference.history),
        }
    };
    let peer = |peer: &Foreign| Point {
        method: peer.name.clone(),
        setting: peer.setting.clone(),
        auto: None,
        is_foreign: true,
        seconds: peer.seconds,
        body: String::new(),
        solves: 0,
        estimate: None,
        errors: peer.errors(&reference.history),
    };
    let of_method = |method: &Method| runs.iter().filter(|run| run.method == method.name).map(own).collect::<Vec<_>>();
    methods.iter().flat_map(of_method).chain(peers.iter().map(peer)).collect()
}

fn write(folder: &Folder, title: &str, points: &[Point], reference: &Reference, left_out: &[String]) -> Result<()> {
    let floor = reference.floor();
    folder.put_bytes("work-precision.csv", csv(points, floor))?;
    folder.put_bytes("summary.md", summary(title, points, reference, left_out))?;
    let figure =
        Precision { title: title.to_owned(), methods: lines(points), floor: [floor.first, floor.whole, floor.tension] };
    ["work-precision.svg", "work-precision.png"]
        .into_iter()
        .try_for_each(|name| folder.put(name, |path| draw(&figure, path)))
}

/// Lines of the figure. `auto` is drawn above all others.
fn lines(points: &[Point]) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for point in points {
        let setting = Setting {
            seconds: point.total(),
            errors: {
                let Difference { first, whole, tension } = point.errors.history;
                [first, whole, tension]
            },
            mark: point.auto.map(|tolerance| format!("{tolerance:e}")),
        };
        match lines.iter_mut().find(|line| line.label == point.method) {
            Some(line) => line.settings.push(setting),
            None => {
                lines.push(Line { label: point.method.clone(), is_foreign: point.is_foreign, settings: vec![setting] })
            }
        }
    }
    // The line of another program goes from fast to slow, whatever the order of its points.
    let foreign = lines.iter_mut().filter(|line| line.is_foreign);
    foreign.for_each(|line| line.settings.sort_by(|a, b| a.seconds.total_cmp(&b.seconds)));
    lines
}
