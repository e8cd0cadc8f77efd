//! Section of a report with the force and the deflection over time.

use crate::error::Result;

use super::data::Data;
use super::figures::Curves;
use super::number::{ACCELERATION, FORCE, LENGTH, MASS, computed, given};
use super::page::{Block, Section};

/// Makes the section.
///
/// # Errors
/// If a figure cannot be drawn.
pub fn section(data: &Data) -> Result<Section> {
    let mass = data.provenance.impactor_mass;
    let peak = data.extremes.as_ref().map_or(f64::NAN, |extremes| extremes.acceleration.value);
    let force = Curves {
        quantity: "contact force",
        units: FORCE,
        time: &data.force.time,
        curves: vec![(String::new(), &data.force.values)],
        limits: Vec::new(),
        caption: format!(
            "Contact force. Divided by the impactor’s mass of {} it is the impactor’s deceleration, with a peak of {}. Bars below the axis show the contacts.",
            given(mass, MASS),
            computed(peak, ACCELERATION)
        ),
    };
    let deflection = Curves {
        quantity: "deflection under the impactor",
        units: LENGTH,
        time: &data.deflection.time,
        curves: vec![(String::new(), &data.deflection.values)],
        limits: Vec::new(),
        caption: "Displacement of the surface under the impactor, along the direction of impact.".to_owned(),
    };
    let parts = vec![Block::Figure(force.draw(data)?), Block::Figure(deflection.draw(data)?)];
    Ok(Section { id: "history", title: "History of the impact", parts })
}
