//! Warnings and notes about a scene and its result, to be read before the result is trusted.

mod accuracy;
mod doubts;
mod geometry;
mod scene;

use super::{note, tell};
pub use accuracy::{
    UNESTIMATED_ROTATIONS, Verdict, describe_model, history_above, missed, note_of_measure, of_deflection,
    of_large_deflection_error, of_tension, remedy_of_tension, verdict,
};
pub use doubts::of_values;
pub use geometry::of_geometry;
pub use scene::{missing_faces, notes};

/// A warning or note about a scene or its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// Kind of the remark. Remarks of the same kind on the members of a sweep are combined.
    pub kind: String,
    /// Severity among remarks of the same kind.
    pub size: f64,
    /// Text of the remark.
    pub text: String,
}

impl Remark {
    fn new(kind: &str, size: f64, text: String) -> Self {
        Self { kind: kind.to_owned(), size, text }
    }
}

/// Warnings and notes of a run, which are printed, and stored with its result.
#[derive(Debug, Default)]
pub struct Said {
    lines: Vec<String>,
    /// Number of lines that are printed.
    printed: usize,
}

impl Said {
    /// Adds warnings.
    pub fn warn(&mut self, texts: impl IntoIterator<Item = String>) {
        self.lines.extend(texts.into_iter().map(|text| format!("warning: {text}")));
    }

    /// Adds notes.
    pub fn note(&mut self, texts: impl IntoIterator<Item = String>) {
        self.lines.extend(texts.into_iter().map(|text| format!("note: {text}")));
    }

    /// Number of remarks.
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// Prints the remarks up to a number that have not been printed yet; no notes if `--quiet` is given.
    pub fn print(&mut self, count: usize) {
        for line in &self.lines[self.printed..count] {
            if line.starts_with("note") { note(format_args!("{line}")) } else { tell(format_args!("{line}")) }
        }
        self.printed = count;
    }

    /// All remarks, each in a line.
    pub fn text(&self) -> String {
        self.lines.join("\n")
    }
}

/// Texts of remarks.
pub fn texts(remarks: impl IntoIterator<Item = Remark>) -> Vec<String> {
    remarks.into_iter().map(|remark| remark.text).collect()
}

/// A number with its noun: "1 vector", "20 vectors".
pub fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Joins words to a list: "a, b and c".
pub fn listed(words: &[&str]) -> String {
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => words.concat(),
    }
}
