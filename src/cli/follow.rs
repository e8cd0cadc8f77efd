//! Follows the construction of a model: shows its progress, and stops it after a signal or at a deadline.

use std::cell::Cell;
use std::rc::Rc;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::model;
use crate::model::watch::{Judged, Stage, Watch, of_first};

use super::interrupt::Interrupt;
use super::progress::Shown;

/// Follows the construction of a model on all ranks. Rank 0 shows the progress.
pub struct Follower {
    comm: Comm,
    interrupt: Rc<Interrupt>,
    display: Option<Display>,
    deadline: Option<Instant>,
    begin: Instant,
    /// The last stage from which the duration can be predicted.
    last: Cell<Option<Stage>>,
}

impl Follower {
    /// Follows until a signal arrives.
    pub fn new(comm: &Comm, interrupt: Rc<Interrupt>) -> Self {
        let display = comm.is_root().then(Display::new);
        Self { comm: comm.clone(), interrupt, display, deadline: None, begin: Instant::now(), last: Cell::new(None) }
    }

    /// Follows until a signal arrives or, by the clock of rank 0, a stage would pass the deadline.
    pub fn until(self, deadline: Instant) -> Self {
        Self { deadline: Some(deadline), ..self }
    }

    /// Predicted duration of the model construction, s; `None` if no basis has been judged. The error of a basis is
    /// assumed to fall with the square of its number of vectors, and the time to grow with the square. The basis is
    /// computed on two or three sets of cells.
    pub fn outlook(&self) -> Option<f64> {
        const SETS_OF_CELLS: f64 = 2.5;
        let Some(Stage::Basis { vectors, judged: Some(Judged { vectors: of, error, wanted }) }) = self.last.get()
        else {
            return None;
        };
        let needed = (of as f64 * (error / wanted).sqrt()).max(vectors as f64);
        Some(SETS_OF_CELLS * self.begin.elapsed().as_secs_f64() * (needed / vectors as f64).powi(2))
    }
}

impl Watch for Follower {
    fn at(&self, stage: Stage) -> Result<()> {
        if let Some(display) = &self.display {
            display.show(stage);
        }
        self.last.set(Some(stage).filter(|stage| matches!(stage, Stage::Basis { .. })).or(self.last.get()));
        let seconds = if let Stage::Assembly { seconds, .. } = stage { seconds } else { 0.0 };
        let end = Instant::now() + Duration::from_secs_f64(seconds);
        let is_late = self.comm.is_root() && self.deadline.is_some_and(|deadline| end > deadline);
        let (signalled, [late]) = self.interrupt.poll(&self.comm, [is_late]);
        if signalled || late { Err(Error::Interrupted) } else { Ok(()) }
    }

    fn is_raised_here(&self) -> bool {
        self.interrupt.is_raised_here()
    }

    fn agreed(&self, mine: f64) -> f64 {
        of_first(&self.comm, mine)
    }
}

/// Shorter work is not shown.
const FLASH: Duration = Duration::from_millis(300);

/// Shows the current stage. A separate thread draws it, also during long stages.
struct Display {
    stages: Option<Sender<Stage>>,
    thread: Option<JoinHandle<()>>,
}

impl Display {
    fn new() -> Self {
        let (sender, receiver) = mpsc::channel();
        let thread = std::thread::spawn(move || {
            let (begin, mut stage) = (Instant::now(), None);
            let mut shown = Shown::new(0, "{spinner} {elapsed} {msg}");
            loop {
                match receiver.recv_timeout(Duration::from_millis(100)) {
                    Ok(next) => stage = Some(next),
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return shown.finish(),
                }
                // The last of several stages that arrived in the meantime.
                stage = receiver.try_iter().last().or(stage);
                let elapsed = begin.elapsed();
                if let Some(stage) = stage.as_ref().filter(|_| elapsed > FLASH) {
                    let line = || format!("{} ({:.0} s so far)", described(stage), elapsed.as_secs_f64());
                    shown.show(0, || described(stage), line);
                }
            }
        });
        Self { stages: Some(sender), thread: Some(thread) }
    }

    fn show(&self, stage: Stage) {
        if let Some(stages) = &self.stages {
            // The thread lives as long as this value.
            let _ = stages.send(stage);
        }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        drop(self.stages.take());
        self.thread.take().map(JoinHandle::join);
    }
}

fn described(stage: &Stage) -> String {
    match stage {
        Stage::Assembly { theory, .. } => format!("{}: making its mesh and matrices", model::name(*theory)),
        Stage::Factor => "factorising the stiffness for a basis".to_owned(),
        Stage::Basis { vectors, judged: None } => format!("reducing the body to a basis: {vectors} vectors so far"),
        Stage::Basis { vectors, judged: Some(Judged { vectors: of, error, wanted }) } => format!(
            "reducing the body to a basis: {vectors} vectors so far; with {of} the estimated error was {:.1} times the allowed one",
            error / wanted
        ),
        Stage::Steps => "preparing the first step".to_owned(),
        Stage::Trial => "computing the impact on a basis, to judge it".to_owned(),
    }
}
