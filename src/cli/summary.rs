//! Prints the summary at the end of a run.

use std::path::Path;

use crate::error::Result;
use crate::impact::checkpoint::Visitor;
use crate::impact::estimated;
use crate::impact::step::Step;
use crate::model::{Edges, Linearity, STIFFENING};
use crate::record::episodes::{Episode, Episodes};
use crate::record::extremes::{Extreme, Extremes, ProbeExtremes};
use crate::record::provenance::Cost;
use crate::record::stress::{LargestTension, StrengthVerdict, TensionExtreme};
use crate::space::evaluate::FaceTension;

use super::{coordinate, say, short};

/// Largest number of contacts in one line. Of more, the first and the last are printed.
const MAX_CONTACTS: usize = 12;

/// Data for the summary of a run.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    peak: (f64, f64),
    /// Energy at t = 0, J.
    initial: f64,
    /// Largest work of the loads and of the impactor's weight, J.
    work: f64,
    last: Step,
    linearity: Option<Linearity>,
    /// Largest deflection, m; 0 if it is not followed.
    largest_deflection: f64,
    tension: LargestTension,
}

impl Summary {
    /// The same summary, which also follows large deflections.
    #[must_use]
    pub fn following(self, linearity: Option<Linearity>) -> Self {
        Self { linearity, ..self }
    }

    /// Takes the next step into account.
    pub fn step(&mut self, step: &Step) {
        if step.impactor.acceleration > self.peak.0 {
            self.peak = (step.impactor.acceleration, step.time);
        }
        if step.number == 0 {
            self.initial = step.energy.total;
        }
        self.work = self.work.max(step.energy.external.abs());
        if let Some(linearity) = &self.linearity {
            self.largest_deflection = self.largest_deflection.max(linearity.deflection(step));
        }
        self.last = *step;
    }

    /// Takes into account the largest tension on each face at a time (s). `strengths` are the strengths of the faces,
    /// Pa.
    pub fn tensions(&mut self, time: f64, tensions: &[FaceTension], strengths: &[Option<f64>]) {
        self.tension.take(time, tensions, strengths);
    }

    /// The largest tension so far.
    pub fn largest_tension(&self) -> LargestTension {
        self.tension.clone()
    }

    /// Time of the largest force, s.
    pub fn peak_time(&self) -> f64 {
        self.peak.1
    }

    /// Time reached, s.
    pub fn end(&self) -> f64 {
        self.last.time
    }

    /// Saves the summary to a checkpoint, or restores it from one. The last step is stored with the episodes.
    ///
    /// # Errors
    /// Same as [`Visitor`].
    pub fn visit(&mut self, visitor: &mut Visitor, last: Option<&Step>) -> Result<()> {
        self.last = last.copied().unwrap_or_default();
        visitor.number("peak", &mut self.peak.0)?;
        visitor.number("peak_time", &mut self.peak.1)?;
        visitor.number("initial", &mut self.initial)?;
        visitor.number("work", &mut self.work)?;
        visitor.number("largest_deflection", &mut self.largest_deflection)?;
        self.tension.visit(visitor)
    }

    /// Prints the summary; `largest` has the lines with the largest values ([`lines`]), and `judged` says what the estimated
    /// error includes.
    pub fn print(&self, episodes: &Episodes, largest: &[String], cost: &Cost, judged: &str, output: &Path) {
        let mut contacts = times(episodes.all());
        if episodes.is_open() {
            contacts += ", and still in contact";
        }
        say(format_args!(
            "peak acceleration {} m/s² at {} ms; impactor's velocity at the end {} m/s",
            short(self.peak.0),
            short(1e3 * self.peak.1),
            short(self.last.impactor.velocity)
        ));
        largest.iter().for_each(|line| say(format_args!("{line}")));
        say(format_args!("contacts: {contacts}"));
        let energy = &self.last.energy;
        say(format_args!(
            "energy: change by the time integration {:+.1e} of the initial {} J{}",
            energy.numerical / (self.initial + self.work),
            short(self.initial),
            if self.work > 0.0 {
                format!(" and the work of the loads, up to {} J", short(self.work))
            } else {
                String::new()
            },
        ));
        if !cost.error_estimate.is_nan() {
            say(format_args!(
                "accuracy: estimated error of the acceleration over the whole history {} of its peak, by {judged}",
                estimated(cost.error_estimate)
            ));
        }
        say(format_args!("{}: {}", output.display(), costs(cost)));
    }

