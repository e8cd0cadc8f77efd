//! Draws the colour bar of a figure.

use super::canvas::{Anchor, Canvas, Drawn};
use super::frame::{FRAME, SMALL, TICK, line};
use super::scale::Scale;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

/// Draws a bar with ticks to the right of a frame. `colour` returns the colour of a relative position on `scale`, from
/// 0 (lower limit) to 1 (upper limit).
pub(super) fn draw_bar<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    (left, top, bottom): (f64, f64, f64),
    scale: &Scale,
    colour: fn(f64) -> RGBColor,
    title: &str,
) -> Drawn {
    let (right, height) = (left + 28.0, bottom - top);
    for n in 0..height as usize {
        let y = bottom - n as f64;
        canvas.rectangle((left, y - 1.0), (right, y), colour(n as f64 / height))?;
    }
    for (place, label) in scale.ticks() {
        let y = bottom - place * height;
        line(canvas, (right, y), (right + TICK, y), &FRAME)?;
        if let Some(label) = label {
            canvas.text(&label, (right + 14.0, y), SMALL, Anchor::Left)?;
        }
    }
    canvas.text(title, (left + 136.0, 0.5 * (top + bottom)), SMALL, Anchor::Upwards)
}
