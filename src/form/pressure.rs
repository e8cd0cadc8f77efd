//! Quadrature of a pressure over a disc or a square, for the shape functions of one facet.

use std::f64::consts::{PI, SQRT_2};

use super::AreaShape;
use super::polygon::{Line, angles, crossing, edges, is_convex_counter_clockwise};
use crate::element::{Element, Inverse, Shape, adaptive};

/// Maximum number of nodes of a facet: the biquadratic quadrilateral has 9.
const NODES: usize = 9;

/// Largest difference between two quadrature rules on one piece of a facet. The total load is 1. The error of the finer
/// rule is far smaller than the difference.
const TOLERANCE: f64 = 1e-13;

/// Load vector of p(r) = 3/(2π R²) √(1 − r²/R²), r < R (Johnson, Contact Mechanics, 1985, 3.4), or of a constant pressure on a
/// disc or a square, on one facet. The total over the whole area is 1.
///
/// Polar coordinates about the disc's centre are used, with r = R sin φ: p r dr = 3/(2π) cos²φ sin φ dφ has no root at
/// the rim. A ray crosses a convex facet between two of its edges. The crossing is a smooth function of the ray's
/// angle, except where the ray passes a vertex or a point where an edge meets the rim. Between such angles the
/// quadrature is adaptive. So it is accurate for facets cut by the rim and for large and small facets.
pub struct PressureForms {
    element: Element,
    area: AreaShape,
}

impl PressureForms {
    /// Forms for a facet shape with elements of order 1 or 2, and the shape of the loaded area.
    pub fn new(shape: Shape, order: usize, area: AreaShape) -> Self {
        Self { element: Element::new(shape, order), area }
    }

