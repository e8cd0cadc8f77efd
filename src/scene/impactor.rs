//! The rigid impactor with one degree of freedom.

use super::Vec3;
use crate::contact::ForceLaw;

/// The rigid impactor with one degree of freedom, and its contact law.
#[derive(Debug, Clone, PartialEq)]
pub struct Impactor {
    /// Mass m0, kg.
    pub mass: f64,
    /// Radius R of the contact surface, m. Only Hertz's law requires it.
    pub radius: Option<f64>,
    /// Contact stiffness k0, N/m^1.5: given, or computed by (15). For other laws: k0 of the Hertz law with the same
    /// contact time on a half-space. It is used to choose cells, bases and theories.
    pub stiffness: f64,
    /// Contact law F(α).
    pub force_law: ForceLaw,
    /// Law in place of F(α) on bodies whose impacted layer is much softer than others; otherwise `None`. α is then the
    /// approach minus the deflection under a point force.
    pub on_soft_layer: Option<ForceLaw>,
    /// Damping d of Hunt and Crossley's factor 1 + d α̇, s/m.
    pub damping: f64,
    /// Speed along the direction at t = 0, m/s.
    pub speed: f64,
    /// Impact point on the surface of the body, m.
    pub point: Vec3,
    /// Unit vector d of the direction of motion.
    pub direction: Vec3,
    /// Distance to the surface at t = 0, along the direction, m.
    pub gap: f64,
    /// Component of gravity along the direction, m/s²; 0 if the weight does not act on the impactor.
    pub gravity: f64,
}

impl Impactor {
    /// Duration of a contact with a fixed half-space without damping, s.
    pub fn contact_time(&self) -> f64 {
        self.force_law.contact_time(self.mass, self.speed)
    }

    /// Time (s) at which viscoelastic layers are taken as elastic in local fields, which are static: half the contact time.
    pub fn moduli_time(&self) -> f64 {
        0.5 * self.contact_time()
    }

    /// Peak force of an impact on a fixed half-space without damping, N.
    pub fn peak_force(&self) -> f64 {
        self.force_law.peak_force(self.mass, self.speed)
    }

    /// Peak indentation of an impact on a fixed half-space without damping, m.
    pub fn peak_indentation(&self) -> f64 {
        self.force_law.peak_indentation(self.mass, self.speed)
    }
}
