//! A box seen as a plate: its middle plane, its thickness, and where it is hit.

use crate::scene::{Geometry, Scene, Symmetry, Vec3, faces};

pub(super) const NAMES: [&str; 3] = ["x", "y", "z"];

/// The plate's axes are two of the scene's; the deflection is along the impactor's direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlateGeometry {
    /// Scene's axes in the plane, ascending.
    pub axes: [usize; 2],
    /// Scene's axis across the plate.
    pub normal: usize,
    /// 1 where the impactor moves along the normal axis, −1 where against it.
    pub sign: f64,
    /// h, m.
    pub thickness: f64,
    /// Edge lengths of the whole plate, m.
    pub edges: [f64; 2],
    /// Where it is hit, from its centre, m.
    pub hit: [f64; 2],
    /// Whether only the part with positive coordinates is modelled.
    pub is_quarter: bool,
}

impl PlateGeometry {
    /// Why the body is no plate.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        let Geometry::Box { size, .. } = &scene.body.geometry else {
            return Err("the body is from a mesh file, not a box".into());
        };
        let direction = scene.impactor.direction;
        let mut along = (0..3).filter(|&axis| direction[axis] != 0.0);
        let (Some(normal), None) = (along.next(), along.next()) else {
            return Err("the impactor does not move along the normal of a face".into());
        };
        let axes = faces::along(normal);
        for axis in axes {
            // Equal lengths typed in different digits.
            if size[axis] < size[normal] * (1.0 - 1e-9) {
                let [across, along] = [normal, axis].map(|axis| NAMES[axis]);
                return Err(format!("the body is not thin along {across}: its edge along {along} is shorter"));
            }
        }
        Ok(Self {
            axes,
            normal,
            sign: direction[normal].signum(),
            thickness: size[normal],
            edges: axes.map(|axis| size[axis]),
            hit: axes.map(|axis| scene.impactor.point[axis]),
            is_quarter: matches!(scene.body.symmetry, Symmetry::Quarter { .. }),
        })
    }

    /// Scene's axes across planes of symmetry.
    pub fn mirrors(&self) -> Vec<usize> {
        if self.is_quarter { self.axes.to_vec() } else { Vec::new() }
    }

    /// A vector's component along the deflection.
    pub fn across(&self, vector: Vec3) -> f64 {
        self.sign * vector[self.normal]
    }

    /// A vector's components in the plane.
    pub fn in_plane(&self, vector: Vec3) -> [f64; 2] {
        self.axes.map(|axis| vector[axis])
    }

    /// How far the hit is from the nearest edge, m.
    pub fn room(&self) -> f64 {
        (0..2).map(|i| 0.5 * self.edges[i] - self.hit[i].abs()).fold(f64::INFINITY, f64::min)
    }
}
