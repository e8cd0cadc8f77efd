//! Quadrature over the portion of a facet within a convex extent of space.

use nalgebra::Vector3;

use crate::description::Extent;
use crate::element::{Element, Quadrature, Shape, Table, gauss_legendre};
use crate::form::polygon::{Line, angles, crossing, is_convex_counter_clockwise};
use crate::scene::Vec3;

/// Portion of a facet within an extent of space.
pub enum Clipped {
    /// The whole facet.
    Whole,
    /// No portion of the facet.
    Nothing,
    /// Quadrature points of a part of the facet.
    Points(Vec<AreaPoint>),
}

/// A quadrature point of an area.
pub struct AreaPoint {
    /// Position, m.
    pub position: Vec3,
    /// Area that the point represents, m².
    pub area: f64,
}

/// Distance from the boundary of an extent, divided by the size of the facet, below which a vertex counts as on it. It
/// is far above the rounding of a typed number.
const ROUNDING: f64 = 1e-9;

/// Number of Gauss points over the angle between two directions at which the ends of a ray change from one line to
/// another. The relative error of the integral is 1e-10.
const ANGLES: usize = 16;

/// Portion of a plane convex facet, with vertices in order, within an extent. The quadrature is exact for polynomials
/// of a degree in each coordinate, except along the rim of a ball.
pub fn clip(facet: &[Vec3], extent: &Extent, degree: usize) -> Clipped {
    // Shortcut for the usual case, in which the whole facet is inside.
    if *extent == Extent::All {
        return Clipped::Whole;
    }
    let x: Vec<Vector3<f64>> = facet.iter().copied().map(Vector3::from).collect();
    let size = (0..x.len()).map(|i| (x[i] - x[0]).norm()).fold(0.0, f64::max);
    match extent {
        Extent::All => Clipped::Whole,
        Extent::Box(corners) => clip_to_box(&x, *corners, ROUNDING * size, degree),
        Extent::Ball { centre, radius } => clip_to_ball(&x, Vector3::from(*centre), *radius, ROUNDING * size, degree),
    }
}

/// Clips a polygon by the planes of a box in turn (Sutherland–Hodgman algorithm).
fn clip_to_box(x: &[Vector3<f64>], corners: [Vec3; 2], rounding: f64, degree: usize) -> Clipped {
    let mut polygon = x.to_vec();
    let mut is_cut = false;
    for axis in 0..3 {
        for (bound, sign) in [(corners[0][axis], 1.0), (corners[1][axis], -1.0)] {
            let depth = |x: &Vector3<f64>| sign * (x[axis] - bound);
            if polygon.iter().all(|x| depth(x) >= -rounding) {
                continue;
            }
            is_cut = true;
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, from) in polygon.iter().enumerate() {
                let to = &polygon[(i + 1) % polygon.len()];
                let (before, after) = (depth(from), depth(to));
                if before >= 0.0 {
                    kept.push(*from);
                }
                if (before >= 0.0) != (after >= 0.0) {
                    kept.push(from + (to - from) * (before / (before - after)));
                }
            }
            polygon = kept;
        }
    }
    if !is_cut {
        return Clipped::Whole;
    }
    // Remove vertices that coincide with their neighbours.
    polygon.dedup_by(|one, other| (*one - *other).norm() <= rounding);
    while polygon.len() > 1 && (polygon[0] - polygon[polygon.len() - 1]).norm() <= rounding {
        polygon.pop();
    }
    if polygon.len() < 3 { Clipped::Nothing } else { Clipped::Points(over_polygon(&polygon, degree)) }
}

