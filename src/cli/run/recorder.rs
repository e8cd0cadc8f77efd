//! What happens with every step of a run: rank 0 writes it, all ranks agree whether to go on.

use std::ops::ControlFlow;
use std::path::Path;
use std::rc::Rc;

use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::impact::checkpoint::Checkpoint;
use crate::impact::step::Step;
use crate::impact::{ErrorEstimate, Observer, Reading};
use crate::record::checkpoint;
use crate::record::extremes::extremes;
use crate::record::provenance::Cost;
use crate::record::series::SeriesWriter;
use crate::scene::Scene;

use super::super::interrupt::Interrupt;
use super::super::keeping::Keeping;
use super::super::notes;
use super::super::progress::Progress;
use super::super::recording::Recording;
use super::super::summary::Summary;
use super::super::{note, tell};

/// What rank 0 keeps of a run.
pub(super) struct Recorder {
    pub writer: SeriesWriter,
    pub recording: Option<Recording>,
    pub progress: Progress,
    pub summary: Summary,
    /// Of the faces, in their order, Pa.
    pub strengths: Vec<Option<f64>>,
}

impl Recorder {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<()> {
        if let Some(recording) = &mut self.recording {
            recording.step(step, reading, &self.writer)?;
        }
        self.writer.push_read(step, reading)?;
        self.progress.step(step);
        self.summary.step(step);
        self.summary.tensions(step.time, &reading.faces, &self.strengths);
        Ok(())
    }

    /// Closes the result and tells what came of the run. `flow` is how the steps ended; `None` where they failed: what was computed is
    /// kept all the same.
    ///
    /// # Errors
    /// Those of writing.
    pub fn finish(mut self, scene: &Scene, flow: Option<ControlFlow<()>>, end: &End<'_>) -> Result<()> {
        self.progress.finish();
        let is_complete = flow == Some(ControlFlow::Continue(()));
        let episodes = self.writer.episodes().clone();
        // Where nothing was computed, all is left as it is.
        let fields = self.recording.as_mut().filter(|_| is_complete || self.writer.has_begun());
        let recorded = fields.map_or(Ok(()), Recording::flush);
        let error_estimate = end.estimate.total().map_or(f64::NAN, |errors| errors.stress);
        self.writer.set_largest(self.summary.largest_tension().with_error(error_estimate, scene));
        // Where the run has failed already, that is what is told: a full disk fails the steps first and then the end.
        self.writer.finish(end.cost, is_complete).and(recorded)?;
        let Some(flow) = flow else { return Ok(()) };
        // Of a file system that cannot be read at once, the run is as good.
        let extremes = extremes(end.output).ok().flatten();
        if end.has_summary {
            self.summary.print(&episodes, extremes.as_ref(), end.cost, &end.estimate.causes(), end.output);
        }
        if let Some(warning) = self.summary.warning() {
            tell(format_args!("warning: {warning}"));
        }
        if let Some(errors) = &end.estimate.total() {
            for missed in notes::missed(errors, (scene.measure, scene.tolerance), end.was_warned) {
                note(format_args!("note: {missed}"));
            }
        }
        if let Some(warning) = self.summary.warning_of_end().filter(|_| flow.is_continue()) {
            tell(format_args!("warning: {warning}"));
        }
        if flow.is_continue() {
            return checkpoint::remove(end.output);
        }
        let output = end.output.display();
        tell(format_args!("interrupted: {output} holds the run up to t = {:.6e} s", self.summary.end()));
        if checkpoint::beside(end.output).exists() {
            note(format_args!("note: --restart {output} continues it"));
        }
        Ok(())
    }
}

/// What is known at the end of a run.
pub(super) struct End<'a> {
    /// Time that it took, and its number of solves.
    pub cost: &'a Cost,
    /// Its estimated errors.
    pub estimate: &'a ErrorEstimate,
    /// The result.
    pub output: &'a Path,
    /// Whether the summary is printed.
    pub has_summary: bool,
    /// Whether a warning before the first step has said that the tolerance is missed.
    pub was_warned: bool,
}

/// What happens with every step.
pub(super) struct Watch {
    pub comm: Comm,
    pub interrupt: Rc<Interrupt>,
    pub keeping: Keeping,
    /// On rank 0.
    pub recorder: Option<Recorder>,
}

impl Observer for Watch {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>> {
        let written = self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.step(step, reading));
        let is_late = self.recorder.is_some() && self.keeping.is_due_by_time();
        let (interrupted, [late, failed]) = self.interrupt.poll(&self.comm, [is_late, written.is_err()]);
        if failed {
            // Rank 0 tells it, and all end in order.
            return Err(Error::Unwritten(written.err().map_or(String::new(), |error| error.to_string())));
        }
        self.keeping.step(step, late);
        Ok(if interrupted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    fn is_interrupted(&mut self) -> bool {
        self.interrupt.is_raised(&self.comm)
    }

    fn settled(&mut self, interrupted: bool, checkpoint: &mut dyn FnMut() -> Result<Checkpoint>) -> Result<()> {
        let record = self.recorder.as_mut().map(|recorder| {
            let Recorder { writer, recording, summary, .. } = recorder;
            (writer, recording.as_mut(), summary)
        });
        self.keeping.settled(record, interrupted, checkpoint)
    }
}
