//! `ricochet run --restart`: what is there of a run, and the checkpoints that it goes on from.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use petsc_wrap::Comm;

use crate::agree::agree;
use crate::error::{Error, Result};
use crate::impact::checkpoint::{Carrier, Checkpoint};
use crate::impact::step::Step;
use crate::model::Simulation;
use crate::record::checkpoint::{Kept, beside};
use crate::record::episodes::Episodes;
use crate::record::read;
use crate::record::series::{Earlier, SeriesWriter};
use crate::scene::{Geometry, Output, Scene, Vec3};

use super::recording::Recording;
use super::summary::Summary;
use super::tell;

/// A run that is to go on.
pub enum Past {
    /// It came to its end: nothing is left to do.
    Complete,
    /// No checkpoint of it was kept.
    Beginning,
    /// It goes on from here, as every rank has read it.
    Moment(Box<Kept>),
}

impl Past {
    /// Reads what is left of the run of a scene whose result is at `result`. Collective.
    ///
    /// # Errors
    /// [`Error::Output`] where that cannot be read; [`Error::Usage`] where it is of another scene.
    pub fn read(comm: &Comm, result: &Path, scene: &Scene) -> Result<Self> {
        let origin = match comm.is_root() {
            true => read::origin(result).map(|(.., complete)| complete).map_err(|error| error.to_string()),
            false => Ok(false),
        };
        let mut complete = agree(comm, origin).map_err(Error::Output)?;
        comm.mpi().process_at_rank(0).broadcast_into(&mut complete);
        if complete {
            return Ok(Self::Complete);
        }
        let kept = agree(comm, Kept::read(result).map_err(|error| error.to_string())).map_err(Error::Output)?;
        // The files of a cluster may not be everywhere at once.
        let mut there = 0;
        comm.mpi().all_reduce_into(&i32::from(kept.is_some()), &mut there, SystemOperation::sum());
        let Some(kept) = kept.filter(|_| there as usize == comm.size()) else {
            if there > 0 {
                return Err(Error::Output(format!("{} is not seen by all ranks", beside(result).display())));
            }
            return Ok(Self::Beginning);
        };
        check_scene(result, &kept.scene, scene)?;
        Ok(Self::Moment(Box::new(kept)))
    }
}

/// The scene of a checkpoint must be the one that is run, but for its end and what is written of it.
fn check_scene(result: &Path, text: &str, scene: &Scene) -> Result<()> {
    let (mut kept, _) = Scene::parse(&beside(result).display().to_string(), text, &[])?;
    kept.title.clone_from(&scene.title);
    // Probes go on; what has not been read of the time before cannot be had any more.
    kept.output = Output { probes: kept.output.probes, fields: kept.output.fields, ..scene.output.clone() };
    kept.time.end = scene.time.end;
    // Its path may be another one; the nodes tell.
    if let (Geometry::Gmsh(_), Geometry::Gmsh(_)) = (&kept.body.geometry, &scene.body.geometry) {
        kept.body.geometry.clone_from(&scene.body.geometry);
    }
    if kept == *scene {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "{} is of another scene: only its end, its title and [output] but for probes and fields may change; `ricochet info {} --scene` shows it",
        beside(result).display(),
        result.display()
    )))
}

/// Sets a simulation to the checkpoint; on rank 0 what there is of the series, and of the summary. Collective.
///
/// # Errors
/// [`Error::Output`] where checkpoint and series do not fit the simulation.
pub fn go_on(
    comm: &Comm,
    kept: Kept,
    (result, probes): (&Path, &[String]),
    impact: &mut Simulation,
) -> Result<Option<(Earlier, Summary)>> {
    let there = match comm.is_root() {
        true => earlier(&kept.checkpoint, result, probes).map(Some).map_err(|error| error.to_string()),
        false => Ok(None),
    };
    let there = agree(comm, there).map_err(Error::Output)?;
    let mut end = 0;
    let mine = impact.nodes().map_or(0, <[_]>::len);
    comm.mpi().scan_into(&mine, &mut end, SystemOperation::sum());
    let wrong = |why| format!("{} does not go on this body: {why}", beside(result).display());
    let part = agree(comm, kept.part(impact.nodes(), end - mine).map_err(wrong)).map_err(Error::Output)?;
    impact.resume(part);
    Ok(there)
}

/// What rank 0 has of the time before a checkpoint.
fn earlier(checkpoint: &Checkpoint, result: &Path, probes: &[String]) -> Result<(Earlier, Summary)> {
    let mut rows = 0;
    // The mass is not among what is carried: no impulse is computed of it before the next step.
    let mut past = (Episodes::new(read::origin(result)?.0.impactor_mass), Summary::default());
    carry(&mut rows, &mut past, &mut Carrier::from(checkpoint))?;
    let (episodes, summary) = past;
    let (columns, probes) = (read::rows(result, rows)?, read::probes(result, probes, rows)?);
    Ok((Earlier { columns, probes, episodes }, summary))
}

