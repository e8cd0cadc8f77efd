//! A rectangular part of the sheet with a horizontal and a vertical axis.

use super::canvas::{Anchor, Canvas, Drawn};
use super::scale::Scale;
use super::stroke::Stroke;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

/// Size of the letters: letters of half this size, as in a figure shown with a width of 800 pixels, are still readable.
pub(super) const LETTERS: f64 = 30.0;
/// Smallest distance between neighbouring labels of the horizontal axis.
const APART: f64 = 8.0;
pub(super) const SMALL: f64 = 24.0;
const GRID: Stroke = Stroke { colour: RGBColor(222, 222, 222), width: 1.5, dashes: &[] };
pub(super) const FRAME: Stroke = Stroke { colour: RGBColor(60, 60, 60), width: 2.0, dashes: &[] };
pub(super) const TICK: f64 = 8.0;
/// Colours of texts and marks, and of what lies under them.
pub(super) const INK: RGBColor = RGBColor(30, 30, 30);
pub(super) const PAPER: RGBColor = RGBColor(255, 255, 255);

/// A rectangular part of the sheet (its edges in pixels) with a horizontal and a vertical axis.
pub(super) struct Frame {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    pub x: Scale,
    pub y: Scale,
}

impl Frame {
    /// Horizontal position of a value, pixels.
    pub fn at_x(&self, x: f64) -> f64 {
        self.left + self.x.place(x) * (self.right - self.left)
    }

    /// Vertical position of a value, pixels.
    pub fn at_y(&self, y: f64) -> f64 {
        self.bottom - self.y.place(y) * (self.bottom - self.top)
    }

    /// Draws grid lines at the labelled ticks of both axes.
    pub fn draw_grid<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        for (place, _) in self.x.ticks().iter().filter(|tick| tick.1.is_some()) {
            let x = self.left + place * (self.right - self.left);
            line(canvas, (x, self.top), (x, self.bottom), &GRID)?;
        }
        for (place, _) in self.y.ticks().iter().filter(|tick| tick.1.is_some()) {
            let y = self.bottom - place * (self.bottom - self.top);
            line(canvas, (self.left, y), (self.right, y), &GRID)?;
        }
        Ok(())
    }

    /// Draws the frame, and the ticks of both axes. The horizontal axis has labels only if `is_last`.
    pub fn draw_axes<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, is_last: bool) -> Drawn {
        for (place, label) in self.y.ticks() {
            let y = self.bottom - place * (self.bottom - self.top);
            let length = if label.is_some() { TICK } else { 0.5 * TICK };
            line(canvas, (self.left - length, y), (self.left, y), &FRAME)?;
            if let Some(label) = label {
                canvas.text(&label, (self.left - 14.0, y), LETTERS, Anchor::Right)?;
            }
        }
        self.draw_across(canvas, is_last)
    }

    /// Draws the frame, and the ticks of the horizontal axis, with labels only if `is_last`.
    pub fn draw_across<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, is_last: bool) -> Drawn {
        // Smallest position of the next label. On narrow figures some labels are omitted.
        let mut free = f64::NEG_INFINITY;
        for (place, label) in self.x.ticks() {
            let x = self.left + place * (self.right - self.left);
            let length = if label.is_some() { TICK } else { 0.5 * TICK };
            line(canvas, (x, self.bottom), (x, self.bottom + length), &FRAME)?;
            let Some(label) = label.filter(|_| is_last) else { continue };
            let half = 0.5 * canvas.text_width(&label, LETTERS);
            if x - half >= free {
                canvas.text(&label, (x, self.bottom + 30.0), LETTERS, Anchor::Centre)?;
                free = x + half + APART;
            }
        }
        for y in [self.top, self.bottom] {
            line(canvas, (self.left, y), (self.right, y), &FRAME)?;
        }
        for x in [self.left, self.right] {
            line(canvas, (x, self.top), (x, self.bottom), &FRAME)?;
        }
        Ok(())
    }
}

/// Title of an axis with its unit, if it has one.
pub(super) fn titled(title: &str, unit: &str) -> String {
    match unit.trim() {
        "" => title.to_owned(),
        unit => format!("{title} ({unit})"),
    }
}

/// Draws a straight line.
pub(super) fn line<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    from: (f64, f64),
    to: (f64, f64),
    stroke: &Stroke,
) -> Drawn {
    canvas.line(&[canvas.point(from.0, from.1), canvas.point(to.0, to.1)], stroke)
}
