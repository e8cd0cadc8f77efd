//! A study of stability as tables: all of it as CSV, and its gist as lines of text.

use super::schemes::{label, name};
use super::stability::{ENOUGH, Reference, Row, Study};

/// Columns of the CSV, with their units.
const HEADER: &str = "scheme,step_s,steps_per_contact,stable_step_s,steps,time_s,energy_error,growth,\
                      force_error_first,force_error,verdict,reason\n";

/// One line a run, by scheme and ascending step. Errors are parts of the initial energy and of the reference's peak acceleration.
pub fn csv(study: &Study) -> String {
    let mut text = HEADER.to_owned();
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

/// As a field of a CSV: commas and quotes are no end of it.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// What was run, and for each scheme how far it holds and what theory has to say.
pub fn gist(study: &Study) -> Vec<String> {
    let mut lines = vec![format!(
        "first contact {:.4} ms, runs to {:.4} ms; right is what is off by less than {:.1e} of energy and force",
        1e3 * study.contact,
        1e3 * study.end,
        study.tolerance
    )];
    lines.push(format!("reference  {}", reference_line(&study.reference)));
    if let Some((reference, difference)) = &study.explicit {
        lines.push(format!("           {}", reference_line(reference)));
        lines.push(format!(
            "           lumping the mass changes the force of the first contact by {difference:.1e} of its peak"
        ));
    }
    lines.extend(study.notes.iter().map(|note| format!("left out   {note}")));
    lines.push(String::new());
    let line = |cells: [&str; 4]| format!("{:<26}{:<27}{:<27}{}", cells[0], cells[1], cells[2], cells[3]);
    lines.push(line(["scheme", "right up to", "gains energy from", "theory: stable"]));
    for row in &study.rows {
        let step = |step: Option<f64>| {
            step.map_or("\u{2013}".to_owned(), |step| format!("{step:.2e} s ({:.1}/contact)", study.contact / step))
        };
        lines.push(line([&label(row.scheme), &step(row.holds()), &step(row.grows()), &theory(row)]));
    }
    lines.push(format!(
        "theory: a contact takes {ENOUGH} steps, {:.2e} s, and more where the body vibrates meanwhile",
        study.contact / ENOUGH
    ));
    lines
}

/// Up to which step theory has a scheme stable.
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