/// What rank 0 knows of a run beside its state, to a checkpoint or from it.
fn carry(rows: &mut usize, (episodes, summary): &mut (Episodes, Summary), carrier: &mut Carrier) -> Result<()> {
    carrier.within("record", |carrier| {
        carrier.count("rows", rows)?;
        episodes.carry(carrier)?;
        summary.carry(carrier)
    })
}

/// When checkpoints are due, and what they are written with.
pub struct Keeping {
    comm: Comm,
    result: PathBuf,
    scene: String,
    /// This rank's nodes.
    nodes: Option<Vec<Vec3>>,
    /// All of them on rank 0, once a checkpoint was kept.
    all_nodes: Option<Vec<Vec3>>,
    steps: Option<usize>,
    time: Option<Duration>,
    last: Instant,
    is_due: bool,
}

impl Keeping {
    /// Checkpoints of a simulation of the scene of this text, beside its result.
    pub fn new(comm: &Comm, (scene, text): (&Scene, &str), result: &Path, impact: &Simulation) -> Self {
        Self {
            comm: comm.clone(),
            result: result.to_owned(),
            scene: text.to_owned(),
            nodes: impact.nodes().map(<[_]>::to_vec),
            all_nodes: None,
            steps: scene.output.checkpoint_steps,
            time: scene.output.checkpoint_minutes.map(|minutes| Duration::from_secs_f64(60.0 * minutes)),
            last: Instant::now(),
            is_due: false,
        }
    }

    /// Whether the clock of this rank says that one is due.
    pub fn is_due_by_time(&self) -> bool {
        self.time.is_some_and(|time| self.last.elapsed() >= time)
    }

    /// A step was taken; `asked` is whether a signal or a clock asks for one, the same on all ranks.
    pub fn step(&mut self, step: &Step, asked: bool) {
        self.is_due |= asked || (step.number > 0 && self.steps.is_some_and(|steps| step.number.is_multiple_of(steps)));
    }

    /// Keeps a checkpoint, if one is due, with what rank 0 has recorded. A checkpoint that cannot be written is told and ends nothing: the
    /// last one is still there. Collective.
    ///
    /// # Errors
    /// PETSc's; on rank 0 those of the series, which is written before.
    pub fn settled(
        &mut self,
        record: Option<(&mut SeriesWriter, Option<&mut Recording>, &mut Summary)>,
        checkpoint: &mut dyn FnMut() -> Result<Checkpoint>,
    ) -> Result<()> {
        if !std::mem::take(&mut self.is_due) {
            return Ok(());
        }
        self.last = Instant::now();
        let Checkpoint { vectors, mut numbers } = checkpoint()?;
        let mut all = Checkpoint::default();
        for (name, values) in vectors {
            let values = if self.nodes.is_some() { gathered(&self.comm, &values) } else { values };
            all.vectors.insert(name, values);
        }
        if let (Some(nodes), None) = (&self.nodes, &self.all_nodes) {
            let flat = gathered(&self.comm, nodes.as_flattened());
            self.all_nodes = Some(flat.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect());
        }
        let Some((writer, recording, summary)) = record else { return Ok(()) };
        recording.map_or(Ok(()), Recording::flush)?;
        writer.flush()?;
        let mut of_record = Checkpoint::default();
        let mut known = (writer.episodes().clone(), *summary);
        carry(&mut writer.rows(), &mut known, &mut Carrier::to(&mut of_record))?;
        numbers.append(&mut of_record.numbers);
        all.numbers = numbers;
        let nodes = self.all_nodes.clone().unwrap_or_default();
        let begin = Instant::now();
        match (Kept { scene: self.scene.clone(), nodes, checkpoint: all }).write(&self.result) {
            Ok(()) => tracing::info!(seconds = begin.elapsed().as_secs_f64(), "checkpoint"),
            Err(error) => tell(format_args!("note: no checkpoint was kept: {error}")),
        }
        Ok(())
    }
}

/// The values of all ranks, in their order, on rank 0; nothing elsewhere. Collective.
fn gathered(comm: &Comm, values: &[f64]) -> Vec<f64> {
    let root = comm.mpi().process_at_rank(0);
    let count = values.len() as i32;
    if !comm.is_root() {
        root.gather_into(&count);
        root.gather_varcount_into(values);
        return Vec::new();
    }
    let mut counts = vec![0; comm.size()];
    root.gather_into_root(&count, &mut counts[..]);
    let mut displacements = Vec::with_capacity(counts.len());
    let mut total = 0;
    for count in &counts {
        displacements.push(total);
        total += count;
    }
    let mut all = vec![0.0; total as usize];
    let mut partition = PartitionMut::new(&mut all[..], counts, displacements);
    root.gather_varcount_into_root(values, &mut partition);
    all
}
