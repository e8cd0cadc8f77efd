//! Colours that represent numbers, and the bar that shows their scale.

use super::canvas::{Anchor, Canvas, Drawn};
use super::frame::{FRAME, SMALL, TICK, line};
use super::scale::Scale;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

/// Colours from light to dark: Blues of ColorBrewer (C. Brewer, 2003) without the two lightest, which are invisible on
/// paper.
const COLOURS: [RGBColor; 7] = [
    RGBColor(232, 241, 250),
    RGBColor(198, 219, 239),
    RGBColor(158, 202, 225),
    RGBColor(107, 174, 214),
    RGBColor(49, 130, 189),
    RGBColor(8, 81, 156),
    RGBColor(8, 38, 82),
];
/// Colour of missing values.
pub(super) const MISSING: RGBColor = RGBColor(160, 160, 160);

/// Colour of a relative position on a scale: light at 0, dark at 1.
pub(super) fn shade(place: f64) -> RGBColor {
    let at = place.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let n = (at as usize).min(COLOURS.len() - 2);
    let (from, to, part) = (COLOURS[n], COLOURS[n + 1], at - n as f64);
    let mixed = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(mixed(from.0, to.0), mixed(from.1, to.1), mixed(from.2, to.2))
}

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
