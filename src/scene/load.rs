//! Loads on the body other than the contact force.

use super::{Vec3, Within};

/// Loads on the body other than the contact force, constant from t = 0 on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Load {
    /// Body force b of (1) without the weight, N/m³.
    pub body_force: Vec3,
    /// Acceleration of gravity g, m/s². In each part with density ρ the force ρ g is added to b.
    pub gravity: Vec3,
    /// Tractions f of (3) on named surfaces.
    pub traction: Vec<Traction>,
}

impl Load {
    /// Body force on a part with a density (kg/m³), including its weight, N/m³.
    pub fn force_on(&self, density: f64) -> Vec3 {
        [0, 1, 2].map(|i| self.body_force[i] + density * self.gravity[i])
    }

    /// Whether a body force or gravity acts along an axis.
    pub fn acts_along(&self, axis: usize) -> bool {
        self.body_force[axis] != 0.0 || self.gravity[axis] != 0.0
    }
}

/// A constant traction on a named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Name of the surface.
    pub surface: String,
    /// Loaded part of the surface; `None` for the whole surface.
    pub within: Option<Within>,
    /// Traction f, N/m².
    pub value: Vec3,
}
