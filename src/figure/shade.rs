//! Colours that represent numbers.

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
