//! Work against precision: the time of each method's settings, and what they are off by.

use super::canvas::{Anchor, Canvas, Drawing, Drawn, HEIGHT, WIDTH};
use super::frame::{Frame, LETTERS, SMALL, line};
use super::output::save;
use super::scale::Scale;
use super::stroke::{COLOURS, LOOKS, Stroke, stroke};
use crate::error::{Error, Result};
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use std::path::Path;

/// A chart of three panels: errors of the acceleration in the first contact and over all, and of the largest tension. The third is left out
/// where no tension is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    /// Above all.
    pub title: String,
    /// The methods.
    pub methods: Vec<Method>,
    /// In each panel, the error below which nothing is known.
    pub floor: [f64; PANELS],
}

/// A line of the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// What the legend calls it.
    pub label: String,
    /// Whether it is another program's: its marks are squares, and it does not count for the front.
    pub is_foreign: bool,
    /// Its settings, from coarse to fine.
    pub settings: Vec<Setting>,
}

/// A mark of the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Wall time, s.
    pub seconds: f64,
    /// The error in each panel; NaN where it is not known.
    pub errors: [f64; PANELS],
    /// What is written beside it, with a ring around it.
    pub mark: Option<String>,
}

/// Draws to `out`, an SVG or a PNG of 1600 × 1000 pixels by its extension.
///
/// # Errors
/// [`Error::Usage`] for another extension, no setting, or more methods than can be told apart; [`Error::Io`] when the file cannot be
/// written.
pub fn draw(chart: &Precision, out: &Path) -> Result<()> {
    let count = chart.methods.len();
    if count > LOOKS || chart.settings().next().is_none() {
        return Err(Error::Usage(format!("a chart shows 1 to {LOOKS} methods, not {count}")));
    }
    save(chart, out)
}

const TITLE: f64 = 34.0;
const TOP: f64 = 106.0;
const BOTTOM: f64 = 730.0;
const LEFT: f64 = 148.0;
const RIGHT: f64 = WIDTH - 30.0;
/// Between the panels, with the labels of the second one.
const GAP: f64 = 112.0;
/// The same between three.
const NARROW_GAP: f64 = 88.0;
const LEGEND: f64 = 836.0;
const LEGEND_COLUMNS: usize = 4;
const LEGEND_LETTERS: f64 = 21.0;
const LEGEND_STROKE: f64 = 46.0;
/// Errors above this are all the same failure.
const WORST: f64 = 3.0;
/// Panels at most.
const PANELS: usize = 3;
const TITLES: [&str; PANELS] =
    ["acceleration, first contact", "acceleration, whole history", "largest tension, first contact"];

const FRONT: Stroke = Stroke { colour: RGBColor(255, 221, 130), width: 13.0, dashes: &[] };
const UNKNOWN: RGBColor = RGBColor(238, 238, 238);
const INK: RGBColor = RGBColor(30, 30, 30);
const PAPER: RGBColor = RGBColor(255, 255, 255);

impl Precision {
    fn settings(&self) -> impl Iterator<Item = &Setting> {
        self.methods.iter().flat_map(|method| &method.settings)
    }

    /// How many panels there are.
    fn panels(&self) -> usize {
        if self.settings().any(|setting| setting.errors[PANELS - 1].is_finite()) { PANELS } else { PANELS - 1 }
    }

    /// Powers of ten around the times, and around the errors of all panels.
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

