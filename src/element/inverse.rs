//! Reference coordinates of a point of a plane facet.

use nalgebra::Vector2;

use super::Shape;

/// Inverse of the degree-1 map of a plane facet, in closed form.
pub struct Inverse {
    /// Coefficients of x(ξ) = origin + first ξ₁ + second ξ₂ + twist ξ₁ξ₂.
    origin: Vector2<f64>,
    first: Vector2<f64>,
    second: Vector2<f64>,
    twist: Vector2<f64>,
}

impl Inverse {
    /// Inverse map of a convex facet with these vertices, counter-clockwise.
    ///
    /// # Panics
    /// If `shape` is not a facet shape.
    pub fn new(shape: Shape, x: &[[f64; 2]]) -> Self {
        let x: Vec<Vector2<f64>> = x.iter().copied().map(Vector2::from).collect();
        match shape {
            Shape::Triangle => Self { origin: x[0], first: x[1] - x[0], second: x[2] - x[0], twist: Vector2::zeros() },
            Shape::Quadrilateral => Self {
                origin: 0.25 * (x[0] + x[1] + x[2] + x[3]),
                first: 0.25 * (x[1] + x[2] - x[0] - x[3]),
                second: 0.25 * (x[2] + x[3] - x[0] - x[1]),
                twist: 0.25 * (x[0] + x[2] - x[1] - x[3]),
            },
            Shape::Tetrahedron | Shape::Hexahedron => panic!("{shape:?} is no facet"),
        }
    }

    /// Reference coordinates of a point of the facet.
    ///
    /// Elimination of ξ₁ yields a ξ₂² + b ξ₂ + c = 0. The slope of this polynomial at a root is the Jacobian
    /// determinant there, which is positive inside the facet. So the root is (−b + √(b² − 4ac))/2a, evaluated in the
    /// form without cancellation.
    pub fn at(&self, point: [f64; 2]) -> [f64; 3] {
        let p = Vector2::from(point) - self.origin;
        let a = self.twist.perp(&self.second);
        let b = self.first.perp(&self.second) + p.perp(&self.twist);
        let c = p.perp(&self.first);
        let root = (b * b - 4. * a * c).max(0.).sqrt();
        let eta = if b >= 0. { -2. * c / (b + root) } else { (root - b) / (2. * a) };
        let along = self.first + self.twist * eta;
        [along.dot(&(p - self.second * eta)) / along.norm_squared(), eta, 0.]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Element;

    /// The inverse of the map of a point is the point, on facets from affine to nearly degenerate.
    #[test]
    fn inverse_undoes_the_map() {
        let facets: [(Shape, &[[f64; 2]]); 6] = [
            (Shape::Triangle, &[[0.2, 0.1], [1.3, 0.4], [0.6, 2.]]),
            (Shape::Quadrilateral, &[[0., 0.], [2., 0.], [2., 1.], [0., 1.]]),
            (Shape::Quadrilateral, &[[0., 0.], [2., 0.3], [1.4, 1.5], [-0.2, 1.]]),
            (Shape::Quadrilateral, &[[-0.2, 1.], [0., 0.], [2., 0.3], [1.4, 1.5]]),
            // A trapezium, and a facet with one nearly straight corner.
            (Shape::Quadrilateral, &[[0., 0.], [3., 0.], [2., 1.], [1., 1.]]),
            (Shape::Quadrilateral, &[[0., 0.], [1., -1.], [2., 1e-3], [1., 1.]]),
        ];
        for (shape, x) in facets {
            let element = Element::new(shape, 1);
            let inverse = Inverse::new(shape, x);
            for i in 0..=10 {
                for j in 0..=10 {
                    let (s, t) = (f64::from(i) / 10., f64::from(j) / 10.);
                    let xi = match shape {
                        Shape::Triangle => [s * (1. - t), t, 0.],
                        _ => [2. * s - 1., 2. * t - 1., 0.],
                    };
                    let mut values = [0.; 4];
                    element.values(xi, &mut values);
                    let sum = |axis: usize| x.iter().zip(&values).map(|(x, value)| x[axis] * value).sum::<f64>();
                    let back = inverse.at([sum(0), sum(1)]);
                    // Rounding of b² − 4ac, multiplied by the squared area over the smallest determinant.
                    assert!((0..2).all(|d| (back[d] - xi[d]).abs() < 1e-12), "{x:?}: {xi:?} became {back:?}");
                }
            }
        }
    }
}
