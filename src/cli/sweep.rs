//! `ricochet sweep`: computes a scene for many values of its keys, and writes one result.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::time::Instant;

use petsc_wrap::Comm;

use crate::agree::{decided, of_root};
use crate::error::{Error, INTERRUPTED, Result};
use crate::model;
use crate::record::provenance::Origin;
use crate::record::stress::StrengthVerdict;
use crate::record::sweep::{Header, Member, Quantity, Status, Sweep as Shard, SweepWriter};
use crate::scene::{Model, Scene, Source};
use crate::study::sweep::{Bodies, Found, Grid, Grouping, Property, Task, Variation, digest, parts, schedule};

use super::follow::Follower;
use super::interrupt::{Ending, Interrupt};
use super::load::{Loaded, load};
use super::members::{MemberFacts, Remarks, tell_of_idle_keys};
use super::progress::Items;
use super::provenance::origin;
use super::{Sweep, note, say, short, tell, warn_of_unused_options};

/// Key whose values are files. Their contents are stored in the scenes of the members.
const TABLE: &str = "contact.table";

/// Computes the missing members of a sweep; returns the exit status. Collective.
///
/// # Errors
/// Any [`Error`]. Members whose solve fails are only counted.
pub fn sweep(comm: &Comm, arguments: &Sweep) -> Result<i32> {
    let begin = Instant::now();
    let variations = arguments.vary.iter().map(|given| Variation::parse(given, arguments.log));
    let mut grid = variations.collect::<std::result::Result<_, _>>().and_then(Grid::new).map_err(Error::Usage)?;
    let Loaded { scene, source, .. } = load(comm, &arguments.scene).map_err(of_base)?;
    let tables = decided(comm, || {
        let contents = |file: &String| Ok(Scene::table_in_file(&source, file)?);
        grid.texts(TABLE).iter().map(contents).collect::<Result<Vec<String>>>()
    })?;
    grid.set_contents(TABLE, tables);
    let grid = grid;
    let (mut grouping, mut remarks, mut facts) = (Grouping::default(), Remarks::default(), Vec::new());
    for index in 0..grid.len() {
        let on_line = grid.line().and_then(|key| Some((property_of(key)?, grid.number(index, key)?)));
        let member = task(arguments, &source, &grid, index)?;
        grouping.count(index, &member.scene, on_line);
        if comm.is_root() {
            remarks.of_scene(index, &member.scene, &member.source);
            facts.push(MemberFacts::new(&member.scene));
        }
    }
    let header = header(comm, arguments, &grid, (&scene, &source))?;
    let (mut recorder, mut todo) = (None, Vec::new());
    let is_something_missing = decided(comm, || {
        todo = recorder.insert(SweepRecorder::open(arguments, &header)?).missing();
        remarks.tell(&grid);
        Ok(!todo.is_empty())
    })?;
    let recorder = recorder.map(|recorder| {
        Rc::new(RefCell::new(SweepRecorder { progress: Items::new(todo.len(), "members"), ..recorder }))
    });

    let (interrupt, alone) = (Rc::new(Interrupt::new(Ending::Soon)), comm.session().alone());
    // One theory for all members, so that it does not change from one to the next.
    let theory = match (scene.body.model, is_something_missing) {
        (Model::Auto, true) if !grid.varies("body.model") => {
            let follower = Follower::new(comm, interrupt.clone());
            let found = grouping.theory(comm, |index| Ok(task(arguments, &source, &grid, index)?.scene), &follower);
            if matches!(found, Err(Error::Interrupted)) {
                return Ok(interrupted(comm));
            }
            let theory = found?;
            if comm.is_root() {
                note(format_args!("{}", of_all_members(&theory, &grid)));
            }
            Some(theory)
        }
        _ => None,
    };
    let scene_of = |index: usize| Ok(task(arguments, &source, &grid, index)?.scene);
    let mut bodies = Bodies::new(&alone, &grouping, &scene_of, theory, arguments.series);
    let keeper = recorder.clone();
    let flow = schedule(
        comm,
        todo,
        move || interrupt.is_raised_here(),
        &mut |index, interrupted| digest(&alone, &task(arguments, &source, &grid, index)?, &mut bodies, interrupted),
        Box::new(move |member| keeper.as_ref().map_or(Ok(()), |recorder| recorder.borrow_mut().keep(member))),
    )?;
    let mut status = if flow.is_break() { INTERRUPTED } else { 0 };
    if let Some(recorder) = recorder {
        let mut recorder = recorder.borrow_mut();
        recorder.progress.finish();
        recorder.writer.finish()?;
        let has_strength = facts.iter().any(|facts| facts.has_strength);
        recorder.print(&grid, has_strength, begin.elapsed().as_secs_f64());
        Remarks::of_results(recorder.writer.sweep(), &facts).tell(&grid);
        tell_of_idle_keys(&grid, recorder.writer.sweep());
        if flow.is_break() {
            let (missing, them) = match recorder.missing().len() {
                1 => ("1 member is".to_owned(), "it"),
                missing => (format!("{missing} members are"), "them"),
            };
            tell(format_args!("interrupted: {missing} missing; the same command computes {them}"));
        } else {
            status = recorder.status();
        }
        warn_of_unused_options(comm)?;
    }
    Ok(of_root(comm, Some(status)))
}

