//! The cells of a plate: small where it is hit, growing to what carries the flexural waves of the contact.

use std::f64::consts::TAU;

use crate::contact::{hertz, zener};
use crate::form::plate::Section;
use crate::scene::{Impactor, growing};

use super::frame::Frame;

/// Cell at the hit, in thicknesses.
const AT_HIT: f64 = 0.5;

/// Each cell over the one before.
const GROWTH: f64 = 1.6;

/// The largest cell, in lengths of the flexural wave of the contact's frequency.
const OF_WAVE: f64 = 0.15;

/// The fewest cells along an edge.
const LEAST: f64 = 6.0;

/// The most cells along an edge: more are no small system.
const MOST: f64 = 400.0;

/// The lines of the grid along both axes of the modelled part.
///
/// # Errors
/// How many cells there would be along an edge, if too many.
pub(super) fn lines(
    frame: &Frame,
    section: &Section,
    impactor: &Impactor,
    fineness: f64,
) -> Result<[Vec<f64>; 2], f64> {
    let wave = wavelength(section, impactor);
    let [x, y] = [0, 1].map(|axis| {
        let (edge, at) = (frame.edges[axis], frame.hit[axis]);
        let largest = fineness * (OF_WAVE * wave).min(edge / LEAST);
        let cells = edge / largest;
        if cells.is_nan() || cells > MOST {
            return Err(cells);
        }
        let smallest = AT_HIT * section.thickness * fineness;
        let mut lines = growing(edge, at, smallest, GROWTH.powf(fineness), largest);
        if frame.quarter {
            lines.retain(|x| *x >= 0.0);
        }
        Ok(lines)
    });
    Ok([x?, y?])
}

/// Length of the flexural wave with the contact's frequency, m. The contact lasts as long as on a half-space, or on a plate that
/// yields less: there the force rises to what the plate's impedance Z gives, k0 (v t)^{3/2} = Z v, within t.
fn wavelength(section: &Section, impactor: &Impactor) -> f64 {
    let Impactor { stiffness, mass, speed, .. } = *impactor;
    let impedance = zener::impedance((section.young, section.poisson), section.density, section.thickness);
    let rise = (impedance / stiffness).powf(2.0 / 3.0) / speed.cbrt();
    let time = hertz::contact_time(stiffness, mass, speed).min(6.0 * rise);
    let frequency = TAU / time;
    let wavenumber = (section.density * section.thickness / section.rigidity()).sqrt() * frequency;
    TAU / wavenumber.sqrt()
}