    /// The marks that no other one beats in a panel, by ascending time.
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
        // Where it is on the sheet: marks beyond the scale are at its edge.
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
            // Between two of its marks, what is left is the earlier one's error.
            let corner = (pair[1].0, pair[0].1);
            line(canvas, pair[0], corner, &FRONT)?;
            line(canvas, corner, pair[1], &FRONT)?;
        }
        for (n, method) in self.methods.iter().enumerate() {
            let look = stroke(n, self.methods.len());
            let known: Vec<&Setting> =
                method.settings.iter().filter(|setting| setting.errors[panel].is_finite()).collect();
            let pixels: Vec<(f64, f64)> = known.iter().map(|s| at(s.seconds, s.errors[panel])).collect();
            let points: Vec<_> = pixels.iter().map(|(x, y)| canvas.point(*x, *y)).collect();
            canvas.line(&points, &Stroke { width: 0.7 * look.width, ..look })?;
            pixels.iter().try_for_each(|pixel| draw_mark(canvas, *pixel, (method.is_foreign, n), look.colour))?;
        }
        // Above all lines.
        let mut marks: Vec<(f64, f64)> = self
            .settings()
            .filter(|setting| setting.errors[panel].is_finite())
            .map(|setting| at(setting.seconds, setting.errors[panel]))
            .collect();
        for (n, method) in self.methods.iter().enumerate() {
            let colour = stroke(n, self.methods.len()).colour;
            for setting in method.settings.iter().filter(|setting| setting.errors[panel].is_finite()) {
                let Some(mark) = &setting.mark else { continue };
                let (x, y) = at(setting.seconds, setting.errors[panel]);
                canvas.dot((x, y), 14.0, INK)?;
                canvas.dot((x, y), 11.0, PAPER)?;
                canvas.dot((x, y), 7.0, colour)?;
                let width = canvas.text_width(mark, LEGEND_LETTERS);
                let place = label_place((x, y), width, frame, &marks);
                canvas.text(mark, place, LEGEND_LETTERS, Anchor::Left)?;
                // Other labels avoid this one as they avoid marks.
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

/// Where the label of a mark begins (the middle of its left edge): about the mark, within the frame, as near as it covers no other mark, or
/// the fewest.
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
    // A mark's own radius besides.
    let is_covered = |(x, y): (f64, f64), other: (f64, f64)| {
        (x - 8.0..x + width + 8.0).contains(&other.0) && (other.1 - y).abs() < half + 8.0
    };
    let covered = |place: &(f64, f64)| marks.iter().filter(|other| is_covered(*place, **other)).count();
    let best = places.iter().copied().filter(|place| is_within(*place)).min_by_key(covered);
    // (A panel holds a label on one side at least.)
    best.unwrap_or(places[0])
}

/// That of a method, by its number: hollow where its colour is another's already, since a lone mark has no line to tell it by.
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

    /// A mark at the right edge of both panels: its label is drawn left of it.
    #[test]
    fn a_label_at_the_edge_is_drawn_within_its_panel() {
        let setting =
            |seconds, error| Setting { seconds, errors: [error, error, f64::NAN], mark: Some(format!("{seconds}")) };
        let settings = vec![setting(0.101, 0.5), setting(9.9, 0.02)];
        let methods = vec![Method { label: "auto".into(), is_foreign: false, settings }];
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("chart.svg");
        draw(&Precision { title: "plate".into(), methods, floor: [f64::NAN; PANELS] }, &out).unwrap();
        let svg = std::fs::read_to_string(&out).unwrap();
        // The labels' left edges, in pixels: the SVG is drawn five times as large.
        let left = svg
            .split("<text x=\"")
            .skip(1)
            .filter(|text| text.contains("\n9.9\n"))
            .map(|text| text.split('"').next().unwrap().parse::<f64>().unwrap() / 5.0);
        let width = 0.5 * (RIGHT - LEFT - GAP);
        // Three letters are about 1.6 as wide as they are high.
        let ends: Vec<f64> = left.map(|left| left + 1.6 * LEGEND_LETTERS).collect();
        assert!(ends.len() == 2 && ends[0] < LEFT + width && ends[1] < RIGHT, "{ends:?}");
    }

    /// Marks at all corners and edges: no label crosses the frame, and none covers another mark that it can avoid.
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
        // Marks at all four near places: farther away there is room.
        let marks = [(430.0, 380.0), (430.0, 420.0), (370.0, 380.0), (370.0, 420.0), (400.0, 372.0), (400.0, 428.0)];
        let (left, middle) = label_place((400.0, 400.0), width, &frame, &marks);
        let is_covered = |(x, y): &(f64, f64)| (left..left + width).contains(x) && (middle - y).abs() < 10.5;
        assert!(!marks.iter().any(is_covered), "{left} {middle}");
    }
}
