//! What a run prints at its end.

use std::path::Path;

use crate::error::Result;
use crate::impact::checkpoint::Carrier;
use crate::impact::step::Step;
use crate::record::episodes::Episodes;
use crate::record::provenance::Cost;

use super::notes::listed;
use super::{say, short};

/// The run in four lines.
#[derive(Debug, Clone, Copy, Default)]
pub struct Summary {
    peak: (f64, f64),
    /// Energy at t = 0, J.
    initial: f64,
    last: Step,
}

impl Summary {
    /// Takes the next step.
    pub fn step(&mut self, step: &Step) {
        if step.impactor.acceleration > self.peak.0 {
            self.peak = (step.impactor.acceleration, step.time);
        }
        if step.number == 0 {
            self.initial = step.energy.total;
        }
        self.last = *step;
    }

    /// Time reached, s.
    pub fn end(&self) -> f64 {
        self.last.time
    }

    /// To a checkpoint or from it, beside the episodes, which have the last step.
    ///
    /// # Errors
    /// Those of [`Carrier`].
    pub fn carry(&mut self, carrier: &mut Carrier, last: Option<&Step>) -> Result<()> {
        self.last = last.copied().unwrap_or_default();
        carrier.number("peak", &mut self.peak.0)?;
        carrier.number("peak_time", &mut self.peak.1)?;
        carrier.number("initial", &mut self.initial)
    }

    /// Prints it.
    pub fn print(&self, episodes: &Episodes, cost: &Cost, judged: &[&str], output: &Path) {
        let contacts: Vec<String> = episodes
            .all()
            .iter()
            .map(|episode| format!("{}–{} ms", short(1e3 * episode.start), short(1e3 * episode.end)))
            .collect();
        let mut contacts = if contacts.is_empty() { "none".to_owned() } else { contacts.join(", ") };
        if episodes.is_open() {
            contacts += ", and still in contact";
        }
        say(format_args!(
            "peak acceleration {} m/s² at {} ms; impactor's velocity at the end {} m/s",
            short(self.peak.0),
            short(1e3 * self.peak.1),
            short(self.last.impactor.velocity)
        ));
        say(format_args!("contacts: {contacts}"));
        let energy = &self.last.energy;
        say(format_args!(
            "energy: {:+.1e} of the initial {} J made by the time integration{}",
            energy.numerical / self.initial,
            short(self.initial),
            if cost.error_estimate.is_nan() {
                String::new()
            } else {
                format!(
                    "; estimated error of the acceleration, by {}, {:.1e} of its peak",
                    listed(judged),
                    cost.error_estimate
                )
            }
        ));
        say(format_args!(
            "{}: {} s (model {}, setup {}, steps {}), {} solves and {} Newton iterations",
            output.display(),
            seconds(cost.total),
            seconds(cost.model),
            seconds(cost.setup),
            seconds(cost.steps),
            cost.solves,
            cost.newton_iterations
        ));
    }
}

/// Milliseconds below ten seconds, tenths of a second above.
fn seconds(value: f64) -> String {
    if value >= 10.0 { format!("{value:.1}") } else { format!("{value:.3}") }
}
