//! Chooses the radius of the patch, and computes the least radius with which the contact law is valid.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::{Hertz, hertz, zener};
use crate::form::{ContactArea, Material};

/// Default radius of a patch over the thickness: an error of 0.16% by [`Patch::error`].
const PATCH_RADIUS_OVER_THICKNESS: f64 = 0.25;

/// Number of cells along the radius that resolve the pressure.
const CELLS: f64 = 2.0;

/// Safety factor on the limit radius of the law.
const MARGIN: f64 = 1.25;

/// A patch, with the quantities that determine its radius.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Patch {
    /// Radius r_p, m.
    pub radius: f64,
    /// Radius of the disc over which the force is applied to the body, m: r_p on a mesh, at least r_p with splines.
    pub disc: f64,
    /// Requirement that determined the radius.
    pub reason: Reason,
    /// Thickness h of the body under the impact point, along the inward normal, m.
    pub thickness: f64,
    /// Longest edge of the facets at the impact point, m; 0 if splines represent the pressure.
    pub cell: f64,
    /// Radius at which the contact stiffness vanishes at the largest indentation of an impact on a half-space, m. The
    /// body gives way, so a run may be valid with a smaller radius.
    pub limit_radius: f64,
    /// Whether the contact has Hertz's law.
    pub has_hertz_law: bool,
}

/// Requirement that determined the radius of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// The radius is given in the scene.
    Scene,
    /// The radius is the [equivalent one](ContactArea::equivalent_radius) of an area that is given in the scene.
    Area,
    /// A quarter of the thickness: the body near the patch must resemble the half-space whose local indentation is
    /// subtracted.
    Thickness,
    /// Two cells: smaller patches are not resolved.
    Cells,
    /// The contact law, which smaller patches make softer.
    Contact,
    /// The surface around the impact point, which has no room for a larger patch.
    Surface,
}

impl Patch {
    /// Relative error of the peak force due to the finite thickness: about 0.025 (r_p/h)². `None` if the contact has another
    /// law than Hertz's, which does not assume a contact that is small compared with the thickness.
    pub fn error(&self) -> Option<f64> {
        self.has_hertz_law.then(|| 0.025 * (self.radius / self.thickness).powi(2))
    }

    /// Tension on the opposite face that a force F at one point causes in excess of the force over the patch, times h²/F:
    /// 3 (1 + ν)/(2π) ln(b(r)/b(0)), here with ν = 0.25. A thick plate under a uniform pressure over a disc of radius r has
    /// the tension of a thin one under a disc of radius b = √(1.6 r² + h²) − 0.675 h for r < 1.724 h, else b = r (H. M.
    /// Westergaard, Stresses in concrete pavements computed by theoretical analysis, Public Roads 7, 1926). Hertz's pressure
    /// has the mean square distance from its centre of a uniform one over r = √0.8 r_p.
    pub fn tension_lost(&self) -> f64 {
        let equivalent = |r: f64| if r < 1.724 { (1.6 * r * r + 1.0).sqrt() - 0.675 } else { r };
        let radius = 0.8_f64.sqrt() * self.radius / self.thickness;
        3.0 * 1.25 / (2.0 * PI) * (equivalent(radius) / equivalent(0.0)).ln()
    }

    /// Whether cells are longer than r_p/2, so that the pressure is not resolved.
    pub fn is_coarse(&self) -> bool {
        // Exactly two cells, up to rounding, are enough.
        self.cell * CELLS > self.radius * (1.0 + 1e-9)
    }

    /// Whether an impact on a half-space would reach negative contact stiffness.
    pub fn is_critical(&self) -> bool {
        self.radius <= self.limit_radius
    }

    /// Chooses the largest radius required by thickness, cells and contact.
    pub(crate) fn choose(thickness: f64, cell: f64, limit_radius: f64, has_hertz_law: bool) -> Self {
        let (mut radius, mut reason) = (PATCH_RADIUS_OVER_THICKNESS * thickness, Reason::Thickness);
        for (least, of) in [(CELLS * cell, Reason::Cells), (MARGIN * limit_radius, Reason::Contact)] {
            // A mesh made for a quarter of the thickness meets the requirement up to rounding.
            if least > radius * (1.0 + 1e-9) {
                (radius, reason) = (least, of);
            }
        }
        Self { radius, disc: radius, reason, thickness, cell, limit_radius, has_hertz_law }
    }

    /// The patch with its radius reduced to the room on the surface.
    pub(crate) fn cut_to(self, radius: f64) -> Self {
        Self { radius, disc: radius, reason: Reason::Surface, ..self }
    }
}

/// Compliance c_l times r_p, m²/N. It is the mean displacement of a half-space along a unit vector, weighted by Hertz's
/// pressure over a disc, under the same pressure along that vector. `cosine` is the cosine of the angle between the
/// vector and the normal.
///
/// The normal part is (3/5) (1 − ν²)/E, and the tangential part is (2 − ν)/(2 − 2ν) times that. In the mean they do not
/// couple (Johnson, Contact Mechanics, 1985, (3.41a) and (3.91a)).
pub(crate) fn unit_compliance(struck: &Material, cosine: f64) -> f64 {
    let nu = struck.poisson;
    let normal = cosine * cosine;
    0.6 * (1.0 - nu * nu) / struck.young * (normal + (1.0 - normal) * (2.0 - nu) / (2.0 - 2.0 * nu))
}

/// Mean displacement of a half-space along a unit vector under 1 N along that vector on an area, weighted by the pressure,
/// m/N. `cosine` is the cosine of the angle between the vector and the normal.
pub(crate) fn dent(area: &ContactArea, struck: &Material, cosine: f64) -> f64 {
    unit_compliance(struck, cosine) * area.dent_over_hertz() / area.half_width
}

/// What an impactor brings to the contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blow {
    /// Stiffness k0 of Hertz's law, N/m^1.5.
    pub stiffness: f64,
    /// Mass of the impactor, kg.
    pub mass: f64,
    /// Speed at the first touch, m/s.
    pub speed: f64,
}

/// Radii at which the contact stiffness vanishes, 1 = c_l F′(α), m: at the largest indentation on a half-space, and at
/// the least indentation expected of a first hit. `mass` is the body's, kg.
///
/// The least indentation is the one on Zener's plate of the local thickness, without echoes. The mass is the reduced
/// mass of impactor and body, since a light body is pushed away.
pub(crate) fn limits(struck: &Material, blow: Blow, mass: f64, thickness: f64, unit_compliance: f64) -> (f64, f64) {
    let Blow { stiffness, mass: of_impactor, speed } = blow;
    let radius = |indentation| unit_compliance * Hertz { stiffness }.tangent(indentation);
    let reduced = of_impactor / (1.0 + of_impactor / mass);
    let impedance = zener::impedance(struck, thickness);
    (
        radius(hertz::peak_indentation(stiffness, of_impactor, speed)),
        radius(zener::peak_indentation(stiffness, reduced, speed, impedance)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean over all directions φ of a wave, with the ratio of Cerruti's and Boussinesq's solutions,
    /// (1 − ν cos² φ)/(1 − ν): the spectrum of the pressure is axisymmetric.
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
            let patch = Patch::choose(thickness, cell, limit, true);
            assert!((patch.radius / radius - 1.0).abs() < 1e-12 && patch.reason == reason, "{patch:?}");
            assert!(!patch.is_coarse() && !patch.is_critical(), "{patch:?}");
        }
    }
}
