//! Draws the results of sweeps: a curve over one key, or a heat map over two keys.

mod curve;
mod field;

use super::canvas::HEIGHT;
use super::output::save;
use crate::error::Result;
use crate::record::episodes::Episode;
use std::path::Path;

/// Vertical positions of the title and of the edges of the figure, pixels.
const TITLE: f64 = 40.0;
const TOP: f64 = 78.0;
const BOTTOM: f64 = HEIGHT - 116.0;
/// Space to the left of the figure without its labels, and the position of the titles in it, pixels.
const LEFT: f64 = 94.0;
const MARGIN: f64 = 38.0;

/// A varied key and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Title of the axis.
    pub label: String,
    /// Unit; empty for a dimensionless number.
    pub unit: String,
    /// Whether the axis is logarithmic; the values must then be positive.
    pub is_log: bool,
}

/// A scalar result of each member, and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Title of the axis.
    pub label: String,
    /// Unit; empty for a dimensionless number.
    pub unit: String,
    /// Names of the values 0, 1, …; empty for numbers.
    pub names: Vec<String>,
}

/// A sweep over one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Title above the figure.
    pub title: String,
    /// The varied key.
    pub key: Key,
    /// The quantity on the vertical axis.
    pub quantity: Quantity,
    /// The members that are done, at least one.
    pub members: Vec<Member>,
}

/// A member of a sweep over one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Value of the key.
    pub value: f64,
    /// Value of the quantity; NaN if the member has none.
    pub result: f64,
    /// The contacts.
    pub contacts: Vec<Episode>,
}

/// A sweep over two keys.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Title above the figure.
    pub title: String,
    /// The varied keys, on the horizontal and on the vertical axis.
    pub keys: [Key; 2],
    /// The quantity shown by the colours.
    pub quantity: Quantity,
    /// Values of both keys, and value of the quantity (NaN if the member has none). At least one member has a value.
    pub members: Vec<([f64; 2], f64)>,
}

/// Draws a quantity, and below it the times of contact, to `out`: an SVG or a PNG of 1600 × 1000 pixels, depending on
/// the extension.
///
/// # Errors
/// [`Usage`](crate::Error::Usage) for another extension; [`Io`](crate::Error::Io) if the file cannot be written.
pub fn draw_curve(curve: &Curve, out: &Path) -> Result<()> {
    save(curve, out)
}

/// Draws a quantity as a heat map to `out`: an SVG or a PNG of 1600 × 1000 pixels, depending on the extension.
///
/// # Errors
/// Same as [`draw_curve`].
pub fn draw_field(field: &Field, out: &Path) -> Result<()> {
    save(field, out)
}

/// The different values in ascending order.
fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
