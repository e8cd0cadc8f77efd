//! Draws a face of the body with the largest tension over time in colours.

mod surface;

use std::f64::consts::TAU;
use std::path::Path;

use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;

use super::canvas::{Anchor, Canvas, Drawing, Drawn, Sheet};
use super::frame::{Frame, INK, LETTERS, PAPER, SMALL, line, titled};
use super::legend::draw_title;
use super::output::{inline, save};
use super::scale::Scale;
use super::shade::{draw_bar, shade};
use super::stroke::Stroke;
use crate::error::{Error, Result};

pub use surface::Surface;

/// Data of the figure of one face.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceFigure {
    /// Title above the figure; may be empty.
    pub title: String,
    /// Quantity shown by the colours.
    pub quantity: String,
    /// Unit of the colour scale.
    pub unit: String,
    /// Divisor that converts a value of the surface to the unit of the colour scale.
    pub scale: f64,
    /// The values on the face, in SI units.
    pub surface: Surface,
    /// Lowest and highest value of the colour scale, in its unit.
    pub range: (f64, f64),
    /// Position of the marked point along the axes of the surface, m.
    pub mark: [f64; 2],
    /// Note below the figure.
    pub note: String,
}

/// Number of rows of coloured cells, and below it the number of colours. Neighbouring cells of one colour are drawn as
/// one rectangle.
const ROWS: usize = 160;
const BANDS: f64 = 20.0;

const LEFT: f64 = 130.0;
const BAR: f64 = 250.0;
const BELOW: f64 = 150.0;
const GAP: f64 = 40.0;

/// Draws to `out`, an SVG or a PNG depending on its extension.
///
/// # Errors
/// [`Error::Usage`] for another extension; [`Error::Io`] if the file cannot be written.
pub fn draw(figure: &FaceFigure, out: &Path) -> Result<()> {
    save(figure, out)
}

/// Draws to the text of an `svg` element for a page. `name` is its description for screen readers.
///
/// # Errors
/// [`Error::Output`] if the figure cannot be drawn.
pub fn draw_inline(figure: &FaceFigure, sheet: Sheet, name: &str) -> Result<String> {
    inline(figure, sheet, name).map_err(Error::Output)
}

impl FaceFigure {
    fn draw_cells<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame, scale: &Scale) -> Drawn {
        let (width, height) = (frame.right - frame.left, frame.bottom - frame.top);
        let rows = ROWS;
        // Points on a line make no face.
        let columns = ((ROWS as f64 * width / height) as usize).clamp(1, 10 * ROWS);
        let [across, up] = self.surface.ends;
        let between = |(low, high): (f64, f64), part: f64| low + part * (high - low);
        for row in 0..rows {
            let y = |n: usize| frame.bottom - height * n as f64 / rows as f64;
            let v = between(up, (row as f64 + 0.5) / rows as f64);
            let colour = |column: usize| {
                let u = between(across, (column as f64 + 0.5) / columns as f64);
                self.surface.at([u, v]).map(|value| banded(scale.place(value / self.scale)))
            };
            let x = |n: usize| frame.left + width * n as f64 / columns as f64;
            let (mut begin, mut of_run) = (0, colour(0));
            for column in 1..=columns {
                let next = (column < columns).then(|| colour(column));
                if next != Some(of_run) {
                    if let Some(of_run) = of_run {
                        canvas.rectangle((x(begin), y(row + 1)), (x(column), y(row)), of_run)?;
                    }
                    (begin, of_run) = (column, next.flatten());
                }
            }
        }
        Ok(())
    }

    /// Draws the part of the circle of interpolated values that lies on the face.
    fn draw_unread<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame) -> Drawn {
        let Some((middle, radius)) = self.surface.unread else { return Ok(()) };
        let [across, up] = self.surface.ends;
        let is_within = |[x, y]: &[f64; 2]| (across.0..=across.1).contains(x) && (up.0..=up.1).contains(y);
        let at = |n: usize| {
            let (sine, cosine) = (n as f64 / ROUND as f64 * TAU).sin_cos();
            [middle[0] + radius * cosine, middle[1] + radius * sine]
        };
        let circle: Vec<[f64; 2]> = (0..=ROUND).map(at).collect();
        for arc in circle.split(|place| !is_within(place)).filter(|arc| arc.len() > 1) {
            let arc: Vec<_> = arc.iter().map(|[x, y]| canvas.point(frame.at_x(*x), frame.at_y(*y))).collect();
            for (colour, dashes) in [(PAPER, &[][..]), (INK, &[3.0, 3.0][..])] {
                canvas.line(&arc, &Stroke { colour, width: 2.5, dashes })?;
            }
        }
        Ok(())
    }

    fn draw_mark<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame) -> Drawn {
        let (x, y) = (frame.at_x(self.mark[0]), frame.at_y(self.mark[1]));
        // The circle of interpolated values must remain visible around the mark.
        let circle =
            self.surface.unread.map(|(middle, radius)| (frame.at_x(middle[0] + radius) - frame.at_x(middle[0])).abs());
        let arm = circle.map_or(LONGEST_ARM, |radius| (0.7 * radius).clamp(SHORTEST_ARM, LONGEST_ARM));
        for (colour, size, width) in [(PAPER, arm + 2.0, 8.0), (INK, arm, 3.5)] {
            let stroke = Stroke { colour, width, dashes: &[] };
            line(canvas, (x - size, y), (x + size, y), &stroke)?;
            line(canvas, (x, y - size), (x, y + size), &stroke)?;
        }
        Ok(())
    }
}

