//! Drawings as files and as parts of pages.
//!
//! plotters knows whole pixels only, so both kinds of files are drawn enlarged. An SVG is then shown smaller, which keeps fractions of
//! a pixel; a PNG is averaged down, which smooths its edges.

use super::canvas::{Canvas, Drawing, HEIGHT, Kind, Sheet, WIDTH};
use crate::error::{Error, Result};
use crate::record::folder::Folder;
use crate::record::target::resolved;
use image::codecs::png::PngEncoder;
use image::{ColorType, ImageEncoder};
use plotters::backend::{BitMapBackend, SVGBackend};
use std::path::Path;

const SVG_SCALE: u32 = 5;
/// Of a figure within a page, which is seldom shown larger than the page is wide.
const INLINE_SCALE: u32 = 2;
const PNG_SCALE: u32 = 3;

/// What figures in files of their own have.
const SHEET: Sheet = Sheet { width: WIDTH as u32, height: HEIGHT as u32 };

/// Draws to the file `out`, SVG or PNG by its extension.
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
    // Whole or not at all: a disk may be full.
    Folder::of(&file).put(name, |part| std::fs::write(part, &bytes).map_err(|e| Error::io(out, e)))
}

/// Draws to the text of an element `svg` for a page: it has the size that the page gives it, and `name` for readers who do not see it.
pub(super) fn inline(drawing: &impl Drawing, sheet: Sheet, name: &str) -> std::result::Result<String, String> {
    let svg = svg(drawing, sheet, INLINE_SCALE)?;
    let name = name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    Ok(svg
        .replacen(&size(sheet, INLINE_SCALE), &format!("role=\"img\" aria-label=\"{name}\""), 1)
        .trim_end()
        .to_owned())
}

/// An SVG of `scale` units a pixel.
fn svg(drawing: &impl Drawing, sheet: Sheet, scale: u32) -> std::result::Result<String, String> {
    let mut svg = String::new();
    let backend = SVGBackend::with_string(&mut svg, (sheet.width * scale, sheet.height * scale));
    Canvas::new(backend, (sheet, scale), Kind::Svg).and_then(|canvas| canvas.finish(drawing))?;
    Ok(svg)
}

/// The size of an SVG as plotters writes it.
fn size(Sheet { width, height }: Sheet, scale: u32) -> String {
    format!("width=\"{}\" height=\"{}\"", width * scale, height * scale)
}

/// The same shown in the sheet's pixels.
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

/// Each square of `scale` × `scale` RGB pixels as its mean.
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
