//! Writes a stability study as tables: the complete results as CSV, and a summary as lines of text.

use super::schemes::{label, name};
use super::stability::{Reference, Row, STEPS_PER_CONTACT, Study};

/// Columns of the CSV, with their units.
pub const COLUMNS: &str = "scheme,step_s,steps_per_contact,stable_step_s,steps,time_s,energy_error,growth,\
                      force_error_first,force_error,verdict,reason\n";

/// One line per run, ordered by scheme and ascending step. Errors are relative to the initial energy and to the
/// reference's peak acceleration.
pub fn csv(study: &Study) -> String {
    let mut text = COLUMNS.to_owned();
    for row in &study.rows {
        for run in &row.runs {
            let measured = &run.measured;
            text += &format!(
                "{},{:e},{:.6},{:e},{},{:e},{:e},{:e},{:e},{:e},{},{}\n",
                name(row.scheme),
                run.step,
                study.contact / run.step,
                row.limit,
                measured.steps,
                measured.time,
                measured.energy_error,
                measured.growth,
                measured.first_error,
                measured.whole_error,
                run.verdict,
                run.verdict.reason().map_or_else(String::new, quoted),
            );
        }
    }
    text
}

/// Quotes a text as one CSV field, so that commas and quotes do not end it.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// Summary of a study: what was run, and for each scheme the largest accurate step and the theoretical limit. No line
/// is wider than 80 characters.
pub fn gist(study: &Study) -> Vec<String> {
    let mut lines =
        entry("runs", &format!("first contact {:.4} ms, end at {:.4} ms", 1e3 * study.contact, 1e3 * study.end));
    lines.extend(entry("right", &format!("errors of energy and force below {:.1e}", study.tolerance)));
    lines.extend(entry("reference", &reference_line(&study.reference)));
    if let Some((reference, difference)) = &study.explicit {
        lines.extend(entry("", &reference_line(reference)));
        let lumping =
            format!("lumping the mass changes the force of the first contact by {difference:.1e} of its peak");
        lines.extend(entry("", &lumping));
    }
    lines.extend(study.notes.iter().flat_map(|note| entry("left out", note)));
    lines.push(String::new());
    let left_out = study.left_out();
    if left_out > 0 {
        let what = format!("{left_out} of {} runs were left out", study.planned());
        lines.extend(entry("incomplete", &what));
    }
    lines.extend(table(study));
    let enough = study.contact / STEPS_PER_CONTACT;
    lines.push(format!("steps: in a contact; {STEPS_PER_CONTACT} of {enough:.2e} s resolve one with a half-space"));
    lines
}

/// Largest number of characters in a line of the summary.
const WIDTH: usize = 80;

/// A text with a heading of at most eleven characters, in lines of [`WIDTH`].
fn entry(head: &str, text: &str) -> Vec<String> {
    let head = format!("{head:<11}");
    let options = textwrap::Options::new(WIDTH).initial_indent(&head).subsequent_indent("           ");
    textwrap::wrap(text, options).into_iter().map(|line| line.into_owned()).collect()
}

/// Table with one line per scheme.
fn table(study: &Study) -> Vec<String> {
    let line = |cells: [&str; 6]| {
        let [scheme, right, right_count, gains, gains_count, theory] = cells;
        format!("{scheme:<30} {right:>7} {right_count:>6}  {gains:>7} {gains_count:>6}  {theory}")
    };
    let mut lines = vec![
        format!("{:<30} {:>14}  {:>14}  {}", "", "right up to", "gains energy", "theory:"),
        line(["scheme", "Δt (s)", "steps", "Δt (s)", "steps", "stable"]),
    ];
    for row in &study.rows {
        let step = |step: Option<f64>| step.map_or("\u{2013}".to_owned(), |step| format!("{step:.2e}"));
        let count = |step: Option<f64>| match step.map(|step| study.contact / step) {
            None => String::new(),
            Some(count) if count < 100.0 => format!("{count:.1}"),
            Some(count) => format!("{count:.0}"),
        };
        let (right, gains) = (row.holds(), row.grows());
        let cells = [label(row.scheme), step(right), count(right), step(gains), count(gains), theory(row)];
        lines.push(line(cells.each_ref().map(String::as_str)));
    }
    lines
}

/// Theoretical stability limit of a scheme, as text.
pub fn theory(row: &Row) -> String {
    match row.limit {
        0.0 => "at no step".to_owned(),
        limit if limit.is_infinite() => "at every step".to_owned(),
        limit => format!("up to {limit:.2e} s"),
    }
}

fn reference_line(reference: &Reference) -> String {
    let error = reference.error.map_or("not known".to_owned(), |error| format!("about {error:.0e} of the peak"));
    format!("{} in steps of {:.2e} s, its own error {error}", label(reference.scheme), reference.step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scheme;
    use crate::study::stability::Trial;
    use crate::study::{Measured, Verdict};

    /// With the longest names and numbers, columns stay separate and lines stay within 80 characters.
    #[test]
    fn the_gist_is_read_at_80_columns() {
        let measured = Measured::NOTHING;
        let reference = Reference { scheme: Scheme::Energy, step: 1.25e-6, measured, error: Some(3e-4) };
        let run = |step, verdict| Trial { step, measured, verdict };
        let row = |scheme, limit| Row {
            scheme,
            limit,
            runs: vec![run(1.234e-9, Verdict::LeftOut), run(1.23e-8, Verdict::Holds), run(1.23e-7, Verdict::Gains)],
        };
        let study = Study {
            contact: 1e-3,
            end: 4e-3,
            tolerance: 1e-2,
            reference,
            explicit: Some((reference, 0.2)),
            rows: vec![
                row(Scheme::Newmark { beta: 0.3025, gamma: 0.6125 }, 3.48e-9),
                row(Scheme::GeneralizedAlpha { rho_inf: 0.1234 }, f64::INFINITY),
                row(Scheme::Newmark { beta: 0.25, gamma: 0.45 }, 0.0),
            ],
            notes: vec!["runs end earlier than the scene does, to keep the study within some minutes, ".repeat(2)],
            is_interrupted: false,
        };
        let lines = gist(&study);
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH), "{lines:#?}");
        let text = lines.join("\n");
        assert!(text.contains("incomplete 3 of 9 runs were left out"), "{text}");
        // A run that was left out does not count as a failed run.
        for line in [
            "scheme                          Δt (s)  steps   Δt (s)  steps  stable",
            "Newmark β = 0.3025, γ = 0.6125 1.23e-8  81301  1.23e-7   8130  up to 3.48e-9 s",
            "generalised-α, ρ∞ = 0.1234     1.23e-8  81301  1.23e-7   8130  at every step",
        ] {
            assert!(lines.iter().any(|other| other == line), "{line}\n{text}");
        }
        assert_eq!(csv(&study).lines().filter(|line| line.ends_with(",left out,")).count(), 3);
    }
}
