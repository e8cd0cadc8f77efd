//! The radius of a patch: what it should be, and below what the contact law fails.

use serde::{Deserialize, Serialize};

use super::{Hertz, hertz, zener};
use crate::form::Material;
use crate::scene::Impactor;

/// Part of the thickness that a patch is made to cover: 0.16% of error by [`Patch::error`].
const OF_THICKNESS: f64 = 0.25;

/// Cells along the radius that carry the pressure.
const CELLS: f64 = 2.0;

/// How far a radius is kept from the limit of the law.
const MARGIN: f64 = 1.25;

/// A patch, and what its radius follows from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Patch {
    /// r_p, m.
    pub radius: f64,
    /// What decided the radius.
    pub reason: Reason,
    /// Thickness h of the body under the impact point, along the inward normal, m.
    pub thickness: f64,
    /// Longest edge of the facets at the impact point, m; 0 where splines carry the pressure.
    pub cell: f64,
    /// The radius at which the contact law has no stiffness left at the indentation of an impact on a half-space, m.
    /// The body yields, so that a run may hold below it.
    pub limit_radius: f64,
}

/// What decided the radius of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// The scene gives it.
    Scene,
    /// A quarter of the thickness: the half-space whose dent is taken out must be a good neighbour.
    Thickness,
    /// Two cells: smaller patches are not resolved.
    Cells,
    /// The contact law, which smaller patches make softer.
    Contact,
    /// The surface around the impact point, on which a larger patch has no room.
    Surface,
}

impl Patch {
    /// What the thickness leaves of error in the peak, as a part of it: about 0.025 (r_p/h)².
    pub fn error(&self) -> f64 {
        0.025 * (self.radius / self.thickness).powi(2)
    }

    /// Whether cells are coarser than r_p/2, so that the pressure is not resolved.
    pub fn is_coarse(&self) -> bool {
        // Two cells up to rounding.
        self.cell * CELLS > self.radius * (1.0 + 1e-9)
    }

    /// Whether an impact on a half-space would meet negative contact stiffness.
    pub fn is_critical(&self) -> bool {
        self.radius <= self.limit_radius
    }

    /// The largest of what thickness, cells and contact ask for.
    pub(crate) fn choose(thickness: f64, cell: f64, limit_radius: f64) -> Self {
        let (mut radius, mut reason) = (OF_THICKNESS * thickness, Reason::Thickness);
        for (least, of) in [(CELLS * cell, Reason::Cells), (MARGIN * limit_radius, Reason::Contact)] {
            // A mesh made for a quarter of the thickness has it up to rounding.
            if least > radius * (1.0 + 1e-9) {
                (radius, reason) = (least, of);
            }
        }
        Self { radius, reason, thickness, cell, limit_radius }
    }

    /// The same, as large as the surface has room for.
    pub(crate) fn cut_to(self, radius: f64) -> Self {
        Self { radius, reason: Reason::Surface, ..self }
    }
}

/// c_l r_p, m²/N: the mean displacement of a half-space along a unit vector, weighted by Hertz's pressure over a
/// disc, under the same pressure along that vector; `cosine` is the one between the vector and the normal.
///
/// (3/5) (1 − ν²)/E for the part along the normal and (2 − ν)/(2 − 2ν) times that for the part along the surface,
/// which do not couple in the mean (Johnson, Contact Mechanics, 1985, (3.41a) and (3.91a)).
pub(crate) fn unit_compliance(struck: &Material, cosine: f64) -> f64 {
    let nu = struck.poisson;
    let normal = cosine * cosine;
    0.6 * (1.0 - nu * nu) / struck.young * (normal + (1.0 - normal) * (2.0 - nu) / (2.0 - 2.0 * nu))
}

/// Radii at which the law has no stiffness left, 1 = c_l F′(α): at the indentation of an impact on a half-space, and
/// at the least that a first hit can be expected to reach, m. `mass` is the body's, kg.
///
/// The least is that of Zener's plate of the local thickness, without echoes, hit by the reduced mass of impactor and
/// body, since a light body flies off.
pub(crate) fn limits(
    struck: &Material,
    impactor: &Impactor,
    mass: f64,
    thickness: f64,
    unit_compliance: f64,
) -> (f64, f64) {
    let Impactor { stiffness, speed, .. } = *impactor;
    let radius = |indentation| unit_compliance * Hertz { stiffness }.tangent(indentation);
    let reduced = impactor.mass / (1.0 + impactor.mass / mass);
    let impedance = zener::impedance(struck, thickness);
    (
        radius(hertz::peak_indentation(stiffness, impactor.mass, speed)),
        radius(zener::peak_indentation(stiffness, reduced, speed, impedance)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean over all directions of a wave of what Cerruti's and Boussinesq's solutions give it, (1 − ν cos² φ) to
    /// 1 − ν, since the pressure's spectrum is round.
    #[test]
    fn compliance_along_the_surface() {
        for poisson in [-0.5, 0.0, 0.23, 0.49] {
            let glass = Material { young: 70e9, poisson, density: 1.0 };
            let waves = (0..12).map(|i| 1.0 - poisson * (f64::from(i) * std::f64::consts::PI / 12.0).cos().powi(2));
            let along = waves.sum::<f64>() / 12.0 / (1.0 - poisson);
            let normal = 0.6 * (1.0 - poisson * poisson) / 70e9;
            for (cosine, expected) in [(1.0, 1.0), (-1.0, 1.0), (0.0, along), (0.6, 0.36 + 0.64 * along)] {
                let ratio = unit_compliance(&glass, cosine) / normal;
                assert!((ratio / expected - 1.0).abs() < 1e-14, "{poisson} {cosine}: {ratio} {expected}");
            }
        }
    }

    #[test]
    fn the_largest_demand_decides() {
        for (thickness, cell, limit, radius, reason) in [
            (0.1, 0.01, 4e-3, 0.025, Reason::Thickness),
            (0.1, 0.0125 * (1.0 + 1e-15), 4e-3, 0.025, Reason::Thickness),
            (0.1, 0.02, 4e-3, 0.04, Reason::Cells),
            (0.02, 0.001, 4.4e-3, 5.5e-3, Reason::Contact),
            (0.02, 0.004, 4.4e-3, 8e-3, Reason::Cells),
        ] {
            let patch = Patch::choose(thickness, cell, limit);
            assert!((patch.radius / radius - 1.0).abs() < 1e-12 && patch.reason == reason, "{patch:?}");
            assert!(!patch.is_coarse() && !patch.is_critical(), "{patch:?}");
        }
    }
}