/// Says which theory was selected for all members, and which of them need it.
fn of_all_members(found: &Found, grid: &Grid) -> String {
    let asked_by = found.asked_by.map(|index| format!(", because {} needs it", grid.name(index)));
    let remedy = found.layerwise_suffices.map(|index| {
        format!(
            "; layerwise suffices for {} (for all members, quicker, error of the theory not estimated: --set body.model=layerwise)",
            grid.name(index)
        )
    });
    format!(
        "{} for all members{}{}",
        model::name(found.theory),
        asked_by.unwrap_or_default(),
        remedy.unwrap_or_default()
    )
}

/// Reports an interruption before the first member.
fn interrupted(comm: &Comm) -> i32 {
    if comm.is_root() {
        tell(format_args!("interrupted: members are missing; the same command computes them"));
    }
    INTERRUPTED
}

/// Marks an error of the scene as independent of the varied values.
pub(super) fn of_base(error: Error) -> Error {
    match error {
        Error::Scene(error) => error.remarked("in the scene itself, before --vary").into(),
        other => other,
    }
}

/// Property that a key such as `support.NUMBER.stiffness` or `body.temperature` changes.
fn property_of(key: &str) -> Option<Property> {
    let mut words = key.split('.');
    if words.next()? != "support" {
        return Some(Property::Relaxation);
    }
    let support = words.next()?.parse().ok()?;
    Some(if words.next()? == "damping" { Property::Damping(support) } else { Property::Stiffness(support) })
}

/// A member with its checked scene.
fn task(arguments: &Sweep, source: &Source, grid: &Grid, index: usize) -> Result<Task> {
    // The file of a sweep has no fields, and probes only in series. Without them a probe may lie outside of a member, as
    // for example outside a thinner plate.
    let are_probes_varied = grid.varies_prefix("output.probes");
    let without_probes = (!arguments.series && !are_probes_varied).then(|| "output.probes=[]".to_owned());
    let values: Vec<String> = without_probes.into_iter().chain(grid.values(index)).collect();
    let varied = Scene::varied(source, &values);
    let (mut scene, source) = varied.map_err(|error| error.remarked(&grid.name(index)))?;
    scene.output.fields = None;
    if !arguments.series {
        scene.output.probes.clear();
    }
    Ok(Task { index, scene, source, has_series: arguments.series })
}

fn header(comm: &Comm, arguments: &Sweep, grid: &Grid, (scene, source): (&Scene, &Source)) -> Result<Header> {
    let probes = scene.output.probes.iter().map(|probe| probe.name.clone());
    Ok(Header {
        origin: origin(comm, scene, source)?,
        keys: grid.keys(),
        has_series: arguments.series,
        probes: if arguments.series { probes.collect() } else { Vec::new() },
        shard: arguments.shard.map(|shard| (shard.i, shard.n)),
    })
}

/// Data of a sweep on rank 0.
struct SweepRecorder {
    writer: SweepWriter,
    progress: Items,
    output: std::path::PathBuf,
    /// Number of members that were already in the file.
    before: usize,
}

impl SweepRecorder {
    /// Opens the result, and adds the members of existing parts to it.
    fn open(arguments: &Sweep, header: &Header) -> Result<Self> {
        let output = arguments.shard.map_or(arguments.output.clone(), |shard| shard.path(&arguments.output));
        let writer = SweepWriter::open(&output, header)?;
        let Origin { version, commit, .. } = &writer.sweep().header.origin;
        if *commit != header.origin.commit {
            let output = output.display();
            note(format_args!("note: {output} was begun by another version of ricochet, {version} ({commit})"));
        }
        let mut recorder = Self { writer, progress: Items::new(0, "members"), output, before: 0 };
        if arguments.shard.is_none() && !recorder.missing().is_empty() {
            for part in parts(&arguments.output) {
                recorder.take_over(&part)?;
            }
        }
        recorder.writer.flush()?;
        recorder.before = recorder.writer.mine().count() - recorder.missing().len();
        Ok(recorder)
    }

