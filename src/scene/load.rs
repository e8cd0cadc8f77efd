//! Forces other than the contact's.

use super::{Vec3, Within};

/// Forces other than the contact's, constant from t = 0 on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Load {
    /// b of (1) without the body's weight, N/m³.
    pub body_force: Vec3,
    /// Acceleration of gravity, m/s²: of the density ρ of each part the force ρ g is added to b.
    pub gravity: Vec3,
    /// f of (3) on named surfaces.
    pub traction: Vec<Traction>,
}

impl Load {
    /// What acts on a part of a density (kg/m³), N/m³.
    pub fn force_on(&self, density: f64) -> Vec3 {
        [0, 1, 2].map(|i| self.body_force[i] + density * self.gravity[i])
    }

    /// Whether a force acts on the body's volume along an axis.
    pub fn acts_along(&self, axis: usize) -> bool {
        self.body_force[axis] != 0.0 || self.gravity[axis] != 0.0
    }
}

/// A constant traction on a named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Name of the surface.
    pub surface: String,
    /// The part of it that is loaded; all of it where this is left out.
    pub within: Option<Within>,
    /// f, N/m².
    pub value: Vec3,
}
