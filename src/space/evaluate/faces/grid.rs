//! Points of a face of a box at the crossings of lines, and interpolation between them.

use crate::scene::Vec3;
use crate::scene::faces::along;

use super::FaceTension;

/// Lines of the points of a face.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceGrid {
    /// Axes along the face.
    pub axes: [usize; 2],
    /// Coordinates along these axes, ascending, m.
    pub lines: [Vec<f64>; 2],
    /// Axes along which the first line is a plane of symmetry.
    pub is_mirrored: [bool; 2],
}

impl FaceGrid {
    /// Grid of the faces of a box impacted along the axis `struck` at the point `hit`: the lines along the axes (m),
    /// and lines through the impact point.
    pub fn of_box((struck, hit): (usize, Vec3), lines: &[Vec<f64>; 3], mirrors: &[usize]) -> Self {
        let axes = along(struck);
        Self {
            axes,
            lines: axes.map(|axis| with_hit(&lines[axis], hit[axis])),
            is_mirrored: axes.map(|axis| mirrors.contains(&axis)),
        }
    }

    /// Points on the face at a coordinate along the normal axis, m.
    pub(super) fn points(&self, across: usize, height: f64) -> Vec<Vec3> {
        let at = |a: f64, b: f64| {
            let mut x = [0.0; 3];
            (x[self.axes[0]], x[self.axes[1]], x[across]) = (a, b, height);
            x
        };
        self.lines[0].iter().flat_map(|a| self.lines[1].iter().map(move |b| at(*a, *b))).collect()
    }

    /// Replaces the largest value by the maxima of parabolas through it and its neighbours along each axis.
    pub(super) fn refine(&self, best: usize, top: f64, value: impl Fn(usize) -> f64, found: &mut FaceTension) {
        let count = self.lines[1].len();
        let place = [best / count, best % count];
        for (side, stride) in [(0, count), (1, 1)] {
            let (lines, at) = (&self.lines[side], place[side]);
            if at + 1 >= lines.len() || (at == 0 && !self.is_mirrored[side]) {
                continue;
            }
            // A neighbour that is left out gives no parabola.
            let (after, ahead) = (value(best + stride), lines[at + 1] - lines[at]);
            let (before, behind) =
                if at == 0 { (after, ahead) } else { (value(best - stride), lines[at] - lines[at - 1]) };
            // f(top) + s x + c x²/2 through both neighbours.
            let (rise, fall) = ((after - top) / ahead, (before - top) / behind);
            let curvature = 2.0 * (rise + fall) / (ahead + behind);
            let slope = rise - 0.5 * curvature * ahead;
            if curvature < 0.0 {
                let way = (-slope / curvature).clamp(-0.5 * behind, 0.5 * ahead);
                found.largest += slope * way + 0.5 * curvature * way * way;
                found.point[self.axes[side]] += way;
            }
        }
    }
}

/// Lines including one through the impact point.
fn with_hit(lines: &[f64], hit: f64) -> Vec<f64> {
    let mut lines = lines.to_vec();
    let size = lines.last().copied().unwrap_or_default() - lines.first().copied().unwrap_or_default();
    let place = lines.partition_point(|x| *x < hit);
    let near = (0..lines.len()).find(|&i| (lines[i] - hit).abs() < 1e-6 * size);
    match near {
        // The exact coordinate, so that one point is at the impact point.
        Some(i) => lines[i] = hit,
        None if place > 0 && place < lines.len() => lines.insert(place, hit),
        None => {}
    }
    lines
}