/// Uses a product rule if the polygon is a parallelogram, else triangles about its first vertex.
fn over_polygon(polygon: &[Vector3<f64>], degree: usize) -> Vec<AreaPoint> {
    let is_parallelogram = match polygon {
        [a, b, c, d] => (a + c - b - d).norm() < 1e-12 * (c - a).norm(),
        _ => false,
    };
    let over = |shape: Shape, degree: usize, x: &[Vec3]| -> Vec<AreaPoint> {
        let table = Table::new(&Element::new(shape, 1), &Quadrature::exact(shape, degree));
        let points = table.areas(x).enumerate();
        points.map(|(q, area)| AreaPoint { position: table.position(q, x), area }).collect()
    };
    let vertices: Vec<Vec3> = polygon.iter().map(|x| Vec3::from(*x)).collect();
    if is_parallelogram {
        return over(Shape::Quadrilateral, degree, &vertices);
    }
    let triangles = (2..vertices.len()).map(|i| [vertices[0], vertices[i - 1], vertices[i]]);
    // A polynomial of a degree in each coordinate has up to twice that total degree.
    triangles.flat_map(|triangle| over(Shape::Triangle, 2 * degree, &triangle)).collect()
}

/// Integrates, in polar coordinates, over the portion of a facet within the disc in which the plane of the facet cuts a
/// ball.
fn clip_to_ball(x: &[Vector3<f64>], centre: Vector3<f64>, radius: f64, rounding: f64, degree: usize) -> Clipped {
    if x.iter().all(|x| (x - centre).norm() <= radius + rounding) {
        return Clipped::Whole;
    }
    let normal = normal(x);
    let height = (x[0] - centre).dot(&normal);
    let square = radius * radius - height * height;
    if square <= rounding * rounding {
        return Clipped::Nothing;
    }
    let (origin, disc) = (centre + normal * height, square.sqrt());
    let first = (x[1] - x[0]).normalize();
    let axes = [first, normal.cross(&first)];
    let seen: Vec<[f64; 2]> = x.iter().map(|x| axes.each_ref().map(|axis| axis.dot(&(x - origin)) / disc)).collect();
    let edges = (0..seen.len()).filter_map(|i| Line::through(seen[i], seen[(i + 1) % seen.len()]));
    let lines: Vec<Line> = edges.collect();
    if !is_convex_counter_clockwise(&seen) || lines.iter().any(|line| line.offset >= 1.0) {
        return Clipped::Nothing;
    }
    let (of_angle, of_radius) = (gauss_legendre(ANGLES), gauss_legendre(degree + 2));
    let mut points = Vec::new();
    for arc in angles(&seen, &lines).windows(2) {
        for (t, weight) in &of_angle {
            let angle = 0.5 * (arc[0] + arc[1]) + 0.5 * (arc[1] - arc[0]) * t;
            let ray = [angle.cos(), angle.sin()];
            let (enters, leaves) = crossing(&lines, ray);
            if enters >= leaves {
                continue;
            }
            for (s, of_point) in &of_radius {
                let r = 0.5 * (enters + leaves) + 0.5 * (leaves - enters) * s;
                let area = 0.25 * weight * of_point * (arc[1] - arc[0]) * (leaves - enters) * r * disc * disc;
                let position = origin + (axes[0] * ray[0] + axes[1] * ray[1]) * (r * disc);
                points.push(AreaPoint { position: position.into(), area });
            }
        }
    }
    if points.is_empty() { Clipped::Nothing } else { Clipped::Points(points) }
}