    fn take_over(&mut self, path: &Path) -> Result<()> {
        let part = Shard::read(path)?;
        let differs = self.writer.sweep().header.check_same(&part.header);
        differs.map_err(|why| Error::io(path, format!("{why}: it cannot be a part of {}", self.output.display())))?;
        let mut count = 0;
        for index in self.missing() {
            if part.status[index] != Status::Missing {
                self.writer.push(part.member(index)?)?;
                count += 1;
            }
        }
        if count > 0 {
            note(format_args!("note: {count} members taken over from {}", path.display()));
        }
        Ok(())
    }

    /// Members that belong in this file and are missing.
    fn missing(&self) -> Vec<usize> {
        self.writer.mine().filter(|member| self.writer.sweep().status[*member] == Status::Missing).collect()
    }

    fn keep(&mut self, member: Option<Member>) -> Result<()> {
        let Some(member) = member else { return self.writer.flush_if_due() };
        self.progress.over(1);
        self.writer.push(member)
    }

    /// Exit status of a completed sweep.
    fn status(&self) -> i32 {
        let sweep = self.writer.sweep();
        match (sweep.count(Status::Failed), sweep.count(Status::Refused)) {
            (0, 0) => 0,
            (0, _) => 2,
            _ => 3,
        }
    }

    /// Prints the sweep in a few lines; with a strength, also the tensions.
    fn print(&self, grid: &Grid, has_strength: bool, time: f64) {
        let sweep = self.writer.sweep();
        let (of, done) = (|quantity| sweep.done(quantity), sweep.count(Status::Done));
        let by_value = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0);
        let (low, high) =
            (of(Quantity::PeakAcceleration).min_by(by_value), of(Quantity::PeakAcceleration).max_by(by_value));
        if let (Some((low, _)), Some((high, at))) = (low, high) {
            let count =
                |pick: fn(f64, f64) -> f64| of(Quantity::Contacts).map(|(count, _)| count).reduce(pick).unwrap_or(0.0);
            let contacts = match (count(f64::min), count(f64::max)) {
                (1.0, 1.0) => "1 contact each".to_owned(),
                (few, many) if few == many => format!("{few} contacts each"),
                (few, many) => format!("{few} to {many} contacts"),
            };
            say(format_args!(
                "peak acceleration {} to {} m/s², the largest of {}; {contacts}",
                short(low),
                short(high),
                grid.name(at)
            ));
        }
        let tensions = of(Quantity::LargestStress);
        if has_strength
            && let (Some((low, _)), Some((high, at))) = (tensions.clone().min_by(by_value), tensions.max_by(by_value))
        {
            let mut passed = of(Quantity::StrengthPassedAt);
            let (count, first) = (passed.clone().count(), passed.next());
            let undecided = StrengthVerdict::Undecided.number();
            let open = of(Quantity::StrengthVerdict).filter(|(number, _)| *number == undecided).count();
            let strength = match first {
                None if open == 0 => "the strength is not exceeded".to_owned(),
                None => format!("whether the strength is exceeded is undecided in {open} of {done} members"),
                Some(_) if count == done => "the strength is exceeded in all members".to_owned(),
                Some((_, first)) => {
                    let first = grid.name(first);
                    format!("the strength is exceeded in {count} of {done} members, the first of them {first}")
                }
            };
            let (low, high) = (short(1e-6 * low), short(1e-6 * high));
            say(format_args!("largest tension {low} to {high} MPa, the largest of {}; {strength}", grid.name(at)));
        }
        let failed = sweep.count(Status::Failed) + sweep.count(Status::Refused);
        let is_failed = |member: usize| sweep.status[member] != Status::Done;
        if let Some((first, why)) = sweep.messages.iter().find(|(member, _)| is_failed(**member)) {
            say(format_args!("failed: {failed}, the first of them {}: {why}", grid.name(*first)));
        }
        let there = if self.before > 0 { format!(", {} of them were there", self.before) } else { String::new() };
        let (all, kept) = (self.writer.mine().count(), done + failed);
        say(format_args!("{}: {kept} of {all} members{there}, {time:.1} s", self.output.display()));
    }
}
