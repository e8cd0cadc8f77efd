//! The canvas on which figures are drawn: an SVG or a bitmap.

use super::letters::{Letters, one_line};
use super::scale::Scale;
use super::stroke::{Point, Stroke, dashed};
use plotters::backend::DrawingBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Rectangle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, IntoTextStyle, RGBColor, WHITE};

/// Width, and below it the height, of a figure in a file, in its pixels.
pub(super) const WIDTH: f64 = 1600.0;
pub(super) const HEIGHT: f64 = 1000.0;

/// Texts are measured with DejaVu Sans. A viewer of the SVG replaces missing letters by letters of other installed
/// fonts.
const FONT: &str = "DejaVu Sans, Verdana, sans-serif";

/// Size of a figure, in its pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

/// Format of a canvas.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Vector graphics.
    Svg,
    /// Raster graphics.
    Bitmap,
}

/// Reference point of a text, which is placed at the given position.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    /// Middle of the left edge.
    Left,
    /// Centre of the text.
    Centre,
    /// Middle of the right edge.
    Right,
    /// Centre of the text, which is rotated to read upwards.
    Upwards,
}

/// A white sheet. All lengths are in pixels of the sheet.
pub(super) struct Canvas<'a, DB: DrawingBackend> {
    area: DrawingArea<DB, Shift>,
    /// Width, and below it the height, of the sheet, pixels.
    pub width: f64,
    pub height: f64,
    scale: f64,
    /// Distance from the middle of a text's box to the middle of its letters, in font sizes; it depends on plotters'
    /// backend.
    text_shift: f64,
    /// Whether lines are drawn segment by segment with round joints. The bitmap backend would draw spikes at acute
    /// angles of wide lines.
    by_pieces: bool,
    font: FontDesc<'a>,
    letters: Letters,
    /// Whether the viewer replaces letters missing in the font by letters of other fonts.
    has_other_fonts: bool,
}

/// A drawing that can be drawn on any canvas.
pub(super) trait Drawing {
    /// Draws it on `canvas`.
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Drawn;
}

/// Result of drawing; the error is the text of an error of plotters.
pub(super) type Drawn = std::result::Result<(), String>;

impl<DB: DrawingBackend> Canvas<'_, DB> {
    /// Makes a sheet; `scale` is the number of pixels of the backend per pixel of the sheet.
    pub fn new(backend: DB, (sheet, scale): (Sheet, u32), kind: Kind) -> std::result::Result<Self, String> {
        plotters::style::register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
            .map_err(|_| "the font cannot be read".to_owned())?;
        let area = backend.into_drawing_area();
        area.fill(&WHITE).map_err(|e| e.to_string())?;
        Ok(Self {
            area,
            width: f64::from(sheet.width),
            height: f64::from(sheet.height),
            scale: f64::from(scale),
            text_shift: match kind {
                Kind::Svg => 0.06,
                Kind::Bitmap => 0.19,
            },
            by_pieces: kind == Kind::Bitmap,
            font: FontDesc::new(FontFamily::Name(FONT), 1.0, FontStyle::Normal),
            letters: Letters::new()?,
            has_other_fonts: kind == Kind::Svg,
        })
    }

    /// Draws `drawing` on the canvas and completes the canvas.
    pub fn finish(self, drawing: &impl Drawing) -> Drawn {
        drawing.draw(&self)?;
        self.area.present().map_err(|e| e.to_string())
    }

    /// Converts a point of the sheet to the nearest pixel of the backend.
    pub fn point(&self, x: f64, y: f64) -> Point {
        let pixel = |v: f64| (v * self.scale).round() as i32;
        (pixel(x), pixel(y))
    }

    /// Draws a line through points made by [`Self::point`].
    pub fn line(&self, points: &[Point], stroke: &Stroke) -> Drawn {
        if stroke.dashes.is_empty() {
            return self.solid(points, stroke);
        }
        let width = stroke.width * self.scale;
        let lengths: Vec<f64> = stroke.dashes.iter().map(|d| d * width).collect();
        dashed(points, &lengths).iter().try_for_each(|piece| self.solid(piece, stroke))
    }

    fn solid(&self, points: &[Point], stroke: &Stroke) -> Drawn {
        let width = (stroke.width * self.scale).round().max(1.0) as u32;
        let style = stroke.colour.stroke_width(width);
        let draw = |points: &[Point]| self.area.draw(&PathElement::new(points, style)).map_err(|e| e.to_string());
        if !self.by_pieces {
            return draw(points);
        }
        for pair in points.windows(2) {
            draw(pair)?;
        }
        let inner = points.get(1..points.len().saturating_sub(1));
        for &joint in inner.unwrap_or_default() {
            let dot = Circle::new(joint, width / 2, stroke.colour.filled());
            self.area.draw(&dot).map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    /// Draws a filled rectangle between two corners.
    pub fn rectangle(&self, from: (f64, f64), to: (f64, f64), colour: RGBColor) -> Drawn {
        let corners = [self.point(from.0, from.1), self.point(to.0, to.1)];
        self.area.draw(&Rectangle::new(corners, colour.filled())).map_err(|e| e.to_string())
    }

    /// Draws a filled circle.
    pub fn dot(&self, middle: (f64, f64), radius: f64, colour: RGBColor) -> Drawn {
        let radius = (radius * self.scale).round() as i32;
        let circle = Circle::new(self.point(middle.0, middle.1), radius, colour.filled());
        self.area.draw(&circle).map_err(|e| e.to_string())
    }

    /// Draws one line of text with letters of `size` pixels.
    pub fn text(&self, text: &str, at: (f64, f64), size: f64, anchor: Anchor) -> Drawn {
        let shift = self.text_shift * size;
        let (at, transform, side) = match anchor {
            Anchor::Left => ((at.0, at.1 + shift), FontTransform::None, HPos::Left),
            Anchor::Centre => ((at.0, at.1 + shift), FontTransform::None, HPos::Center),
            Anchor::Right => ((at.0, at.1 + shift), FontTransform::None, HPos::Right),
            Anchor::Upwards => ((at.0 + shift, at.1), FontTransform::Rotate270, HPos::Center),
        };
        let style = self
            .font
            .resize(size * self.scale)
            .transform(transform)
            .into_text_style(&self.area)
            .color(&RGBColor(30, 30, 30))
            .pos(Pos::new(side, VPos::Center));
        let text = if self.has_other_fonts { one_line(text) } else { self.letters.plain(text, '?') };
        self.area.draw_text(&text, &style, self.point(at.0, at.1)).map_err(|e| e.to_string())
    }

    /// Width of the widest label of an axis with letters of `size` pixels.
    pub fn widest(&self, scale: &Scale, size: f64) -> f64 {
        let ticks = scale.ticks();
        ticks.iter().flat_map(|tick| &tick.1).map(|label| self.text_width(label, size)).fold(0.0, f64::max)
    }

    /// Width of a text with letters of `size` pixels.
    pub fn text_width(&self, text: &str, size: f64) -> f64 {
        // A letter of another font is assumed to be as wide as the widest letter.
        let text = self.letters.plain(text, if self.has_other_fonts { 'W' } else { '?' });
        // Measured at a large size, because plotters returns whole pixels. Without a font no text is drawn, so its
        // width is 0.
        let large = self.font.resize(100.0).box_size(&text);
        large.map_or(0.0, |(width, _)| f64::from(width) * size / 100.0)
    }
}
