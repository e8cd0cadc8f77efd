//! Clamped edges of a plate of one layer, which prevent the strain of the thickness and the warping of the sections.

use super::layers::Layers;
use super::{Points, layers::profile::rotation};
use crate::description::{Clamp, Description, Extent, Spring};
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

/// Corrections of twice the elastic energy along clamped edges, and along edges on springs as far as these are stiffer than
/// the sections of the plate. Without shear, and with several layers, there are none.
pub(super) fn forms(points: &Points, description: &Description) -> Vec<Square<2>> {
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
            let is_here = |surface: &str| Face::of_surface(surface, &geometry.mirrors()).any(|other| other == face);
            let is_clamp = |clamp: &Clamp| {
                is_here(&clamp.surface) && clamp.components[across] && clamp.components[geometry.normal]
            };
            let of_spring = |Spring { region, stiffness, .. }: &Spring| {
                let is_whole = region.iter().any(|place| place.extent == Extent::All && is_here(&place.surface));
                let relative = stiffness[across].min(stiffness[geometry.normal]) * section.thickness / section.young;
                if is_whole { relative / (1.0 + relative) } else { 0.0 }
            };
            let is_clamped = description.clamps.iter().any(is_clamp);
            let held = match is_clamped {
                true => 1.0,
                false => description.springs.iter().map(of_spring).fold(0.0, f64::max),
            };
            if is_symmetry_plane || held == 0.0 {
                continue;
            }
            let (mut place, mut along) = (AREA, [0, 0]);
            (place[side], along[side]) = (Along::Within(strip), 1);
            let rigidity = held * bending(section.poisson) * section.rigidity() / STRIP;
            let shear = held * SHEAR * strain.factor * section.shear() / section.thickness / STRIP;
            forms.push(Square::of_sum(rigidity, &[rotation(0, side, along)], place));
            forms.push(Square { factor: shear, parts: profile.shear_strain(strain, side), place });
        }
    }
    forms
}
