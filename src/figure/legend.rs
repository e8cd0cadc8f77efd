//! Draws the title of a figure and the legend of its curves.

use super::canvas::{Anchor, Canvas};
use super::frame::LETTERS;
use super::letters::one_line;
use super::stroke::Stroke;
use plotters::backend::DrawingBackend;

const LEGEND_LETTERS: f64 = 29.0;
pub(super) const MARGIN: f64 = 30.0;
/// Height of a line of text.
pub(super) const LINE: f64 = 42.0;
const LEGEND_LINE: f64 = 40.0;
/// Length of the line sample in front of a label.
const LEGEND_STROKE: f64 = 84.0;
const LEGEND_COLUMNS: usize = 4;
const LEGEND_LINES: usize = 8;
/// With more entries than this, long labels are shortened to fit into columns instead of getting a line each.
const LEGEND_LONG_LINES: usize = 5;
/// An entry of a legend.
pub(super) struct Entry<'a> {
    /// Name of the curve; shortened if it is too long.
    pub label: &'a str,
    /// Stroke of the curve.
    pub stroke: Stroke,
}

/// Draws the title, if there is one. Returns the vertical position of its lower end.
pub(super) fn draw_title<DB: DrawingBackend>(canvas: &Canvas<DB>, title: &str) -> std::result::Result<f64, String> {
    if title.is_empty() {
        return Ok(MARGIN);
    }
    let fits = |title: &str| canvas.text_width(title, LETTERS) <= canvas.width - 2.0 * MARGIN;
    let at = (0.5 * canvas.width, MARGIN + 0.5 * LINE);
    canvas.text(&shortened(title, fits), at, LETTERS, Anchor::Centre)?;
    Ok(MARGIN + LINE + 10.0)
}

/// Draws the legend from `top` on, if at least one curve has a label. Returns the vertical position of its lower end.
pub(super) fn draw_legend<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    top: f64,
    entries: &[Entry],
) -> std::result::Result<f64, String> {
    let count = entries.len();
    if entries.iter().all(|entry| entry.label.is_empty()) {
        return Ok(top);
    }
    let width = canvas.width - 2.0 * MARGIN;
    let beside = LEGEND_STROKE + 46.0;
    let widest =
        entries.iter().map(|entry| canvas.text_width(entry.label, LEGEND_LETTERS) + beside).fold(0.0, f64::max);
    let fitting = ((width / widest) as usize).clamp(1, LEGEND_COLUMNS);
    let needed = if count > LEGEND_LONG_LINES { 2.max(count.div_ceil(LEGEND_LINES)) } else { 1 };
    let columns = fitting.max(needed).min(count);
    let lines = count.div_ceil(columns);
    let column = (width / columns as f64).min(widest);
    for (n, entry) in entries.iter().enumerate() {
        let x = MARGIN + 10.0 + (n / lines) as f64 * column;
        let y = top + ((n % lines) as f64 + 0.5) * LEGEND_LINE;
        let ends = [canvas.point(x, y), canvas.point(x + LEGEND_STROKE, y)];
        canvas.line(&ends, &entry.stroke)?;
        let fits = |label: &str| canvas.text_width(label, LEGEND_LETTERS) <= column - beside + 1.0;
        let label = shortened(entry.label, fits);
        let at = (x + LEGEND_STROKE + 16.0, y);
        canvas.text(&label, at, LEGEND_LETTERS, Anchor::Left)?;
    }
    Ok(top + lines as f64 * LEGEND_LINE + 26.0)
}

/// Shortens a label that does not fit: keeps its start and its end around an ellipsis, because titles of one study
/// differ at these ends.
fn shortened(label: &str, fits: impl Fn(&str) -> bool) -> String {
    let all = one_line(label);
    let letters: Vec<char> = all.chars().collect();
    if fits(&all) {
        return all;
    }
    let kept = |n: usize| -> String {
        let (head, tail) = (n - n / 2, n / 2);
        let head: String = letters[..head].iter().collect();
        let tail: String = letters[letters.len() - tail..].iter().collect();
        format!("{}\u{2026}{}", head.trim_end(), tail.trim_start())
    };
    let longest = (0..letters.len()).rev().find(|&n| fits(&kept(n)));
    kept(longest.unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::shortened;

    #[test]
    fn a_long_label_keeps_both_its_ends() {
        let fits = |label: &str| label.chars().count() <= 12;
        assert_eq!(shortened("short", fits), "short");
        assert_eq!(shortened("glass plate, k = 1e9", fits), "glass…= 1e9");
        assert_eq!(shortened("two\nlines", fits), "two lines");
    }
}
