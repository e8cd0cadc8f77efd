//! Draws quantities of runs against time.

use super::canvas::{Anchor, Canvas, Drawing, Drawn, Sheet};
use super::frame::{FRAME, Frame, LETTERS, titled};
use super::legend::{Entry, LINE, MARGIN, draw_legend, draw_title};
use super::output::{inline, save};
use super::scale::Scale;
use super::stroke::{LIMIT, MAX_STROKES, Stroke, TOTAL, is_like_total, stroke, thinned};
use crate::error::{Error, Result};
use crate::record::episodes::Episode;
use plotters::backend::DrawingBackend;
use std::path::Path;

/// Data of a figure: a quantity of one or more runs against time.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Title above the figure; may be empty.
    pub title: String,
    /// Title of the vertical axis.
    pub quantity: String,
    /// Unit of the quantity.
    pub unit: String,
    /// The runs.
    pub runs: Vec<RunCurves>,
}

/// The curves of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunCurves {
    /// Times of the values, s.
    pub time: Vec<f64>,
    /// The quantity, or one curve for each of its components.
    pub curves: Vec<Curve>,
    /// The contacts.
    pub contacts: Vec<Episode>,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name in the legend; shortened if it is too long.
    pub label: String,
    /// Value at each time.
    pub values: Vec<f64>,
    /// Meaning of the curve beside the others.
    pub role: Role,
}

/// Meaning of a curve beside the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// One of several alike.
    Value,
    /// The sum of the others, drawn wide, black and dashed.
    Total,
    /// A limit with which others are compared, drawn dashed.
    Limit,
}

/// Draws the curves to `out`, an SVG or a PNG of 1600 × 1000 pixels, depending on the extension. Values that are not
/// finite are left out.
///
/// # Errors
/// [`Error::Usage`] for another extension, without a curve, or for more curves than can be distinguished; [`Error::Io`]
/// if the file cannot be written.
pub fn draw(history: &History, out: &Path) -> Result<()> {
    check(history)?;
    save(history, out)
}

/// Draws the curves to the text of an `svg` element for a page. `name` is its description for screen readers.
///
/// # Errors
/// [`Error::Usage`] without a curve, or for more curves than can be distinguished; [`Error::Output`] if the figure
/// cannot be drawn.
pub fn draw_inline(history: &History, sheet: Sheet, name: &str) -> Result<String> {
    check(history)?;
    inline(history, sheet, name).map_err(Error::Output)
}

fn check(history: &History) -> Result<()> {
    match history.curves().count() {
        1..=MAX_STROKES => Ok(()),
        count => Err(Error::Usage(format!("a figure shows 1 to {MAX_STROKES} curves, not {count}"))),
    }
}

/// Smallest and largest height of the area with the contacts, pixels.
const CONTACTS: (f64, f64) = (36.0, 160.0);
/// Distance between the plot and the area with the contacts, pixels.
const CONTACTS_GAP: f64 = 16.0;

/// Distance of the titles of the axes from the labels, pixels.
const TITLES: f64 = 50.0;

impl Drawing for History {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let top = draw_title(canvas, &self.title)?;
        let strokes = self.strokes();
        let entries: Vec<Entry> =
            self.curves().zip(&strokes).map(|(curve, stroke)| Entry { label: &curve.label, stroke: *stroke }).collect();
        let top = draw_legend(canvas, top, &entries)?;
        let [plot, below] = self.frames(canvas, top);
        plot.draw_grid(canvas)?;
        let curves = self.runs.iter().flat_map(|run| run.curves.iter().map(move |curve| (run, curve)));
        for ((run, curve), stroke) in curves.zip(&strokes) {
            let points = run.points(curve).map(|(t, value)| canvas.point(plot.at_x(t), plot.at_y(value)));
            canvas.line(&thinned(points), stroke)?;
        }
        plot.draw_axes(canvas, false)?;
        self.draw_contacts(canvas, &below)?;
        below.draw_axes(canvas, true)?;
        let title = titled("time", &below.x.unit("ms"));
        canvas.text(&title, (0.5 * (plot.left + plot.right), below.bottom + 84.0), LETTERS, Anchor::Centre)?;
        let title = titled(&self.quantity, &plot.y.unit(&self.unit));
        canvas.text(&title, (MARGIN + 12.0, 0.5 * (top + below.bottom)), LETTERS, Anchor::Upwards)
    }
}

