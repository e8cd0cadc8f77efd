//! The rigid impactor with one degree of freedom.

use super::Vec3;
use crate::contact::ForceLaw;

/// The rigid impactor with one degree of freedom, and the law of its contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Impactor {
    /// m0, kg.
    pub mass: f64,
    /// Radius R of the contact surface, m; laws other than Hertz's need none.
    pub radius: Option<f64>,
    /// Contact stiffness k0, N/m^1.5: given, or (15). For laws other than Hertz's that of Hertz's law with the same contact time on a
    /// half-space, by which cells, bases and theories are chosen.
    pub stiffness: f64,
    /// F(α).
    pub force_law: ForceLaw,
    /// d of Hunt and Crossley's factor 1 + d α̇, s/m.
    pub damping: f64,
    /// Speed along the direction at t = 0, m/s.
    pub speed: f64,
    /// Impact point on the surface of the body, m.
    pub point: Vec3,
    /// Unit vector of travel d.
    pub direction: Vec3,
    /// Distance to the surface at t = 0, m.
    pub gap: f64,
    /// Component of the acceleration of gravity along the direction, m/s²; 0 where the weight does not act.
    pub gravity: f64,
}

impl Impactor {
    /// Time of a contact with a fixed half-space without damping, s.
    pub fn contact_time(&self) -> f64 {
        self.force_law.contact_time(self.mass, self.speed)
    }

    /// Largest force of the same impact, N.
    pub fn peak_force(&self) -> f64 {
        self.force_law.peak_force(self.mass, self.speed)
    }

    /// Largest indentation of the same impact, m.
    pub fn peak_indentation(&self) -> f64 {
        self.force_law.peak_indentation(self.mass, self.speed)
    }
}
