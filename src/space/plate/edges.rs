//! Clamped edges of a plate of one layer, which prevent the strain of the thickness and the warping of the sections.

use super::layers::Layers;
use super::{Points, layers::profile::rotation};
use crate::description::Clamp;
use crate::form::plate::AREA;
use crate::form::tensor::{Along, Square};
use crate::space::grid::Face;

/// Width of the strip over which the additional stiffness of a clamped edge is spread, divided by h: narrow, so that the
/// moment hardly changes within it.
const STRIP: f64 = 0.25;

/// Part of the shear stiffness that a clamped edge adds over the width h. In three-dimensional elasticity it is 0.0156 for
/// ν = 0 and 0.0133 for ν = 0.45.
const SHEAR: f64 = 0.0145;

/// Part of the flexural rigidity that a clamped edge adds over the width h. Under a bending moment M, an elastic strip that
/// is clamped at its end turns by C h M/D less than a beam. The formula is within 1.5% of C in plane strain for ν up to
/// 0.45. It is 0.0054 for ν = 0.23 (scripts/independent/clamped_strip.py computes both parts).
fn bending(poisson: f64) -> f64 {
    let across = poisson / (1.0 - poisson);
    across * across / (15.0 + 5.2 * across)
}

/// Corrections of twice the elastic energy along clamped edges. Without shear, and with several layers, there are none.
/// Edges on springs have none, so that the stiffness of the body is linear in that of its springs.
pub(super) fn forms(points: &Points, clamps: &[Clamp]) -> Vec<Square<2>> {
    let Points { geometry, section, layers, .. } = points;
    let Layers { theory, profile, .. } = layers;
    let [strain] = &theory.transverse().shear[..] else { return Vec::new() };
    if profile.is_thin() {
        return Vec::new();
    }
    let width = STRIP * section.thickness;
    let mut forms = Vec::new();
    for (side, lines) in points.lines_in_plane().into_iter().enumerate() {
        let (start, end) = (lines[0], lines[lines.len() - 1]);
        let across = geometry.axes[side];
        for (is_upper, strip) in [(false, [start, start + width]), (true, [end - width, end])] {
            let face = Face { axis: across, is_upper };
            let is_symmetry_plane = geometry.halved[side] && !is_upper;
            let holds = |clamp: &Clamp| {
                let is_here = Face::of_surface(&clamp.surface, &geometry.mirrors()).any(|other| other == face);
                is_here && clamp.components[across] && clamp.components[geometry.normal]
            };
            if is_symmetry_plane || !clamps.iter().any(holds) {
                continue;
            }
            let (mut place, mut along) = (AREA, [0, 0]);
            (place[side], along[side]) = (Along::Within(strip), 1);
            let rigidity = bending(section.poisson) * section.rigidity() / STRIP;
            let shear = SHEAR * strain.factor * section.shear() / section.thickness / STRIP;
            forms.push(Square::of_sum(rigidity, &[rotation(0, side, along)], place));
            forms.push(Square { factor: shear, parts: profile.shear_strain(strain, side), place });
        }
    }
    forms
}
