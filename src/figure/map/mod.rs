//! Draws heat maps of values over the time step, with one row for each scheme, side by side with a common colour scale.

use crate::error::{Error, Result};
use crate::figure::axis::exponential;
use crate::figure::canvas::{Anchor, Canvas, Drawing, Drawn, HEIGHT, WIDTH};
use crate::figure::frame::{FRAME, Frame, INK, PAPER, TICK, line, titled};
use crate::figure::output::save;
use crate::figure::scale::Scale;
use crate::figure::shade::{MISSING, shade};
use crate::figure::stroke::Stroke;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use std::cmp::Ordering;
use std::path::Path;

/// Heat maps over the same rows and time steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Title above the maps.
    pub title: String,
    /// Titles of the maps, from left to right.
    pub panels: Vec<String>,
    /// The rows, from top to bottom.
    pub rows: Vec<Row>,
    /// Duration of a contact, s. The upper axis shows the number of time steps in it.
    pub contact: f64,
    /// Up to two time steps, s, marked by vertical lines, with their texts in the legend.
    pub marks: Vec<(f64, String)>,
    /// Text of the dots in the legend.
    pub good: String,
}

/// A row of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the row.
    pub label: String,
    /// Note below the name, in small letters.
    pub note: String,
    /// Time step of a limit, s, drawn as a line; an arrow is drawn if it is beyond the axis. 0 or infinity for no
    /// limit.
    pub limit: f64,
    /// Cells by ascending time step.
    pub cells: Vec<Cell>,
}

/// A cell of a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Time step Δt, s.
    pub step: f64,
    /// One value for each map.
    pub values: Vec<Value>,
    /// Whether the cell gets a dot.
    pub is_good: bool,
}

/// Content of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// A non-negative number.
    Number(f64),
    /// No number, because the solution grows without bound.
    Unbounded,
    /// No number for another reason.
    Missing,
}

/// Draws to `out`, an SVG or a PNG of 1600 × 1000 pixels, depending on the extension.
///
/// # Errors
/// [`Error::Usage`] for another extension or without a cell; [`Error::Io`] if the file cannot be written.
pub fn draw(map: &Map, out: &Path) -> Result<()> {
    if map.panels.is_empty() || map.rows.iter().all(|row| row.cells.is_empty()) {
        return Err(Error::Usage("a map without cells shows nothing".into()));
    }
    save(map, out)
}

const LETTERS: f64 = 28.0;
const SMALL: f64 = 21.0;
const MARGIN: f64 = 26.0;
const TOP: f64 = 172.0;
const BOTTOM: f64 = 830.0;
/// Distance between the maps, pixels.
const GAP: f64 = 34.0;
/// Fraction of the height of a row that its cells fill.
const FILL: f64 = 0.84;
/// Largest ratio between the time step of a cell and the ends of the cell; the ends are closer if a neighbour is near.
const REACH: f64 = std::f64::consts::SQRT_2;

/// Smallest and largest power of ten of the colour scale.
const SCALE: (i32, i32) = (-6, 0);
const UNBOUNDED: RGBColor = RGBColor(213, 94, 0);
const LIMIT: Stroke = Stroke { colour: INK, width: 5.0, dashes: &[] };
/// Strokes of the marks, in their order.
const MARKS: [Stroke; 2] = [
    Stroke { colour: RGBColor(0, 120, 90), width: 3.0, dashes: &[4.0, 2.5] },
    Stroke { colour: RGBColor(150, 60, 120), width: 3.0, dashes: &[1.2, 1.6] },
];

/// Draws an arrow with the given tip, which points to a limit beyond the axis. `inwards` is 1 if the axis lies to the
/// right of the tip, −1 if it lies to the left. The arrow has a white outline, because the cells below it may have any
/// colour.
fn draw_arrow<DB: DrawingBackend>(canvas: &Canvas<DB>, tip: (f64, f64), inwards: f64) -> Drawn {
    for (colour, wider) in [(PAPER, 4.0), (INK, 0.0)] {
        let stroke = Stroke { colour, width: 4.0 + wider, dashes: &[] };
        let at = |x: f64, y: f64| canvas.point(tip.0 + inwards * x, tip.1 + y);
        canvas.line(&[at(0.0, 0.0), at(24.0 + 0.5 * wider, 0.0)], &stroke)?;
        canvas.line(&[at(10.0, -10.0), at(0.0, 0.0), at(10.0, 10.0)], &stroke)?;
    }
    Ok(())
}

