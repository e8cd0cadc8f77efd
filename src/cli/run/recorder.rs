//! Processes every step of a run: rank 0 writes it, and all ranks agree whether to go on.

use std::ops::ControlFlow;
use std::path::Path;
use std::rc::Rc;

use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::impact::checkpoint::Checkpoint;
use crate::impact::step::Step;
use crate::impact::{ErrorEstimate, Errors, Observer, Reading, estimated};
use crate::record::checkpoint;
use crate::record::extremes::extremes;
use crate::record::provenance::Cost;
use crate::record::series::SeriesWriter;
use crate::record::stress::LargestTension;
use crate::record::useless::Printed;
use crate::scene::{Measure, Scene};

use super::super::checkpoint_writer::CheckpointWriter;
use super::super::interrupt::Interrupt;
use super::super::notes::{self, Said};
use super::super::progress::Progress;
use super::super::recording::Recording;
use super::super::summary::{Summary, lines};
use super::super::{note, tell};

/// Data that rank 0 records during a run.
pub(super) struct Recorder {
    pub writer: SeriesWriter,
    pub recording: Option<Recording>,
    pub progress: Progress,
    pub summary: Summary,
    /// Strengths of the faces, in the order of the faces, Pa.
    pub strengths: Vec<Option<f64>>,
    /// Warnings and notes of the run so far.
    pub said: Said,
}

impl Recorder {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<()> {
        if let Some(recording) = &mut self.recording {
            recording.step(step, reading, &self.writer)?;
        }
        self.writer.push(step, reading)?;
        self.progress.step(step);
        self.summary.step(step);
        self.summary.tensions(step.time, &reading.faces, &self.strengths);
        Ok(())
    }

    /// Closes the result and prints the outcome of the run. `flow` says how the steps ended; `None` if they failed. The
    /// computed steps are kept in any case. Returns a message if printed numbers are of no use and the run was not forced.
    ///
    /// # Errors
    /// If writing fails.
    pub fn finish(mut self, scene: &Scene, flow: Option<ControlFlow<()>>, end: &End<'_>) -> Result<Option<String>> {
        self.progress.finish();
        let is_complete = flow == Some(ControlFlow::Continue(()));
        let episodes = self.writer.episodes().clone();
        // If nothing was computed, existing fields are left as they are.
        let fields = self.recording.as_mut().filter(|_| is_complete || self.writer.has_begun());
        let recorded = fields.map_or(Ok(()), Recording::flush);
        let first_end = episodes.all().first().map(|first| first.end);
        let largest_tension = self.summary.largest_tension().with_error(&end.estimate.of_tension(), scene, first_end);
        self.writer.set_largest(largest_tension.clone());
        if let Some(flow) = flow {
            self.remark(scene, flow, &largest_tension, end);
        }
        let useless = self.useless(first_end, &largest_tension, end).filter(|_| is_complete);
        let printed = self.said.count();
        self.said.warn(useless.clone());
        self.writer.set_warnings(self.said.text());
        // If the steps have failed, the caller reports that error: a full disk first fails the steps and then the end.
        self.writer.finish(end.cost, is_complete).and(recorded)?;
        let Some(flow) = flow else { return Ok(None) };
        // If the file cannot be read back at once, the run is still valid.
        let extremes = extremes(end.output).ok().flatten();
        if end.has_summary {
            let largest =
                extremes.map_or_else(Vec::new, |extremes| lines(&extremes, end.cost.deflection_error_estimate));
            self.summary.print(&episodes, &largest, end.cost, &judged(scene, end.estimate), end.output);
        }
        // Unless it is accepted, the last warning is printed as the error that ends the program.
        self.said.print(if end.force { self.said.count() } else { printed });
        if flow.is_continue() {
            checkpoint::remove(end.output)?;
            return Ok(useless.filter(|_| !end.force));
        }
        let output = end.output.display();
        tell(format_args!("interrupted: {output} holds the run up to t = {:.6e} s", self.summary.end()));
        if checkpoint::beside(end.output).exists() {
            note(format_args!("note: --restart {output} continues it"));
        }
        Ok(None)
    }

    /// Adds the warnings and notes on a run that has ended.
    fn remark(&mut self, scene: &Scene, flow: ControlFlow<()>, largest: &LargestTension, end: &End<'_>) {
        self.said.warn(self.summary.warning());
        self.said.note(notes::missed(end.estimate, scene, end.was_warned, largest));
        self.said.warn(self.summary.warning_of_end().filter(|_| flow.is_continue()));
    }

    /// Message that printed numbers are of no use, if their estimated errors are large.
    fn useless(&self, first_end: Option<f64>, largest: &LargestTension, end: &End<'_>) -> Option<String> {
        let total = end.estimate.total().unwrap_or(Errors::throughout(f64::NAN));
        let printed = Printed {
            first_end,
            peak_time: self.summary.peak_time(),
            first_contact_error: total.first_contact,
            history_error: total.history,
            deflection_error: end.cost.deflection_error_estimate,
            stress_error: largest.error_estimate,
        };
        let named = |(name, error): (&str, f64)| format!("{name} ({})", estimated(error));
        let listed = printed.useless().into_iter().map(named).reduce(|all, next| all + ", " + &next)?;
        Some(format!(
            "these numbers are of no use, as their estimated errors are above half of the peak: {listed}. The result is complete; \
             --force accepts it"
        ))
    }
}

/// Causes that an estimated error includes, and whether the error of the time steps is missing.
fn judged(scene: &Scene, estimate: &ErrorEstimate) -> String {
    let causes = notes::listed(&estimate.causes(Measure::Acceleration));
    match scene.time.step {
        Some(_) => format!("{causes}; the error of the given time step is not estimated"),
        None => causes,
    }
}

/// Facts about the end of a run.
pub(super) struct End<'a> {
    /// Wall times and number of solves.
    pub cost: &'a Cost,
    /// Estimated errors.
    pub estimate: &'a ErrorEstimate,
    /// Path of the result.
    pub output: &'a Path,
    /// Whether the summary is printed.
    pub has_summary: bool,
    /// Whether a warning before the first step has already said that the tolerance is missed.
    pub was_warned: bool,
    /// Whether numbers that are of no use are accepted.
    pub force: bool,
}

/// Processes every step on all ranks.
pub(super) struct Watch {
    pub comm: Comm,
    pub interrupt: Rc<Interrupt>,
    pub keeping: CheckpointWriter,
    /// On rank 0.
    pub recorder: Option<Recorder>,
}

impl Observer for Watch {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>> {
        let written = self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.step(step, reading));
        let is_late = self.recorder.is_some() && self.keeping.is_due_by_time();
        let (interrupted, [late, failed]) = self.interrupt.poll(&self.comm, [is_late, written.is_err()]);
        if failed {
            // Rank 0 reports the error, and all ranks end in order.
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
