//! Localisation vector of a plate: where and how it is loaded and its displacement evaluated.

use super::{Disc, Points};
use crate::form::Spread;
use crate::form::plate::deflection;
use crate::form::tensor::Derivative;

/// Localisation vector a of all symmetry classes: a point or the given area for Kirchhoff's theory, a disc or a wide
/// area for the others, with moments in addition to the deflection.
pub(super) fn localization(points: &Points) -> Vec<f64> {
    let Points { geometry, layers, .. } = points;
    let mut parts = layers.face_deflection();
    parts.push((1.0, deflection([0, 0])));
    match (layers.disc, &geometry.area) {
        (Some(Disc { spread, radius }), _) => on_disc(points, (&spread, radius), &parts),
        (None, Some(area)) => {
            let (spread, radius) = Spread::of_area(area, 0.0);
            on_disc(points, (&spread, radius), &parts)
        }
        (None, None) => {
            let mut a = vec![0.0; points.all_unknowns()];
            points.add_point(deflection([0, 0]), geometry.hit, 1.0, &mut a);
            a
        }
    }
}

/// Contribution of a pressure on a disc, or an area, of a radius (m) for derivatives of fields with their factors.
fn on_disc(points: &Points, (spread, radius): (&Spread, f64), parts: &[(f64, Derivative<2>)]) -> Vec<f64> {
    let geometry = &points.geometry;
    let mut a = vec![0.0; points.all_unknowns()];
    // For a quarter, only the quadrant of the disc in the modelled part is integrated and multiplied by the number of
    // quarters. Otherwise the whole disc is integrated.
    let multiplicity = if geometry.is_quarter { geometry.multiplicity() } else { 1.0 };
    let lines = points.lines_of_whole();
    for (x, line) in spread.strips(geometry.hit, radius, [0, 1].map(|i| &lines[geometry.axes[i]][..])) {
        for (factor, part) in parts {
            points.add_line((*part, multiplicity * factor), x, &line, &mut a);
        }
    }
    a
}