impl Drawing for Map {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let labels =
            self.rows.iter().map(|row| canvas.text_width(&row.label, LETTERS).max(canvas.text_width(&row.note, SMALL)));
        let first = MARGIN + labels.fold(0.0, f64::max) + 20.0;
        let count = self.panels.len() as f64;
        let width = (WIDTH - MARGIN - first - (count - 1.0) * GAP) / count;
        canvas.text(&self.title, (0.5 * WIDTH, MARGIN + 6.0), LETTERS, Anchor::Centre)?;
        let pitch = (BOTTOM - TOP) / self.rows.len() as f64;
        for (n, row) in self.rows.iter().enumerate() {
            let y = TOP + (n as f64 + 0.5) * pitch;
            canvas.text(&row.label, (first - 16.0, y - 0.5 * SMALL), LETTERS, Anchor::Right)?;
            canvas.text(&row.note, (first - 16.0, y + 0.6 * LETTERS), SMALL, Anchor::Right)?;
        }
        for n in 0..self.panels.len() {
            let left = first + n as f64 * (width + GAP);
            let (x, y) = (self.steps(), Scale::new(0.0, 1.0, false));
            let frame = Frame { left, right: left + width, top: TOP, bottom: BOTTOM, x, y };
            self.draw_panel(canvas, &frame, n)?;
        }
        self.draw_legend(canvas)
    }
}

impl Map {
    /// Axis of the time steps, which encloses all cells.
    fn steps(&self) -> Scale {
        let steps = self.rows.iter().flat_map(|row| &row.cells).map(|cell| cell.step);
        let (low, high) = steps.fold((f64::INFINITY, 0.0_f64), |(low, high), s| (low.min(s), high.max(s)));
        Scale::new(low / REACH, high * REACH, true)
    }

    fn draw_panel<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame, panel: usize) -> Drawn {
        let pitch = (BOTTOM - TOP) / self.rows.len() as f64;
        for (n, row) in self.rows.iter().enumerate() {
            let middle = TOP + (n as f64 + 0.5) * pitch;
            let (top, bottom) = (middle - 0.5 * FILL * pitch, middle + 0.5 * FILL * pitch);
            for (m, cell) in row.cells.iter().enumerate() {
                let (low, high) = row.extent(m);
                // A white line separates neighbouring cells.
                let corners = ((frame.at_x(low) + 1.0, top), (frame.at_x(high) - 1.0, bottom));
                let value = cell.values.get(panel).copied().unwrap_or(Value::Missing);
                canvas.rectangle(corners.0, corners.1, value.colour())?;
                if cell.is_good {
                    let is_dark = matches!(value, Value::Number(number) if place(number) > 0.55);
                    let ink = if is_dark { PAPER } else { INK };
                    canvas.dot((0.5 * (corners.0.0 + corners.1.0), middle), 4.5, ink)?;
                }
            }
        }
        for ((step, _), stroke) in self.marks.iter().zip(&MARKS).filter(|((step, _), _)| frame.x.holds(*step)) {
            let x = frame.at_x(*step);
            line(canvas, (x, TOP), (x, BOTTOM), stroke)?;
        }
        for (n, row) in self.rows.iter().enumerate() {
            let (top, middle) = (TOP + n as f64 * pitch, TOP + (n as f64 + 0.5) * pitch);
            match row.side(&frame.x) {
                Some(Ordering::Equal) => {
                    let x = frame.at_x(row.limit);
                    line(canvas, (x, top + 1.0), (x, top + pitch - 1.0), &LIMIT)?;
                }
                Some(Ordering::Less) => draw_arrow(canvas, (frame.left + 5.0, middle), 1.0)?,
                Some(Ordering::Greater) => draw_arrow(canvas, (frame.right - 5.0, middle), -1.0)?,
                None => {}
            }
        }
        self.draw_axes(canvas, frame, &self.panels[panel])
    }

    /// Draws the frame, the ticks and the titles: time step below, time steps per contact above.
    fn draw_axes<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame, title: &str) -> Drawn {
        frame.draw_across(canvas, true)?;
        // The number of time steps per contact increases from right to left.
        let counts = Scale::new(self.contact / frame.x.high, self.contact / frame.x.low, true);
        for (place, label) in counts.ticks() {
            let x = frame.right - place * (frame.right - frame.left);
            let length = if label.is_some() { TICK } else { 0.5 * TICK };
            line(canvas, (x, TOP - length), (x, TOP), &FRAME)?;
            if let Some(label) = label {
                canvas.text(&label, (x, TOP - 28.0), LETTERS, Anchor::Centre)?;
            }
        }
        let middle = 0.5 * (frame.left + frame.right);
        canvas.text(title, (middle, 74.0), LETTERS, Anchor::Centre)?;
        canvas.text(&titled("steps a contact", &counts.unit("")), (middle, 110.0), SMALL, Anchor::Centre)?;
        canvas.text(&titled("time step", &frame.x.unit("s")), (middle, BOTTOM + 60.0), SMALL, Anchor::Centre)
    }

    /// Draws the colour scale at the left, and the legend of lines, dots and special colours to its right.
    fn draw_legend<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let (y, height) = (HEIGHT - 62.0, 24.0);
        let (left, width) = (MARGIN + 24.0, 330.0);
        for n in 0..width as usize {
            let x = left + n as f64;
            let value = 10_f64.powf(f64::from(SCALE.0) + f64::from(SCALE.1 - SCALE.0) * n as f64 / width);
            canvas.rectangle((x, y - 0.5 * height), (x + 1.0, y + 0.5 * height), colour(value))?;
        }
        for power in (SCALE.0..=SCALE.1).step_by(2) {
            let x = left + width * f64::from(power - SCALE.0) / f64::from(SCALE.1 - SCALE.0);
            canvas.text(&exponential(power), (x, y + 32.0), SMALL, Anchor::Centre)?;
        }
        let (mut x, steps) = (left + width + 50.0, self.steps());
        let mut entry = |text: &str, draw: &dyn Fn(f64) -> Drawn| -> Drawn {
            draw(x)?;
            canvas.text(text, (x + 46.0, y), SMALL, Anchor::Left)?;
            x += 46.0 + canvas.text_width(text, SMALL) + 20.0;
            Ok(())
        };
        for (value, text) in [(Value::Unbounded, "blows up"), (Value::Missing, "not solved")] {
            let mut cells = self.rows.iter().flat_map(|row| &row.cells);
            if cells.any(|cell| cell.values.contains(&value)) {
                entry(text, &|x| {
                    canvas.rectangle((x, y - 0.5 * height), (x + 36.0, y + 0.5 * height), value.colour())
                })?;
            }
        }
        entry(&self.good, &|x| canvas.dot((x + 18.0, y), 4.5, INK))?;
        let upright = |x: f64, stroke: &Stroke| line(canvas, (x + 18.0, y - 22.0), (x + 18.0, y + 22.0), stroke);
        let sides: Vec<Ordering> = self.rows.iter().filter_map(|row| row.side(&steps)).collect();
        if sides.contains(&Ordering::Equal) {
            entry("predicted limit", &|x| upright(x, &LIMIT))?;
        }
        if let Some(side) = sides.iter().find(|side| **side != Ordering::Equal) {
            let (tip, towards) = if *side == Ordering::Less { (8.0, 1.0) } else { (30.0, -1.0) };
            let text =
                if sides.contains(&Ordering::Equal) { "beyond the axis" } else { "predicted limit: beyond the axis" };
            entry(text, &|x| draw_arrow(canvas, (x + tip, y), towards))?;
        }
        for ((_, text), stroke) in self.marks.iter().zip(&MARKS).filter(|((step, _), _)| steps.holds(*step)) {
            entry(text, &|x| upright(x, stroke))?;
        }
        Ok(())
    }
}