impl History {
    /// Iterates over the curves of all runs.
    fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.runs.iter().flat_map(|run| &run.curves)
    }

    /// Strokes of the curves, in their order.
    fn strokes(&self) -> Vec<Stroke> {
        let (count, has_total) = (self.curves().count(), self.curves().any(|curve| curve.role == Role::Total));
        let mut values = (0..).filter(|n| !has_total || !is_like_total(*n));
        let stroke = |curve: &Curve| match curve.role {
            Role::Value => stroke(values.next().unwrap_or_default(), count),
            Role::Total => TOTAL,
            Role::Limit => LIMIT,
        };
        self.curves().map(stroke).collect()
    }

    /// Frames of the curves and, below it, of the contacts.
    fn frames<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, top: f64) -> [Frame; 2] {
        let (mut x, mut y) = ((0.0_f64, 0.0_f64), (0.0_f64, 0.0_f64));
        let points = self.runs.iter().flat_map(|run| run.curves.iter().flat_map(|curve| run.points(curve)));
        for (t, value) in points {
            x = (x.0.min(t), x.1.max(t));
            y = (y.0.min(value), y.1.max(value));
        }
        // An extreme value below 1e-3 of the opposite one (less than a pixel) is due to rounding. The axis is not
        // extended for it.
        let seen = |own: f64, other: f64| if own.abs() < 1e-3 * other.abs() { 0.0 } else { own };
        let y = (seen(y.0, y.1), seen(y.1, y.0));
        // Leaves a margin of 2% above the highest peak and below the lowest.
        let (values, contacts) = (Scale::spanning(1.02 * y.0, 1.02 * y.1), Scale::named(&["contact".to_owned()]));
        let left = MARGIN + TITLES + canvas.widest(&values, LETTERS).max(canvas.widest(&contacts, LETTERS));
        let right = canvas.width - 1.6 * MARGIN;
        let foot = canvas.height - MARGIN - 2.0 * LINE - 14.0;
        let below = foot - self.pitch() * self.runs.len() as f64;
        let frame =
            |top: f64, bottom: f64, y: Scale| Frame { left, right, top, bottom, x: Scale::spanning(x.0, x.1), y };
        [frame(top, below - CONTACTS_GAP, values), frame(below, foot, contacts)]
    }

    /// Height of one run's row of contacts, pixels.
    fn pitch(&self) -> f64 {
        let count = self.runs.len() as f64;
        (16.0 * count).clamp(CONTACTS.0, CONTACTS.1) / count
    }

    /// Draws the contacts of each run as a row of bars.
    fn draw_contacts<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame) -> Drawn {
        let pitch = self.pitch();
        let (mut curves, all) = (0, self.curves().count());
        for (n, run) in self.runs.iter().enumerate() {
            // The contacts of a single run with several components do not belong to one of its curves, so they get a
            // neutral colour.
            let is_of_all = self.runs.len() == 1 && all > 1;
            let colour = if is_of_all { FRAME.colour } else { stroke(curves, all).colour };
            curves += run.curves.len();
            let y = frame.top + (n as f64 + 0.5) * pitch;
            let half = (0.36 * pitch).min(6.0);
            for &Episode { start, end, .. } in &run.contacts {
                if !(start.is_finite() && end.is_finite()) {
                    continue;
                }
                let from = frame.at_x(1e3 * start).max(frame.left);
                // A bar has a width of at least 2 pixels, so that it is visible.
                let to = frame.at_x(1e3 * end).min(frame.right).max(from + 2.0);
                canvas.rectangle((from, y - half), (to, y + half), colour)?;
            }
        }
        Ok(())
    }
}

impl RunCurves {
    /// Time in ms and value of a curve, where both are finite.
    fn points(&self, curve: &Curve) -> impl Iterator<Item = (f64, f64)> {
        let points = self.time.iter().zip(&curve.values).map(|(t, value)| (1e3 * t, *value));
        points.filter(|(t, value)| t.is_finite() && value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A total differs from all other curves in colour, wherever it is among them, and all strokes differ.
    #[test]
    fn a_total_has_a_colour_of_its_own() {
        for (count, total) in [(9, 8), (6, 5), (9, 0), (3, 1)] {
            let curve = |n: usize| Curve {
                label: n.to_string(),
                values: vec![0.0],
                role: if n == total { Role::Total } else { Role::Value },
            };
            let run = RunCurves { time: vec![0.0], curves: (0..count).map(curve).collect(), contacts: Vec::new() };
            let history =
                History { title: String::new(), quantity: String::new(), unit: String::new(), runs: vec![run] };
            let strokes = history.strokes();
            for (n, one) in strokes.iter().enumerate() {
                assert!(n == total || one.colour != TOTAL.colour, "{n} of {count}");
                assert!(strokes[n + 1..].iter().all(|other| other != one), "{n} of {count}");
            }
        }
    }
}