    /// Warning that the force may rise further after the end of the run, if the last force is the largest.
    pub fn warning_of_end(&self) -> Option<String> {
        let Step { time, contact, .. } = &self.last;
        (contact.force > 0.0 && self.peak.1 == *time).then(|| ends_at_peak(*time))
    }

    /// Warning that the deflection is too large for the model, if it is.
    pub fn warning(&self) -> Option<String> {
        let ratio = self.linearity?.excess(self.largest_deflection)?;
        let edges = self.linearity?.edges();
        Some(format!("the body bends by about {} mm, {}", short(1e3 * self.largest_deflection), beyond(ratio, edges)))
    }
}

/// Warning for a run whose force is the largest at its end (s).
pub fn ends_at_peak(end: f64) -> String {
    let time = short(1e3 * end);
    format!(
        "the force is the largest at the end of the run, {time} ms, and may rise further: a later time.end shows it"
    )
}

/// Consequences of a deflection (`ratio` in plate thicknesses).
pub fn beyond(ratio: f64, edges: Edges) -> String {
    let [least, most] = STIFFENING.map(|factor| 100.0 * factor * ratio * ratio);
    let by = match edges {
        Edges::Held => format!("by up to {most:.0}%, since its edges cannot move in the plane"),
        Edges::Movable => format!("by about {least:.0}%, or less where it bends in one direction alone"),
        Edges::Unknown => {
            format!(
                "by about {least:.0}% where its edges can move in the plane and by up to {most:.0}% where they cannot"
            )
        }
    };
    format!(
        "{} times the thickness, and the model is geometrically linear: it neglects membrane forces, which make the plate stiffer {by}; \
         expect larger forces and smaller deflections",
        short(ratio)
    )
}

/// Times of contacts, in one line.
fn times(contacts: &[Episode]) -> String {
    let shown = |contact: &Episode| format!("{}–{} ms", short(1e3 * contact.start), short(1e3 * contact.end));
    let mut shown: Vec<String> = contacts.iter().map(shown).collect();
    if shown.is_empty() {
        return "none".to_owned();
    }
    if shown.len() > MAX_CONTACTS {
        let omitted = MAX_CONTACTS - 2..shown.len() - 1;
        let more = format!("{} more", omitted.len());
        shown.splice(omitted, [more]);
    }
    shown.join(", ")
}

