//! Writes drawings to files and into pages.
//!
//! plotters only supports whole pixels, so figures are drawn enlarged. An SVG is then displayed at a reduced size,
//! which keeps fractions of a pixel. A PNG is averaged down, which smooths its edges.

use super::canvas::{Canvas, Drawing, HEIGHT, Kind, Sheet, WIDTH};
use crate::error::{Error, Result};
use crate::record::folder::Folder;
use crate::record::target::resolved;
use image::codecs::png::PngEncoder;
use image::{ColorType, ImageEncoder};
use plotters::backend::{BitMapBackend, SVGBackend};
use std::path::Path;

const SVG_SCALE: u32 = 5;
/// Enlargement of a figure within a page, which is seldom displayed wider than the page.
const INLINE_SCALE: u32 = 2;
const PNG_SCALE: u32 = 3;

/// Size of figures in files.
const SHEET: Sheet = Sheet { width: WIDTH as u32, height: HEIGHT as u32 };

/// Draws to the file `out`, SVG or PNG depending on its extension.
pub(super) fn save(drawing: &impl Drawing, out: &Path) -> Result<()> {
    let extension = out.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let bytes = match extension.to_ascii_lowercase().as_str() {
        "svg" => svg(drawing, SHEET, SVG_SCALE).map(|svg| sized(&svg, SHEET, SVG_SCALE).into_bytes()),
        "png" => png(drawing),
        _ => return Err(Error::Usage(format!("{}: a figure is an .svg or a .png file", out.display()))),
    };
    let bytes = bytes.map_err(|e| Error::io(out, e))?;
    let file = resolved(out);
    let name = file.file_name().unwrap_or_default();
    // The file appears complete or not at all, because the disk may be full.
    Folder::of(&file).put(name, |part| std::fs::write(part, &bytes).map_err(|e| Error::io(out, e)))
}

/// Draws to the text of an `svg` element for a page. The page sets its size. `name` is its description for screen
/// readers.
pub(super) fn inline(drawing: &impl Drawing, sheet: Sheet, name: &str) -> std::result::Result<String, String> {
    let svg = svg(drawing, sheet, INLINE_SCALE)?;
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    Ok(svg
        .replacen(&size(sheet, INLINE_SCALE), &format!("role=\"img\" aria-label=\"{name}\""), 1)
        .trim_end()
        .to_owned())
}

/// Draws an SVG with `scale` units per pixel of the sheet.
fn svg(drawing: &impl Drawing, sheet: Sheet, scale: u32) -> std::result::Result<String, String> {
    let mut svg = String::new();
    let backend = SVGBackend::with_string(&mut svg, (sheet.width * scale, sheet.height * scale));
    Canvas::new(backend, (sheet, scale), Kind::Svg).and_then(|canvas| canvas.finish(drawing))?;
    Ok(svg)
}

/// The attributes of an SVG's size, as plotters writes them.
fn size(Sheet { width, height }: Sheet, scale: u32) -> String {
    format!("width=\"{}\" height=\"{}\"", width * scale, height * scale)
}

/// Replaces the displayed size of an SVG by the size of the sheet.
fn sized(svg: &str, sheet: Sheet, scale: u32) -> String {
    svg.replacen(&size(sheet, scale), &size(sheet, 1), 1)
}

fn png(drawing: &impl Drawing) -> std::result::Result<Vec<u8>, String> {
    let large = (SHEET.width * PNG_SCALE, SHEET.height * PNG_SCALE);
    let mut pixels = vec![0; 3 * (large.0 * large.1) as usize];
    let backend = BitMapBackend::with_buffer(&mut pixels, large);
    Canvas::new(backend, (SHEET, PNG_SCALE), Kind::Bitmap).and_then(|canvas| canvas.finish(drawing))?;
    let averaged = averaged(&pixels, large.0 as usize, PNG_SCALE as usize);
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&averaged, SHEET.width, SHEET.height, ColorType::Rgb8)
        .map_err(|e| e.to_string())?;
    Ok(png)
}

/// Averages each square of `scale` × `scale` RGB pixels.
fn averaged(pixels: &[u8], width: usize, scale: usize) -> Vec<u8> {
    let rows = pixels.chunks_exact(3 * width);
    let mut small = Vec::with_capacity(pixels.len() / (scale * scale));
    let mut sums = vec![0_usize; 3 * width / scale];
    for (y, row) in rows.enumerate() {
        for (x, pixel) in row.chunks_exact(3).enumerate() {
            for (channel, value) in pixel.iter().enumerate() {
                sums[3 * (x / scale) + channel] += usize::from(*value);
            }
        }
        if y % scale == scale - 1 {
            small.extend(sums.iter().map(|sum| (sum / (scale * scale)) as u8));
            sums.fill(0);
        }
    }
    small
}
