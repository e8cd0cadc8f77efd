//! Interpolates the largest tensions on faces between bodies that differ in one value.
//!
//! The largest tension is searched with the stresses of one body. Tensions of at least 0.8 of the largest are then
//! corrected: the stresses of the other bodies are evaluated at the same point and step. A change of the value also moves
//! the point of the largest tension, but near a maximum this changes the tension little.

use std::rc::Rc;

use super::{ContactNow, FaceStresses, FaceTension};

/// Tensions below this fraction of the largest one are not interpolated. Tensions of neighbouring bodies are assumed to
/// differ by less than 20%.
const NEAR_LARGEST: f64 = 0.8;

/// Bodies between which tensions are interpolated. They have the same sampled points and the same basis.
#[derive(Clone)]
pub struct FaceInterpolation {
    /// The bodies.
    pub bodies: Vec<WeightedFaces>,
}

/// Faces of a body, with its weights in the interpolation.
#[derive(Clone)]
pub struct WeightedFaces {
    /// Stresses on the faces for a unit value of each coordinate on the basis.
    pub faces: Rc<FaceStresses>,
    /// Weight in the interpolation.
    pub weight: f64,
    /// Weight in the linear interpolation between the two bodies that enclose the value, with which the error is
    /// estimated.
    pub linear_weight: f64,
}

/// An interpolated tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterpolatedTension {
    /// Tension, Pa.
    pub value: f64,
    /// Estimated error of the interpolation, Pa.
    pub error: f64,
}

impl FaceInterpolation {
    /// Smallest tension that is interpolated: a fraction of the largest one or, if that is lower, of a strength, Pa.
    pub fn smallest(largest: f64, strength: f64) -> f64 {
        NEAR_LARGEST * largest.min(strength)
    }

    /// Interpolates the largest tension of a face at a step, which was found with the stresses of one of the bodies
    /// (`searched`). `coordinates` are the coordinates on the basis at this step. `None` if the points are not on a grid, if
    /// a body has no stress at the point, or if its stresses are not a dense matrix with this number of coordinates.
    pub fn interpolate(
        &self,
        searched: &FaceStresses,
        (face, found): (usize, &FaceTension),
        coordinates: &[f64],
        contact: &ContactNow,
    ) -> Option<InterpolatedTension> {
        let point = searched.faces[face].nearest(found.point)?;
        let own = searched.tension_at(face, point, coordinates, contact)?;
        let (mut change, mut linear_change) = (0.0, 0.0);
        for WeightedFaces { faces, weight, linear_weight } in &self.bodies {
            let difference = faces.tension_at(face, point, coordinates, contact)? - own;
            change += weight * difference;
            linear_change += linear_weight * difference;
        }
        Some(InterpolatedTension { value: found.largest + change, error: (change - linear_change).abs() })
    }
}

#[cfg(test)]
mod tests {
    use super::super::faces::FaceGrid;
    use super::super::faces::tests::on_grid;
    use super::super::{Map, StressMap};
    use super::*;

    /// A face of nine points on a basis of one vector. At the middle point the tension is twice the factor times the
    /// coordinate.
    fn face(factor: f64) -> Rc<FaceStresses> {
        let lines = [-0.1, 0.0, 0.1].to_vec();
        let grid = FaceGrid { axes: [0, 1], lines: [lines.clone(), lines.clone()], is_mirrored: [false; 2] };
        let points: Vec<_> = lines.iter().flat_map(|a| lines.iter().map(|b| [*a, *b, 0.0])).collect();
        let rows = points.iter().flat_map(|[a, b, _]| [factor * (2.0 - a * a - b * b), 0.0, 0.0]).collect();
        let map = StressMap::Forms { map: Map::Dense(1, rows), components: 3 };
        Rc::new(FaceStresses::new(map, vec![on_grid(grid, points)]))
    }

    /// Stresses that are a cubic function of the value are interpolated exactly; the estimated error is that of linear
    /// interpolation.
    #[test]
    fn a_cubic_is_interpolated_exactly() {
        let values = [0.0, 1.0, 2.0, 3.0];
        let cubic = |x: f64| 1.0 + 0.1 * x - 0.02 * x * x + 0.003 * x * x * x;
        let x = 1.3;
        let weights = values.map(|own| {
            let others = values.iter().filter(|other| **other != own);
            others.map(|other| (x - other) / (own - other)).product()
        });
        let linear_weights = [0.0, 0.7, 0.3, 0.0];
        let bodies: Vec<WeightedFaces> = (0..4)
            .map(|i| WeightedFaces {
                faces: face(cubic(values[i])),
                weight: weights[i],
                linear_weight: linear_weights[i],
            })
            .collect();
        let searched = bodies[1].faces.clone();
        let interpolation = FaceInterpolation { bodies };
        let found = FaceTension { largest: 3.0 * 2.0 * cubic(1.0), point: [0.01, -0.02, 0.0] };
        let contact = ContactNow::default();
        let interpolated = interpolation.interpolate(&searched, (0, &found), &[3.0], &contact).expect("stresses");
        let [exact, linear] = [cubic(x), 0.7 * cubic(1.0) + 0.3 * cubic(2.0)].map(|factor| 3.0 * 2.0 * factor);
        // Rounding of sums of a few numbers.
        assert!((interpolated.value - exact).abs() < 1e-13 * exact, "{interpolated:?} {exact}");
        assert!((interpolated.error - (exact - linear).abs()).abs() < 1e-13 * exact, "{interpolated:?} {linear}");
        assert!(interpolated.error > 1e-3);
        // A wrong number of coordinates gives no tension.
        assert_eq!(interpolation.interpolate(&searched, (0, &found), &[3.0, 1.0], &contact), None);
    }
}
