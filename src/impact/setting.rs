//! What an impact is made of, beside its body: the numbers of impactor and contact.

use crate::body::Body;
use crate::contact::{Hertz, Law, hertz};
use crate::error::{Error, Result};
use crate::scene;

/// Impactor and contact as the modelled part of the body meets them.
///
/// Of a body with n-fold symmetry one part is modelled, hit by that part of the impactor: mass and force are divided by
/// n, and the compliance c_l of the patch is multiplied, so that the indentation is the same.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
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

impl Setting {
    /// The setting of a scene with its body.
    pub fn new(impactor: &scene::Impactor, body: &Body) -> Self {
        Self::of(impactor, body.copies, body.localization.compliance)
    }

    /// The setting of an impactor with one of `copies` parts of a body, whose contact law has the compliance (m/N).
    pub fn of(impactor: &scene::Impactor, copies: f64, compliance: f64) -> Self {
        Self {
            mass: impactor.mass / copies,
            speed: impactor.speed,
            gap: impactor.gap,
            weight: impactor.mass / copies * impactor.gravity,
            law: Law { hertz: Hertz { stiffness: impactor.stiffness / copies }, compliance },
            copies,
        }
    }

    /// Refuses an approach beyond what the contact law can follow.
    ///
    /// # Errors
    /// [`Error::Solve`]; [`Error::Unstable`] where no impact reaches as far.
    pub(super) fn admit(&self, approach: f64) -> Result<()> {
        if approach <= self.law.limit() || approach.is_nan() {
            return Ok(());
        }
        // No impact presses harder than this on a body at rest; one that moves may do so by a little.
        let hardest = hertz::peak_force(self.law.hertz.stiffness, self.mass, self.speed);
        if self.law.force(approach) > 10.0 * hardest.max(self.law.force(self.law.limit())) {
            return Err(Error::Unstable(
                "the motion has blown up: the time integration is unstable at this step".into(),
            ));
        }
        Err(Error::Solve(format!(
            "the contact is as wide as the patch that stands for it: at a force of {:.4e} N the law's stiffness would turn \
             negative. A larger contact.patch_radius is needed, more than 1.2 (E*/E') times the contact's radius",
            self.copies * self.law.force(self.law.limit())
        )))
    }
}
