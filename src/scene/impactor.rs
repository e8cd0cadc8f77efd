//! The rigid impactor with one degree of freedom.

use std::sync::Arc;

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
    /// Effect of the other layers of the body on the contact.
    pub layer_effect: LayerEffect,
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

/// Effect of the layers below the impacted one on the contact.
#[derive(Debug, Clone, PartialEq)]
pub enum LayerEffect {
    /// The impacted layer is like a half-space, or Hertz's law is not asked for.
    Negligible,
    /// Law on plates, and on spline solids without a patch of a given radius.
    Law(Arc<LayeredContact>),
    /// The layer is treated as a half-space, which is inaccurate. The reason is a clause.
    Untreated(&'static str),
}

/// Contact with a stack of layers.
#[derive(Debug, Clone, PartialEq)]
pub struct LayeredContact {
    /// Law in place of F(α). Its indentation is the approach minus the mean displacement of the loaded disc on an infinite
    /// plate.
    pub force_law: ForceLaw,
    /// Part of a body's local compliance c_l (m/N) that this law leaves out, because its indentation is not that of Hertz's
    /// law.
    pub compliance: f64,
    /// Forces (N) with the contact radius (m) at each.
    pub radii: Vec<[f64; 2]>,
    /// Radius of the disc on which bodies carry the force, m.
    pub disc: f64,
}

impl LayeredContact {
    /// Contact radius (m) at a force (N): a power of the force between the known ones.
    pub fn radius(&self, force: f64) -> f64 {
        let number = self.radii.partition_point(|[at, _]| *at < force).clamp(1, self.radii.len() - 1);
        let ([f0, r0], [f1, r1]) = (self.radii[number - 1], self.radii[number]);
        // From the first touch on the contact is Hertz's.
        let exponent = if f0 > 0.0 { (r1 / r0).ln() / (f1 / f0).ln() } else { 1.0 / 3.0 };
        r1 * (force.max(0.0) / f1).powf(exponent)
    }
}

impl Impactor {
    /// The contact with the layers of the body, if it has a law of its own.
    pub fn layered_contact(&self) -> Option<&Arc<LayeredContact>> {
        if let LayerEffect::Law(contact) = &self.layer_effect { Some(contact) } else { None }
    }

    /// Whether another impactor has the same motion and the same contact law on a half-space.
    pub fn is_like(&self, other: &Self) -> bool {
        Self { layer_effect: LayerEffect::Negligible, ..self.clone() }
            == Self { layer_effect: LayerEffect::Negligible, ..other.clone() }
    }

    /// Duration of a contact with a fixed half-space without damping, s.
    pub fn contact_time(&self) -> f64 {
        self.force_law.contact_time(self.mass, self.speed)
    }

    /// Time (s) by which bases are made: the duration of the contact with a fixed half-space, halved as often as the contact with a
    /// stack of layers requires. (On a thin coat it may be a fifth.)
    pub fn basis_time(&self) -> f64 {
        let time = self.contact_time();
        let of_layers =
            self.layered_contact().map_or(time, |layered| layered.force_law.contact_time(self.mass, self.speed));
        time * (of_layers / time).log2().floor().clamp(-10.0, 0.0).exp2()
    }

    /// Half the contact time on a half-space, s. Static local fields replace viscoelastic layers by elastic ones, with
    /// their secant moduli at this time.
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
