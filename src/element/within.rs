//! Reference coordinates of a point in a cell.

use nalgebra::Vector3;

use super::{Element, Shape, table};

/// Maximum number of Newton steps; about five are needed if the point is in the cell.
const STEPS: usize = 30;

/// Reference coordinates of a point in the cell with vertices `x`, and their distance from the reference cell: 0
/// inside. `None` if the map of the cell does not reach the point, which is then outside.
///
/// # Panics
/// If `shape` is not a cell shape.
pub fn within(shape: Shape, x: &[[f64; 3]], point: [f64; 3]) -> Option<([f64; 3], f64)> {
    let geometry = Element::new(shape, 1);
    let (mut values, mut gradients) = ([0.; 8], [[0.; 3]; 8]);
    let n = geometry.nodes();
    let middle = if shape == Shape::Tetrahedron { 0.25 } else { 0. };
    let mut xi = Vector3::repeat(middle);
    for _ in 0..STEPS {
        geometry.values(xi.into(), &mut values[..n]);
        geometry.gradients(xi.into(), &mut gradients[..n]);
        let reached: Vector3<f64> = x.iter().zip(&values).map(|(x, value)| Vector3::from(*x) * *value).sum();
        let step = table::jacobian(&gradients[..n], x).lu().solve(&(Vector3::from(point) - reached))?;
        xi += step;
        if step.amax() <= 1e-13 * (1. + xi.amax()) {
            return Some((xi.into(), outside(shape, xi)));
        }
        // A point so far away is in another cell.
        if xi.amax() > 10. || xi.amax().is_nan() {
            return None;
        }
    }
    Some((xi.into(), outside(shape, xi)))
}

/// Distance of reference coordinates from the reference cell; 0 inside.
fn outside(shape: Shape, xi: Vector3<f64>) -> f64 {
    match shape {
        Shape::Tetrahedron => (-xi.min()).max(xi.sum() - 1.).max(0.),
        Shape::Hexahedron => (xi.amax() - 1.).max(0.),
        Shape::Triangle | Shape::Quadrilateral => panic!("{shape:?} is no cell"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverse of the map of a point is the point, in affine and in twisted cells, inside and outside.
    #[test]
    fn within_undoes_the_map() {
        let twisted: Vec<[f64; 3]> = Shape::Hexahedron
            .reference_vertices()
            .iter()
            .enumerate()
            .map(|(i, v)| [v[0] + 0.1 * (i as f64).sin(), 0.5 * v[1] + 0.05 * (2.0 * i as f64).cos(), 0.1 * v[2]])
            .collect();
        let tetrahedron = vec![[0.2, 0.1, 0.0], [1.3, 0.4, 0.1], [0.6, 2.0, 0.3], [0.5, 0.5, 0.05]];
        for (shape, x) in [(Shape::Hexahedron, twisted), (Shape::Tetrahedron, tetrahedron)] {
            let element = Element::new(shape, 1);
            let mut values = vec![0.; element.nodes()];
            for xi in [[0.1, 0.2, 0.3], [0.0, 0.0, 1.0], [0.7, 0.1, 0.2], [0.3, 0.3, 0.9], [-0.1, 0.2, 0.5]] {
                element.values(xi, &mut values);
                let point = [0, 1, 2].map(|c| x.iter().zip(&values).map(|(x, v)| x[c] * v).sum());
                let (found, out) = within(shape, &x, point).expect("a point near the cell");
                assert!((0..3).all(|c| (found[c] - xi[c]).abs() < 1e-12), "{shape:?}: {xi:?} became {found:?}");
                let expected = match shape {
                    Shape::Tetrahedron => (-xi.iter().copied().fold(0.0, f64::min)).max(xi.iter().sum::<f64>() - 1.0),
                    _ => 0.0,
                };
                assert!((out - expected.max(0.0)).abs() < 1e-12, "{shape:?} {xi:?}: {out}");
            }
        }
    }
}