/// Lines with the largest values of a run, without the acceleration. `deflection_error` is the estimated error of the
/// deflection, NaN if it is unknown.
pub fn lines(extremes: &Extremes, deflection_error: f64) -> Vec<String> {
    let at = |extreme: &Extreme, factor: f64, unit: &str| {
        format!("{} {unit} at {} ms", short(factor * extreme.value), short(1e3 * extreme.time))
    };
    let backwards =
        if extremes.deflection.value < 0.0 { " (opposite to the impactor's direction of travel)" } else { "" };
    let of_deflection = match deflection_error {
        unknown if unknown.is_nan() => String::new(),
        error => format!(", estimated error {}", estimated(error)),
    };
    // A half-space has no deflection, only an indentation; of other bodies no row with a deflection may be recorded.
    let deflection = match extremes.deflection.value {
        0.0 => String::new(),
        _ => format!(
            "; largest deflection under the impactor {}{backwards}{of_deflection}",
            at(&extremes.deflection, 1e3, "mm")
        ),
    };
    let mut lines = vec![format!("peak force {}{deflection}", at(&extremes.force, 1.0, "N"))];
    if let Some(TensionExtreme { largest, face, strength_passed_face, strength_verdict }) = &extremes.tension {
        let [x, y, z] = largest.point;
        let mut line = format!(
            "largest tension {} MPa on face {face:?} at {} ms, at [{}, {}, {}] m",
            short(1e-6 * largest.value),
            short(1e3 * largest.time),
            coordinate(x),
            coordinate(y),
            coordinate(z)
        );
        line += &match (largest.error_estimate, largest.without_estimate.as_str()) {
            // Killed runs have neither.
            (none, "") if none.is_nan() => ", without an estimate of its error".to_owned(),
            (none, why) if none.is_nan() => format!(", without an estimate of its error: {why}"),
            (error, _) => format!(", estimated error {}", estimated(error)),
        };
        if !largest.strength_passed_at.is_nan() {
            // Older results do not have the name of the face.
            let of_face = match strength_passed_face.as_str() {
                "" => String::new(),
                face => format!(" of face {face:?}"),
            };
            line +=
                &format!("; the strength{of_face} is first exceeded at {} ms", short(1e3 * largest.strength_passed_at));
        } else if strength_verdict == StrengthVerdict::NotExceeded.name() {
            line += "; the strength is not exceeded";
        } else if strength_verdict == StrengthVerdict::Undecided.name() {
            line += "; whether the strength is exceeded is undecided";
        }
        lines.push(line);
    }
    // Of two faces, the line above names the one that matters.
    if extremes.faces.len() > 2 {
        let faces: Vec<String> =
            extremes.faces.iter().map(|of| format!("{} {}", of.face, short(1e-6 * of.value))).collect();
        lines.push(format!(
            "largest tension on each face, MPa (the error is estimated for the largest value only): {}",
            faces.join(", ")
        ));
    }
    for ProbeExtremes { name, displacement, velocity, tension } in &extremes.probes {
        lines.push(format!(
            "probe {name:?}: displacement {}, velocity {}, tension {}",
            at(displacement, 1e3, "mm"),
            at(velocity, 1.0, "m/s"),
            at(tension, 1e-6, "MPa")
        ));
    }
    lines
}

/// Wall times and counts of a run.
pub fn costs(Cost { total, model, setup, steps, solves, newton_iterations, .. }: &Cost) -> String {
    let [total, model, setup, steps] = [total, model, setup, steps].map(|time| seconds(*time));
    format!(
        "{total} s (model {model}, setup {setup}, steps {steps}), {solves} solves and {newton_iterations} Newton iterations"
    )
}

/// Formats a time: to milliseconds below ten seconds, to tenths of a second above.
fn seconds(value: f64) -> String {
    if value >= 10.0 { format!("{value:.1}") } else { format!("{value:.3}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::step::{Contact, Motion};

    /// There is a warning if the force is largest at the last step, but not if it has fallen or the contact is over.
    #[test]
    fn a_run_may_end_before_its_peak() {
        let is_warned = |forces: &[f64]| {
            let mut summary = Summary::default();
            for (number, force) in forces.iter().enumerate() {
                summary.step(&Step {
                    number,
                    time: 0.5 * number as f64,
                    impactor: Motion { acceleration: *force, ..Motion::default() },
                    contact: Contact { force: *force, ..Contact::default() },
                    ..Step::default()
                });
            }
            summary.warning_of_end().is_some()
        };
        assert!(is_warned(&[0.0, 2.0, 3.0]) && is_warned(&[0.0, 2.0, 0.0, 3.0]));
        for forces in [&[0.0, 2.0, 1.0][..], &[2.0, 3.0, 0.0], &[0.0, 4.0, 0.0, 3.0], &[0.0, 0.0], &[]] {
            assert!(!is_warned(forces), "{forces:?}");
        }
    }

    #[test]
    fn many_contacts_fit_in_one_line() {
        let episode = Episode { start: 0.0, end: 0.0, peak_force: 1.0, peak_time: 0.0, impulse: 1.0 };
        let contacts: Vec<Episode> = (0..100)
            .map(|n| Episode { start: 1e-3 * f64::from(n), end: 1e-3 * (f64::from(n) + 0.5), ..episode })
            .collect();
        assert_eq!(times(&contacts[..2]), "0.0000–0.5000 ms, 1.0000–1.5000 ms");
        let all = times(&contacts);
        assert!(all.ends_with("9.0000–9.5000 ms, 89 more, 99.000–99.500 ms"), "{all}");
        assert_eq!(all.split(", ").count(), MAX_CONTACTS);
    }
}
