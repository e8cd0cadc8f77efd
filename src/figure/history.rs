//! Quantities of runs against time.

use super::axis::Axis;
use super::canvas::{Anchor, Canvas, Drawing, Drawn, HEIGHT, WIDTH, save};
use super::letters::one_line;
use super::stroke::{LOOKS, Stroke, stroke, thinned};
use crate::error::{Error, Result};
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use std::path::Path;

/// A quantity of some runs.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Above all; empty for none.
    pub title: String,
    /// What the vertical axis shows.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The runs.
    pub runs: Vec<Run>,
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Times, s.
    pub time: Vec<f64>,
    /// The quantity, or its components.
    pub curves: Vec<Curve>,
    /// Start and end of each contact, s.
    pub contacts: Vec<(f64, f64)>,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What the legend calls it; shortened where it is too long.
    pub label: String,
    /// Its value at each time.
    pub values: Vec<f64>,
}

/// Draws the curves to `out`, an SVG or a PNG of 1600 × 1000 pixels by its extension. Values that are not finite are
/// left out.
///
/// # Errors
/// [`Error::Usage`] for another extension, no curve, or more curves than can be told apart; [`Error::Io`] when the
/// file cannot be written.
pub fn draw(history: &History, out: &Path) -> Result<()> {
    let count = history.curves().count();
    if count == 0 || count > LOOKS {
        let message = format!("a figure shows 1 to {LOOKS} curves, not {count}");
        return Err(Error::Usage(message));
    }
    save(history, out)
}

/// Size of the letters: half of it is still readable where the figure is shown at 800 pixels.
const LETTERS: f64 = 32.0;
const LEGEND_LETTERS: f64 = 29.0;
const MARGIN: f64 = 30.0;
/// Height of a line of letters.
const LINE: f64 = 42.0;
const LEGEND_LINE: f64 = 40.0;
/// Length of the stroke beside a label.
const LEGEND_STROKE: f64 = 84.0;
const LEGEND_COLUMNS: usize = 4;
const LEGEND_LINES: usize = 8;
/// Long labels are rather shortened than given a line each when there are more.
const LEGEND_LONG_LINES: usize = 5;
/// Height that the contacts take at least and at most.
const CONTACTS: (f64, f64) = (36.0, 160.0);
/// Between the plot and the contacts.
const CONTACTS_GAP: f64 = 16.0;

const GRID: Stroke = Stroke { colour: RGBColor(222, 222, 222), width: 1.5, dashes: &[] };
const FRAME: Stroke = Stroke { colour: RGBColor(60, 60, 60), width: 2.0, dashes: &[] };

/// Where the data go: values to pixels.
struct Plot {
    x: Axis,
    y: Axis,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    /// Below the contacts.
    foot: f64,
}

impl Plot {
    fn at_x(&self, x: f64) -> f64 {
        self.left + (x - self.x.low) / (self.x.high - self.x.low) * (self.right - self.left)
    }

    fn at_y(&self, y: f64) -> f64 {
        self.bottom - (y - self.y.low) / (self.y.high - self.y.low) * (self.bottom - self.top)
    }
}

impl Drawing for History {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let top = self.draw_legend(canvas, self.draw_title(canvas)?)?;
        let plot = self.plot(canvas, top);
        self.draw_axes(canvas, &plot)?;
        self.draw_contacts(canvas, &plot)?;
        let count = self.curves().count();
        let curves = self.runs.iter().flat_map(|run| run.curves.iter().map(move |curve| (run, curve)));
        for (n, (run, curve)) in curves.enumerate() {
            let points = run.points(curve).map(|(t, value)| canvas.point(plot.at_x(t), plot.at_y(value)));
            canvas.line(&thinned(points), &stroke(n, count))?;
        }
        Ok(())
    }
}

impl History {
    /// The curves of all runs.
    fn curves(&self) -> impl Iterator<Item = &Curve> {
        self.runs.iter().flat_map(|run| &run.curves)
    }

