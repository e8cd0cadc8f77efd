//! The boundary layers of free edges.

use super::Points;
use crate::description::Clamp;
use crate::form::plate::{AREA, EDGE_STRIP, mindlin_edge};
use crate::form::tensor::{Along, Square};
use crate::space::grid::Face;

/// Twice the elastic energy that Mindlin's theory lacks along free edges.
///
/// A clamp of the rotation along an edge leaves no boundary layer there; where it holds the rotation across the edge too, there is no
/// twist, and nothing to be left out. Springs have the layer: they are far softer than the plate's sections, or, as a clamp of a part
/// of a side, hold the twist itself.
pub(super) fn forms(points: &Points, shear_factor: f64, clamps: &[Clamp]) -> Vec<Square<2>> {
    let Points { geometry, section, .. } = points;
    let width = EDGE_STRIP * section.thickness;
    let mut forms = Vec::new();
    for (side, lines) in points.lines_in_plane().into_iter().enumerate() {
        let (start, end) = (lines[0], lines[lines.len() - 1]);
        let [across, along] = [geometry.axes[side], geometry.axes[1 - side]];
        for (is_upper, strip) in [(false, [start, start + width]), (true, [end - width, end])] {
            let face = Face { axis: across, is_upper };
            let is_symmetry_plane = geometry.halved[side] && !is_upper;
            let holds = |clamp: &Clamp| {
                let is_here = Face::of_surface(&clamp.surface, &[]).any(|other| other == face);
                is_here && clamp.components[along] && !clamp.components[across]
            };
            if !is_symmetry_plane && !clamps.iter().any(holds) {
                let mut place = AREA;
                place[side] = Along::Within(strip);
                forms.push(mindlin_edge(section, shear_factor, side, place));
            }
        }
    }
    forms
}
