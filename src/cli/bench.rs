//! Runs one scene with many settings. Results are kept in a folder, so that no run is repeated.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use petsc_wrap::{Comm, options};

use crate::agree::{decided, of_root};
use crate::error::{Error, Result};
use crate::record::folder::Folder;
use crate::record::provenance::{Cost, Origin};
use crate::record::read;
use crate::record::series::{Points, SeriesWriter};
use crate::record::stress::Faces;
use crate::scene::{Scene, Source};
use crate::study::chart::{Attempt, Recording, Timed, history, spent, time};

use super::provenance::{origin, provenance};

/// A scene, the folder of its runs, and a test for interruption.
pub struct Bench<'a> {
    comm: &'a Comm,
    source: &'a Source,
    /// Path and folder of the runs, on rank 0 only.
    folder: Option<(PathBuf, Folder)>,
    interrupted: Rc<dyn Fn() -> bool>,
}

impl<'a> Bench<'a> {
    /// Keeps runs in a subfolder of `folder` for each build of this program. Collective.
    ///
    /// # Errors
    /// [`Error::Output`] if the folder cannot be created.
    pub fn new(comm: &'a Comm, source: &'a Source, folder: &Path, interrupted: Rc<dyn Fn() -> bool>) -> Result<Self> {
        let folder = &folder.join(program());
        let mut made = None;
        decided(comm, || {
            made = Some((folder.to_owned(), Folder::create(folder)?));
            Ok(())
        })?;
        Ok(Self { comm, source, folder: made, interrupted })
    }

    /// Result of a method with some settings; run several times if `repeated`. `None` if interrupted. Collective.
    ///
    /// # Errors
    /// If an error is not caused by the settings.
    pub fn outcome(&self, method: &str, settings: &[String], repeated: bool) -> Result<Option<Attempt>> {
        let (scene, source) =
            match Scene::within(self.source.name(), self.source.folder(), self.source.text(), settings) {
                Ok(scene) => scene,
                Err(Error::Scene(error)) => return Ok(Some(Err(error.to_string()))),
                Err(error) => return Err(error),
            };
        let name = file_name(method, settings);
        if let Some(outcome) = self.kept(&name, (&scene, &source), repeated)? {
            return Ok(Some(outcome));
        }
        tracing::info!(name, "runs");
        match time(self.comm, &scene, repeated, &self.interrupted) {
            Ok(None) => Ok(None),
            Ok(Some((timed, recording))) => {
                self.keep(&name, (&scene, &source), &timed, recording)?;
                Ok(Some(Ok(timed)))
            }
            Err(error @ (Error::Fault(_) | Error::Solve(_) | Error::Unstable(_))) if error.is_everywhere() => {
                let reason = error.to_string();
                self.keep_reason(&name, &source, &reason)?;
                Ok(Some(Err(reason)))
            }
            Err(error) => Err(error.in_scene(&source)),
        }
    }

    /// Result of an earlier run, if it was made on the same number of ranks with the same options.
    fn kept(&self, name: &str, (scene, source): (&Scene, &Source), repeated: bool) -> Result<Option<Attempt>> {
        let own = self.folder.as_ref().and_then(|(path, _)| self.read(&path.join(name), (scene, source), repeated));
        // The times determine the next runs of all ranks.
        let told = of_root(self.comm, Some(own.clone()));
        Ok(own.or(told))
    }

    fn read(&self, path: &Path, (scene, source): (&Scene, &Source), repeated: bool) -> Option<Attempt> {
        let failed = std::fs::read_to_string(path.with_extension("h5.txt")).ok();
        if let Some(reason) = failed.as_deref().and_then(|text| text.strip_prefix(&self.headed(source).ok()?)) {
            return Some(Err(reason.trim_end().to_owned()));
        }
        if !path.exists() {
            return None;
        }
        let (made, cost, is_complete) = read::origin(path).ok()?;
        let now = origin(self.comm, scene, source).ok()?;
        let key = |Origin { ranks, scene, petsc_options, .. }| (ranks, scene, petsc_options);
        if !is_complete || key(made.origin) != key(now) {
            return None;
        }
        Some(Ok(Timed {
            build: cost.model,
            run: cost.steps,
            spent: if repeated { spent(cost.total) } else { cost.total },
            model: made.model,
            reduction: made.reduction,
            unknowns: made.unknowns,
            solves: cost.solves,
            iterations: cost.newton_iterations,
            estimate: cost.error_estimate,
            history: history(path, scene.impactor.mass).ok()?,
        }))
    }

    fn keep(&self, name: &str, (scene, source): (&Scene, &Source), timed: &Timed, recording: Recording) -> Result<()> {
        let of_model = (timed.model.as_str(), timed.reduction.clone(), timed.unknowns - 1);
        let mut made = provenance(self.comm, scene, source, of_model)?;
        let Some((path, _)) = &self.folder else { return Ok(()) };
        let Recording { faces, steps, readings } = recording;
        made.planned_rows = Some(steps.len());
        let points = Points { faces: Faces { names: faces, ..Faces::default() }, ..Points::default() };
        let mut writer = SeriesWriter::create(&path.join(name), &made, &points)?;
        steps.iter().zip(&readings).try_for_each(|(step, reading)| writer.push(step, reading))?;
        let cost = Cost {
            model: timed.build,
            setup: 0.0,
            steps: timed.run,
            total: timed.build + timed.run,
            newton_iterations: timed.iterations,
            solves: timed.solves,
            error_estimate: timed.estimate,
            deflection_error_estimate: f64::NAN,
        };
        writer.finish(&cost, true)
    }

    fn keep_reason(&self, name: &str, source: &Source, reason: &str) -> Result<()> {
        let Some((_, folder)) = &self.folder else { return Ok(()) };
        folder.put_bytes(format!("{name}.txt"), format!("{}{reason}\n", self.headed(source)?))
    }

    /// Header of a stored error message: the scene, the number of ranks and the options for which it holds.
    fn headed(&self, source: &Source) -> Result<String> {
        let (ranks, options) = (self.comm.size(), options::all(self.comm.session())?);
        Ok(format!("{}\n\nranks: {ranks}, options: {options}\n\n", source.text()))
    }
}

/// Commit and a hash of the program file, since builds of one commit may differ.
fn program() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    let mut digest = DefaultHasher::new();
    bytes.hash(&mut digest);
    format!("{}-{:08x}", env!("RICOCHET_COMMIT"), digest.finish() as u32)
}

/// File name of the result of a run.
fn file_name(method: &str, settings: &[String]) -> String {
    let words = [method].into_iter().chain(settings.iter().map(String::as_str));
    let plain = |c: char| if c.is_ascii_alphanumeric() || ".=-".contains(c) { c } else { '-' };
    let name: Vec<String> = words.map(|word| word.chars().map(plain).collect()).collect();
    format!("{}.h5", name.join(","))
}
