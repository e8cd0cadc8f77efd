//! Parameters of the impactor and of the contact.

use crate::body::Body;
use crate::contact::{Footprint, Law};
use crate::error::{Error, Result};
use crate::scene;

/// Impactor and contact, scaled to the modelled part of the body.
///
/// For a body with n-fold symmetry, only one part is modelled. It is hit by one n-th of the impactor: mass and force
/// are divided by n, and the compliance c_l of the patch is multiplied by n, so that the indentation is the same.
#[derive(Debug, Clone)]
pub struct ImpactParameters {
    /// Mass m0 of one n-th of the impactor, kg.
    pub mass: f64,
    /// Speed of the impactor at t = 0, m/s.
    pub speed: f64,
    /// Speed of the hit with the work of the weight in the contact, m/s.
    pub contact_speed: f64,
    /// Duration of a contact with a half-space, s.
    pub contact_time: f64,
    /// Distance between impactor and body at t = 0, m.
    pub gap: f64,
    /// Component of the impactor's weight along its direction of travel, N; 0 without gravity.
    pub weight: f64,
    /// Contact law Φ(δ) of the modelled part.
    pub law: Law,
    /// Distribution of the force on the surface.
    pub footprint: Footprint,
    /// Whether the law is that of a sphere on the layers of the body.
    pub has_law_of_layers: bool,
    /// Number n of equal parts of the whole body.
    pub multiplicity: f64,
}

impl ImpactParameters {
    /// Returns the parameters of an impactor on a body.
    pub fn new(impactor: &scene::Impactor, body: &Body) -> Self {
        Self::of(impactor, body.terms.multiplicity, (body.terms.contact.compliance, body.terms.contact.footprint))
    }

    /// Returns the parameters of an impactor on one of `multiplicity` parts of a body. `compliance` is c_l of Hertz's law on
    /// that part, m/N.
    pub fn of(impactor: &scene::Impactor, multiplicity: f64, (compliance, footprint): (f64, Footprint)) -> Self {
        let layered = impactor.layered_contact().filter(|_| matches!(footprint, Footprint::Disc { .. }));
        let (force_law, compliance) = match layered {
            Some(layered) => (&layered.force_law, compliance - multiplicity * layered.compliance),
            None => (&impactor.force_law, compliance),
        };
        Self {
            mass: impactor.mass / multiplicity,
            speed: impactor.speed,
            contact_speed: impactor.contact_speed(),
            contact_time: impactor.contact_time(),
            gap: impactor.gap,
            weight: impactor.mass / multiplicity * impactor.gravity,
            law: Law { force_law: force_law.part(multiplicity), compliance, damping: impactor.damping },
            footprint,
            has_law_of_layers: layered.is_some(),
            multiplicity,
        }
    }

    /// Displacement (m) of the surface under the impactor: aᵀu, with the local part under a force (N) on a given area. (Under
    /// Hertz's law that part is the indentation's.)
    pub(super) fn surface(&self, displacement: f64, force: f64) -> f64 {
        let is_given = matches!(self.footprint, Footprint::Area { .. });
        if is_given { displacement - self.law.compliance * force } else { displacement }
    }

    /// Contact force F at an approach (m) and its rate (m/s), N.
    pub(super) fn force(&self, approach: f64, rate: f64) -> f64 {
        self.law.damped(approach, rate).force
    }

    /// Impulse ∫ F dt on the whole body since t = 0 at a velocity of the impactor (m/s) and a time (s), N s: the momentum that
    /// the impactor has lost and its weight has added.
    pub(super) fn impulse(&self, velocity: f64, time: f64) -> f64 {
        self.multiplicity * (self.mass * (self.speed - velocity) + self.weight * time)
    }

    /// Upper bound of the force, N: the largest force of the same impact on a fixed half-space, with an allowance for
    /// damping.
    pub(super) fn force_bound(&self) -> f64 {
        self.law.force_law.peak_force(self.mass, self.contact_speed) * (1.0 + self.law.damping * self.contact_speed)
    }

    /// Checks that the contact law is valid at an approach (m), its rate (m/s) and its force (N).
    ///
    /// # Errors
    /// [`Error::Solve`] if the approach is beyond the limit of the law; [`Error::Unstable`] if no impact can reach this
    /// approach.
    pub(super) fn admit(&self, approach: f64, rate: f64, force: f64) -> Result<()> {
        let law = self.law.at_rate(approach, rate);
        // Beyond the limit the approach may decrease again while the indentation increases.
        let is_within = approach <= law.limit() && law.admits(law.indentation(approach, force));
        if is_within || approach.is_nan() || rate.is_nan() {
            return Ok(());
        }
        if law.limit() == 0.0 {
            return Err(Error::Solve(format!(
                "the law of the contact is stiffer from its first touch on than the body's own dent on the patch, {:.4e} N/m: a larger \
                 contact.patch_radius, or a law that begins softer, is needed",
                self.multiplicity / law.compliance
            )));
        }
        // On a body at rest the force never exceeds `force_bound`; on a moving body it can be slightly larger. Ten times as
        // much is a sign of instability.
        if law.force(approach) > 10.0 * self.force_bound().max(law.force(law.limit())) {
            return Err(Error::Unstable(
                "the motion has blown up: the time integration is unstable at this step".into(),
            ));
        }
        if law.ends() {
            let (what, remedy) = match self.has_law_of_layers {
                true => (
                    "the contact law of the layers",
                    "With a larger contact.disc_radius, up to the distance to the edge, the law reaches further, but the errors by waves under the \
                     disc are not estimated. Or reduce the mass or the speed",
                ),
                false => ("contact.table", "The table has to go on, or the impactor has to be lighter or slower"),
            };
            return Err(Error::Solve(format!(
                "the impactor has come to the end of {what}, an indentation of {:.4e} m at a force of {:.4e} N. {remedy}",
                law.force_law.end(),
                self.multiplicity * law.force(law.limit())
            )));
        }
        let (what, remedy) = match self.footprint {
            Footprint::Disc { .. } | Footprint::Area { .. } => (
                "too wide for the contact law",
                "A larger contact.disc_radius, or a hit farther from edges and supports, is needed",
            ),
            Footprint::Patch(_) | Footprint::Point => (
                "as wide as the patch that stands for it",
                "A larger contact.patch_radius is needed, more than 1.2 (E*/E') times the contact's radius",
            ),
        };
        Err(Error::Solve(format!(
            "the contact is {what}: at a force of {:.4e} N the law's stiffness would turn negative. {remedy}",
            self.multiplicity * law.force(law.limit())
        )))
    }
}
