//! Stresses near the impact point, averaged over a disc.
//!
//! Cells that are fine enough for the force are coarse for the stresses under the applied pressure: at its centre,
//! plates and boxes of splines have errors of several per cent. The means over a disc do not: such a mean is as
//! accurate as the force, which is itself computed from a mean displacement. The weight is the density of a [`Spread`]
//! point force, whose second and fourth moments are zero. The mean of a wave is therefore exact up to O((ξR)⁶).

use std::f64::consts::PI;

use crate::element::gauss_legendre;
use crate::form::Spread;
use crate::scene::Vec3;

use super::{Form, PointEvaluator};

/// Number of Gauss points along a cell; stresses of splines are polynomials only within a cell. With four, the mean on
/// the coarsest plates of a tolerance of 1e-2 differs by 1e-4 from the limit. A rule in polar coordinates, which
/// ignores cells, needs two thousand points for that.
const ALONG: usize = 4;

/// Receives an entry of the forms of the stresses: component, unknown, value.
pub type Add<'a> = dyn FnMut(usize, usize, f64) + 'a;

/// Weighted mean of the section stresses over a disc about a point along two axes. Points beyond planes of symmetry,
/// which are normal to the axes `mirrors`, are evaluated at their mirror images.
pub(super) fn smoothed(
    points: &dyn PointEvaluator,
    mirrors: &[usize],
    centre: Vec3,
    (axes, radius): ([usize; 2], f64),
) -> [Form; 6] {
    let spread = Spread::new(0.0);
    let is_corner = axes.iter().all(|axis| centre[*axis] == 0.0 && mirrors.contains(axis));
    let cells = points.cell_lines();
    let [first, second] = axes.map(|axis| {
        let mut lines = cells[axis].clone();
        if mirrors.contains(&axis) {
            lines.extend(cells[axis].iter().map(|x| -x));
        }
        // At a corner of the modelled part, one quadrant represents all four.
        let from = if is_corner { 0.0 } else { centre[axis] - radius };
        rule_by_cells(&lines, (from, centre[axis] + radius))
    });
    let mut sums: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; points.unknowns()]);
    let at_distance = |square: f64| density(&spread, square) / (radius * radius);
    if is_corner {
        for (x, along_x) in &first {
            let of_place = |(y, along_y): &(f64, f64)| {
                let square = (x * x + y * y) / (radius * radius);
                (square < 1.0).then(|| (*y, 4.0 * along_x * along_y * at_distance(square)))
            };
            let line: Vec<(f64, f64)> = second.iter().filter_map(of_place).collect();
            let mut place = centre;
            place[axes[0]] = *x;
            // Shear stresses cancel over the four quadrants.
            points.add_normal_section_stress_along(place, axes[1], &line, &mut |component, unknown, value| {
                if component < 3 {
                    sums[component][unknown] += value;
                }
            });
        }
        return entries(sums);
    }
    for ((x, along_x), (y, along_y)) in first.iter().flat_map(|x| second.iter().map(move |y| (x, y))) {
        let square = ((x - centre[axes[0]]).powi(2) + (y - centre[axes[1]]).powi(2)) / (radius * radius);
        if square >= 1.0 {
            continue;
        }
        let of_point = along_x * along_y * at_distance(square);
        let mut place = centre;
        (place[axes[0]], place[axes[1]]) = (*x, *y);
        let mut signs = [1.0; 3];
        for &axis in mirrors {
            if place[axis] < 0.0 {
                (place[axis], signs[axis]) = (-place[axis], -1.0);
            }
        }
        // xx, yy, zz, yz, xz, xy
        let turned = [1.0, 1.0, 1.0, signs[1] * signs[2], signs[0] * signs[2], signs[0] * signs[1]];
        points.add_section_stress(place, &mut |component, unknown, value| {
            sums[component][unknown] += of_point * turned[component] * value;
        });
    }
    entries(sums)
}

/// Non-zero entries.
fn entries(sums: [Vec<f64>; 6]) -> [Form; 6] {
    sums.map(|sum| sum.into_iter().enumerate().filter(|(_, value)| *value != 0.0).collect())
}

/// Weight times R² at r²/R² < 1.
fn density(spread: &Spread, square: f64) -> f64 {
    spread.over_hertz(square) * 1.5 / PI * (1.0 - square).sqrt()
}

/// Points and weights between two ends (m), by Gauss's rule on each cell between lines, which may be in any order.
fn rule_by_cells(lines: &[f64], (from, to): (f64, f64)) -> Vec<(f64, f64)> {
    let mut ends: Vec<f64> = lines.iter().copied().filter(|x| from < *x && *x < to).collect();
    ends.extend([from, to]);
    ends.sort_by(f64::total_cmp);
    let rule = gauss_legendre(ALONG);
    let of_cell = |pair: &[f64]| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        rule.iter().map(move |(node, weight)| (middle + half * node, half * weight)).collect::<Vec<_>>()
    };
    // Repeated lines make cells of zero width.
    ends.windows(2).filter(|pair| pair[1] - pair[0] > 1e-9 * (to - from)).flat_map(of_cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weights sum to one, and the moments of r² and r⁴ vanish as for a point force, wherever the edge of the disc
    /// cuts the cells. The remaining error is due to the second derivative of the weight, which jumps at the edge.
    #[test]
    fn moments_of_the_weight() {
        let spread = Spread::new(0.0);
        let moment = |cells: f64, k: i32| -> f64 {
            let lines: Vec<f64> = (-8..=8).map(|i| f64::from(i) / cells).collect();
            let rule = rule_by_cells(&lines, (-1.0, 1.0));
            let each = rule.iter().flat_map(|(x, one)| rule.iter().map(move |(y, other)| (x * x + y * y, one * other)));
            each.filter(|(square, _)| *square < 1.0)
                .map(|(square, weight)| weight * density(&spread, square) * square.powi(k))
                .sum()
        };
        for cells in [2.7, 3.0, 3.4] {
            let all = [0, 1, 2].map(|k| moment(cells, k));
            assert!((all[0] - 1.0).abs() < 1e-3 && all[1].abs() < 1e-3 && all[2].abs() < 1e-3, "{cells}: {all:?}");
        }
    }
}
