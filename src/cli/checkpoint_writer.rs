//! Writes the checkpoints of a run.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::impact::checkpoint::{Checkpoint, Visitor};
use crate::impact::step::Step;
use crate::model::Simulation;
use crate::record::checkpoint::StoredCheckpoint;
use crate::record::episodes::Episodes;
use crate::record::series::SeriesWriter;
use crate::scene::{Scene, Vec3};
use crate::space::evaluate::TensionMap;

use super::collect::gathered;
use super::recording::Recording;
use super::summary::Summary;
use super::tell;

/// Times at which checkpoints are due, and the data for writing them.
pub struct CheckpointWriter {
    comm: Comm,
    result: PathBuf,
    scene: String,
    /// Positions of the nodes of this rank, m; `None` for a body without a mesh.
    nodes: Option<Vec<Vec3>>,
    /// Positions of all nodes, m, on rank 0 after the first checkpoint.
    all_nodes: Option<Vec<Vec3>>,
    steps: Option<usize>,
    time: Option<Duration>,
    last: Instant,
    is_due: bool,
}

impl CheckpointWriter {
    /// Prepares checkpoints of a simulation of `scene`, whose text is `text`. They are written next to its `result`.
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

    /// Whether a checkpoint is due by the clock of this rank.
    pub fn is_due_by_time(&self) -> bool {
        self.time.is_some_and(|time| self.last.elapsed() >= time)
    }

    /// Takes a step into account. `late` says whether a clock asks for a checkpoint, and is the same on all ranks.
    pub fn step(&mut self, step: &Step, late: bool) {
        self.is_due |= late || (step.number > 0 && self.steps.is_some_and(|steps| step.number.is_multiple_of(steps)));
    }

    /// Writes a checkpoint with the data recorded on rank 0, if one is due or the run is `interrupted` at this step. If
    /// a checkpoint cannot be written, a note is printed and the run goes on; the previous checkpoint is still there.
    /// Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, or on rank 0 if the series cannot be written; it is written first.
    pub fn settled(
        &mut self,
        record: Option<(&mut SeriesWriter, Option<&mut Recording>, &mut Summary)>,
        interrupted: bool,
        checkpoint: &mut dyn FnMut() -> Result<Checkpoint>,
    ) -> Result<()> {
        if !(std::mem::take(&mut self.is_due) || interrupted) {
            return Ok(());
        }
        self.last = Instant::now();
        let Checkpoint { vectors, mut numbers, .. } = checkpoint()?;
        let mut all = Checkpoint::default();
        for (name, values) in vectors {
            let values = if self.nodes.is_some() { gathered(&self.comm, &values) } else { values };
            all.vectors.insert(name, values);
        }
        if let (Some(nodes), None) = (&self.nodes, &self.all_nodes) {
            self.all_nodes = Some(gathered(&self.comm, nodes.as_flattened()).as_chunks().0.to_vec());
        }
        let Some((writer, recording, summary)) = record else { return Ok(()) };
        // The series and the fields must be on the disk before the checkpoint that refers to them.
        recording.map_or(Ok(()), Recording::sync)?;
        writer.sync()?;
        let mut of_record = Checkpoint::default();
        let mut known = Known {
            rows: writer.rows(),
            episodes: writer.episodes().clone(),
            summary: summary.clone(),
            map: writer.map().clone(),
        };
        known.visit(&mut Visitor::save(&mut of_record))?;
        numbers.append(&mut of_record.numbers);
        (all.numbers, all.lists) = (numbers, of_record.lists);
        let begin = Instant::now();
        let kept = StoredCheckpoint {
            scene: self.scene.clone(),
            run_id: writer.run_id(),
            time: summary.end(),
            nodes: self.all_nodes.clone().unwrap_or_default(),
            checkpoint: all,
        };
        match kept.write(&self.result) {
            Ok(()) => tracing::info!(seconds = begin.elapsed().as_secs_f64(), "checkpoint"),
            Err(error) => tell(format_args!("note: no checkpoint was kept: {error}")),
        }
        Ok(())
    }
}

/// Data of a run on rank 0 that are not part of the state of the simulation.
#[derive(Default)]
pub struct Known {
    /// Number of rows of the series.
    pub rows: usize,
    /// Contacts so far.
    pub episodes: Episodes,
    /// Summary that is printed at the end.
    pub summary: Summary,
    /// Largest tension so far at each point of the faces.
    pub map: TensionMap,
}

impl Known {
    /// Saves the data to a checkpoint, or restores them from it.
    ///
    /// # Errors
    /// Same as [`Visitor`].
    pub fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        let Self { rows, episodes, summary, map } = self;
        visitor.within("record", |visitor| {
            visitor.count("rows", rows)?;
            episodes.visit(visitor)?;
            summary.visit(visitor, episodes.last())?;
            let mut tension: Vec<f64> = map.tension.iter().copied().map(f64::from).collect();
            visitor.list("tension", &mut tension)?;
            visitor.list("tension_time", &mut map.time)?;
            if ![1, tension.len()].contains(&map.time.len()) {
                let (points, times) = (tension.len(), map.time.len());
                return Err(Error::Output(format!("the checkpoint has {points} tensions at {times} times")));
            }
            map.tension = tension.into_iter().map(|tension| tension as f32).collect();
            Ok(())
        })
    }
}
