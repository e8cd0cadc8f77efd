//! The rigid impactor with one degree of freedom.

use std::sync::Arc;

use super::Vec3;
use crate::contact::{Blow, ForceLaw, LayerEffect, LayeredContact};

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
    /// Acceleration towards the surface before the contact, m/s²: `gravity`, less the acceleration of a free body by its
    /// loads.
    pub closing: f64,
    /// Mass (kg) that determines how long contacts last: `mass`, but at most a hundred times the mass of the body. A light
    /// body that is free, or held softly, leaves a heavier impactor within the same time.
    pub timing_mass: f64,
}

/// Largest mass of an impactor that determines the duration of a contact, over the mass of the body. The duration on a
/// half-space is then six times that of the reduced mass, and time steps resolve the vibrations of the body; on free bodies the
/// force was right up to ratios of 3000.
pub(in crate::scene) const HEAVIEST: f64 = 100.0;

impl Impactor {
    /// The contact with the layers of the body, if it has a law of its own.
    pub fn layered_contact(&self) -> Option<&Arc<LayeredContact>> {
        if let LayerEffect::Law(contact) = &self.layer_effect { Some(contact) } else { None }
    }

    /// Estimated relative error of the force by the contact law; 0 if it is negligible or not estimated.
    pub fn error_of_law(&self) -> f64 {
        if let LayerEffect::Estimated(error) = self.layer_effect { error } else { 0.0 }
    }

    /// Whether another impactor has the same motion and the same contact law on a half-space.
    pub fn is_like(&self, other: &Self) -> bool {
        let of_motion = |one: &Self| Self {
            layer_effect: LayerEffect::Negligible,
            timing_mass: one.mass,
            closing: one.gravity,
            ..one.clone()
        };
        of_motion(self) == of_motion(other)
    }

    /// Time of the flight through the gap, s; infinite if the impactor turns back before the surface.
    pub fn flight_time(&self) -> f64 {
        let square = self.speed.powi(2) + 2.0 * self.closing * self.gap;
        match self.gap {
            0.0 => 0.0,
            _ if square < 0.0 => f64::INFINITY,
            gap => 2.0 * gap / (self.speed + square.sqrt()),
        }
    }

    /// Speed relative to the surface at the first touch, m/s; the speed at t = 0 if the impactor does not reach the surface.
    pub fn hit_speed(&self) -> f64 {
        let time = self.flight_time();
        if time.is_finite() { self.speed + self.closing * time } else { self.speed }
    }

    /// [`Self::hit_speed`] with the work that the weight does in the contact: the impact of an impactor at this speed and without
    /// weight has the peak force of one that is laid on a half-space, 2.5 times its weight by Hertz's law. In m/s.
    pub fn contact_speed(&self) -> f64 {
        let dent = self.force_law.indentation(2.5 * self.mass * self.gravity.max(0.0));
        self.hit_speed().hypot((2.0 * self.gravity.max(0.0) * dent).sqrt())
    }

    /// What it brings to the contact.
    pub(crate) fn blow(&self) -> Blow {
        Blow { stiffness: self.stiffness, mass: self.mass, speed: self.contact_speed() }
    }

    /// Duration of a contact with a fixed half-space without damping, s.
    pub fn contact_time(&self) -> f64 {
        self.force_law.contact_time(self.timing_mass, self.contact_speed())
    }

    /// Half the contact time on a half-space, s. Static local fields replace viscoelastic layers by elastic ones, with
    /// their secant moduli at this time.
    pub fn moduli_time(&self) -> f64 {
        0.5 * self.contact_time()
    }

    /// Peak force of an impact on a fixed half-space without damping, N.
    pub fn peak_force(&self) -> f64 {
        self.force_law.peak_force(self.mass, self.contact_speed())
    }

    /// Peak indentation of an impact on a fixed half-space without damping, m.
    pub fn peak_indentation(&self) -> f64 {
        self.force_law.peak_indentation(self.mass, self.contact_speed())
    }
}
