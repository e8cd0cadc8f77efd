//! A sweep: curves over one key, a map over two.

mod curve;
mod field;

use super::output::save;
use super::scale::Scale;
use crate::error::Result;
use std::path::Path;

/// A key and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// What its axis is called.
    pub label: String,
    /// Its unit; empty for a number without one.
    pub unit: String,
    /// Whether its axis is logarithmic; then its values are positive.
    pub is_log: bool,
}

/// A sweep over one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Above all.
    pub title: String,
    /// What is varied.
    pub key: Key,
    /// The members that are done, at least one.
    pub members: Vec<Member>,
}

/// A member of a sweep over one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The key's value.
    pub value: f64,
    /// Peak acceleration, m/s².
    pub peak: f64,
    /// Start and end of each contact, s, and its peak force, N.
    pub contacts: Vec<(f64, f64, f64)>,
}

/// A sweep over two keys.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Above all.
    pub title: String,
    /// What is varied along the horizontal and the vertical axis.
    pub keys: [Key; 2],
    /// The keys' values and the peak acceleration, m/s², which is NaN for members without one; one member at least has one.
    pub members: Vec<([f64; 2], f64)>,
}

/// Draws the peak acceleration, and below it when the bodies touch, to `out`: an SVG or a PNG of 1600 × 1000 pixels by its
/// extension.
///
/// # Errors
/// [`Usage`](crate::Error::Usage) for another extension; [`Io`](crate::Error::Io) when the file cannot be written.
pub fn draw_curve(curve: &Curve, out: &Path) -> Result<()> {
    save(curve, out)
}

/// Draws the peak acceleration as a heat map, likewise.
///
/// # Errors
/// As of [`draw_curve`].
pub fn draw_field(field: &Field, out: &Path) -> Result<()> {
    save(field, out)
}

impl Key {
    /// The title of its axis.
    fn title(&self, scale: &Scale) -> String {
        match scale.unit(&self.unit).trim() {
            "" => self.label.clone(),
            unit => format!("{} ({unit})", self.label),
        }
    }
}

/// The values in ascending order, each once.
fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
