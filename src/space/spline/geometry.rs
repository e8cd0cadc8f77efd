//! Geometry of a box and its impact point.

use crate::scene::{Contact, Geometry, Scene, Symmetry, Vec3, faces};

/// Smallest ratio of the shortest edge to the longest. The rounding error is proportional to the fourth power of the
/// inverse ratio, and is 1e-3 of the deflection at this limit.
const THINNEST: f64 = 1.0 / 2000.0;

/// A box, its impact point, and its modelled part.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BoxGeometry {
    /// Edge lengths of the whole box, m.
    pub size: Vec3,
    /// Impact point, m.
    pub hit: Vec3,
    /// Axis normal to the impacted face.
    pub struck: usize,
    /// Heights along z of the interfaces between different layers, including both ends, m; empty for one material.
    pub interfaces: Vec<f64>,
    /// Axes normal to planes of symmetry. The modelled part has positive coordinates along them.
    pub mirrors: Vec<usize>,
}

impl BoxGeometry {
    /// Geometry of a scene's box, or the reason why splines cannot model it.
    pub fn new(scene: &Scene) -> std::result::Result<Self, String> {
        let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else {
            return Err("the body is from a mesh file, not a box".into());
        };
        if scene.contact == Contact::Point {
            return Err("a solid yields without limit under a force at a point".into());
        }
        let [shortest, longest] =
            [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| size.iter().fold(size[0], |a, b| pick(a, *b)));
        if shortest < THINNEST * longest {
            return Err(format!(
                "rounding would show in a box that is 1/{:.0} as thin as it is long",
                longest / shortest
            ));
        }
        let mirrors = match scene.body.symmetry {
            Symmetry::Quarter { axes } => axes.to_vec(),
            Symmetry::None { .. } | Symmetry::Parts { .. } => Vec::new(),
        };
        let interfaces = scene.body.composition.interfaces();
        if !interfaces.is_empty() && struck != 2 {
            return Err("a side of its layers is hit".into());
        }
        Ok(Self { size: *size, hit: scene.impactor.point, struck, interfaces, mirrors })
    }

    /// Symmetry multiplicity: number of times that the modelled part fits into the whole box.
    pub fn multiplicity(&self) -> f64 {
        if self.mirrors.is_empty() { 1.0 } else { 4.0 }
    }

    /// Axes along the impacted face.
    pub fn plane(&self) -> [usize; 2] {
        faces::along(self.struck)
    }

    /// Ends of the modelled part along an axis, m.
    pub fn ends(&self, axis: usize) -> [f64; 2] {
        let half = 0.5 * self.size[axis];
        [if self.mirrors.contains(&axis) { 0.0 } else { -half }, half]
    }
}
