//! The cells of a plate: small where it is hit, growing to what carries the flexural waves of the contact.

use std::f64::consts::TAU;

use crate::contact::zener;
use crate::form::plate::Section;
use crate::material::Material;
use crate::scene::{Geometry, Impactor, Scene};

use super::Settings;
use super::geometry::PlateGeometry;
use crate::space::grading::{Side, Sizes};

/// Cells over the distance from the hit, between those at the hit and the largest.
const GROWTH: f64 = 1.0;

/// Cells at the hit over the radius of the disc that is pressed.
const OF_DISC: f64 = 0.75;

/// The largest cell, in lengths of the flexural wave of the contact's frequency.
///
/// Splines carry waves down to two cells long. The force lacks the echoes of shorter ones: with largest cells of 0.20, 0.26 and 0.34 of the wave it was off
/// by 0.7%, 1.6% to 1.9% and 3% of its peak on a pane of 8 mm, and by 0.2%, 0.7% and 0.8% on a plate of 40 mm, with splines of degree 4 as
/// with those of degree 5, and with cells at the hit of 0.4 to 0.75 of the disc.
const OF_WAVE: f64 = 0.14;

/// The fewest cells along an edge.
const LEAST: f64 = 7.0;

/// The most cells along an edge: more are no small system.
const MOST: f64 = 100.0;

/// The lines of the grid along both axes of the modelled part, with small cells for the disc of a radius (m), or the point, that is hit, and
/// larger ones for waves of a length (m).
///
/// # Errors
/// How many cells there would be along an edge, where that is no number of cells of a small system.
pub(super) fn lines(
    geometry: &PlateGeometry,
    section: &Section,
    wave: f64,
    disc: Option<f64>,
    settings: &Settings,
) -> Result<[Vec<f64>; 2], f64> {
    let Settings { cell_size_factor, largest_cell_factor, .. } = *settings;
    let hit_in_part = geometry.hit_in_part();
    let along = |axis: usize| {
        let (edge, hit, [low, high]) = (geometry.edges[axis], hit_in_part[axis], geometry.ends(axis));
        let largest = cell_size_factor * (largest_cell_factor * OF_WAVE * wave).min(edge / LEAST);
        // A point's deflection is off by a part of F c²/D with its cells c: a small part of the waves' length will do.
        let at_hit = disc.map_or(section.thickness.max(largest / cell_size_factor / 8.0), |radius| OF_DISC * radius);
        // Splines that are smooth across the hit resolve it half as well as those that end there.
        let at_hit = cell_size_factor * if hit == low { at_hit } else { 0.5 * at_hit };
        let sizes = Sizes { hit: at_hit, largest, growth: cell_size_factor * GROWTH };
        let sides = [hit - low, high - hit].map(|length| Side { length, sizes });
        let cells = sides.iter().map(Side::cells).sum::<f64>();
        if !(largest > 0.0 && cells <= MOST) {
            return Err(cells);
        }
        let [below, above] = sides.map(|side| side.lines());
        let mut lines: Vec<f64> = below.iter().rev().map(|d| hit - d).chain([hit]).collect();
        lines.extend(above.iter().map(|d| hit + d));
        // The ends, without the rounding of a difference, and with what is left of an edge beside the hit.
        let last = lines.len() - 1;
        [lines[0], lines[last]] = [low, high];
        Ok(lines)
    };
    Ok([along(0)?, along(1)?])
}

/// How long a contact with a plate lasts, s: as long as on a half-space, or on a plate that yields less: there the force rises to
/// what the plate's impedance Z gives, k0 (v t)^{3/2} = Z v, within t.
pub(in crate::space) fn contact_time(section: &Section, impactor: &Impactor) -> f64 {
    let Impactor { stiffness, speed, .. } = *impactor;
    let impedance = zener::impedance(&section.material(), section.thickness);
    let rise = (impedance / stiffness).powf(2.0 / 3.0) / speed.cbrt();
    impactor.contact_time().min(6.0 * rise)
}

/// Length of the flexural wave of a period (s), m.
pub(in crate::space) fn wavelength(section: &Section, period: f64) -> f64 {
    let wavenumber = (section.density * section.thickness / section.rigidity()).sqrt() * TAU / period;
    TAU / wavenumber.sqrt()
}

/// The time in which a shear wave crosses the thickness of a box, all its layers with their moduli at t → 0, over that of a contact on a half-space; infinite for a mesh file.
pub fn crossing(scene: &Scene) -> f64 {
    let (body, impactor) = (&scene.body, &scene.impactor);
    let (Geometry::Box { size, .. }, Some(axis)) = (&body.geometry, scene.struck_axis()) else { return f64::INFINITY };
    let through = |(thickness, material): (f64, Material)| {
        let constants = material.instantaneous;
        let speed = (0.5 * constants.young / (1.0 + constants.poisson) / constants.density).sqrt();
        thickness / speed
    };
    let all: f64 = body.composition.across(axis, size[axis]).into_iter().map(through).sum();
    all / impactor.contact_time()
}
