//! What an impact is made of, beside its body: the numbers of impactor and contact.

use crate::body::Body;
use crate::contact::Law;
use crate::error::{Error, Result};
use crate::scene;

/// Impactor and contact as the modelled part of the body meets them.
///
/// Of a body with n-fold symmetry one part is modelled, hit by that part of the impactor: mass and force are divided by
/// n, and the compliance c_l of the patch is multiplied, so that the indentation is the same.
#[derive(Debug, Clone)]
pub struct ImpactParameters {
    /// m0 of the part, kg.
    pub mass: f64,
    /// Speed at t = 0, m/s.
    pub speed: f64,
    /// Distance at t = 0, m.
    pub gap: f64,
    /// The impactor's weight along its direction, where it acts, N.
    pub weight: f64,
    /// Φ(δ) of the part.
    pub law: Law,
    /// How many such parts the whole has.
    pub copies: f64,
}

impl ImpactParameters {
    /// The parameters of a scene with its body.
    pub fn new(impactor: &scene::Impactor, body: &Body) -> Self {
        Self::of(impactor, body.copies, body.localization.compliance)
    }

    /// The parameters of an impactor with one of `copies` parts of a body, whose contact law has the compliance (m/N).
    pub fn of(impactor: &scene::Impactor, copies: f64, compliance: f64) -> Self {
        Self {
            mass: impactor.mass / copies,
            speed: impactor.speed,
            gap: impactor.gap,
            weight: impactor.mass / copies * impactor.gravity,
            law: Law { force_law: impactor.force_law.part(copies), compliance, damping: impactor.damping },
            copies,
        }
    }

    /// F at an approach (m) and its rate (m/s), N.
    pub(super) fn force(&self, approach: f64, rate: f64) -> f64 {
        self.law.damped(approach, rate).force
    }

    /// Largest force of the same impact on a fixed half-space, N; with damping no more than that.
    pub(super) fn hardest(&self) -> f64 {
        self.law.force_law.peak_force(self.mass, self.speed) * (1.0 + self.law.damping * self.speed)
    }

    /// Refuses an approach (m) beyond what the contact law can follow at its rate (m/s).
    ///
    /// # Errors
    /// [`Error::Solve`]; [`Error::Unstable`] where no impact reaches as far.
    pub(super) fn admit(&self, approach: f64, rate: f64) -> Result<()> {
        let law = self.law.at_rate(approach, rate);
        if approach <= law.limit() || approach.is_nan() || rate.is_nan() {
            return Ok(());
        }
        if law.limit() == 0.0 {
            return Err(Error::Solve(format!(
                "the law of the contact is stiffer from its first touch on than the body's own dent on the patch, {:.4e} N/m: a larger \
                 contact.patch_radius, or a law that begins softer, is needed",
                self.copies / law.compliance
            )));
        }
        // No impact presses harder than this on a body at rest; one that moves may do so by a little.
        if law.force(approach) > 10.0 * self.hardest().max(law.force(law.limit())) {
            return Err(Error::Unstable(
                "the motion has blown up: the time integration is unstable at this step".into(),
            ));
        }
        if law.ends() {
            return Err(Error::Solve(format!(
                "the impactor has come to the end of contact.table, an indentation of {:.4e} m at a force of {:.4e} N: the table \
                 has to go on, or the impactor has to be lighter or slower",
                law.force_law.end(),
                self.copies * law.force(law.limit())
            )));
        }
        Err(Error::Solve(format!(
            "the contact is as wide as the patch that stands for it: at a force of {:.4e} N the law's stiffness would turn \
             negative. A larger contact.patch_radius is needed, more than 1.2 (E*/E') times the contact's radius",
            self.copies * law.force(law.limit())
        )))
    }
}