/// Unit normal of a plane polygon. If the vertices are not in one plane, the normal of the plane that fits them.
pub fn normal(x: &[Vector3<f64>]) -> Vector3<f64> {
    let sum: Vector3<f64> = (0..x.len()).map(|i| x[i].cross(&x[(i + 1) % x.len()])).sum();
    sum.normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const SQUARE: [Vec3; 4] = [[0.0, 0.0, 0.3], [2.0, 0.0, 0.3], [2.0, 2.0, 0.3], [0.0, 2.0, 0.3]];
    const TRIANGLE: [Vec3; 3] = [[0.0, 0.0, 0.3], [2.0, 0.0, 0.3], [0.0, 2.0, 0.3]];

    fn integral(facet: &[Vec3], extent: &Extent, f: impl Fn(Vec3) -> f64) -> f64 {
        match clip(facet, extent, 4) {
            Clipped::Whole => f64::INFINITY,
            Clipped::Nothing => 0.0,
            Clipped::Points(points) => points.iter().map(|point| point.area * f(point.position)).sum(),
        }
    }

    /// Integrates x⁴ y³ over rectangles cut from a square, and a polynomial over the part of a triangle within a box.
    #[test]
    fn boxes_cut_exactly() {
        let (low, high) = ([0.5, -1.0, -1.0], [1.25, 0.75, 1.0]);
        let exact = (1.25_f64.powi(5) - 0.5_f64.powi(5)) / 5.0 * 0.75_f64.powi(4) / 4.0;
        let found = integral(&SQUARE, &Extent::Box([low, high]), |x| x[0].powi(4) * x[1].powi(3));
        assert!((found / exact - 1.0).abs() < 1e-14, "{found} {exact}");
        // Part x < 1 of the triangle: ∫ x² y dA = ∫₀¹ x² (2 − x)²/2 dx.
        let found = integral(&TRIANGLE, &Extent::Box([[-9.0; 3], [1.0, 9.0, 9.0]]), |x| x[0].powi(2) * x[1]);
        let exact = 0.5 * (4.0 / 3.0 - 1.0 + 0.2);
        assert!((found / exact - 1.0).abs() < 1e-14, "{found} {exact}");
        // A box that ends at the edges of the facet, apart from the rounding of typed numbers, cuts nothing off.
        let typed = Extent::Box([[1e-11, -9.0, -9.0], [2.0 - 1e-11, 9.0, 9.0]]);
        assert!(matches!(clip(&SQUARE, &typed, 4), Clipped::Whole));
        assert!(matches!(clip(&SQUARE, &Extent::Box([[2.0, 0.0, 0.0], [3.0; 3]]), 4), Clipped::Nothing));
        assert!(matches!(clip(&SQUARE, &Extent::Box([[0.0, 0.0, 0.4], [3.0; 3]]), 4), Clipped::Nothing));
    }

    /// Areas and second moments of a disc within a facet, of a disc cut by its rim, and of a disc about a vertex.
    #[test]
    fn balls_cut_to_their_rim() {
        for facet in [&SQUARE[..], &TRIANGLE] {
            let ball = |centre: [f64; 2], radius: f64| {
                // The centre of the ball is 0.3 below the facet.
                let sphere = radius.hypot(0.3);
                Extent::Ball { centre: [centre[0], centre[1], 0.0], radius: sphere }
            };
            let r = 0.4;
            let area = integral(facet, &ball([0.5, 0.6], r), |_| 1.0);
            assert!((area / (PI * r * r) - 1.0).abs() < 1e-12, "{area}");
            let moment = integral(facet, &ball([0.5, 0.6], r), |x| (x[0] - 0.5).powi(2));
            assert!((moment / (PI * r.powi(4) / 4.0) - 1.0).abs() < 1e-12, "{moment}");
            // A quarter of a disc about the vertex: ∫ xy = r⁴/8. Half of a disc about a point of the edge.
            let moment = integral(facet, &ball([0.0, 0.0], r), |x| x[0] * x[1]);
            assert!((moment / (r.powi(4) / 8.0) - 1.0).abs() < 1e-12, "{moment}");
            let area = integral(facet, &ball([1.0, 0.0], r), |_| 1.0);
            assert!((area / (0.5 * PI * r * r) - 1.0).abs() < 1e-12, "{area}");
        }
        // A circular segment: the centre is 0.3 r outside the edge.
        let (r, e) = (0.5, 0.15_f64);
        let ball = Extent::Ball { centre: [1.0, -e, 0.3], radius: r };
        let exact = r * r * (e / r).acos() - e * (r * r - e * e).sqrt();
        let found = integral(&SQUARE, &ball, |_| 1.0);
        assert!((found / exact - 1.0).abs() < 1e-10, "{found} {exact}");
        assert!(matches!(clip(&SQUARE, &Extent::Ball { centre: [1.0, 1.0, 0.3], radius: 1.5 }, 4), Clipped::Whole));
        assert!(matches!(clip(&SQUARE, &Extent::Ball { centre: [1.0, 1.0, 2.0], radius: 1.5 }, 4), Clipped::Nothing));
    }
}
