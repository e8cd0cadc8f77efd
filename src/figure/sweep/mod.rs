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

/// A number of each member, and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// What its axis is called.
    pub label: String,
    /// Its unit; empty for a number without one.
    pub unit: String,
    /// What its values 0, 1, … are called; empty for numbers.
    pub names: Vec<String>,
}

/// A sweep over one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Above all.
    pub title: String,
    /// What is varied.
    pub key: Key,
    /// What is drawn over it.
    pub quantity: Quantity,
    /// The members that are done, at least one.
    pub members: Vec<Member>,
}

/// A member of a sweep over one key.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The key's value.
    pub value: f64,
    /// The quantity; NaN where the member has none.
    pub result: f64,
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
    /// What is drawn over them.
    pub quantity: Quantity,
    /// The keys' values and the quantity, which is NaN for members without one; one member at least has one.
    pub members: Vec<([f64; 2], f64)>,
}

/// Draws a quantity, and below it when the bodies touch, to `out`: an SVG or a PNG of 1600 × 1000 pixels by its
/// extension.
///
/// # Errors
/// [`Usage`](crate::Error::Usage) for another extension; [`Io`](crate::Error::Io) when the file cannot be written.
pub fn draw_curve(curve: &Curve, out: &Path) -> Result<()> {
    save(curve, out)
}

/// Draws a quantity as a heat map, likewise.
///
/// # Errors
/// As of [`draw_curve`].
pub fn draw_field(field: &Field, out: &Path) -> Result<()> {
    save(field, out)
}

impl Key {
    /// The title of its axis.
    fn title(&self, scale: &Scale) -> String {
        titled(&self.label, &scale.unit(&self.unit))
    }
}

impl Quantity {
    /// The title of its axis, whose labels are in this unit.
    fn title(&self, unit: &str) -> String {
        titled(&self.label, unit)
    }
}

fn titled(label: &str, unit: &str) -> String {
    match unit.trim() {
        "" => label.to_owned(),
        unit => format!("{label} ({unit})"),
    }
}

/// The values in ascending order, each once.
fn ascending(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
