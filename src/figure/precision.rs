//! Draws work-precision charts: wall time and error of the settings of several methods.

use super::canvas::{Anchor, Canvas, Drawing, Drawn, HEIGHT, WIDTH};
use super::frame::{Frame, INK, LETTERS, PAPER, SMALL, line};
use super::output::save;
use super::scale::Scale;
use super::stroke::{COLOURS, MAX_STROKES, Stroke, stroke};
use crate::error::{Error, Result};
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use std::path::Path;

/// A chart of three panels with the errors of the acceleration in the first contact, of the acceleration over the whole
/// history, and of the largest tension. The third panel is omitted if no error of the tension is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    /// Title above the panels.
    pub title: String,
    /// The methods, each drawn as a line.
    pub methods: Vec<Method>,
    /// Smallest error that the reference resolves, in each panel; the area below it is shaded. NaN if unknown.
    pub floor: [f64; PANELS],
}

/// A method, drawn as a line of the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Name in the legend.
    pub label: String,
    /// Whether the method belongs to another program. Its marks are squares, and it is not part of the Pareto front.
    pub is_foreign: bool,
    /// The settings of the method, from coarse to fine.
    pub settings: Vec<Setting>,
}

/// A setting of a method, drawn as a mark of the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Wall time, s.
    pub seconds: f64,
    /// The error in each panel, relative to the peak; NaN if unknown.
    pub errors: [f64; PANELS],
    /// Label of the mark, which is then also drawn with a ring; `None` for an ordinary mark.
    pub mark: Option<String>,
}

/// Draws to `out`, an SVG or a PNG of 1600 × 1000 pixels, depending on the extension.
///
/// # Errors
/// [`Error::Usage`] for another extension, without a setting, or for more methods than can be distinguished;
/// [`Error::Io`] if the file cannot be written.
pub fn draw(chart: &Precision, out: &Path) -> Result<()> {
    let count = chart.methods.len();
    if count > MAX_STROKES || chart.settings().next().is_none() {
        return Err(Error::Usage(format!("a chart shows 1 to {MAX_STROKES} methods, not {count}")));
    }
    save(chart, out)
}

const TITLE: f64 = 34.0;
const TOP: f64 = 106.0;
const BOTTOM: f64 = 730.0;
const LEFT: f64 = 148.0;
const RIGHT: f64 = WIDTH - 30.0;
/// Distance between two panels, which contains the labels of the right one.
const GAP: f64 = 112.0;
/// Distance between the panels if there are three.
const NARROW_GAP: f64 = 88.0;
const LEGEND: f64 = 836.0;
const LEGEND_COLUMNS: usize = 4;
const LEGEND_LETTERS: f64 = 21.0;
const LEGEND_STROKE: f64 = 46.0;
/// Larger errors are drawn at this value, because they all mean failure.
const WORST: f64 = 3.0;
/// Largest number of panels.
const PANELS: usize = 3;
const TITLES: [&str; PANELS] =
    ["acceleration, first contact", "acceleration, whole history", "largest tension, first contact"];

const FRONT: Stroke = Stroke { colour: RGBColor(255, 221, 130), width: 13.0, dashes: &[] };
const UNKNOWN: RGBColor = RGBColor(238, 238, 238);

impl Precision {
    fn settings(&self) -> impl Iterator<Item = &Setting> {
        self.methods.iter().flat_map(|method| &method.settings)
    }

    /// Number of panels to be drawn.
    fn panels(&self) -> usize {
        if self.settings().any(|setting| setting.errors[PANELS - 1].is_finite()) { PANELS } else { PANELS - 1 }
    }

    /// Powers of ten that enclose all times, and powers of ten that enclose the errors of all panels.
    fn scales(&self) -> [(f64, f64); 2] {
        let decades = |values: &mut dyn Iterator<Item = f64>| {
            let known = values.filter(|value| *value > 0.0 && value.is_finite());
            let (low, high) = known.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
            if low > high {
                return (1e-3, 1.0);
            }
            let whole = |value: f64, round: fn(f64) -> f64| 10f64.powf(round(value.log10()));
            let (low, high) = (whole(low, f64::floor), whole(high, f64::ceil));
            (low, if high > low { high } else { 10.0 * low })
        };
        let errors = &mut self.settings().flat_map(|setting| setting.errors).map(|error| error.min(WORST));
        [decades(&mut self.settings().map(|setting| setting.seconds)), decades(errors)]
    }

    /// The Pareto front of a panel: the marks of the program's methods for which no faster mark has a smaller error, by
    /// ascending time.
    fn front(&self, panel: usize) -> Vec<(f64, f64)> {
        let own = self.methods.iter().filter(|method| !method.is_foreign).flat_map(|method| &method.settings);
        let mut marks: Vec<(f64, f64)> =
            own.map(|setting| (setting.seconds, setting.errors[panel])).filter(|mark| mark.1.is_finite()).collect();
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut least = f64::INFINITY;
        marks.retain(|mark| {
            let is_better = mark.1 < least;
            least = least.min(mark.1);
            is_better
        });
        marks
    }
}

