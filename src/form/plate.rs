//! Kirchhoff's and Reissner–Mindlin's plate theories as forms on fields: the deflection w, and for Reissner–Mindlin the
//! rotations θ.
//!
//! A point at the height z along w moves by z θ in the plane; in Kirchhoff's theory θ = −∇w.

use super::Material;
use super::tensor::{Along, Part, Square};

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
pub const fn deflection(derivatives: [usize; 2]) -> Part<2> {
    Part { field: DEFLECTION, derivatives }
}

/// A derivative of a rotation of the Reissner–Mindlin theory: field 1 is θ_x, field 2 is θ_y.
pub const fn rotation(axis: usize, derivatives: [usize; 2]) -> Part<2> {
    Part { field: 1 + axis, derivatives }
}

fn square(factor: f64, parts: &[Part<2>]) -> Square<2> {
    Square::of_sum(factor, parts, AREA)
}

/// Twice the elastic energy of Kirchhoff's theory, ∫ D (ν (Δw)² + (1 − ν) (w_xx² + w_yy² + 2 w_xy²)).
pub fn kirchhoff_elastic(section: &Section) -> Vec<Square<2>> {
    let (xx, yy, xy) = (deflection([2, 0]), deflection([0, 2]), deflection([1, 1]));
    bending(section, [[xx, yy], [xy, xy]])
}

/// Twice the elastic energy of the Reissner–Mindlin theory: the bending energy of θ, plus κ μ h ∫ |∇w + θ|².
pub fn mindlin_elastic(section: &Section, shear_factor: f64) -> Vec<Square<2>> {
    let stretch = [rotation(0, [1, 0]), rotation(1, [0, 1])];
    let twist = [rotation(0, [0, 1]), rotation(1, [1, 0])];
    let mut forms = bending(section, [stretch, twist]);
    let slopes = [[1, 0], [0, 1]].map(deflection);
    let shear = shear_factor * section.shear();
    forms.extend((0..2).map(|axis| square(shear, &[slopes[axis], rotation(axis, [0, 0])])));
    forms
}

/// Width, divided by h, of the strip at a free edge that does not contribute to the twisting stiffness of a plate. It
/// is half of Saint-Venant's 0.6302 in G b h³/3 (1 − 0.6302 h/b) for a rectangle b × h (Timoshenko & Goodier, *Theory
/// of Elasticity*, § 109).
const EDGE_WIDTH: f64 = 0.3151;

/// Width of the strip over which [`mindlin_edge`] is averaged, divided by h.
pub const EDGE_STRIP: f64 = 1.0;

/// Correction of twice the elastic energy of Mindlin's theory near a free edge normal to `axis`, over the strip `place`
/// there.
///
/// Near a free edge the twisting moment falls to zero, so that a width of 0.3151 h does not resist the twist τ, the
/// derivative along the edge of the rotation across it. In Mindlin's theory the width of this boundary layer is
/// h/√(12κ), which is too small with the κ of long waves. The rest of the energy is −μ h³/3 (0.3151 − 1/√(12κ)) h ∫ τ²
/// ds. It is spread over the strip, since τ hardly changes within the boundary layer. Applied at the edge line alone,
/// it would make short waves unstable. Spread over the strip, it is at most 0.05 of the twisting stiffness of the
/// plate, which Korn's inequality bounds.
pub fn mindlin_edge(section: &Section, shear_factor: f64, axis: usize, place: [Along; 2]) -> Square<2> {
    let width = EDGE_WIDTH - 1.0 / (12.0 * shear_factor).sqrt();
    let mut along = [0, 0];
    along[1 - axis] = 1;
    // μ h³/3
    let twisting = section.shear() * section.thickness.powi(2) / 3.0;
    Square::of_sum(-twisting * width / EDGE_STRIP, &[rotation(axis, along)], place)
}

/// ∫ D (ν (κ_x + κ_y)² + (1 − ν) (κ_x² + κ_y² + ½ (2κ_xy)²)), from the curvatures κ_x, κ_y and the two parts of 2κ_xy.
fn bending(section: &Section, [[x, y], twist]: [[Part<2>; 2]; 2]) -> Vec<Square<2>> {
    let (rigidity, nu) = (section.rigidity(), section.poisson);
    let part = rigidity * (1.0 - nu);
    vec![square(rigidity * nu, &[x, y]), square(part, &[x]), square(part, &[y]), square(0.5 * part, &twist)]
}

/// Twice the kinetic energy, ∫ ρ h w², with w as a velocity.
pub fn kirchhoff_mass(section: &Section) -> Vec<Square<2>> {
    vec![square(section.density * section.thickness, &[deflection([0, 0])])]
}

/// Twice the kinetic energy, ∫ ρ h w² + ρ h³/12 θ², with w and θ as velocities.
pub fn mindlin_mass(section: &Section) -> Vec<Square<2>> {
    let rotary = section.density * section.inertia();
    let mut forms = kirchhoff_mass(section);
    forms.extend((0..2).map(|axis| square(rotary, &[rotation(axis, [0, 0])])));
    forms
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Saint-Venant's constant for a thin rectangle is (192/π⁵) Σ 1/n⁵ over odd n; half of it equals the constant of
    /// the source to four digits.
    #[test]
    fn width_of_an_edge() {
        let sum: f64 = (0..50).map(|n| f64::from(2 * n + 1).powi(-5)).sum();
        let width = 0.5 * 192.0 / std::f64::consts::PI.powi(5) * sum;
        assert!((width - EDGE_WIDTH).abs() < 5e-5, "{width}");
    }
}