/// Lengths of the arms of the mark at the impact point, in units of the canvas.
const LONGEST_ARM: f64 = 15.0;
const SHORTEST_ARM: f64 = 6.0;

/// Number of points of a circle.
const ROUND: usize = 96;

/// Colour of the band that contains a relative position between 0 and 1.
fn banded(place: f64) -> RGBColor {
    shade(((place * BANDS).floor().clamp(0.0, BANDS - 1.0) + 0.5) / BANDS)
}

impl Drawing for FaceFigure {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let top = draw_title(canvas, &self.title)? + 10.0;
        let (left, right, bottom) = (LEFT, canvas.width - BAR, canvas.height - BELOW);
        // Both axes have the same scale.
        let [across, up] = self.surface.ends.map(|(low, high)| high - low);
        let size = ((right - left) / across).min((bottom - top) / up);
        let (left, top) = (0.5 * (left + right - size * across), 0.5 * (top + bottom - size * up));
        let (right, bottom) = (left + size * across, top + size * up);
        let [x, y] = self.surface.ends.map(|(low, high)| Scale::new(low, high, false));
        let frame = Frame { left, right, top, bottom, x, y };
        let scale = Scale::new(self.range.0, self.range.1, false);
        self.draw_cells(canvas, &frame, &scale)?;
        frame.draw_axes(canvas, true)?;
        self.draw_unread(canvas, &frame)?;
        self.draw_mark(canvas, &frame)?;
        let [across, up] = self.surface.axes.map(|axis| ["x", "y", "z"][axis]);
        let below = bottom + 72.0;
        let title = titled(across, &frame.x.unit("m"));
        canvas.text(&title, (0.5 * (left + right), below), LETTERS, Anchor::Centre)?;
        let at = (0.5 * canvas.width, (below + 44.0).min(canvas.height - 20.0));
        canvas.text(&self.note, at, SMALL, Anchor::Centre)?;
        let title = titled(up, &frame.y.unit("m"));
        let beside = left - 40.0 - canvas.widest(&frame.y, LETTERS);
        canvas.text(&title, (beside, 0.5 * (top + bottom)), LETTERS, Anchor::Upwards)?;
        let title = titled(&self.quantity, &scale.unit(&self.unit));
        draw_bar(canvas, (right + GAP, top, bottom), &scale, banded, &title)
    }
}
