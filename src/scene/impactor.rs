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
    /// Contact with a layer that is much softer than others of the body.
    pub soft_layer: SoftLayer,
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

/// Contact with an impacted layer that is much softer than others of the body.
#[derive(Debug, Clone, PartialEq)]
pub enum SoftLayer {
    /// The impacted layer is not soft, or Hertz's law is not asked for.
    None,
    /// Law in place of F(α) on plates, and on spline solids without a patch of a given radius. α is the approach minus the
    /// deflection under a point force.
    Law(ForceLaw),
    /// The layer is treated as a half-space, which is inaccurate: it is viscoelastic or thin compared with the contact, or
    /// the hit is near an edge, or a face of the box is supported.
    Untreated,
}

impl SoftLayer {
    /// Radius (m) of the disc on which bodies with a soft layer's law carry the force, for a thickness of the body (m). On a
    /// narrower one the contact may have negative stiffness. The soft layer does not bend separately, as a ply does.
    pub fn disc(thickness: f64) -> f64 {
        3.0 * thickness
    }
}

impl Impactor {
    /// The law of a soft layer, if there is one.
    pub fn soft_law(&self) -> Option<&ForceLaw> {
        if let SoftLayer::Law(law) = &self.soft_layer { Some(law) } else { None }
    }

    /// Whether another impactor has the same motion and the same contact law on a hard body.
    pub fn is_like(&self, other: &Self) -> bool {
        Self { soft_layer: SoftLayer::None, ..self.clone() } == Self { soft_layer: SoftLayer::None, ..other.clone() }
    }

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