impl Drawing for Precision {
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let [times, errors] = self.scales();
        let count = self.panels();
        let gap = if count < PANELS { GAP } else { NARROW_GAP };
        let width = (RIGHT - LEFT - (count - 1) as f64 * gap) / count as f64;
        canvas.text(&self.title, (0.5 * WIDTH, TITLE), LETTERS, Anchor::Centre)?;
        for (panel, title) in TITLES[..count].iter().enumerate() {
            let left = LEFT + panel as f64 * (width + gap);
            let frame = Frame {
                left,
                right: left + width,
                top: TOP,
                bottom: BOTTOM,
                x: Scale::new(times.0, times.1, true),
                y: Scale::new(errors.0, errors.1, true),
            };
            canvas.text(title, (left + 0.5 * width, TOP - 26.0), SMALL, Anchor::Centre)?;
            self.draw_panel(canvas, &frame, panel)?;
            canvas.text("wall time (s)", (left + 0.5 * width, BOTTOM + 74.0), SMALL, Anchor::Centre)?;
        }
        let title = "error / peak value";
        canvas.text(title, (36.0, 0.5 * (TOP + BOTTOM)), SMALL, Anchor::Upwards)?;
        self.draw_legend(canvas)
    }
}

impl Precision {
    fn draw_panel<DB: DrawingBackend>(&self, canvas: &Canvas<DB>, frame: &Frame, panel: usize) -> Drawn {
        // Position of a mark in pixels; marks beyond the scale are drawn at its edge.
        let at = |seconds: f64, error: f64| {
            (frame.at_x(seconds), frame.at_y(error.min(WORST)).clamp(frame.top, frame.bottom))
        };
        let floor = self.floor[panel];
        if floor > 0.0 && frame.at_y(floor) < frame.bottom {
            canvas.rectangle((frame.left, frame.at_y(floor)), (frame.right, frame.bottom), UNKNOWN)?;
        }
        frame.draw_grid(canvas)?;
        let front: Vec<(f64, f64)> = self.front(panel).iter().map(|mark| at(mark.0, mark.1)).collect();
        for pair in front.windows(2) {
            // Between two marks of the front, the best error is the error of the earlier mark.
            let corner = (pair[1].0, pair[0].1);
            line(canvas, pair[0], corner, &FRONT)?;
            line(canvas, corner, pair[1], &FRONT)?;
        }
        let known = |setting: &&Setting| setting.errors[panel].is_finite();
        let methods = self.methods.iter().map(|method| {
            let settings = method.settings.iter().filter(known);
            settings.map(|setting| (setting, at(setting.seconds, setting.errors[panel]))).collect()
        });
        let settings: Vec<Vec<(&Setting, (f64, f64))>> = methods.collect();
        for (n, (method, settings)) in self.methods.iter().zip(&settings).enumerate() {
            let look = stroke(n, self.methods.len());
            let points: Vec<_> = settings.iter().map(|(_, (x, y))| canvas.point(*x, *y)).collect();
            canvas.line(&points, &Stroke { width: 0.7 * look.width, ..look })?;
            settings.iter().try_for_each(|(_, at)| draw_mark(canvas, *at, (method.is_foreign, n), look.colour))?;
        }
        // Ringed marks are drawn above all lines.
        let mut marks: Vec<(f64, f64)> = settings.iter().flatten().map(|(_, at)| *at).collect();
        for (n, settings) in settings.iter().enumerate() {
            let colour = stroke(n, self.methods.len()).colour;
            for (setting, (x, y)) in settings {
                let (Some(mark), at) = (&setting.mark, (*x, *y)) else { continue };
                canvas.dot(at, 14.0, INK)?;
                canvas.dot(at, 11.0, PAPER)?;
                canvas.dot(at, 7.0, colour)?;
                let width = canvas.text_width(mark, LEGEND_LETTERS);
                let place = label_place(at, width, frame, &marks);
                canvas.text(mark, place, LEGEND_LETTERS, Anchor::Left)?;
                // Later labels must also avoid this label, so it is added as marks.
                marks.extend([0.0, 0.5, 1.0].map(|part| (place.0 + part * width, place.1)));
            }
        }
        frame.draw_axes(canvas, true)?;
        Ok(())
    }