    /// Computes ∫ p φ_i dA over the facet, one value per node.
    ///
    /// `x` are the vertices in the plane of the area, relative to its centre, in units of its radius or half its side,
    /// counter-clockwise. The load is zero on a facet that is turned away, seen on edge or folded.
    pub fn load(&self, x: &[[f64; 2]], out: &mut [f64]) {
        out.fill(0.);
        // The disc through the corners of a square contains it.
        let scale = if self.area == AreaShape::EvenSquare { SQRT_2 } else { 1.0 };
        let seen: Vec<[f64; 2]> = x.iter().map(|v| v.map(|v| v / scale)).collect();
        let mut lines: Vec<Line> = edges(&seen).filter_map(|(from, to)| Line::through(from, to)).collect();
        if self.area == AreaShape::EvenSquare {
            let side = |normal| Line { normal, offset: -1.0 / SQRT_2 };
            lines.extend([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(side));
        }
        if !is_convex_counter_clockwise(&seen) || lines.iter().any(|line| line.offset >= 1.) {
            return;
        }
        let inverse = Inverse::new(self.element.shape(), x);
        let mut along_ray = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let (enters, leaves) = crossing(&lines, [cos, sin]);
            if enters >= leaves {
                return [0.; NODES];
            }
            adaptive((enters.asin(), leaves.asin()), 1e-2 * TOLERANCE, &mut |phi: f64| {
                let r = phi.sin();
                let mut values = [0.; NODES];
                self.element
                    .values(inverse.at([scale * r * cos, scale * r * sin]), &mut values[..self.element.nodes()]);
                let weight = match self.area {
                    AreaShape::HertzDisc => 1.5 / PI * phi.cos().powi(2) * r,
                    AreaShape::EvenDisc => phi.cos() * r / PI,
                    AreaShape::EvenSquare => 0.5 * phi.cos() * r,
                };
                values.map(|value| weight * value)
            })
        };
        for arc in angles(&seen, &lines).windows(2) {
            let sum = adaptive((arc[0], arc[1]), TOLERANCE, &mut along_ray);
            for (out, sum) in out.iter_mut().zip(sum) {
                *out += sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [(Shape, usize); 4] =
        [(Shape::Triangle, 1), (Shape::Triangle, 2), (Shape::Quadrilateral, 1), (Shape::Quadrilateral, 2)];

    /// Load of a facet and its first and second moments, from the interpolants of 1, x, y, x², xy, y².
    fn moments(shape: Shape, order: usize, x: &[[f64; 2]]) -> [f64; 6] {
        let element = Element::new(shape, order);
        let mut load = vec![0.; element.nodes()];
        PressureForms::new(shape, order, AreaShape::HertzDisc).load(x, &mut load);
        let mut sum = [0.; 6];
        for (load, of) in load.iter().zip(element.node_vertices()) {
            let [x, y] = [0, 1].map(|axis| of.iter().map(|&v| x[v][axis]).sum::<f64>() / of.len() as f64);
            for (sum, field) in sum.iter_mut().zip([1., x, y, x * x, x * y, y * y]) {
                *sum += load * field;
            }
        }
        sum
    }

    fn assert_close(found: &[f64], expected: &[f64], name: &str) {
        // About ten pieces, with an error of at most 1e-13 each.
        let worst = found.iter().zip(expected).map(|(f, e)| (f - e).abs()).fold(0., f64::max);
        assert!(worst < 2e-13, "{name}: {found:?} instead of {expected:?}");
    }

    /// Total 1, ∫ p x = 0, ∫ p x² = 1/5, for any position and size of a facet that contains the disc.
    #[test]
    fn disc_within_a_facet() {
        for (shape, order) in SHAPES {
            for size in [3., 1e3, 1e6] {
                let all = [[-1., -1.2], [1.5, -1.], [1.4, 1.1], [-1.1, 0.9]].map(|v: [f64; 2]| v.map(|v| size * v));
                let x: &[[f64; 2]] = match shape {
                    Shape::Triangle => &[[-size, -size], [3. * size, -size], [-size, 3. * size]],
                    _ => &all,
                };
                let found = moments(shape, order, x);
                let rounding = 1e-16 * size * size;
                assert!((found[0] - 1.).abs() < 1e-13 && found[1].abs() < 1e-13 + rounding, "{shape:?} {found:?}");
                assert!(found[2].abs() < 1e-13 + rounding, "{shape:?} {found:?}");
                if order == 2 && shape == Shape::Triangle && size < 10. {
                    assert_close(&found, &[1., 0., 0., 0.2, 0., 0.2], "second moments");
                }
            }
        }
    }

    /// A half-plane whose edge is at the distance e from the centre contains the load 1/2 + 3/4 (e − e³/3), because the
    /// integral of the pressure along a line at the distance e is 3/4 (1 − e²). The first moment across the edge is
    /// −3/16 (1 − e²)².
    #[test]
    fn edge_at_any_distance() {
        for (shape, order) in SHAPES {
            for e in [0., 1e-16, 1e-12, 1e-9, 1e-7, 1e-6, 1e-4, 0.01, 0.3, 0.9, 0.999_999, 1., 1.5] {
                for e in [e, -e] {
                    for turn in [0., 0.1, 1., 2.5, 4., 5.5] {
                        // The half-plane x < e, rotated.
                        let (sin, cos) = f64::sin_cos(turn);
                        let corners: &[[f64; 2]] = match shape {
                            Shape::Triangle => &[[e, -6.], [e, 6.], [-9., 0.]],
                            _ => &[[e, -2.], [e, 2.], [-3., 4.], [-3., -5.]],
                        };
                        let x: Vec<[f64; 2]> =
                            corners.iter().map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect();
                        let [total, mx, my, ..] = moments(shape, order, &x);
                        let inside = e.clamp(-1., 1.);
                        let expected = 0.5 + 0.75 * (inside - inside.powi(3) / 3.);
                        let across = -3. / 16. * (1. - inside * inside).powi(2);
                        let found = [total, cos * mx + sin * my, cos * my - sin * mx];
                        assert_close(&found, &[expected, across, 0.], &format!("{shape:?} {order}, e = {e}, {turn}"));
                    }
                }
            }
        }
    }

    /// A right angle with its vertex at the centre contains a quarter of the load; ∫ p x = 3/32, ∫ p xy = 1/(10π).
    #[test]
    fn corner_at_the_centre() {
        for (shape, order) in SHAPES {
            let x: &[[f64; 2]] = match shape {
                Shape::Triangle => &[[0., 0.], [4., 0.], [0., 4.]],
                _ => &[[0., 0.], [4., 0.], [4., 4.], [0., 4.]],
            };
            let expected = [0.25, 3. / 32., 3. / 32., 0.05, 0.1 / PI, 0.05];
            let compared = if order == 2 { 6 } else { 3 };
            assert_close(&moments(shape, order, x)[..compared], &expected[..compared], &format!("{shape:?} {order}"));
        }
    }

    /// The loads of facets that cover the disc sum to 1. The disc covers a part of one facet up to many facets. Its
    /// centre is on a vertex, on an edge, very near to either, or elsewhere.
    #[test]
    fn facets_share_out_the_load() {
        for (shape, order) in SHAPES {
            for cell in [0.07, 0.3, 0.9, 7.] {
                for [dx, dy] in [[0., 0.], [0.4, 0.], [1e-12, 0.3], [1e-6, 1e-12], [0.37, 0.61], [0.5, 0.5 + 1e-9]] {
                    let n = (1.1 / cell) as i32 + 2;
                    let mut sum = [0.; 6];
                    let at = |i: i32, j: i32| {
                        let [x, y] = [f64::from(i) - dx, f64::from(j) - dy];
                        // Sheared; the maps are still affine.
                        [cell * (x + 0.2 * y), cell * (y - 0.1 * x)]
                    };
                    for (i, j) in (-n..=n).flat_map(|i| (-n..=n).map(move |j| (i, j))) {
                        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                        let facets: &[&[[f64; 2]]] = match shape {
                            Shape::Triangle => &[&[a, b, c], &[a, c, d]],
                            _ => &[&[a, b, c, d]],
                        };
                        for facet in facets {
                            for (sum, part) in sum.iter_mut().zip(moments(shape, order, facet)) {
                                *sum += part;
                            }
                        }
                    }
                    let compared = if order == 2 { 6 } else { 3 };
                    let worst = sum.iter().zip([1., 0., 0., 0.2, 0., 0.2]).take(compared);
                    let worst = worst.map(|(s, e)| (s - e).abs()).fold(0., f64::max);
                    // Rounding of some hundred facets; the moments scale with the size of the cells.
                    assert!(worst < 1e-13 * (1. + cell * cell), "{shape:?} {order}, {cell} {dx} {dy}: {sum:?}");
                }
            }
        }
    }

    #[test]
    fn facets_not_seen_whole_give_nothing() {
        for x in [
            // Turned away, on edge, folded.
            &[[-1., -1.], [-1., 1.], [1., 1.], [1., -1.]],
            &[[-1., 0.], [1., 0.], [1., 1e-17], [-1., 1e-17]],
            &[[-1., -1.], [1., -1.], [-0.5, -0.5], [-1., 1.]],
        ] {
            assert_eq!(moments(Shape::Quadrilateral, 1, x), [0.; 6]);
        }
    }
}
