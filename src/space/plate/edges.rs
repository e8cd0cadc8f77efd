//! Boundary layers of free edges in Mindlin's theory.

use super::Points;
use crate::description::Clamp;
use crate::form::plate::{AREA, EDGE_STRIP, mindlin_edge};
use crate::form::tensor::{Along, Square};
use crate::space::grid::Face;

/// Corrections of twice the elastic energy of Mindlin's theory along free edges.
///
/// If the rotation along an edge is clamped, there is no boundary layer. If the rotation across the edge is clamped
/// too, there is no twist, and the correction is zero anyway. An edge on springs has the boundary layer: the springs
/// are far softer than the sections of the plate, or, if they represent a clamp of part of a side, they constrain the
/// twist itself.
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