    fn plot<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, top: f64) -> Plot {
        let (mut x, mut y) = ((0.0_f64, 0.0_f64), (0.0_f64, 0.0_f64));
        let points = self.runs.iter().flat_map(|run| run.curves.iter().flat_map(|curve| run.points(curve)));
        for (t, value) in points {
            x = (x.0.min(t), x.1.max(t));
            y = (y.0.min(value), y.1.max(value));
        }
        // Less than a pixel to the other side of zero, as rounding makes it, takes no room.
        let seen = |own: f64, other: f64| if own.abs() < 1e-3 * other.abs() { 0.0 } else { own };
        let y = (seen(y.0, y.1), seen(y.1, y.0));
        // Some room above the highest peak and below the lowest.
        let (x, y) = (Axis::spanning(x.0, x.1), Axis::spanning(1.02 * y.0, 1.02 * y.1));
        let widest = y
            .ticks()
            .iter()
            .map(|(_, label)| canvas.text_width(label, LETTERS))
            .fold(canvas.text_width(CONTACT_LABEL, LETTERS), f64::max);
        let foot = HEIGHT - MARGIN - 2.0 * LINE - 14.0;
        Plot {
            x,
            y,
            left: MARGIN + LINE + widest + 18.0,
            right: WIDTH - 1.6 * MARGIN,
            top,
            bottom: foot - self.pitch() * self.runs.len() as f64 - CONTACTS_GAP,
            foot,
        }
    }

    /// Height of one run's row of contacts.
    fn pitch(&self) -> f64 {
        let count = self.runs.len() as f64;
        (16.0 * count).clamp(CONTACTS.0, CONTACTS.1) / count
    }

    /// Draws the title, where there is one, and returns where it ends.
    fn draw_title<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> std::result::Result<f64, String> {
        if self.title.is_empty() {
            return Ok(MARGIN);
        }
        let fits = |title: &str| canvas.text_width(title, LETTERS) <= WIDTH - 2.0 * MARGIN;
        let at = (0.5 * WIDTH, MARGIN + 0.5 * LINE);
        canvas.text(&shortened(&self.title, fits), at, LETTERS, Anchor::Centre)?;
        Ok(MARGIN + LINE + 10.0)
    }

    /// Draws the legend from `top` on, and returns where it ends.
    fn draw_legend<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, top: f64) -> std::result::Result<f64, String> {
        let count = self.curves().count();
        let width = WIDTH - 2.0 * MARGIN;
        let beside = LEGEND_STROKE + 46.0;
        let widest =
            self.curves().map(|curve| canvas.text_width(&curve.label, LEGEND_LETTERS) + beside).fold(0.0, f64::max);
        let fitting = ((width / widest) as usize).clamp(1, LEGEND_COLUMNS);
        let needed = if count > LEGEND_LONG_LINES { 2.max(count.div_ceil(LEGEND_LINES)) } else { 1 };
        let columns = fitting.max(needed).min(count);
        let lines = count.div_ceil(columns);
        let column = (width / columns as f64).min(widest);
        for (n, curve) in self.curves().enumerate() {
            let x = MARGIN + 10.0 + (n / lines) as f64 * column;
            let y = top + ((n % lines) as f64 + 0.5) * LEGEND_LINE;
            let ends = [canvas.point(x, y), canvas.point(x + LEGEND_STROKE, y)];
            canvas.line(&ends, &stroke(n, count))?;
            let fits = |label: &str| canvas.text_width(label, LEGEND_LETTERS) <= column - beside + 1.0;
            let label = shortened(&curve.label, fits);
            let at = (x + LEGEND_STROKE + 16.0, y);
            canvas.text(&label, at, LEGEND_LETTERS, Anchor::Left)?;
        }
        Ok(top + lines as f64 * LEGEND_LINE + 26.0)
    }

    /// Draws a row of bars a run between the plot and its time axis' labels.
    fn draw_contacts<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, plot: &Plot) -> Drawn {
        let pitch = self.pitch();
        let top = plot.bottom + CONTACTS_GAP;
        let middle = 0.5 * (top + plot.foot) - 2.0;
        let at = (plot.left - 14.0, middle);
        canvas.text(CONTACT_LABEL, at, LETTERS, Anchor::Right)?;
        let (mut curves, all) = (0, self.curves().count());
        for (n, run) in self.runs.iter().enumerate() {
            // Of a single run's components none is the one that touches.
            let is_of_all = self.runs.len() == 1 && all > 1;
            let colour = if is_of_all { FRAME.colour } else { stroke(curves, all).colour };
            curves += run.curves.len();
            let y = top + (n as f64 + 0.5) * pitch - 3.0;
            let half = (0.36 * pitch).min(6.0);
            for &(start, end) in &run.contacts {
                if !(start.is_finite() && end.is_finite()) {
                    continue;
                }
                let from = plot.at_x(1e3 * start).max(plot.left);
                // Never so thin that it cannot be seen.
                let to = plot.at_x(1e3 * end).min(plot.right).max(from + 2.0);
                canvas.rectangle((from, y - half), (to, y + half), colour)?;
            }
        }
        Ok(())
    }
}

const CONTACT_LABEL: &str = "contact";

impl History {
    /// Grid, frame, ticks and titles of both axes.
    fn draw_axes<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, plot: &Plot) -> Drawn {
        let line = |from: (f64, f64), to: (f64, f64), stroke| {
            canvas.line(&[canvas.point(from.0, from.1), canvas.point(to.0, to.1)], stroke)
        };
        for (x, label) in plot.x.ticks() {
            let x = plot.at_x(x);
            line((x, plot.top), (x, plot.foot), &GRID)?;
            line((x, plot.foot), (x, plot.foot + 8.0), &FRAME)?;
            canvas.text(&label, (x, plot.foot + 30.0), LETTERS, Anchor::Centre)?;
        }
        for (y, label) in plot.y.ticks() {
            let y = plot.at_y(y);
            line((plot.left, y), (plot.right, y), &GRID)?;
            line((plot.left - 8.0, y), (plot.left, y), &FRAME)?;
            canvas.text(&label, (plot.left - 14.0, y), LETTERS, Anchor::Right)?;
        }
        line((plot.left, plot.top), (plot.left, plot.foot), &FRAME)?;
        line((plot.left, plot.bottom), (plot.right, plot.bottom), &FRAME)?;
        line((plot.left, plot.foot), (plot.right, plot.foot), &FRAME)?;
        let title = format!("time ({})", plot.x.unit("ms"));
        let middle = 0.5 * (plot.left + plot.right);
        let at = (middle, HEIGHT - MARGIN - 14.0);
        canvas.text(&title, at, LETTERS, Anchor::Centre)?;
        let title = match plot.y.unit(&self.unit).trim() {
            "" => self.quantity.clone(),
            unit => format!("{} ({unit})", self.quantity),
        };
        let at = (MARGIN + 12.0, 0.5 * (plot.top + plot.foot));
        canvas.text(&title, at, LETTERS, Anchor::Upwards)
    }
}

impl Run {
    /// Time in ms and value of a curve, where both are finite.
    fn points(&self, curve: &Curve) -> impl Iterator<Item = (f64, f64)> {
        let points = self.time.iter().zip(&curve.values).map(|(t, value)| (1e3 * t, *value));
        points.filter(|(t, value)| t.is_finite() && value.is_finite())
    }
}

/// The label if it fits, else its beginning and its end, in which titles of one study differ, around an ellipsis.
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
