//! Cross-section of a homogeneous plate, and its deflection as a field.

use super::Material;
use super::tensor::{Along, Derivative};

/// Integration over the whole plate.
pub const AREA: [Along; 2] = [Along::All; 2];

/// Field number of the deflection.
pub const DEFLECTION: usize = 0;

/// Cross-section of a homogeneous plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Thickness h, m.
    pub thickness: f64,
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
}

impl Section {
    /// Cross-section of a plate with this thickness (m).
    pub fn new(thickness: f64, material: &Material) -> Self {
        let Material { young, poisson, density } = *material;
        Self { thickness, young, poisson, density }
    }

    /// Returns the material of the plate.
    pub fn material(&self) -> Material {
        let Self { young, poisson, density, .. } = *self;
        Material { young, poisson, density }
    }

    /// Bending stiffness D = E h³ / (12 (1 − ν²)), N m.
    pub fn rigidity(&self) -> f64 {
        self.young * self.thickness.powi(3) / (12.0 * (1.0 - self.poisson * self.poisson))
    }

    /// Moment of inertia per unit width h³/12, m³.
    pub fn inertia(&self) -> f64 {
        self.thickness.powi(3) / 12.0
    }

    /// Shear stiffness μ h, N/m, without the shear factor κ.
    pub fn shear(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson) * self.thickness
    }
}

/// A derivative of the deflection w.
pub const fn deflection(derivatives: [usize; 2]) -> Derivative<2> {
    Derivative { field: DEFLECTION, derivatives }
}