impl Row {
    /// Position of the limit relative to the axis of the time steps; `None` without a limit.
    fn side(&self, steps: &Scale) -> Option<Ordering> {
        let has_limit = self.limit > 0.0 && self.limit.is_finite();
        has_limit.then_some(match self.limit {
            limit if limit < steps.low => Ordering::Less,
            limit if limit > steps.high => Ordering::Greater,
            _ => Ordering::Equal,
        })
    }

    /// Smallest and largest time step of a cell, s: half way (on the logarithmic axis) to its neighbours, at most a
    /// factor of [`REACH`].
    fn extent(&self, cell: usize) -> (f64, f64) {
        let step = |n: usize| self.cells.get(n).map(|cell| cell.step);
        let here = self.cells[cell].step;
        let before = cell.checked_sub(1).and_then(step).unwrap_or(0.0);
        let after = step(cell + 1).unwrap_or(f64::INFINITY);
        ((before * here).sqrt().max(here / REACH), (here * after).sqrt().min(here * REACH))
    }
}

impl Value {
    fn colour(self) -> RGBColor {
        match self {
            Self::Number(number) => colour(number),
            Self::Unbounded => UNBOUNDED,
            Self::Missing => MISSING,
        }
    }
}

/// Relative position of a value on the colour scale, from 0 to 1.
fn place(value: f64) -> f64 {
    let (low, high) = (f64::from(SCALE.0), f64::from(SCALE.1));
    // NaN is drawn as the worst value.
    let power = value.log10().min(high).max(low);
    if value.is_nan() { 1.0 } else { (power - low) / (high - low) }
}

fn colour(value: f64) -> RGBColor {
    shade(place(value))
}

#[cfg(test)]
mod tests;