    fn draw_legend<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn {
        let count = self.methods.len() + 1;
        let rows = count.div_ceil(LEGEND_COLUMNS);
        let (width, height) =
            ((RIGHT - 60.0) / LEGEND_COLUMNS as f64, ((HEIGHT - LEGEND - 12.0) / rows as f64).min(32.0));
        let place = |n: usize| (60.0 + (n / rows) as f64 * width, LEGEND + (n % rows) as f64 * height);
        for (n, method) in self.methods.iter().enumerate() {
            let ((x, y), look) = (place(n), stroke(n, self.methods.len()));
            line(canvas, (x, y), (x + LEGEND_STROKE, y), &Stroke { width: 0.7 * look.width, ..look })?;
            draw_mark(canvas, (x + 0.5 * LEGEND_STROKE, y), (method.is_foreign, n), look.colour)?;
            canvas.text(&method.label, (x + LEGEND_STROKE + 12.0, y), LEGEND_LETTERS, Anchor::Left)?;
        }
        let (x, y) = place(self.methods.len());
        line(canvas, (x, y), (x + LEGEND_STROKE, y), &FRONT)?;
        canvas.text("the best of all", (x + LEGEND_STROKE + 12.0, y), LEGEND_LETTERS, Anchor::Left)
    }
}

/// Position of the label of a mark (middle of its left edge). Candidates lie around the mark and within the frame. The
/// result is the nearest one that covers no other mark, or else the one that covers the fewest.
fn label_place(mark: (f64, f64), width: f64, frame: &Frame, marks: &[(f64, f64)]) -> (f64, f64) {
    let half = 0.5 * LEGEND_LETTERS;
    let around = |farther: f64| {
        let (right, left, up) = (18.0 + farther, -18.0 - farther - width, 16.0 + farther);
        let middle = -0.5 * width;
        [(right, -up), (right, up), (left, -up), (left, up), (middle, -up - 12.0), (middle, up + 12.0)]
    };
    let places = [0.0, 16.0, 32.0, 48.0].into_iter().flat_map(around);
    let places: Vec<(f64, f64)> = places.map(|(dx, dy)| (mark.0 + dx, mark.1 + dy)).collect();
    let is_within = |(x, y): (f64, f64)| {
        x >= frame.left && x + width <= frame.right && y - half >= frame.top && y + half <= frame.bottom
    };
    // The added length is the radius of a mark.
    let is_covered = |(x, y): (f64, f64), other: (f64, f64)| {
        (x - 8.0..x + width + 8.0).contains(&other.0) && (other.1 - y).abs() < half + 8.0
    };
    let covered = |place: &(f64, f64)| marks.iter().filter(|other| is_covered(*place, **other)).count();
    let best = places.iter().copied().filter(|place| is_within(*place)).min_by_key(covered);
    // A label always fits on at least one side of a mark within a panel.
    best.unwrap_or(places[0])
}

/// Draws a mark of the method with number `n`. It is hollow if the colour is already used by another method, because a
/// single mark has no line that identifies it.
fn draw_mark<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    (x, y): (f64, f64),
    (is_foreign, n): (bool, usize),
    colour: RGBColor,
) -> Drawn {
    let parts = if n < COLOURS.len() { &[(7.0, colour)][..] } else { &[(7.0, colour), (3.5, PAPER)] };
    parts.iter().try_for_each(|&(half, colour)| match is_foreign {
        true => canvas.rectangle((x - half, y - half), (x + half, y + half), colour),
        false => canvas.dot((x, y), half, colour),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For marks at all corners and edges, no label crosses the frame or covers another mark if this can be avoided.
    #[test]
    fn labels_stay_within_the_frame() {
        let scale = || Scale::new(1.0, 10.0, true);
        let frame = Frame { left: 100.0, right: 700.0, top: 50.0, bottom: 650.0, x: scale(), y: scale() };
        let width = 50.0;
        for x in [100.0, 110.0, 400.0, 690.0, 700.0] {
            for y in [50.0, 60.0, 400.0, 640.0, 650.0] {
                let (left, middle) = label_place((x, y), width, &frame, &[(x, y)]);
                assert!(left >= frame.left && left + width <= frame.right, "{x} {y}: {left}");
                assert!(middle > frame.top + 10.0 && middle < frame.bottom - 10.0, "{x} {y}: {middle}");
            }
        }
        assert_eq!(label_place((400.0, 400.0), width, &frame, &[(430.0, 380.0)]), (418.0, 416.0));
        // All near positions are occupied by marks, but there is room farther away.
        let marks = [(430.0, 380.0), (430.0, 420.0), (370.0, 380.0), (370.0, 420.0), (400.0, 372.0), (400.0, 428.0)];
        let (left, middle) = label_place((400.0, 400.0), width, &frame, &marks);
        let is_covered = |(x, y): &(f64, f64)| (left..left + width).contains(x) && (middle - y).abs() < 10.5;
        assert!(!marks.iter().any(is_covered), "{left} {middle}");
    }
}
