//! Local field at one point for any contact radius.

use super::half_space;

/// Stresses in cylindrical coordinates about the line of the force, Pa; tension is positive, z points into the body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cylindrical {
    /// Radial stress σ_rr.
    pub rr: f64,
    /// Hoop stress σ_θθ.
    pub tt: f64,
    /// Axial stress σ_zz.
    pub zz: f64,
    /// Shear stress σ_rz.
    pub rz: f64,
}

impl Cylindrical {
    /// Adds `factor` times another stress.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        Self {
            rr: self.rr + factor * other.rr,
            tt: self.tt + factor * other.tt,
            zz: self.zz + factor * other.zz,
            rz: self.rz + factor * other.rz,
        }
    }

    /// Returns xx, yy, zz, yz, xz, xy in Cartesian coordinates, from the unit vectors along r and z (into the body).
    ///
    /// σ = σ_θθ 1 + (σ_rr − σ_θθ) r rᵀ + (σ_zz − σ_θθ) z zᵀ + σ_rz (r zᵀ + z rᵀ).
    pub fn cartesian(&self, radial: [f64; 3], inward: [f64; 3]) -> [f64; 6] {
        [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)].map(|(i, j)| {
            let unit = if i == j { self.tt } else { 0.0 };
            let across = radial[i] * inward[j] + inward[i] * radial[j];
            unit + (self.rr - self.tt) * radial[i] * radial[j]
                + (self.zz - self.tt) * inward[i] * inward[j]
                + self.rz * across
        })
    }
}

/// Local field at one point: a polynomial in the square of the contact radius and, in the loaded layer, Hertz's field.
#[derive(Debug, Clone, PartialEq)]
pub struct PointField {
    /// Position at which Hertz's field is added, if it is.
    pub(super) hertz: Option<HertzPoint>,
    /// Coefficients of Chebyshev polynomials of 2 (r_c/largest)² − 1: σ_rr + σ_θθ, σ_rr − σ_θθ, σ_zz, σ_rz, Pa.
    pub(super) coefficients: Vec<[f64; 4]>,
    /// Largest contact radius, m.
    pub(super) largest: f64,
}

/// Point in the loaded layer (radius and depth in m) at which Hertz's field of a half-space is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HertzPoint {
    pub poisson: f64,
    pub radius: f64,
    pub depth: f64,
    /// Factor of Hertz's field there.
    pub factor: f64,
}

impl PointField {
    /// Stresses that 1 N adds at a contact radius, m. For a contact radius above the largest one prepared, the part
    /// other than Hertz's half-space field is evaluated at the largest one.
    pub fn stress(&self, contact_radius: f64) -> Cylindrical {
        let smooth = self.smooth_stress(contact_radius);
        let Some(HertzPoint { poisson, radius, depth, factor }) = self.hertz else { return smooth };
        smooth.plus(factor, &half_space::hertz(poisson, radius, depth, contact_radius))
    }

    /// Same as [`PointField::stress`], without Hertz's field of the loaded layer. On the loaded face this excludes the
    /// contact pressure and its ring of tension ([`half_space::ring_tension`]). These have steep gradients and are not
    /// comparable with a bending strength.
    pub fn smooth_stress(&self, contact_radius: f64) -> Cylindrical {
        let t = Self::variable(contact_radius, self.largest);
        // Clenshaw's recurrence.
        let (mut next, mut after) = ([0.0; 4], [0.0; 4]);
        for of_degree in self.coefficients.iter().skip(1).rev() {
            let this = std::array::from_fn(|i| of_degree[i] + 2.0 * t * next[i] - after[i]);
            (after, next) = (next, this);
        }
        let first = self.coefficients.first().copied().unwrap_or_default();
        let [sum, difference, zz, rz]: [f64; 4] = std::array::from_fn(|i| first[i] + t * next[i] - after[i]);
        of_bessel([sum, difference, zz, rz])
    }

    /// Coefficients of [`Self::smooth_stress`] in the Chebyshev polynomials T_0, T_1 and so on of [`Self::variable`].
    pub fn smooth_coefficients(&self) -> impl Iterator<Item = Cylindrical> {
        self.coefficients.iter().map(|coefficient| of_bessel(*coefficient))
    }

    /// Largest contact radius for which the field was prepared, m.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Argument of the Chebyshev polynomials: 2 (r_c/largest)² − 1, at most 1.
    pub fn variable(contact_radius: f64, largest: f64) -> f64 {
        2.0 * (contact_radius / largest).powi(2).min(1.0) - 1.0
    }
}

/// Stresses from σ_rr + σ_θθ, σ_rr − σ_θθ, σ_zz, σ_rz.
fn of_bessel([sum, difference, zz, rz]: [f64; 4]) -> Cylindrical {
    Cylindrical { rr: 0.5 * (sum + difference), tt: 0.5 * (sum - difference), zz, rz }
}
