//! A body's stresses near the hit, averaged over a disc.
//!
//! Cells that are fine enough for the force are coarse for the field of the pressure that presses them: at its centre plates and boxes
//! of splines are off by some per cent. Their means over a disc are not: such a mean is as good as the force, whose own reading is one.
//! The weight is that of a [`Spread`] point force, whose second and fourth moments are zero, so that waves pass it but for O((ξR)⁶).

use std::f64::consts::PI;

use crate::element::gauss_legendre;
use crate::form::Spread;
use crate::scene::Vec3;

use super::{Form, PointEvaluator};

/// Points of the quadrature along a radius, exact for the weight times polynomials of degree 28 in r, and about the centre: a multiple of
/// four, so that they mirror each other.
const ALONG: usize = 10;
const ABOUT: usize = 32;

/// Takes entries of the stresses' forms: component, unknown, value.
pub type Add<'a> = dyn FnMut(usize, usize, f64) + 'a;

/// The weighted mean of the stresses that the sections of a body carry, over a disc about a point along two axes. Points beyond planes of
/// symmetry, which are those across the axes `mirrors`, count by their images.
pub(super) fn smoothed(
    points: &dyn PointEvaluator,
    mirrors: &[usize],
    centre: Vec3,
    (axes, radius): ([usize; 2], f64),
) -> [Form; 6] {
    let spread = Spread::new(0.0);
    let is_corner = axes.iter().all(|axis| centre[*axis] == 0.0 && mirrors.contains(axis));
    let mut sums: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; points.unknowns()]);
    for (node, weight) in gauss_legendre(ALONG) {
        // ∫ p r dr dφ with s = r²/R² from 0 to 1.
        let square = 0.5 * (1.0 + node);
        let density = spread.over_hertz(square) * 1.5 / PI * (1.0 - square).sqrt();
        let of_point = 0.5 * weight * density * PI / ABOUT as f64;
        for turn in 0..ABOUT / if is_corner { 4 } else { 1 } {
            let angle = 2.0 * PI * (turn as f64 + 0.5) / ABOUT as f64;
            let mut x = centre;
            x[axes[0]] += radius * square.sqrt() * angle.cos();
            x[axes[1]] += radius * square.sqrt() * angle.sin();
            let mut signs = [1.0; 3];
            for &axis in mirrors {
                if x[axis] < 0.0 {
                    (x[axis], signs[axis]) = (-x[axis], -1.0);
                }
            }
            // xx, yy, zz, yz, xz, xy
            let turned = [1.0, 1.0, 1.0, signs[1] * signs[2], signs[0] * signs[2], signs[0] * signs[1]];
            // Of points in all quadrants shear stresses cancel.
            let (of_point, even) = if is_corner { (4.0 * of_point, 3) } else { (of_point, 6) };
            let mut add = |component: usize, unknown: usize, value: f64| {
                if component < even {
                    sums[component][unknown] += of_point * turned[component] * value;
                }
            };
            match even {
                3 => points.add_normal_section_stress(x, &mut add),
                _ => points.add_section_stress(x, &mut add),
            }
        }
    }
    sums.map(|sum| sum.into_iter().enumerate().filter(|(_, value)| *value != 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule's weights sum to one, and the moments of r² and r⁴ vanish, as those of a point force do.
    #[test]
    fn moments_of_the_weight() {
        let spread = Spread::new(0.0);
        let moment = |k: i32| -> f64 {
            let each = gauss_legendre(ALONG).into_iter().map(|(node, weight)| {
                let square = 0.5 * (1.0 + node);
                0.5 * weight * spread.over_hertz(square) * 1.5 * (1.0 - square).sqrt() * square.powi(k)
            });
            each.sum()
        };
        // The weight is (1 − s)² times a polynomial in s: Gauss's rule is exact but for rounding.
        assert!((moment(0) - 1.0).abs() < 1e-12, "{}", moment(0));
        assert!(moment(1).abs() < 1e-12 && moment(2).abs() < 1e-12, "{} {}", moment(1), moment(2));
    }
}
